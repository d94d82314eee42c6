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
from .machine import DEFAULT_TOLERANCE_MM, off_sheet, text_of
from .moves import Program
from .paint import visits
from .posts import POSTS
from .posts.text import plain
from .program import Job, unchecked_program
from .readback import Readback, ReadSection, header_of

TOUCH_MM = 2e-3  # what the rounding of a program may lift a pose off the paper
CHORD_RAD = 0.02
STRAY_MM = 0.02  # what rounding and the chords of circles make of a path; a brush does not show it
Problems = list[tuple[str, str]]


@dataclass(frozen=True)
class Ran:
    """What a program paints: its passes as they are programmed and as they are run, with corners cut.

    problems: (stroke, sentence) for each thing that must not be.
    """

    plan: object
    marks: object
    problems: Problems
    visits: tuple


@dataclass(frozen=True)
class Made:
    """What a program's header says of how it was made."""

    title: str
    brush: str
    cell: str
    sheet_mm: tuple[float, float] | None
    z_offset_mm: float
    first_stroke: int
    compensation: str
    tolerance_mm: float
    lag_mm: float | None


def made(text: str) -> Made:
    """Error when the header is not one of ours."""
    header = header_of(text)
    if {"title", "cell"} <= set(header) and header["title"].startswith(("border of ", "how high the paper")):
        raise Error("this program paints no drawing: there are no marks to compare")
    if not {"title", "brush", "cell"} <= set(header):
        raise Error("its header does not name title, brush and cell: brushsvg did not write this program")
    sheet = re.fullmatch(r"([\d.]+) x ([\d.]+) mm", header.get("sheet", ""))
    paper = re.match(r"[+-][\d.]+", header.get("paper", ""))
    resumed = re.fullmatch(r"from stroke (\d+)", header.get("resumed", ""))
    how = re.match(r"(\w+), tolerance (\S+) mm(?:, lag (\S+) mm)?", header.get("compensation", ""))
    return Made(
        compensation=how[1] if how else "closed",
        tolerance_mm=float(how[2]) if how else DEFAULT_TOLERANCE_MM,
        lag_mm=float(how[3]) if how and how[3] else None,
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
    return Ran(plan, marks, problems, _visits(read, cell))


def _visits(read: Readback, cell: Cell) -> tuple:
    """For each stroke's section the stations that the program visits before it."""
    by_name = {station.name: station for station in cell.stations}
    found, waiting = [], []
    for section in read.sections:
        if section.title.startswith("paint: "):
            name = _name(section)
            if name not in by_name:
                raise Error(f"cell {cell.name} has no station {name!r}, which the program visits")
            waiting.append(by_name[name])
        elif section.title.startswith("stroke "):
            found.append(tuple(waiting))
            waiting = []
    return tuple(found)


def again(ran: Ran, read: Readback, brush, cell: Cell, z_offset_mm: float) -> Program | None:
    """What brushsvg would make of the strokes and visits that were read; None where a stroke is not one touch."""
    titles = [section.title for section in read.sections if section.title.startswith("stroke ")]
    if not titles or len(titles) != len(ran.plan.passes):
        return None
    first = int(re.match(r"stroke (\d+)", titles[0])[1])
    passes = [ran.plan.passes[0]] * (first - 1) + list(ran.plan.passes)
    plan = _core.Plan(brush.name, "", ran.plan.sheet_mm, passes)
    stops = ((),) * (first - 1) + ran.visits
    return unchecked_program(plan, brush, cell, (), Job(z_offset_mm, first, stops))


def rewritten(program: Program, cell: Cell) -> str:
    """Its text, without header."""
    return "".join(text_of(POSTS[cell.language], program))


def paint_problems(ran: Ran, expected, cell: Cell) -> Problems:
    """(stroke, sentence) for the first stroke before which paint is fetched otherwise than the cell says."""
    left: dict[str, list] = {}
    for a_pass in expected.passes:
        left.setdefault(_written(a_pass.stroke), []).append(a_pass)
    names = [_written(a_pass.stroke) for a_pass in ran.plan.passes]
    if sorted(names) != sorted(name for name, same in left.items() for _ in same):
        return []  # told by matched(); what was painted before is not known
    ordered = [left[name].pop(0) for name in names]
    wanted = visits(_core.Plan("", "", ran.plan.sheet_mm, ordered), cell) or ((),) * len(ordered)
    for a_pass, found, asked in zip(ordered, ran.visits, wanted, strict=True):
        if found != asked:
            told = [" and ".join(station.name for station in each) or "nothing" for each in (found, asked)]
            return [(a_pass.stroke, f"before it the program visits {told[0]}, the cell asks for {told[1]}")]
    return []


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
            chords = list(step.via) or _chords(last, end, centres[-1])
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


def strayed(plan, expected, cell: Cell) -> Problems:
    """(stroke, sentence) where a pass that was read does not run where the expected plan runs, by name."""
    limit_mm = STRAY_MM + (cell.servo.step_mm if cell.servo else 0.0)
    wanted: dict[str, list] = {}
    for a_pass in expected.passes:
        wanted.setdefault(_written(a_pass.stroke), []).append(a_pass)
    problems = []
    for a_pass in plan.passes:
        same = wanted.get(_written(a_pass.stroke))
        if not same:
            continue  # told by matched()
        meant = same.pop(0)
        found, asked = _round(a_pass), _round(meant)
        away_mm = max(_farthest(_along(found), asked), _farthest(_along(asked), found))
        if away_mm > limit_mm:
            sentence = (
                f"the program runs {away_mm:.2f} mm away from where the drawing asks it to: it was changed, or made "
                "with other flags or of another drawing"
            )
            problems.append((a_pass.stroke, sentence))
        if abs(a_pass.speed_mm_s - meant.speed_mm_s) > 0.1:
            asked = f"the drawing asks for {meant.speed_mm_s:.1f} mm/s"
            sentence = f"it is painted at {a_pass.speed_mm_s:.1f} mm/s, {asked}"
            problems.append((a_pass.stroke, sentence))
    return problems


def _round(a_pass) -> np.ndarray:
    """The poses, those on a circle with chords between them."""
    poses = np.asarray(a_pass.poses_mm)
    centres = {k: (*arc.centre_mm, arc.direction) for arc in a_pass.arcs for k in range(arc.first, arc.last)}
    points = [poses[0]]
    for k in range(len(poses) - 1):
        points += _chords(poses[k], poses[k + 1], centres[k]) if k in centres else []
        points.append(poses[k + 1])
    return np.array(points)


def _along(poses: np.ndarray) -> np.ndarray:
    """Poses and the middles between them."""
    return np.vstack([poses, (poses[1:] + poses[:-1]) / 2])


def _farthest(points: np.ndarray, path: np.ndarray) -> float:
    """Largest distance [mm] of points (n, 3) from a path (m, 3) of straight moves."""
    starts, steps = path[:-1], np.diff(path, axis=0)
    if not len(steps):
        return float(np.linalg.norm(points - path[0], axis=1).max())
    squares = np.maximum((steps**2).sum(axis=1), 1e-30)
    farthest = 0.0
    for first in range(0, len(points), 256):  # bounds the memory, nothing else
        offset = points[first : first + 256, None] - starts
        at = np.clip((offset * steps).sum(axis=2) / squares, 0, 1)
        away = np.linalg.norm(offset - at[..., None] * steps, axis=2).min(axis=1)
        farthest = max(farthest, float(away.max()))
    return farthest


def differing_line(text: str, written: str) -> str | None:
    """A sentence on the first line that brushsvg would write otherwise for the same poses; None where there is none.

    Numbers may differ by what rounding twice does to the last digit. The header is not looked at.
    """
    ours, theirs = _body(text), _body(written)
    for k in range(max(len(ours), len(theirs))):
        number, line = ours[k] if k < len(ours) else (0, "")
        expected = theirs[k][1] if k < len(theirs) else ""
        if line != expected and not _alike(line, expected):
            if not line:
                return f"the line {expected.strip()[:60]!r} is missing at the end"
            instead = (
                f"brushsvg would write {expected.strip()[:60]!r}" if expected else "nothing should follow"
            )
            return f"line {number}: {line.strip()[:60]!r}: for these strokes and this cell {instead}"
    return None


_NUMBER = re.compile(r"-?\d+(?:\.\d+)?")


def _body(text: str) -> list[tuple[int, str]]:
    lines = enumerate(text.splitlines(), 1)
    titles = r"\(?(stroke \d|paint: |border |end: )"
    return [
        (number, line)
        for number, line in lines
        if line.strip() and (re.match(titles, line) or not re.match(r"\(|  # (?!stroke|paint)", line))
    ]


def _alike(line: str, expected: str) -> bool:
    if _NUMBER.sub("0", line) != _NUMBER.sub("0", expected):
        return False
    for found, wanted in zip(_NUMBER.findall(line), _NUMBER.findall(expected), strict=True):
        decimals = len(wanted.partition(".")[2])
        if (
            len(found.partition(".")[2]) != decimals
            or abs(float(found) - float(wanted)) > 3.1 * 10.0**-decimals
        ):
            return False
    return True


def matched(plan, strokes, resumed: bool = False) -> tuple[list, Problems]:
    """For each pass the stroke of the drawing that has its name (as programs write it), and what has no partner.

    None stands for a stroke that is painted in parts, between which paint is fetched: no part is to be measured
    against the whole. resumed: strokes that the program does not paint were painted before.
    """
    left: dict[str, list] = {}
    for stroke in strokes:
        left.setdefault(_written(stroke.id), []).append(stroke)
    names = [_written(a_pass.stroke) for a_pass in plan.passes]
    in_parts = {_whole(name) for name in names if name not in left and _whole(name) != name}
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
    return re.sub(r"\+\d+$", "", name)


def _written(name: str) -> str:
    return plain(name, 1000).translate({ord("("): "[", ord(")"): "]"})
