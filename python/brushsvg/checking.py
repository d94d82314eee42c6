"""The last look before a machine moves: a program read back, simulated, and held against limits and drawing."""

from __future__ import annotations

import re
from dataclasses import dataclass

import numpy as np

from . import _core
from .blends import blend_radii, blended
from .cell import Blending, Cell, robot_from_paper
from .errors import Error
from .frame import moved
from .limits import broken_limits
from .machine import off_sheet
from .posts.text import plain
from .readback import Readback, ReadSection, header_of

TOUCH_MM = 2e-3  # what the rounding of a program may lift a pose off the paper
CHORD_RAD = 0.02
Problems = list[tuple[str, str]]


@dataclass(frozen=True)
class Ran:
    """What a program paints: its passes as they are programmed and as they are run, with corners cut.

    problems: (stroke, sentence) for each thing that must not be.
    """

    plan: object
    marks: object
    problems: Problems


@dataclass(frozen=True)
class Made:
    """What a program's header says of how it was made."""

    title: str
    brush: str
    cell: str
    sheet_mm: tuple[float, float] | None
    z_offset_mm: float
    first_stroke: int


def made(text: str) -> Made:
    """Error when the header is not one of ours."""
    header = header_of(text)
    if not {"title", "brush", "cell"} <= set(header):
        raise Error("its header does not name title, brush and cell: brushsvg did not write this program")
    sheet = re.fullmatch(r"([\d.]+) x ([\d.]+) mm", header.get("sheet", ""))
    paper = re.match(r"[+-][\d.]+", header.get("paper", ""))
    resumed = re.fullmatch(r"from stroke (\d+)", header.get("resumed", ""))
    return Made(
        title=header["title"],
        brush=header["brush"].rpartition(", ")[0] or header["brush"],
        cell=header["cell"].rpartition(", ")[0],
        sheet_mm=(float(sheet[1]), float(sheet[2])) if sheet else None,
        z_offset_mm=float(paper[0]) if paper else 0.0,
        first_stroke=int(resumed[1]) if resumed else 1,
    )


def run(read: Readback, brush, cell: Cell, sheet_mm, z_offset_mm: float = 0.0) -> Ran:
    """Simulate the program as a machine of this cell runs it. Error for poses deeper than the brush allows."""
    problems: Problems = []
    meant, cut = [], []
    frame = np.eye(4) if read.in_paper_frame else robot_from_paper(cell, z_offset_mm)
    here = None
    for section in read.sections:
        track = _track(section, frame, here)
        problems += [(_name(section), said) for said in _careless(section, track, brush, cell, here)]
        if section.title.startswith("stroke "):
            found = list(_passes(section, track, here))
            if not found:
                problems.append((_name(section), "the brush never touches the paper"))
            for name, poses, radii, speed, arcs in found:
                joint = radii if read.in_paper_frame else blend_radii(poses, Blending(read.joint_mm))
                meant.append(_core.Pass(name, poses, speed, arcs=arcs))
                cut.append(_core.Pass(name, blended(poses, joint)[0], speed))
        here = track.points[-1] if len(track.points) else here
    plan = _core.Plan(brush.name, "", tuple(sheet_mm), meant)
    marks = _core.simulate(_core.Plan(brush.name, "", tuple(sheet_mm), cut), brush)
    problems += broken_limits(plan, brush, cell, z_offset_mm) + off_sheet(marks, brush, sheet_mm)
    return Ran(plan, marks, problems)


@dataclass(frozen=True)
class _Track:
    """The steps of a section in the paper's frame; circles as chords. step: which step each point belongs to."""

    points: np.ndarray
    step: np.ndarray
    centres: list


def _name(section: ReadSection) -> str:
    return section.title.partition(": ")[2] or section.title


def _track(section: ReadSection, frame: np.ndarray, here: np.ndarray | None) -> _Track:
    paper_from_robot = np.linalg.inv(frame)
    points, owner, centres = [], [], []
    last = here
    for number, step in enumerate(section.steps):
        centres.append(None)
        if np.isnan([step.x, step.y, step.z]).any():
            continue  # straight up, wherever the tool is
        end = moved(paper_from_robot, np.array([[step.x, step.y, step.z]]))[0]
        if step.centre is not None and last is not None:
            middle = moved(paper_from_robot, np.array([[*step.centre[:2], step.z]]))[0, :2]
            centres[-1] = (*middle.tolist(), step.centre[2])
            chords = _chords(last, end, centres[-1])
            points += chords
            owner += [number] * len(chords)
        points.append(end)
        owner.append(number)
        last = end
    return _Track(np.array(points).reshape(-1, 3), np.array(owner, dtype=int), centres)


def _chords(start: np.ndarray, end: np.ndarray, centre: tuple[float, float, int]) -> list[np.ndarray]:
    """Points of a circle between its ends, CHORD_RAD apart."""
    x, y, turn = centre
    first, last = np.arctan2(start[1] - y, start[0] - x), np.arctan2(end[1] - y, end[0] - x)
    sweep = (last - first) * turn % (2 * np.pi) * turn
    radius = np.hypot(end[0] - x, end[1] - y)
    count = int(np.ceil(abs(sweep) / CHORD_RAD))
    angles = first + sweep * np.arange(1, count) / max(count, 1)
    heights = np.linspace(start[2], end[2], count + 1)[1:-1]
    return [
        np.array([x + radius * np.cos(angle), y + radius * np.sin(angle), z])
        for angle, z in zip(angles, heights, strict=True)
    ]


def _passes(section: ReadSection, track: _Track, here: np.ndarray | None):
    """(name, poses, blends, speed, arcs) of each time that the brush is on the paper."""
    touching = track.points[:, 2] <= TOUCH_MM
    if not touching.any():
        return
    edges = np.flatnonzero(np.diff(np.r_[False, touching, False]))
    for first, last in zip(edges[::2], edges[1::2], strict=True):
        poses = track.points[first:last].copy()
        poses[:, 2] = np.minimum(poses[:, 2], 0.0)
        owner = track.step[first:last]
        steps = [section.steps[number] for number in owner]
        is_end = np.r_[np.diff(owner) != 0, True]
        radii = np.where(is_end, [step.blend_mm for step in steps], 0.0)
        speed = max((step.speed_mm_s for step in steps[1:]), default=steps[0].speed_mm_s)
        yield _name(section), poses, radii, speed, _arcs(owner, track.centres)


def _arcs(owner: np.ndarray, centres: list) -> list:
    """The circles among the poses."""
    rows = []
    for number in dict.fromkeys(owner.tolist()):
        on = np.flatnonzero(owner == number)
        if centres[number] is not None and on[0] > 0:
            x, y, turn = centres[number]
            rows.append(_core.Arc(int(on[0]) - 1, int(on[-1]), (x, y), turn))
    return rows


def _careless(section: ReadSection, track: _Track, brush, cell: Cell, here: np.ndarray | None):
    """Sentences for what is fast while it touches, or goes sideways too low in the air."""
    at_paint = section.title.startswith("paint")
    limit = min(brush.max_speed_mm_s, cell.speeds.paint_mm_s)
    last = here
    for point, number in zip(track.points, track.step, strict=True):
        step = section.steps[number]
        low = min(point[2], point[2] if last is None else last[2])
        sideways = last is None or np.abs(point[:2] - last[:2]).max() > TOUCH_MM
        touches = low <= TOUCH_MM
        if step.rapid and low < cell.heights.safe_mm - TOUCH_MM and (touches or sideways):
            how = "while the brush touches" if touches else f"at {low:.2f} mm, below the safe height"
            yield f"line {step.line}: a rapid move {how}"
        elif touches and not step.rapid and step.speed_mm_s > limit + 1e-6:
            yield f"line {step.line}: speed {step.speed_mm_s:.1f} mm/s while the brush touches, limit {limit:.1f} mm/s"
        elif sideways and not at_paint and low < cell.heights.safe_mm - TOUCH_MM and point[2] > TOUCH_MM:
            safe = f"the safe height {cell.heights.safe_mm:g} mm"
            yield f"line {step.line}: the tool travels at {low:.2f} mm, below {safe}"
        last = point


def matched(plan, strokes, resumed: bool = False) -> tuple[list, Problems]:
    """For each pass the stroke of the drawing that has its name (as programs write it), and what has no partner.

    None stands for a stroke that is painted in parts, between which paint is fetched: no part is to be measured
    against the whole. resumed: strokes that the program does not paint were painted before.
    """
    left: dict[str, list] = {}
    for stroke in strokes:
        left.setdefault(_written(stroke.id), []).append(stroke)
    names = [_written(a_pass.stroke) for a_pass in plan.passes]
    in_parts = {_whole(name) for name in names if _whole(name) != name}
    found, problems = [], []
    for name in names:
        key = _whole(name) if name not in left else name
        if key.endswith("..."):  # a long name is cut in a program
            key = next((each for each in left if each.startswith(key[:-3]) and left[each]), key)
        if key in in_parts and (left.get(key) or name != key):
            left[key] = []
            found.append(None)
        elif left.get(key):
            found.append(left[key].pop(0))
        else:
            problems.append((name, "the drawing has no such stroke"))
    if not resumed:
        missing = [stroke.id for rest in left.values() for stroke in rest]
        problems += [(name, "the program does not paint this stroke") for name in missing]
    return found, problems


def _whole(name: str) -> str:
    return re.sub(r"~\d+$", "", name)


def _written(name: str) -> str:
    return plain(name, 1000).translate({ord("("): "[", ord(")"): "]"})
