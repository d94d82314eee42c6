"""The last check before a machine moves.

A program is read back, simulated as the machine runs it, and compared with the limits of the cell and the brush.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from .. import _core
from ..errors import Error, Notice
from ..machine.cells.cell import MOST_TILT_DEG, Blending, Cell, min_part_mm, robot_from_paper, unit_mm, value_mm
from ..machine.frames import is_upright, transform_points
from ..machine.limits.move_extents import make_paths
from ..machine.limits.paint_on_sheet import find_paint_off_sheet
from ..machine.limits.speeds import commanded_touching_mm_s, touching_mm_s
from ..machine.limits.vessels import find_vessels_entered, find_vessels_near_travel
from ..machine.limits.workspace import broken_limits, check_first_rise, find_broken_limits, find_limits_broken_between
from ..machine.pen_changes import may_pause, pen
from ..machine.posts.text import NAMED, spelled
from ..machine.preflight import as_run
from ..machine.realised.arc_chords import OFF_MM
from ..machine.realised.corner_blending import blend_radii
from ..machine.realised.distortion import commanded_pass, is_similar, true_mm, true_pass
from ..machine.setup_programs import slow_below_mm
from ..machine.station_moves import names_of_stations
from ..machine.tool_axes import tilts_deg
from .readback import Readback, ReadSection, Step

MAX_ROUNDING_LIFT_MM = 2e-3  # height by which the rounding of a program may lift a pose off the paper
MAX_CHORD_RAD = 0.02
TILT_ROUNDING_DEG = 0.01  # rounding error of a tilt
TURN_SPEED_TOLERANCE = 0.05  # share by which rounded places may speed up the tool's turn on a short move
# Both halves of an arc must turn by less than this: its poses are less than half a turn apart.
MAX_HALF_ARC_RAD = 3.0
Problems = list[Notice]


@dataclass(frozen=True)
class SimulatedProgram:
    """The passes and marks that a program paints.

    plan: the passes as they are programmed; as_run: the passes as the machine runs them, with corners cut; marks: the
    marks of `as_run`; problems: one notice for each violation; visits: for each stroke, the stations that the program
    visits before it; lines: for each pass, the line of the program that leads to each pose; rests: for each pass,
    whether a servo rests at each pose.
    """

    plan: object
    as_run: object
    marks: object
    problems: Problems
    visits: tuple
    lines: tuple
    rests: tuple


def slack_mm(cell: Cell) -> float:
    """Return the height error [mm] that rounding alone may cause.

    It comes from the program's units, or from a servo's whole values.
    """
    return max(MAX_ROUNDING_LIFT_MM, 1.1 * unit_mm(cell)) + (value_mm(cell) / 2 if cell.servo else 0.0)


def simulate_program(read: Readback, brush, cell: Cell, sheet_mm, z_offset_mm: float = 0.0) -> SimulatedProgram:
    """Simulate the program as a machine of this cell runs it.

    Raises Error for poses deeper than the brush allows.
    """
    problems: Problems = []
    programmed, run_passes, lines, rests = [], [], [], []
    slack = slack_mm(cell)
    leans = not read.in_paper_frame and not is_upright(robot_from_paper(cell, z_offset_mm))
    here = None
    frame = np.eye(4) if read.in_paper_frame else robot_from_paper(cell, z_offset_mm)
    for section, track, notices in walk_sections(read, brush, cell, sheet_mm, z_offset_mm):
        name = _section_name(section)
        problems += [replace(each, where=name) for each in notices]
        stroke = _match_stroke_title(section)
        track = _true_track(track, cell) if stroke else track
        track = track if cell.servo else _insert_paper_crossings(track, here, slack)
        here = track.points[-1] if len(track.points) else here
        touches = list(_find_touches(track, slack))
        if stroke and len(touches) != 1:
            times = f"{len(touches)} times, not once" if touches else "never"
            problems.append(Notice(name, f"the brush touches the paper {times}", code="touches-miscounted"))
        elif touches and not stroke and not section.title.startswith("paint: "):
            line = section.steps[track.step[touches[0].start]].line
            sentence = f"line {line}: the brush touches the paper outside of any stroke"
            problems.append(Notice(name, sentence, code="touches-outside-stroke"))
        for touch in touches if stroke else ():
            poses, radii, speed, arcs = _touch_to_pass(section, track, touch, cell, leans)
            axes = _tool_axes_of_touch(section, track, touch, frame)
            poses = _clamp_to_deepest(poses, brush, slack)
            joint = radii if read.blends_by_radius else blend_radii(poses, Blending(read.joint_mm), arcs)
            programmed.append(_core.Pass(name, poses, speed, arcs=arcs, tool_axes=axes))
            commanded = [commanded_pass(programmed[-1], cell)]
            run = true_pass(as_run(commanded, lambda *_, joint=joint: joint)[0][0], cell)
            # Where a machine on bent paper cuts a corner, it may go some micrometres deeper than the planned poses.
            # The simulation checks the depths of the planned poses themselves.
            is_allowed = poses[:, 2].min(initial=0.0) >= -brush.depth_range_mm[1]
            run_mm = _clamp_to_deepest(run.poses_mm, brush, np.inf if is_allowed else slack)
            run_passes.append(_core.Pass(name, run_mm, run.speed_mm_s, arcs=run.arcs, tool_axes=run.tool_axes))
            lines.append(np.array([section.steps[number].line for number in track.step[touch]]))
            rests.append(np.array([_servo_rests_after(section.steps[number], cell) for number in track.step[touch]]))
    plan = _core.Plan(brush.name, "", tuple(sheet_mm), programmed)
    run_plan = _core.Plan(brush.name, "", tuple(sheet_mm), run_passes)
    marks = _core.simulate(run_plan, brush, may_rise=True)
    visited = _visits_before_strokes(read, cell)
    if brush.paint:
        # Where visits belong to no stroke, each stroke begins freshly dipped, as in predictions.
        is_counted = cell.reload and len(visited) == len(run_passes)
        dips = [[0.0] if not is_counted or visited[k] else [] for k in range(len(run_passes))]
        _core.narrow(marks, brush.paint, dips)
    problems += find_vessels_near_travel(cell, z_offset_mm)
    problems += broken_limits(programmed, sheet_mm, brush, _with_rounding_allowance(cell))
    problems += find_paint_off_sheet(marks, brush, sheet_mm, rounded_mm=slack)
    return SimulatedProgram(plan, run_plan, marks, list(dict.fromkeys(problems)), visited, tuple(lines), tuple(rests))


def _clamp_to_deepest(poses_mm, brush, slack: float) -> np.ndarray:
    """Return poses (n, 3) [mm] raised to the brush's greatest depth.

    Only poses that rounding put below it are changed.
    """
    poses, deepest_mm = np.array(poses_mm), brush.depth_range_mm[1]
    just_over = (poses[:, 2] < -deepest_mm) & (poses[:, 2] >= -deepest_mm - slack)
    poses[just_over, 2] = -deepest_mm
    return poses


def _servo_rests_after(step: Step, cell: Cell) -> bool:
    """Return whether a servo rests after a step: a second wait follows that for its travel."""
    return bool(cell.servo) and step.waits > 1 and step.wait_s >= cell.servo.settle_s


def check_stroke_numbers(read: Readback, first_stroke: int, count: int) -> Problems:
    """Report the first stroke that is missing, superfluous or out of order.

    The program must contain all strokes from first_stroke to count, in order.
    """
    number = first_stroke - 1
    for section in read.sections:
        if found := _match_stroke_title(section):
            number += 1
            if (int(found[1]), int(found[2])) != (number, count):
                place = f"line {section.line}: stroke {found[1]} of {found[2]}"
                sentence = f"{place} stands where stroke {number} of {count} should"
                return [Notice(_section_name(section), sentence, code="stroke-misnumbered")]
    missing = f"stroke {count} is" if number == count - 1 else f"strokes {number + 1} to {count} are"
    return [Notice("", f"{missing} missing at the end", code="strokes-missing")] if number < count else []


def walk_sections(
    read: Readback, brush, cell: Cell, sheet_mm, z_offset_mm: float = 0.0, paper_mm: float = 0.0
) -> Iterator[tuple[ReadSection, Track, Problems]]:
    """Yield each section with its track and its notices.

    The track is in the paper frame. A notice reports an unsafe or out-of-bounds step. paper_mm: greatest height of the
    paper above its assumed place. Every move below this height has to be slow.
    """
    frame = np.eye(4) if read.in_paper_frame else robot_from_paper(cell, z_offset_mm)
    here, here_low, ends = None, None, []  # the tool's place as commanded, and its true place over the paper
    for section in read.sections:
        track = _track_of_section(section, frame, here)
        low = _true_track(track, cell) if _match_stroke_title(section) else track
        notices = [*_check_moves(section, low, track, brush, cell, here_low, paper_mm)]
        notices += _check_backlash(read, section, low, frame, brush, cell, paper_mm)
        if len(track.points):
            ends = [ends[0] if ends else track.points[0], track.points[-1]]
        if section is read.sections[-1]:
            notices += _check_rises(read, np.reshape(ends, (-1, 3)), frame, cell, z_offset_mm)
        yield (
            section,
            track,
            notices + _check_workspace_limits(section, track, here, cell, sheet_mm, z_offset_mm),
        )
        if len(track.points):
            here, here_low = track.points[-1], low.points[-1]


def _check_rises(read: Readback, ends: np.ndarray, frame: np.ndarray, cell: Cell, z_offset_mm: float) -> Problems:
    """Report the limits that the rise before the first move breaks.

    ends: (n, 3) first and last place of the program [mm], in the paper frame; frame: (4, 4) pose of the paper in the
    frame of the program.
    """
    robot_from_program = robot_from_paper(cell, z_offset_mm) @ np.linalg.inv(frame)
    places = transform_points(frame, ends)
    return [
        each
        for height_mm in dict.fromkeys(read.rises_mm)
        for each in check_first_rise(height_mm, places, robot_from_program, cell, slack_mm(cell))
    ]


def _with_rounding_allowance(cell: Cell) -> Cell:
    """Return the cell with limits widened so that rounded values still keep them."""
    heights = replace(cell.heights, lowest_mm=cell.heights.lowest_mm - slack_mm(cell))
    servo = cell.servo and replace(cell.servo, step_mm=cell.servo.step_mm + value_mm(cell))
    tool = cell.tool and replace(cell.tool, turn_deg_s=cell.tool.turn_deg_s * (1 + TURN_SPEED_TOLERANCE))
    return replace(cell, heights=heights, servo=servo, tool=tool)


def _check_workspace_limits(
    section: ReadSection, track: Track, here: np.ndarray | None, cell: Cell, sheet_mm, z_offset_mm: float
) -> Problems:
    """Report the workspace limits that a section breaks, also in the air. The move to the section is included."""
    slack, points = slack_mm(cell), track.points
    if not len(points):
        return []
    notices: Problems = []
    frame = robot_from_paper(cell, z_offset_mm)
    if here is not None:
        notices += find_limits_broken_between(here, points[0], frame, cell, slack)
    circles = []
    for number in [k for k, centre in enumerate(track.centres) if centre is not None]:
        on = np.flatnonzero(track.step == number)
        start = points[on[0] - 1] if on[0] else here
        circles.append((start, points[on[-1]], track.centres[number]))
    moves = make_paths([points], circles)
    entered = [] if section.title.startswith("paint: ") else find_vessels_entered(moves, cell, slack)
    return notices + entered + find_broken_limits(moves, frame, cell, sheet_mm, slack)


def _visits_before_strokes(read: Readback, cell: Cell) -> tuple:
    """Return each stroke's stations visited before; raise Error if the cell lacks one."""
    by_title = {_comparable_title(f"paint: {name}"): station for station, name in names_of_stations(cell).items()}
    visits, pending_stations = [], []
    for section in read.sections:
        if section.title.startswith("paint: "):
            pen_title = re.fullmatch(r"paint: pen ([0-9a-f]{6})", section.title)
            if pen_title and not cell.reload and may_pause(cell):
                pending_stations.append(pen(pen_title[1]))
                continue
            if (title := _comparable_title(section.title)) not in by_title:
                name = _section_name(section)
                sentence = f"line {section.line}: cell {cell.name} has no station {name!r}, which the program visits"
                raise Error(sentence, code="station-unknown")
            pending_stations.append(by_title[title])
        elif _match_stroke_title(section):
            visits.append(tuple(pending_stations))
            pending_stations = []
    return tuple(visits)


def _comparable_title(text: str) -> str:
    """Return the part of a title that a program contains in any language."""
    return spelled(text)[: len("paint: ") + NAMED].rstrip(" ")


@dataclass(frozen=True)
class Track:
    """The steps of a section in the paper frame, with circles as chords.

    points: (n, 3) places [mm]; step: (n,) index of the step that each point belongs to; centres: for each step, the
    centre and turn of its circle, or None.
    """

    points: np.ndarray
    step: np.ndarray
    centres: list


def _true_track(track: Track, cell: Cell) -> Track:
    """Return the true track of the tool for a commanded track."""
    if cell.machine is None:
        return track
    centres = [None] * len(track.centres)
    for number, centre in enumerate(track.centres if is_similar(cell.machine) else ()):
        if centre is not None:
            height_mm = track.points[np.flatnonzero(track.step == number)[-1], 2]
            x, y, _ = true_mm(np.array([[*centre[:2], height_mm]]), cell.machine)[0].tolist()
            centres[number] = (x, y, centre[2])
    return Track(true_mm(track.points, cell.machine), track.step, centres)


def _match_stroke_title(section: ReadSection) -> re.Match | None:
    """Match a stroke section's title: group 1 is the stroke's number, group 2 the strokes' count."""
    return re.match(r"stroke (\d{1,6}) of (\d{1,7}): ", section.title)


def _section_name(section: ReadSection) -> str:
    before, colon, name = section.title.partition(": ")
    return name if colon else before


def _track_of_section(section: ReadSection, frame: np.ndarray, here: np.ndarray | None) -> Track:
    steps, back = section.steps, np.linalg.inv(frame)
    ends = transform_points(back, np.array([(step.x, step.y, step.z) for step in steps], dtype=float).reshape(-1, 3))
    known = np.flatnonzero(~np.isnan(ends).any(axis=1))  # the other steps go straight up, from any place
    # A repeated line does not move the tool, except for its blend.
    stays = (np.diff(ends[known], axis=0) == 0).all(axis=1)
    does = [
        steps[k].centre is not None
        or steps[k].blend_mm > 0
        or steps[k].wait_s > 0
        or steps[k].axis != steps[before].axis
        for before, k in pairwise(known)
    ]
    stays &= ~np.array(does, dtype=bool)
    known = known[np.r_[True, ~stays]] if len(known) else known
    centres: list = [None] * len(steps)
    points, owner = [ends[:0]], [known[:0]]
    done = 0
    for at, number in enumerate(known):
        step = steps[number]
        last = ends[known[at - 1]] if at else here
        if step.centre is None or last is None:
            continue
        middle = transform_points(back, np.array([[*step.centre[:2], step.z]]))[0, :2]
        centres[number] = (*middle.tolist(), step.centre[2])
        named = transform_points(back, np.reshape(step.via, (-1, 3)))
        halves = ((last, named[0]), (named[0], ends[number])) if len(named) else ()
        if not halves:
            between = arc_points(last, ends[number], centres[number])
        elif max(abs(_sweep_rad(*half, centres[number])) for half in halves) < MAX_HALF_ARC_RAD:
            between = named
        else:  # the named place stays in the middle of the points between the ends, where brushsvg chooses it
            middles = [_middle_of_arc(*half, centres[number]) for half in halves]
            between = [middles[0], named[0], middles[1]]
        points += [ends[known[done:at]], np.reshape(between, (-1, 3))]
        owner += [known[done:at], np.full(len(between), number)]
        done = at
    return Track(np.vstack([*points, ends[known[done:]]]), np.concatenate([*owner, known[done:]]), centres)


def arc_points(start: np.ndarray, end: np.ndarray, centre: tuple[float, float, int]) -> list[np.ndarray]:
    """Return points (3,) of an arc between its ends.

    The points are MAX_CHORD_RAD apart, or closer, so that their chords stay within OFF_MM of the circle.
    """
    x, y, _ = centre
    first, sweep = np.arctan2(start[1] - y, start[0] - x), _sweep_rad(start, end, centre)
    radius = np.hypot(end[0] - x, end[1] - y)
    least = min(MAX_CHORD_RAD, 2 * np.arccos(1 - OFF_MM / max(radius, OFF_MM)))
    count = int(np.ceil(abs(sweep) / least))
    angles = first + sweep * np.arange(1, count) / max(count, 1)
    heights = np.linspace(start[2], end[2], count + 1)[1:-1]
    return [
        np.array([x + radius * np.cos(angle), y + radius * np.sin(angle), z])
        for angle, z in zip(angles, heights, strict=True)
    ]


def _sweep_rad(start: np.ndarray, end: np.ndarray, centre: tuple[float, float, int]) -> float:
    """Return the signed angle [rad] by which an arc turns from its start to its end."""
    x, y, turn = centre
    first, last = np.arctan2(start[1] - y, start[0] - x), np.arctan2(end[1] - y, end[0] - x)
    return (last - first) * turn % (2 * np.pi) * turn


def _middle_of_arc(start: np.ndarray, end: np.ndarray, centre: tuple[float, float, int]) -> np.ndarray:
    """Return the point (3,) halfway along an arc."""
    x, y, _ = centre
    angle = np.arctan2(start[1] - y, start[0] - x) + _sweep_rad(start, end, centre) / 2
    radius = np.hypot(end[0] - x, end[1] - y)
    return np.array([x + radius * np.cos(angle), y + radius * np.sin(angle), (start[2] + end[2]) / 2])


def _insert_paper_crossings(track: Track, here: np.ndarray | None, slack: float) -> Track:
    """Return the track with a point added where each straight move crosses the paper.

    A touch begins or ends at a crossing, whether or not the program names the place. The move from `here` to the
    first point is included. A servo's heights change in steps, so its moves have no crossings.
    """
    if here is None or not len(track.points):
        ways, step = track.points, track.step
    else:
        ways, step = np.vstack([here, track.points]), np.r_[track.step[:1], track.step]
    before, after = ways[:-1], ways[1:]
    straight = np.array([track.centres[number] is None for number in step[1:]], dtype=bool)
    crosses = np.minimum(before[:, 2], after[:, 2]) < -slack
    crosses &= np.maximum(before[:, 2], after[:, 2]) > slack
    at = np.flatnonzero(crosses & straight)
    before, after = before[at], after[at]
    part = before[:, 2:] / (before[:, 2:] - after[:, 2:])
    first = len(ways) - len(track.points)
    points = np.insert(ways, at + 1, before + part * (after - before), axis=0)[first:]
    return Track(points, np.insert(step, at + 1, step[at + 1])[first:], track.centres)


def _find_touches(track: Track, slack: float) -> Iterator[slice]:
    """Yield the points of each touch of the paper as a slice."""
    edges = np.flatnonzero(np.diff(np.r_[False, track.points[:, 2] <= slack, False]))
    for first, last in zip(edges[::2], edges[1::2], strict=True):
        yield slice(int(first), int(last))


def _touch_to_pass(section: ReadSection, track: Track, on: slice, cell: Cell, leans: bool) -> tuple:
    """Return poses (n, 3), blends (n,) [mm], speed [mm/s] and arcs of one touch.

    leans: whether the paper is tilted in the frame of the program.
    """
    poses = track.points[on].copy()
    poses[:, 2] = np.minimum(poses[:, 2], 0.0)
    owner = track.step[on]
    steps = [section.steps[number] for number in owner]
    is_end = np.r_[np.diff(track.step) != 0, True][on]
    radii = np.where(is_end, [step.blend_mm for step in steps], 0.0)
    speeds = [step.speed_mm_s for step in steps[1:] or steps if np.isfinite(step.speed_mm_s)]
    # A stroke lands no faster than it is painted.
    landed_mm_s = steps[0].speed_mm_s if steps[0].speed_mm_s <= cell.speeds.press_mm_s else 0.0
    speed = max(speeds, default=0.0)
    # After rounding, a straight move down has a small sideways part. The slower feed shows the intention. A servo is
    # slow on every steep part of its path. Without its sideways part, a short move could be rounded to nothing.
    if leans or cell.servo is None:
        sideways = np.abs(np.diff(poses[:, :2], axis=0)).max(axis=1, initial=0.0)
        slower = np.array([step.speed_mm_s for step in steps[1:]]) < speed - 1e-6
        rises = np.abs(np.diff(poses[:, 2])) > min_part_mm(cell)
        straight = np.flatnonzero(slower & rises & (sideways < 2 * unit_mm(cell)))
        falls = poses[straight + 1, 2] < poses[straight, 2]
        # The deeper pose keeps its place, and so its distance from the next pose along the stroke.
        for k in straight[falls][::-1]:
            poses[k, :2] = poses[k + 1, :2]
        for k in straight[~falls]:
            poses[k + 1, :2] = poses[k, :2]
    arcs = _arcs_of_touch(owner, track.centres)
    for first, last in _connected_arcs(arcs):  # connected arcs have one depth, except for rounding
        on_arcs = poses[first : last + 1, 2]
        if np.ptp(on_arcs) <= slack_mm(cell):
            on_arcs[:] = on_arcs.min()
    return poses, radii, max(speed, landed_mm_s), arcs


def _tool_axes_of_touch(section: ReadSection, track: Track, on: slice, frame: np.ndarray) -> np.ndarray:
    """Return tool axes (n, 3) at the poses of one touch, in the paper frame.

    The result is (0, 3) where the brush is upright. frame: (4, 4) pose of the paper in the frame of the program. Raises
    Error where the brush is tilted too far.
    """
    steps = [section.steps[number] for number in track.step[on]]
    if not any(step.axis for step in steps):
        return np.zeros((0, 3))
    normal = tuple(frame[:3, 2].tolist())
    axes = np.array([step.axis or normal for step in steps]) @ frame[:3, :3]
    most_deg = tilts_deg(axes)
    if most_deg[worst := int(most_deg.argmax())] > MOST_TILT_DEG + TILT_ROUNDING_DEG:
        raise Error(
            f"line {steps[worst].line}: the brush is tilted by {most_deg[worst]:.4g} degrees, outside the range "
            f"[0, {MOST_TILT_DEG:g}] degrees from upright",
            _section_name(section),
            code="tilt-out-of-range",
        )
    return axes


def _connected_arcs(arcs: list) -> list[list[int]]:
    """Return the first and last pose of each chain of arcs that begin where the previous one ends."""
    chains: list[list[int]] = []
    for arc in arcs:
        if chains and chains[-1][1] == arc.first:
            chains[-1][1] = arc.last
        else:
            chains.append([arc.first, arc.last])
    return chains


def _arcs_of_touch(owner: np.ndarray, centres: list) -> list:
    """Return the arcs among the poses of one touch. owner: (n,) step of each pose; centres: by step."""
    rows = []
    for number in dict.fromkeys(owner.tolist()):
        on = np.flatnonzero(owner == number)
        if centres[number] is not None and on[0] > 0:
            x, y, turn = centres[number]
            rows.append(_core.Arc(int(on[0]) - 1, int(on[-1]), (x, y), turn))
    return rows


def _check_moves(
    section: ReadSection,
    track: Track,
    commanded: Track,
    brush,
    cell: Cell,
    here: np.ndarray | None,
    paper_mm: float,
) -> Iterator[Notice]:
    """Report moves that are too fast while the brush touches, or too low in the air.

    A move is too low in the air if it goes sideways below the safe height. track: the way of the tool; commanded: the
    same points as the program states them.
    """
    if not len(track.points):
        return
    slack, safe = slack_mm(cell), cell.heights.safe_mm
    limit = _max_touching_mm_s(section, brush, cell)
    steps = [section.steps[number] for number in track.step]
    rapid = np.array([step.rapid for step in steps])
    speed = np.array([step.speed_mm_s for step in steps])
    before = np.vstack([track.points[:1] if here is None else here, track.points[:-1]])
    low = np.minimum(before[:, 2], track.points[:, 2])
    high = np.maximum(before[:, 2], track.points[:, 2])
    sideways = np.abs(track.points[:, :2] - before[:, :2]).max(axis=1) > 2 * slack  # both ends were rounded
    sideways[0] |= here is None
    touches, is_low = low <= paper_mm + slack, low < safe - slack
    careless = rapid & is_low & (touches | sideways)
    # A servo uses no feed while it stands.
    goes = (track.points[:, :2] != before[:, :2]).any(axis=1) if cell.servo else True
    fast = touches & ~rapid & goes & (speed > limit + 1e-6)
    travels = sideways & is_low & (high > paper_mm + slack) & (not section.title.startswith("paint: "))
    for k in np.flatnonzero(careless | fast | travels):
        line = f"line {steps[k].line}"
        if careless[k]:
            yield _rapid_notice(steps[k], "" if touches[k] else f"at {low[k]:.2f} mm, below the safe height")
        elif fast[k]:
            yield _speed_notice(steps[k], limit)
        else:
            sentence = f"{line}: the tool travels at {low[k]:.2f} mm, below the safe height {safe:g} mm"
            yield Notice("", sentence, code="travel-too-low")
    if cell.servo:
        first, last = np.diff(np.r_[False, touches, False].astype(int)).nonzero()[0].reshape(-1, 2).T
        ways_mm = np.linalg.norm(np.diff(commanded.points[:, :2], axis=0, prepend=before[:1, :2]), axis=1)
        from_mm, to_mm = (np.minimum(points[:, 2], paper_mm + slack) for points in (before, track.points))
        for on in map(slice, first, last):
            yield from _check_servo_tip_speed(steps[on], ways_mm[on], from_mm[on], to_mm[on], cell, limit)
        yield from _check_servo_lifts(steps, before, track.points, cell, paper_mm)


def _rapid_notice(step: Step, where: str = "") -> Notice:
    sentence = f"line {step.line}: a rapid move {where or 'while the brush touches'}"
    return Notice("", sentence, code="rapid-too-low")


def _max_touching_mm_s(section: ReadSection, brush, cell: Cell) -> float:
    """Return the highest commanded speed while the brush touches; only strokes are corrected for the machine."""
    return (commanded_touching_mm_s if _match_stroke_title(section) else touching_mm_s)(brush, cell)


def _speed_notice(step: Step, limit: float) -> Notice:
    speed = f"speed {step.speed_mm_s:.1f} mm/s while the brush touches, limit {limit:.1f} mm/s"
    return Notice("", f"line {step.line}: {speed}", code="speed-out-of-range")


def _check_backlash(
    read: Readback, section: ReadSection, low: Track, frame: np.ndarray, brush, cell: Cell, paper_mm: float
) -> Iterator[Notice]:
    """Report axes that take up their backlash too fast or too late.

    An axis must take up its backlash before the brush touches. While the brush touches, its speed is limited.
    """
    top_mm, limit = paper_mm + slack_mm(cell), _max_touching_mm_s(section, brush, cell)
    places = np.array([(step.x, step.y, step.z) for step in section.taking_up]).reshape(-1, 3)
    places = transform_points(np.linalg.inv(frame), places)
    heights = (true_mm(places, cell.machine) if _match_stroke_title(section) else places)[:, 2]
    for step, height_mm in zip(section.taking_up, heights, strict=True):
        if height_mm <= top_mm and step.rapid:
            yield _rapid_notice(step)
        elif height_mm <= top_mm and step.speed_mm_s > limit + 1e-6:
            yield _speed_notice(step, limit)
    lines = [section.steps[number].line for number in low.step[low.points[:, 2] <= top_mm]]
    for line in (each for each in lines if each in read.unsure):
        sentence = f"line {line}: the brush touches before the axes have taken up their backlash"
        yield Notice("", sentence, code="backlash-not-taken-up")
        break


def _check_servo_tip_speed(
    steps: list, ways_mm: np.ndarray, before_mm: np.ndarray, after_mm: np.ndarray, cell: Cell, limit: float
) -> Iterator[Notice]:
    """Report where the tip of a servo's brush is too fast in one touch.

    The feed of a servo is the speed of the path without the lift. Its heights change in steps of at least one value.
    Over any number of moves, the tip may be at most two steps and one value ahead of the distance that the limit
    allows in their time. ways_mm: (n,) commanded flat length of each step, for which its feed is; before_mm, after_mm:
    (n,) height of the tip at its start and end, at most where it touches; limit: [mm/s].
    """
    lead_mm = _max_servo_lead_mm(cell)
    speeds = np.array([step.speed_mm_s for step in steps])
    took_s = np.divide(ways_mm, speeds, out=np.zeros(len(steps)), where=speeds > 0)
    took_s = np.maximum(took_s, [step.took_s for step in steps])
    ends_s = np.cumsum(took_s + np.r_[0.0, [step.wait_s for step in steps[:-1]]])
    begins_s, ends_mm = ends_s - took_s, np.cumsum(ways_mm)
    # A steep move is slow, so the rounding of its ends changes its duration.
    rounded_s = np.divide(0.71 * unit_mm(cell), speeds, out=np.zeros(len(steps)), where=took_s > 0)
    rounded_s = np.max([rounded_s, np.r_[rounded_s[1:], 0.0], np.r_[0.0, rounded_s[:-1]]], axis=0)
    begins_mm = ends_mm - ways_mm
    for count in _window_lengths(len(steps)):
        rise_mm = np.abs(after_mm[count - 1 :] - before_mm[: len(steps) - count + 1])
        on_mm = ends_mm[count - 1 :] - begins_mm[: len(steps) - count + 1]
        path_mm = np.hypot(on_mm, np.maximum(rise_mm - lead_mm, 0.0))
        seconds = ends_s[count - 1 :] - begins_s[: len(steps) - count + 1]
        ends_rounded_s = np.minimum(rounded_s[: len(seconds)] + rounded_s[count - 1 :], seconds)
        most_mm = (limit + 1e-6) * (seconds + ends_rounded_s) + PATH_ROUNDING_MM
        ahead = np.flatnonzero((rise_mm > lead_mm) & (path_mm > most_mm))
        if len(ahead):
            k = int(ahead[0])
            line = f"line {steps[k + count - 1].line}"
            if path_mm[k] > 10 * limit * seconds[k]:
                problem = f"the height changes by {rise_mm[k]:.2f} mm at once while the brush touches"
            else:
                speed = path_mm[k] / seconds[k]
                problem = f"speed {speed:.1f} mm/s of the tip while the brush touches, limit {limit:.1f} mm/s"
            yield Notice("", f"{line}: {problem}", code="speed-out-of-range")
            return


def _max_servo_lead_mm(cell: Cell) -> float:
    """Return how far [mm] rounded heights may be ahead of the true ones.

    Rounded heights change in steps. A lift begins at the height that the servo held during the last part of the
    previous path.
    """
    return 2 * max(cell.servo.step_mm, value_mm(cell)) + value_mm(cell) + 1e-6


def _check_servo_lifts(
    steps: list, before: np.ndarray, after: np.ndarray, cell: Cell, paper_mm: float
) -> Iterator[Notice]:
    """Report lifts of a standing brush that are too far at once, or too fast.

    Lifts are checked between the clearance and the paper. A step may be no larger than brushsvg writes, and no faster
    than the cell presses. `_check_servo_tip_speed` compares lifts that are entirely in the paint with the brush's
    limit.
    """
    slow_mm = slow_below_mm(paper_mm, cell) if paper_mm else cell.heights.clearance_mm
    paper, clearance = paper_mm + slack_mm(cell), slow_mm - value_mm(cell)
    stands = ~(after[:, :2] != before[:, :2]).any(axis=1)
    highest = np.maximum(before[:, 2], after[:, 2])
    rise_mm = np.abs(np.minimum(after[:, 2], clearance) - np.minimum(before[:, 2], clearance))
    waits_s = np.array([step.wait_s for step in steps])
    least_s = rise_mm / cell.speeds.press_mm_s - WAIT_ROUNDING_S
    # Along a path, the height changes without a wait, and the move sideways follows.
    is_way = (waits_s == 0) & ~np.r_[stands[1:], False]
    fast = (rise_mm > _max_servo_lead_mm(cell)) | ((waits_s < least_s) & ~is_way)
    for k in np.flatnonzero(stands & (highest > paper) & fast):
        sentence = (
            f"line {steps[k].line}: the servo moves the brush by {rise_mm[k]:.2f} mm in {waits_s[k]:.3f} s near the "
            f"paper (steps of {cell.servo.step_mm:g} mm, at most {cell.speeds.press_mm_s:g} mm/s)"
        )
        yield Notice("", sentence, code="speed-out-of-range")
        return


WAIT_ROUNDING_S = 1e-3  # error of a wait by the rounding of its decimals
PATH_ROUNDING_MM = 4e-3  # error of a path length by the rounding of its ends


def _window_lengths(most: int) -> Iterator[int]:
    """Yield 1, 2, 3, 4, 6, 8, 12, ..., up to `most`.

    A tip that is too fast over any number of moves is also too fast, or nearly so, over one of these numbers.
    """
    count = 1
    while count <= most:
        yield count
        if count > 1 and count * 3 // 2 <= most:
            yield count * 3 // 2
        count *= 2
