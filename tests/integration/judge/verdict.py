"""Judge the run of a program.

The judge compares a run with the limits of its cell, along the whole way, and with a plan. It compares the
run of a damaged program with the run of the sound program. A brush touches where its tip is at most LAST_MM
over the paper. Lengths are in mm, and places are in the paper's frame unless a docstring says otherwise.
"""

from __future__ import annotations

import itertools
import json
import math
import re
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from . import places
from .backlash import with_play
from .dobot import run_dobot
from .doosan import run_doosan
from .ebb import run_ebb
from .fanuc import run_fanuc
from .gcode import run_gcode
from .hpgl import run_hpgl
from .jaka import run_jaka
from .krl import run_krl
from .moves import Leg, Run, arc_points
from .printer import Pen, run_printer
from .rapid import run_rapid
from .ros2 import run_ros2
from .urscript import run_urscript
from .xarm import run_xarm

OFF_MM = 0.1  # a larger deviation shows in the mark of a brush
# The distance between samples where the brush may touch. It limits how exactly OFF_MM is checked.
STEP_MM = 0.04
AIR_STEP_MM = 1.0
LAST_MM = 0.01
ROUNDING_MM = 0.002  # two units of the last decimal of the coarsest dialect
LEVER_MM = 10.0  # length of a brush: a leaning tool displaces the tip by its angle times this length
SLACK_MM = 0.01  # rounded numbers may exceed a limit by this much
MOST = 4000  # the largest number of samples in one leg


ROBOTS = {
    "urscript": run_urscript,
    "jaka": run_jaka,
    "rapid": run_rapid,
    "xarm": run_xarm,
    "krl": run_krl,
    "dobot": run_dobot,
    "fanuc": run_fanuc,
    "doosan": run_doosan,
    "ros2": run_ros2,
}


SERVOS = ("grbl-servo", "ebb")


@dataclass
class Job:
    """A job: the cell file, plan.json, the brush's top speed, the paper's height."""

    cell: dict
    plan: dict
    brush_mm_s: float
    z_offset_mm: float = 0.0
    first_stroke: int = 1
    compare: bool = True

    @cached_property
    def paper(self) -> np.ndarray:
        return places.paper_of(self.cell, self.z_offset_mm)

    @cached_property
    def back(self) -> np.ndarray:
        return np.linalg.inv(self.paper)

    @cached_property
    def language(self) -> str:
        return self.cell["language"]

    @cached_property
    def machine(self) -> dict | None:
        return self.cell.get("machine")

    @cached_property
    def servo_mm(self) -> tuple[float, float]:
        """Return a servo's largest height per value and its step, else zeros."""
        servo = self.cell.get("servo")
        if self.language not in SERVOS:
            return 0.0, 0.0
        steps = np.diff(np.array(servo["table"], dtype=float), axis=0)
        return float(np.abs(steps[:, 0] / steps[:, 1]).max()), servo.get("step_mm", 0.1)

    @cached_property
    def touch_mm(self) -> float:
        return LAST_MM + self.servo_mm[0] / 2

    @cached_property
    def near_mm(self) -> float:
        """Return the largest distance from the way of a visit.

        A servo moves along this way in steps, so its steps are added.
        """
        return 1.5 * OFF_MM + sum(self.servo_mm) / 2

    @cached_property
    def fastest_mm_s(self) -> float:
        return min(self.brush_mm_s, self.cell["speeds"]["paint_mm_s"])

    @cached_property
    def passes(self) -> list[np.ndarray]:
        """Return the sampled passes of the plan from the first stroke on.

        Circles of the plan stay round. On leaning paper and with a servo, a machine runs lines instead of
        circles. These lines are near enough to the circles.
        """
        return [_sampled(_round(each)) for each in self.plan["passes"][self.first_stroke - 1 :]]

    @cached_property
    def stations(self) -> list[np.ndarray]:
        """Return the way of each visit to a station."""
        safe, clear = self.cell["heights"]["safe_mm"], self.cell["heights"]["clearance_mm"]
        ways = []
        for station in self.cell.get("stations", ()):
            x, y = station["place_mm"]
            high = safe + places.highest_paper(x, y, self.machine)
            bottom = station.get("surface_mm", 0.0) - station.get("depth_mm", 0.0)
            wipes = [tuple(point) for point in station.get("wipe_mm", ())]
            end = wipes[-1][:2] if wipes else (x, y)
            way = [
                (x, y, high),
                (x, y, bottom),
                (x, y, station.get("rim_mm", 0.0) + clear),
                *wipes,
                (*end, high),
            ]
            if station.get("by_hand"):
                way = [(x, y, high), (x, y, high)]
            # The way is commanded as the cell has it. A machine that leans bends the way where it meets the
            # paper.
            ways.append(places.true_of(_sampled(np.array(way, dtype=float)), self.machine))
        return ways

    @cached_property
    def start(self) -> tuple:
        """Return the place of the tool before the job.

        It is low over the end of the job, so that a missing rise shows.
        """
        end, height = self.plan["passes"][-1]["poses_mm"][-1], self.cell["heights"]["safe_mm"] / 2
        return tuple(places.moved(self.paper, places.commanded_in_air(end, height, self.machine)[None])[0])

    def interpret(self, text: str) -> Run:
        """Return the run of the tool on the machine's axes, with their play."""
        run = self._interpreted(text)
        backlash_mm = (self.machine or {}).get("backlash_mm", (0.0, 0.0))
        return with_play(run, backlash_mm) if any(backlash_mm) else run

    def _interpreted(self, text: str) -> Run:
        if robot := ROBOTS.get(self.language):
            more = [self.cell["blending"].get("ramp_s", 0.5)] if self.language == "fanuc" else []
            more += [
                self.cell["contact"][key] for key in ("force_n", "sensitivity") if key in self.cell.get("contact", ())
            ]
            of = self.start, self.paper, places.down_of(self.cell), places.tool_of(self.cell)
            return robot(text, *of, *more)
        if self.language in ("marlin", "klipper"):
            return run_printer(text, self.language, self.start, bool(self.cell.get("arc_segment_mm")))
        if self.language == "marlin-servo":
            pen, safe_mm = self.cell["pen"], self.cell["heights"]["safe_mm"]
            heights = dict(zip(pen["servo_values"], (safe_mm, pen["down_mm"]), strict=True))
            servo = Pen(pen.get("servo_number", 0), heights, pen.get("settle_s", 0.3))
            return run_printer(text, "marlin", self.start, False, servo)
        if self.language == "hpgl":
            heights = self.cell["pen"]["down_mm"], self.cell["heights"]["safe_mm"]
            return run_hpgl(text, self.start, *heights, self.cell["speeds"]["travel_mm_s"])
        if self.language == "ebb":
            return run_ebb(text, self.start, self.cell["motors"], self.cell["servo"]["table"])
        dialect = self.language.removesuffix("-servo")
        servo = self.cell["servo"]["table"] if self.language == "grbl-servo" else None
        return run_gcode(text, dialect, self.start, servo, self.cell["speeds"]["travel_mm_s"])


def _round(a_pass: dict) -> np.ndarray:
    poses = np.array(a_pass["poses_mm"], dtype=float)
    circles = {}
    for first, last, x, y, turn in a_pass.get("arcs", ()):
        circles |= {k: (x, y, turn) for k in range(first, last)}
    points = [poses[:1]]
    for k in range(len(poses) - 1):
        if k in circles:
            x, y, turn = circles[k]
            leg = Leg(0, "arc", tuple(poses[k]), tuple(poses[k + 1]), 1.0, (x, y), turn)
            if np.linalg.norm(poses[k, :2] - poses[k + 1, :2]) > 1e-6:
                points.append(arc_points(leg))
                continue
        points.append(poses[k + 1 : k + 2])
    return np.vstack(points)


def _sampled(points: np.ndarray) -> np.ndarray:
    steps = np.diff(points, axis=0)
    counts = np.maximum(1, np.ceil(np.linalg.norm(steps, axis=1) / STEP_MM)).astype(int)
    which = np.repeat(np.arange(len(steps)), counts)
    part = (np.arange(len(which)) - np.repeat(np.cumsum(counts) - counts, counts) + 1) / counts[which]
    return np.vstack([points[:1], points[which] + steps[which] * part[:, None]])


@dataclass
class Way:
    """A run in the paper's frame, as the machine moves.

    starts and ends (n, 3) belong to straight moves; a circle is split into chords. leg holds the index of
    each move's leg. samples (m, 3) are places along the moves, row holds the index of each sample's move, and
    commanded holds the commanded places. touches holds the samples of each touch, and commanded_touches the
    commanded places.
    """

    run: Run
    starts: np.ndarray
    ends: np.ndarray
    leg: np.ndarray
    samples: np.ndarray
    row: np.ndarray
    commanded: np.ndarray
    touches: list[np.ndarray] = field(default_factory=list)
    commanded_touches: list[np.ndarray] = field(default_factory=list)


def way_of(run: Run, job: Job) -> Way:
    moving = [k for k, leg in enumerate(run.legs) if leg.kind not in ("wait", "stop")]
    both = np.array([(run.legs[k].start, run.legs[k].end) for k in moving], dtype=float).reshape(-1, 2, 3)
    both = np.clip(both, -1e7, 1e7)
    starts, ends = (places.moved(job.back, both[:, side]) for side in (0, 1))
    owner = np.array(moving, dtype=int)
    arcs = [n for n, k in enumerate(moving) if run.legs[k].kind == "arc"]
    if arcs:
        parts, done = [], 0
        for n in arcs:
            leg = run.legs[moving[n]]
            if run.blends_by_radius:
                points = arc_points(leg._replace(start=tuple(starts[n]), end=tuple(ends[n])))
            else:
                points = places.moved(job.back, arc_points(leg))
            points = np.vstack([starts[n], points])
            parts += [
                (starts[done:n], ends[done:n], owner[done:n]),
                (points[:-1], points[1:], np.full(len(points) - 1, moving[n])),
            ]
            done = n + 1
        parts.append((starts[done:], ends[done:], owner[done:]))
        starts, ends, owner = (np.concatenate(each) for each in zip(*parts, strict=True))
    if not len(starts):
        return Way(run, starts, ends, owner, starts, owner, starts)
    steps = ends - starts
    true_starts, true_ends = (places.true_of(each, job.machine) for each in (starts, ends))
    low = np.minimum(true_starts[:, 2], true_ends[:, 2]) < 1.0
    counts = np.ceil(np.linalg.norm(steps, axis=1) / np.where(low, STEP_MM, AIR_STEP_MM))
    counts = np.clip(counts, 1, MOST).astype(int)
    row = np.repeat(np.arange(len(steps)), counts)
    part = (np.arange(len(row)) - np.repeat(np.cumsum(counts) - counts, counts) + 1) / counts[row]
    commanded = starts[row] + steps[row] * part[:, None]
    samples = places.true_of(commanded, job.machine)
    on = samples[:, 2] <= job.touch_mm
    edges = np.flatnonzero(np.diff(np.r_[False, on, False].astype(int)))
    touches, commanded_touches = (
        [each[a:b] for a, b in zip(edges[::2], edges[1::2], strict=True)] for each in (samples, commanded)
    )
    return Way(run, true_starts, true_ends, owner, samples, row, commanded, touches, commanded_touches)


# Limits -----------------------------------------------------------------------------------------------


def broken(way: Way, job: Job) -> list[str]:
    """Return a sentence for each broken limit and for each move too fast or too low."""
    if not len(way.starts):
        return []
    return [*_beyond(way, job), *_fast(way, job), *_low(way, job), *_leaning(way)]


def _beyond(way: Way, job: Job):
    first = _first_place(way)
    cell, points = job.cell, way.commanded[first:]
    if not len(points):
        return
    # The limit of the height applies to strokes as they are painted, and to vessels as they stand.
    heights = points[:, 2] if job.machine is None else np.maximum(points[:, 2], way.samples[first:, 2])
    workspace = cell["workspace"]
    slack = SLACK_MM + job.servo_mm[0] / 2
    margin = np.array([workspace["margin_mm"]] * 2) + SLACK_MM
    over = np.maximum(-margin - points[:, :2], points[:, :2] - margin - np.array(job.plan["sheet_mm"])).max(axis=1)
    if over.max() > 0:
        yield f"{over.max():.3f} mm beyond the sheet's margin, line {_line(way, over.argmax() + first)}"
    if heights.min() < cell["heights"]["lowest_mm"] - slack:
        yield f"height {heights.min():.3f} mm, line {_line(way, heights.argmin() + first)}"
    robot = places.moved(job.paper, points)
    if box := workspace.get("box_mm"):
        over = np.maximum(np.array(box[0]) - robot, robot - np.array(box[1])).max(axis=1)
        if over.max() > SLACK_MM:
            yield f"{over.max():.3f} mm out of the box, line {_line(way, over.argmax() + first)}"
    for low, high in workspace.get("keep_out_mm", ()):
        inside = np.minimum(robot - np.array(low), np.array(high) - robot).min(axis=1)
        if inside.max() > SLACK_MM:
            yield f"{inside.max():.3f} mm within what is kept out of, line {_line(way, inside.argmax() + first)}"
    if reach := workspace.get("reach_mm"):
        away = np.linalg.norm(robot, axis=1)
        over = np.maximum(reach[0] - away, away - reach[1])
        if over.max() > SLACK_MM:
            yield f"{over.max():.3f} mm out of reach, line {_line(way, over.argmax() + first)}"


def _first_place(way: Way) -> int:
    """Return the first sample after the line of the program that goes to the first place of the run.

    That way may begin anywhere. It has several steps where axes take up their play. A rise along the robot's z axis
    is not that way, although it goes sideways over tilted paper.
    """
    if not len(way.row):
        return 0
    legs = [way.run.legs[k] for k in way.leg]
    by_robot = np.array([np.subtract(leg.end, leg.start) for leg in legs], dtype=float)
    sideways = [np.linalg.norm(steps[:, :2], axis=1) > SLACK_MM for steps in (way.ends - way.starts, by_robot)]
    if not np.logical_and(*sideways).any():
        return 1
    first = np.logical_and(*sideways).argmax()
    later = np.flatnonzero([leg.line != legs[first].line for leg in legs[first:]])
    return int(np.searchsorted(way.row, first + later[0], "left")) if len(later) else len(way.row)


def _line(way: Way, sample: int) -> int:
    return way.run.legs[way.leg[way.row[sample]]].line


def _fast(way: Way, job: Job):
    legs = way.run.legs
    kinds = np.array([legs[k].kind for k in way.leg])
    speeds = np.array([legs[k].speed_mm_s for k in way.leg])
    low = np.minimum(way.starts[:, 2], way.ends[:, 2]) <= job.touch_mm
    still = np.linalg.norm(way.ends - way.starts, axis=1) < 1e-6
    still &= ~np.array([legs[k].takes_up for k in way.leg], dtype=bool)
    # A program with times (ros2) has rounded places, so its speeds are rounded as well.
    lengths = np.maximum(np.linalg.norm(way.ends - way.starts, axis=1), 1e-9)
    rounded = 2e-5 * speeds / lengths if job.language == "ros2" else 0.0
    fast = (
        low & ~still & (kinds != "jump") & ((kinds == "rapid") | (speeds > job.fastest_mm_s * 1.001 + 0.01 + rounded))
    )
    for k in np.flatnonzero(fast):
        fast[k] = not _at_vessel(way, k, job)
    if fast.any():
        k = int(fast.argmax())
        yield f"fast while touching: {kinds[k]} at {speeds[k]:.1f} mm/s, line {legs[way.leg[k]].line}"
    fastest, press = (
        max(job.cell["speeds"][f"{what}_mm_s"] for what in names) for names in (("travel", "approach"), ("press",))
    )
    over = ~still & (kinds != "jump") & (speeds > fastest * 1.001 + 0.01 + rounded)
    # Only the dips and wipes at a vessel are pressed faster than the cell travels.
    for k in np.flatnonzero(over):
        over[k] = speeds[k] > press * 1.001 + 0.01 or not _at_vessel(way, k, job)
    if over.any():
        k = int(over.argmax())
        yield f"faster than any speed of the cell: {speeds[k]:.1f} mm/s, line {legs[way.leg[k]].line}"
    if job.language in SERVOS:
        yield from _jumps(way, job)


def _at_vessel(way: Way, row: int, job: Job) -> bool:
    """Return whether a row of the way is over a vessel, which may stand lower than the paper."""
    ends = np.array([way.starts[row], way.ends[row]])[:, :2]
    return any(_to_path(ends, visit[:, :2]).max() < job.near_mm for visit in job.stations)


def _jumps(way: Way, job: Job):
    """Find where a servo's height changes too fast while the brush touches.

    The height may be at most two steps ahead of the height that the top speed allows. It counts from the paper, and
    over a vessel from where the cell has the paper.
    """
    heights, times, lines, now = [], [], [], 0.0
    value, step = job.servo_mm
    paper_mm = (job.machine or {}).get("height_mm", 0.0)
    row_of_leg = dict(zip(way.leg, range(len(way.leg)), strict=True))
    for number, leg in enumerate(way.run.legs):
        if leg.kind == "jump":
            under_mm = 0.0 if paper_mm and _at_vessel(way, row_of_leg[number], job) else paper_mm
            heights += [leg.start[2] - under_mm, leg.end[2] - under_mm]
            times += [now, now]
            lines += [leg.line, leg.line]
        elif leg.kind == "wait" or leg.takes_up:
            now += leg.seconds
        elif leg.kind != "stop":
            now += float(np.linalg.norm(np.subtract(leg.end, leg.start))) / max(leg.speed_mm_s, 1e-9)
    heights, times = np.array(heights), np.array(times)
    for apart in (1, 3, 5, 7):
        rise = heights[apart:] - heights[:-apart]
        allowed = 2 * step + value + SLACK_MM + job.fastest_mm_s * 1.1 * (times[apart:] - times[:-apart])
        on = np.minimum(heights[apart:], heights[:-apart]) <= job.touch_mm
        # Only the part of a rise below touch_mm counts: above this height the brush is in the air.
        rise = np.minimum(np.abs(rise), job.touch_mm - np.minimum(heights[apart:], heights[:-apart]) + 1e-9)
        if (bad := on & (rise > allowed)).any():
            k = int(bad.argmax())
            yield f"the height changes by {rise[k]:.2f} mm at once while touching, line {lines[k + apart]}"
            return


def _low(way: Way, job: Job):
    """Find a sideways move in the air below the safe height, except during visits."""
    safe, legs = job.cell["heights"]["safe_mm"], way.run.legs
    low, high = np.minimum(way.starts[:, 2], way.ends[:, 2]), np.maximum(way.starts[:, 2], way.ends[:, 2])
    sideways = np.linalg.norm(way.ends[:, :2] - way.starts[:, :2], axis=1)
    bad = (
        (low < safe - 0.05 - job.servo_mm[0] / 2) & (high > job.touch_mm + job.servo_mm[1] + 1e-6) & (sideways > OFF_MM)
    )
    for k in np.flatnonzero(bad):
        a, b = legs[way.leg[k]].start, legs[way.leg[k]].end
        if b[2] >= a[2] and max(abs(a[0] - b[0]), abs(a[1] - b[1])) < 1e-6:
            continue  # the robot moves straight up, and the paper leans
        ends = np.array([way.starts[k], way.ends[k]])
        if any(_to_path(ends, visit).max() < job.near_mm for visit in job.stations):
            continue
        yield f"sideways {sideways[k]:.2f} mm in the air at {low[k]:.2f} mm, line {legs[way.leg[k]].line}"
        return


def _leaning(way: Way):
    leg = max(way.run.legs, key=lambda leg: leg.tilt_rad, default=None)
    if leg and leg.tilt_rad * LEVER_MM > OFF_MM:
        yield f"the tool leans by {np.degrees(leg.tilt_rad):.2f} degrees, line {leg.line}"


def _to_path(points: np.ndarray, path: np.ndarray) -> np.ndarray:
    """Return the distance (n,) of points from a path of straight moves."""
    path = path if len(path) > 1 else np.vstack([path, path])
    starts, steps = path[:-1], np.diff(path, axis=0)
    squares = np.maximum((steps**2).sum(axis=1), 1e-18)
    offset = points[:, None] - starts
    along = np.clip((offset * steps).sum(axis=2) / squares, 0, 1)
    return np.linalg.norm(offset - along[..., None] * steps, axis=2).min(axis=1)


# The plan ---------------------------------------------------------------------------------------------


def strokes_of(way: Way, job: Job) -> list[np.ndarray]:
    """Return the touches that are not visits to a vessel.

    A vessel's place is commanded as the cell has it, so the commanded place of a vessel is off the sheet.
    """
    width, height = job.plan["sheet_mm"]
    found = []
    for touch, commanded in zip(way.touches, way.commanded_touches, strict=True):
        is_off = (commanded[:, :2] <= 0).any(axis=1) | (commanded[:, :2] >= (width, height)).any(axis=1)
        if is_off.all() and any(_to_path(touch, visit).max() < job.near_mm for visit in job.stations):
            continue
        found.append(touch)
    return found


def unlike(way: Way, job: Job, sound: list[np.ndarray] | None = None) -> list[str]:
    """Return a sentence for each way in which the run does not paint the plan.

    Each stroke must be painted once, in order and in its direction, at most OFF_MM off in place and depth.
    sound holds the touches of a program that is known to paint the plan. Touches that are equal to these are
    not checked.
    """
    strokes = strokes_of(way, job)
    reasons = []
    if len(strokes) != len(job.passes):
        reasons.append(f"{len(strokes)} strokes instead of {len(job.passes)}")
    for k, (stroke, target) in enumerate(zip(strokes, job.passes, strict=False)):
        if sound and k < len(sound) and sound[k].shape == stroke.shape and (sound[k] == stroke).all():
            continue
        if (away := off_mm(stroke, target, sound[k] if sound and k < len(sound) else None)) > OFF_MM:
            reasons.append(f"stroke {k + 1} is {away:.3g} mm off, lost in part, or runs another way")
            break
    return reasons + _corners(way, job)


def off_mm(stroke: np.ndarray, target: np.ndarray, sound: np.ndarray | None) -> float:
    """Return how far a stroke is from its target, by the Frechet distance.

    The result is at most OFF_MM if both can be walked from end to end, never back, and never further apart
    than that. Otherwise the result is the distance at the worst place, and always more than OFF_MM.
    """
    near = OFF_MM + STEP_MM / 2
    if sound is not None:  # only the changed part can be far from the target
        n = min(len(sound), len(stroke))
        same = np.flatnonzero((sound[:n] != stroke[:n]).any(axis=1))
        first = int(same[0]) if len(same) else n
        same = np.flatnonzero((sound[-n:] != stroke[-n:]).any(axis=1))
        last = len(stroke) - (n - 1 - int(same[-1]) if len(same) else n)
        if first < last:
            middle = stroke[max(0, first - 1) : last + 1]
            gap = _to_path(middle[:: max(1, len(middle) // 200)], target[:: max(1, len(target) // 2000)]).max()
            if gap > 3 * OFF_MM:
                return float(gap)
    if _keep_pace(stroke, target) or walkable(stroke, target, near):
        return 0.0
    far = max(_to_path(stroke[::3], target[::3]).max(), _to_path(target[::3], stroke[::3]).max())
    return max(float(far), OFF_MM * 1.001)


def _keep_pace(one: np.ndarray, other: np.ndarray) -> bool:
    """Return whether two walkers stay within OFF_MM if both always have covered the same share of their paths.

    This is one of the ways to walk both paths. It is quicker to try than all ways.
    """
    covered = [np.concatenate([[0], np.cumsum(np.linalg.norm(np.diff(each, axis=0), axis=1))]) for each in (one, other)]
    shares = [each / max(each[-1], 1e-9) for each in covered]
    for path, share, to, to_share in ((one, shares[0], other, shares[1]), (other, shares[1], one, shares[0])):
        partner = np.column_stack([np.interp(share, to_share, axis) for axis in to.T])
        if (np.linalg.norm(path - partner, axis=1) > OFF_MM).any():
            return False
    return True


def walkable(one: np.ndarray, other: np.ndarray, near_mm: float) -> bool:
    """Return whether two paths can be walked together, near_mm apart and never back."""
    if len(one) < len(other):
        one, other = other, one
    if max(np.linalg.norm(one[0] - other[0]), np.linalg.norm(one[-1] - other[-1])) > near_mm:
        return False
    low, high, square = 0, 1, near_mm**2
    reached = np.zeros(len(other), dtype=bool)
    reached[0] = True
    for k, point in enumerate(one):
        # Only points that can still be reached count: from the first reached point to the first one that is
        # far.
        high = min(len(other), high + 64)
        while True:
            free = ((other[low:high] - point) ** 2).sum(axis=1) <= square
            if high == len(other) or not free[-1]:
                break
            high = min(len(other), high + 256)
        if k:
            from_before = reached[low:high].copy()
            from_before[1:] |= reached[low : high - 1]
        else:
            from_before = np.zeros(high - low, dtype=bool)
            from_before[0] = True
        enter = free & from_before
        runs = np.cumsum(~free)
        # Within a run of free places, everything after an entrance can be reached.
        index = np.where(enter, np.arange(len(free)), -1)
        last_enter = np.maximum.accumulate(index)
        ok = free & (last_enter >= 0)
        ok &= runs == np.where(last_enter >= 0, runs[np.maximum(last_enter, 0)], -1)
        reached[low:high] = ok
        places_ = np.flatnonzero(ok)
        if not len(places_):
            return False
        reached[:low] = False
        reached[high:] = False
        high = low + int(places_[-1]) + 1
        low += int(places_[0])
    return bool(reached[len(other) - 1])


def cuts(way: Way, job: Job) -> np.ndarray:
    """Return the largest distance (n,) between each leg's end and the tool's way.

    The distance is zero unless the controller may cut the corner.
    """
    legs = way.run.legs
    if not len(legs):
        return np.zeros(0)
    out = np.zeros(len(legs))
    cut = np.array([leg.cut_mm for leg in legs])
    moving = np.array([leg.kind not in ("wait", "stop") for leg in legs])
    if not (cut[moving] > 0).any():
        return out
    starts, ends = np.array([leg.start for leg in legs]), np.array([leg.end for leg in legs])
    steps = ends - starts
    reaching, leaving = steps.copy(), steps.copy()
    for k, leg in enumerate(legs):
        if leg.kind == "arc":
            here = (
                places.moved(job.back, np.array([leg.start, leg.end]))
                if way.run.blends_by_radius
                else np.array([leg.start, leg.end])
            )
            for side, into in ((0, leaving), (1, reaching)):
                spoke = here[side, :2] - leg.centre
                into[k] = (-leg.turn * spoke[1], leg.turn * spoke[0], 0.0)
                if way.run.blends_by_radius:
                    into[k] = job.paper[:3, :3] @ into[k]
    lengths = np.linalg.norm(steps, axis=1)
    known = [k for k in range(len(legs)) if moving[k] and lengths[k] > 1e-9]
    for a, b in itertools.pairwise(known):
        if not cut[a] > 0 or not moving[a : b + 1].all():
            continue
        u, v = reaching[a] / np.linalg.norm(reaching[a]), leaving[b] / np.linalg.norm(leaving[b])
        turn = np.arctan2(np.linalg.norm(v - u), np.linalg.norm(v + u))  # half of the angle
        half = min(lengths[a], lengths[b]) / 2
        if way.run.blends_by_radius:
            out[a] = min(cut[a], 2 * half) * np.tan(turn / 2)
        else:
            out[a] = min(cut[a], half * np.tan(turn / 2))
    return out


def _corners(way: Way, job: Job) -> list[str]:
    cut = cuts(way, job)
    if not len(cut):
        return []
    ends = places.moved(job.back, np.array([leg.end for leg in way.run.legs]))
    bad = (cut > OFF_MM) & (ends[:, 2] <= job.touch_mm)
    if bad.any():
        k = int(bad.argmax())
        return [f"a corner may be cut by {cut[k]:.3g} mm, line {way.run.legs[k].line}"]
    return _overlapping(way, ends, job) if way.run.blends_by_radius else []


def _overlapping(way: Way, ends: np.ndarray, job: Job) -> list[str]:
    """Find overlapping blends on the paper.

    The manual of URScript says that the robot skips a move whose blend overlaps with a blend next to it.
    """
    rests = ("wait", "stop")
    for (a, b), end in zip(itertools.pairwise(way.run.legs), ends[1:], strict=True):
        if a.kind in rests or b.kind in (*rests, "arc") or a.cut_mm <= 0 or end[2] > job.touch_mm:
            continue
        far_mm = math.dist(b.start, b.end)
        if 0 < far_mm < a.cut_mm + b.cut_mm - ROUNDING_MM:
            return [f"blends overlap on {far_mm:.3g} mm, line {b.line}"]
    return []


# The judgement -----------------------------------------------------------------------------------------

FACT = re.compile(r"(\w+): (.*)")
TITLE = re.compile(r"(stroke \d+ of |paint: |end: |stop: |border |height )")


def facts(run: Run) -> tuple[dict, list]:
    """Return the facts of the header, and after how many mm each section begins.

    A user who resumes a job relies on the titles of the sections.
    """
    by_word: dict[str, set] = {}
    for line in run.header:
        if found := FACT.fullmatch(line.strip()):
            by_word.setdefault(found[1], set()).add(found[2])
    by_word["what frames it"] = set(run.frame)
    sizes = [float(np.linalg.norm(np.subtract(leg.end, leg.start))) for leg in run.legs]
    done = np.concatenate([[0.0], np.cumsum(sizes)])
    return by_word, [(words, float(done[at])) for words, at in run.titles if TITLE.match(words)]


FASTER_MM_S = 0.01  # rounding changes a feed by at most this much
LIFT_S = 0.05  # duration of one step of a servo's lift


def same_facts(one: tuple[dict, list], other: tuple[dict, list]) -> bool:
    (ours, titles), (its, others) = one, other
    if ours != its or [words for words, _ in titles] != [words for words, _ in others]:
        return False
    return all(abs(a - b) < SAME_PLACE_MM for (_, a), (_, b) in zip(titles, others, strict=True))


# A title may be displaced along the way by this much. Rounding adds up to less, and every move between strokes is
# longer.
SAME_PLACE_MM = 0.5


@dataclass
class Sound:
    """The run of the undamaged program, which damaged programs are compared with."""

    job: Job
    text: str
    way: Way
    strokes: list[np.ndarray]

    @cached_property
    def steps(self) -> list:
        return _commanded(self.way, self.job)

    @cached_property
    def facts(self) -> tuple:
        return facts(self.way.run)


def sound(text: str, job: Job) -> Sound:
    """Return the run of a program that must be sound.

    Raise AssertionError with the reasons if it is not.
    """
    run = job.interpret(text)
    assert not run.refused and not run.acts, (run.refused, run.acts)
    way = way_of(run, job)
    reasons = broken(way, job) + (unlike(way, job) if job.compare else [])
    assert not reasons, reasons
    return Sound(job, text, way, strokes_of(way, job))


def dangers(text: str, whole: Sound) -> tuple[list[str], Way]:
    """Return the reasons why nobody should run this program, and its run."""
    job = whole.job
    run = job.interpret(text)
    way = way_of(run, job)
    reasons = [f"acts: {what}" for what in run.acts]
    reasons += broken(way, job)
    reasons += unlike(way, job, whole.strokes)
    if run.refused and (reasons or not run.legs):
        reasons.append(f"the controller stops: {run.refused}")
    return reasons, way


def judged(text: str, whole: Sound) -> tuple[str, str]:
    """Return "dangerous", "harmless" or "neither", and the reason."""
    reasons, way = dangers(text, whole)
    if reasons:
        return "dangerous", "; ".join(reasons[:3])
    if way.run.refused:
        return "neither", f"the controller stops: {way.run.refused}"
    if not same_facts(facts(way.run), whole.facts):
        return "neither", "the header or a title says something else"
    commanded = _commanded(way, whole.job)
    return (
        ("harmless", "") if _same(commanded, whole.steps, whole.job) else ("neither", "other moves, yet not dangerous")
    )


def _commanded(way: Way, job: Job) -> list:
    """Return moves, waits and stops in order, each with its corner's largest cut.

    The steps of a servo in one place become one lift, because they only round a ramp. The manual of JAKA
    script does not say what a tolerance bounds, so there the tolerance counts as it is written.
    """
    cut = [leg.cut_mm for leg in way.run.legs] if job.language == "jaka" else cuts(way, job)
    out: list = []
    for k, leg in enumerate(way.run.legs):
        if leg.kind in ("jump", "wait") and job.language in SERVOS:
            if out and out[-1][0].kind == "lift":
                out[-1] = (_lifted(out[-1][0], leg, job), 0.0)
            else:
                speed = leg.speed_mm_s if leg.kind == "jump" else 0.0
                out.append((leg._replace(kind="lift", cut_mm=0.0, speed_mm_s=speed), 0.0))
            continue
        moves = leg.kind not in ("wait", "stop")
        if moves and leg.kind != "arc" and np.linalg.norm(np.subtract(leg.end, leg.start)) < 1e-9:
            if leg.cut_mm > 0 and way.run.blends_by_radius:
                out.append((leg._replace(kind="stop"), 0.0))  # a blend over no distance makes a robot stop
            continue
        out.append((leg, cut[k]))
    return [each for each in out if each[0].kind != "lift" or each[0].start != each[0].end or each[0].seconds]


def _lifted(before: Leg, leg: Leg, job: Job) -> Leg:
    """Join two parts of a lift.

    cut_mm of the result is the largest single step on the paper, or the largest step back.
    """
    rise, more = before.end[2] - before.start[2], leg.end[2] - leg.start[2]
    on = min(leg.start[2], leg.end[2]) <= job.touch_mm
    back = max(before.cut_mm, abs(more) if on or rise * more < 0 else 0.0)
    speed = max((each.speed_mm_s for each in (before, leg) if np.isfinite(each.speed_mm_s)), default=0.0)
    return before._replace(end=leg.end, seconds=before.seconds + leg.seconds, cut_mm=back, speed_mm_s=speed)


def _same(ours: list, theirs: list, job: Job) -> bool:
    """Return whether legs agree within rounding, and ours are nowhere faster."""
    near = ROUNDING_MM if job.language not in SERVOS else max(ROUNDING_MM, 1.01 * job.servo_mm[0])
    first = 0
    while first < min(len(ours), len(theirs)) and _alike(ours[first], theirs[first], near, job):
        first += 1
    last = 0
    most = min(len(ours), len(theirs)) - first
    while last < most and _alike(ours[-1 - last], theirs[-1 - last], near, job):
        last += 1
    ours, theirs = ours[first : len(ours) - last], theirs[first : len(theirs) - last]
    if not ours and not theirs:
        return True
    if not ours or not theirs or len(ours) + len(theirs) > 60:
        return False
    if {leg.kind for leg, _ in ours + theirs} - {"feed", "rapid", "process"} or len(
        {leg.kind for leg, _ in ours + theirs}
    ) > 1:
        return False
    if max(leg.acceleration for leg, _ in ours) > min(leg.acceleration for leg, _ in theirs) * 1.001:
        return False
    # In ros2, rows have times. A missing row between two others changes neither the way nor the total time.
    commanded = (max if job.language == "ros2" else min)(leg.speed_mm_s for leg, _ in theirs)
    if max(leg.speed_mm_s for leg, _ in ours) > commanded + FASTER_MM_S:
        return False
    if max(cut for _, cut in ours) > max(cut for _, cut in theirs) + ROUNDING_MM:
        return False
    # A servo's heights are rounded to values. Its places are not.
    flat = (1.0, 1.0, ROUNDING_MM / near)
    both = [np.array([each[0][0].start] + [leg.end for leg, _ in each]) for each in (ours, theirs)]
    boxes = [np.vstack([points.min(axis=0), points.max(axis=0)]) * flat for points in both]
    if np.abs(boxes[0] - boxes[1]).max() > ROUNDING_MM:
        return False  # needs no samples, which may be millions, for example for a height of ten metres
    one, other = (_sampled(points) * flat for points in both)
    both = max(_to_path(one, other).max(), _to_path(other, one).max())
    return both <= ROUNDING_MM and walkable(one, other, ROUNDING_MM + STEP_MM)


def _alike(one, other, near: float, job: Job) -> bool:
    (a, cut), (b, its) = one, other
    if (a.tilt_rad - b.tilt_rad) * LEVER_MM > LAST_MM:
        return False
    if a.kind != b.kind or a.turn != b.turn or cut > its + ROUNDING_MM:
        return False
    if a.acceleration > b.acceleration * 1.001:
        return False
    if a.kind == "lift" and (abs(a.seconds - b.seconds) > LIFT_S or (a.seconds > 0) != (b.seconds > 0)):
        return False
    if a.kind == "lift" and a.cut_mm > max(b.cut_mm, 1.5 * job.servo_mm[1] + job.servo_mm[0] + SLACK_MM):
        return False
    if a.speed_mm_s > b.speed_mm_s + FASTER_MM_S or (a.kind != "lift" and abs(a.seconds - b.seconds) > 0.0011):
        return False
    if a.centre and max(abs(p - q) for p, q in zip(a.centre, b.centre, strict=True)) > near:
        return False
    nears = (ROUNDING_MM, ROUNDING_MM, near) * 2
    return all(abs(p - q) <= n for p, q, n in zip((*a.start, *a.end), (*b.start, *b.end), nears, strict=True))


def job_of(cell: dict, plan_json: str, brush_mm_s: float, z_offset_mm: float = 0.0, first_stroke: int = 1) -> Job:
    return Job(cell, json.loads(plan_json), brush_mm_s, z_offset_mm, first_stroke)
