"""Check that the keys of a cell agree, and report unusual values."""

from __future__ import annotations

import math
import re
from dataclasses import replace
from itertools import pairwise

import numpy as np

from ...errors import Error, Notice
from ..frames import normal_tilt_deg, rotation, transform_points
from ..limits.move_extents import distances_from_origin, make_paths
from ..limits.workspace import find_broken_limits
from ..posts import POSTS
from ..realised.displacement_field import max_field_slope
from .cell import (
    DEFAULT_FANUC_CONFIGURATION,
    MIN_WALL_TILT_DEG,
    RELOAD_OCCASIONS,
    Cell,
    Machine,
    Speeds,
    Station,
    entries_of,
    list_uncorrectable_keys,
    min_backlash_mm,
    reason_for_no_waiting,
    robot_from_paper,
    value_mm,
)
from .language_limits import ARCS_IN_SEGMENTS, CONTACT_KEYS, LEAST_ACCELERATION_MM_S2, LEAST_SPEED_MM_S, REQUIRED_TABLES

# Largest tilt of paper next to which the brush dips into a vessel without a remark. The shipped arms allow no more.
MAX_DIP_TILT_DEG = 15.0
# Smallest spacing of the grid lines of a height map, and largest height or depth in the map.
MIN_GRID_SPACING_MM, MAX_MAP_MM = 5.0, 5.0
# Largest slope of a displacement field in mm per mm, equal to the limit of scale and skew.
# A slope of 1 or more would fold the sheet.
MAX_FIELD_SLOPE = 0.1
ARM_JOINT_COUNT = 6  # with more joints, an arm reaches a place with infinitely many joint angles
# Largest height that one value of a servo may change. Depths are off by up to half of it.
MAX_SERVO_VALUE_MM = 0.5
# Largest distance of the tip behind the plane of the flange without a remark: errors of teaching may be this large.
MAX_TIP_BEHIND_MM = 0.5


def check(cell: Cell) -> None:
    """Check a cell for contradictions between its keys.

    Raises Error with the key in `where`.
    """
    heights = cell.heights
    if not heights.clearance_mm <= heights.safe_mm:
        sentence = f"clearance_mm {heights.clearance_mm:g} must not be above safe_mm {heights.safe_mm:g}"
        raise Error(sentence, where="heights.clearance_mm", code="cell-heights")
    _check_tables(cell)
    min_mm_s2 = LEAST_ACCELERATION_MM_S2.get(cell.language, 0.0)
    if cell.speeds.acceleration_mm_s2 < min_mm_s2:
        max_mm_s2 = entries_of(Speeds)["acceleration_mm_s2"].greatest
        raise Error(
            f"{cell.speeds.acceleration_mm_s2:g} mm/s2 is outside the range [{min_mm_s2:g}, {max_mm_s2:g}] "
            f"mm/s2 of language {cell.language!r}",
            where="speeds.acceleration_mm_s2",
            code="out-of-range",
        )
    _check_speeds(cell)
    _check_own_keys(cell)
    _check_paper(cell)
    _check_workspace(cell)
    if cell.machine and cell.machine.map_mm:
        _check_map(cell.machine.map_mm)
    if cell.machine:
        _check_field(cell.machine)
        _check_corrections(cell)
    if cell.pen:
        _check_pen(cell)
    if cell.motors:
        _check_motors(cell)
    if cell.servo:
        _check_servo(cell)
    _check_paint(cell)
    if cell.contact:
        _check_contact(cell)
    if cell.arm:
        _check_arm(cell)


def _check_tables(cell: Cell) -> None:
    """Raise Error if a table of the cell is missing or unused.

    A table is unused if only other languages use it. Nobody knows what a language without a post uses.
    """
    for table in sorted({table for tables in REQUIRED_TABLES.values() for table in tables}):
        languages = [language for language, tables in REQUIRED_TABLES.items() if table in tables]
        is_given = getattr(cell, table) is not None
        if cell.language in languages and not is_given:
            raise Error(f"language {cell.language!r} needs a table {table}", where=table, code="key-missing")
        if is_given and cell.language in POSTS and cell.language not in languages:
            sentence = f"language {cell.language!r} does not use a table {table}: it is for {', '.join(languages)}"
            raise Error(sentence, where=table, code="key-unused")


def _check_contact(cell: Cell) -> None:
    used_key = CONTACT_KEYS.get(cell.language)
    if used_key is None:
        sentence = f"language {cell.language!r} cannot set a contact force: set it on the controller"
        raise Error(sentence, where="contact", code="cell-contact")
    for key in CONTACT_KEYS.values():
        if bool(getattr(cell.contact, key)) != (key == used_key):
            says = "needs" if key == used_key else "does not use"
            raise Error(f"language {cell.language!r} {says} {key}", where=f"contact.{key}", code="cell-contact")


def _check_arm(cell: Cell) -> None:
    arm = cell.arm
    if cell.tool is None:
        raise Error("an arm needs a table tool: the brush on its flange", where="tool", code="key-missing")
    if len(arm.dh) != ARM_JOINT_COUNT:
        raise Error(f"the arm has {len(arm.dh)} rows of links, not {ARM_JOINT_COUNT}", where="arm.dh", code="cell-arm")
    for key in ("limits_deg", "speeds_deg_s", "posture_deg", "numbers"):
        if len(values := getattr(arm, key)) != ARM_JOINT_COUNT and (values or key == "limits_deg"):
            sentence = f"{len(values)} values are given for {ARM_JOINT_COUNT} joints"
            raise Error(sentence, where=f"arm.{key}", code="cell-arm")
    if any(number % 1 or number <= before for before, number in pairwise((0, *arm.numbers))):
        sentence = f"{[*arm.numbers]} are not joint numbers that rise"
        raise Error(sentence, where="arm.numbers", code="cell-arm")
    for number, (low, high) in enumerate(arm.limits_deg, 1):
        if not low < high:
            sentence = f"joint {number}: the least angle {low:g} must be below the greatest, {high:g} degrees"
            raise Error(sentence, where="arm.limits_deg", code="cell-arm")
        if arm.posture_deg and not low <= (angle := arm.posture_deg[number - 1]) <= high:
            sentence = (
                f"joint {number}: {angle:g} degrees are outside the range [{low:g}, {high:g}] degrees of limits_deg"
            )
            raise Error(sentence, where="arm.posture_deg", code="cell-arm")


# Each key that only one language has, with this language and the reason why another language refuses the key.
KEYS_OF_ONE_LANGUAGE = {
    "blending.step_mm": ("dobot", "has no steps of blends: they are as fine as its decimals"),
    "blending.ramp_s": ("fanuc", "gives blends in mm, for any time to speed"),
    "tool.configuration": ("fanuc", "gives no configuration of the arm"),
    "pen.servo_values": ("marlin-servo", "sets no servo"),
    "pen.servo_number": ("marlin-servo", "sets no servo"),
    "pen.settle_s": ("marlin-servo", "waits for no pen"),
    "tool.base_frame": ("ros2", "names no frames"),
    "tool.flange_frame": ("ros2", "names no frames"),
}


def _check_own_keys(cell: Cell) -> None:
    """Raise Error for keys of one language in a cell of another language."""
    for key, (language, why) in KEYS_OF_ONE_LANGUAGE.items():
        name, _, entry = key.partition(".")
        table = getattr(cell, name)
        if table and getattr(table, entry) != getattr(type(table), entry) and cell.language != language:
            raise Error(f"language {cell.language!r} {why}", where=key, code="key-unused")
    if cell.arc_segment_mm and cell.language not in ARCS_IN_SEGMENTS:
        sentence = f"language {cell.language!r} makes no lines of circles"
        raise Error(sentence, where="arc_segment_mm", code="key-unused")
    if cell.language == "fanuc" and not re.fullmatch(FANUC_CONFIGURATION_PATTERN, cell.tool.configuration):
        raise Error(
            f"{cell.tool.configuration[:40]!r} is no configuration as the pendant shows it, such as "
            f"{DEFAULT_FANUC_CONFIGURATION!r}",
            where="tool.configuration",
            code="out-of-range",
        )
    for key in ("base_frame", "flange_frame") if cell.language == "ros2" else ():
        if not re.fullmatch(r"[A-Za-z]\w{0,99}(?:/\w{1,99})*", name := getattr(cell.tool, key), re.ASCII):
            sentence = f"{name[:40]!r} is no name of a frame: the letters a to z and A to Z, digits, _ and /"
            raise Error(sentence, where=f"tool.{key}", code="name-invalid")


FANUC_CONFIGURATION_PATTERN = r"[NF] [UD] [TB], -?[0-9], -?[0-9], -?[0-9]"


def _check_speeds(cell: Cell) -> None:
    min_mm_s = LEAST_SPEED_MM_S.get(cell.language, 0.0)
    for key in ("travel_mm_s", "approach_mm_s", "press_mm_s", "paint_mm_s"):
        if (speed := getattr(cell.speeds, key)) < min_mm_s:
            raise Error(
                f"{speed:g} mm/s is outside the range [{min_mm_s:g}, {entries_of(Speeds)[key].greatest:g}] mm/s of "
                f"language {cell.language!r}",
                where=f"speeds.{key}",
                code="out-of-range",
            )


def _check_paper(cell: Cell) -> None:
    if cell.paper.taught_mm and len(cell.paper.taught_mm) not in (3, 4):
        sentence = f"{len(cell.paper.taught_mm)} points were taught, not 3 or 4"
        raise Error(sentence, where="paper.taught_mm", code="paper-taught")
    if cell.paper.taught_mm and (any(cell.paper.origin_mm) or any(cell.paper.rotation_deg)):
        sentence = "the paper has both a pose and taught points: one must go"
        raise Error(sentence, where="paper.taught_mm", code="paper-taught")
    try:
        tilt_deg = normal_tilt_deg(robot_from_paper(cell))
    except Error as refusal:
        refusal.where = "paper.taught_mm"
        raise
    limit_deg = cell.workspace.tilt_limit_deg
    if tilt_deg > limit_deg + 1e-9:
        if cell.paper.taught_mm and tilt_deg > 90:
            advice = "seen from above, the third point must be to the left of the line from the first to the second"
        elif cell.tool:
            advice = "raise this limit if the paper should lean; cell new reads it from the file of --like"
        else:
            advice = ""
        raise Error(
            f"the paper leans {tilt_deg:.2f} degrees, outside the range [0, {limit_deg:g}] degrees of "
            "workspace.tilt_limit_deg",
            where="paper",
            code="paper-tilted",
            advice=advice,
        )


def _check_workspace(cell: Cell) -> None:
    box_mm, reach_mm = cell.workspace.box_mm, cell.workspace.reach_mm
    if box_mm and not all(low < high for low, high in zip(*box_mm, strict=True)):
        sentence = "the first corner must be the lower one in x, y and z"
        raise Error(sentence, where="workspace.box_mm", code="cell-workspace")
    for number, corners in enumerate(cell.workspace.keep_out_mm, 1):
        if not all(low < high for low, high in zip(*corners, strict=True)):
            sentence = f"box {number}: the first corner must be the lower one in x, y and z"
            raise Error(sentence, where="workspace.keep_out_mm", code="cell-workspace")
    if reach_mm and not reach_mm[0] < reach_mm[1]:
        raise Error("the least distance must be below the greatest", where="workspace.reach_mm", code="cell-workspace")


LARGEST_SHEET_MM = 1e5


def report_workspace_out_of_reach(cell: Cell) -> list[Notice]:
    """Report a workspace in which the tool can reach no point of a sheet of any size.

    The sheet is checked at the paper and at the safe height. Each notice names the key.
    """
    notices: list[Notice] = []
    for height_mm in (0.0, cell.heights.safe_mm):
        notices = notices or _sheet_out_of_reach(cell, height_mm)
    return notices


def _sheet_out_of_reach(cell: Cell, height_mm: float) -> list[Notice]:
    box_mm, reach_mm = cell.workspace.box_mm, cell.workspace.reach_mm
    ends = (-cell.workspace.margin_mm, LARGEST_SHEET_MM)
    sheet = np.array([(ends[a], ends[b], height_mm) for a, b in ((0, 0), (1, 0), (1, 1), (0, 1))])
    reachable = transform_points(robot_from_paper(cell), sheet)
    at = f"at height {height_mm:g} mm the whole sheet"
    for axis, name in enumerate("xyz" if box_mm else ""):
        low, high = box_mm[0][axis], box_mm[1][axis]
        for bound, sign, where in ((low, 1.0, "below"), (high, -1.0, "above")):
            reachable = _clip_polygon(reachable, sign * (reachable[:, axis] - bound))
            if not len(reachable):
                sentence = f"{at} has {name} {where} {bound:g} mm, outside the range [{low:g}, {high:g}] mm of the box"
                return [Notice("workspace.box_mm", sentence, code="sheet-out-of-reach")]
    if reach_mm:
        nearest_mm, farthest_mm = _distances_from_origin_mm(reachable)
        if nearest_mm > reach_mm[1] or farthest_mm < reach_mm[0]:
            away = f"{nearest_mm:.0f} mm and more" if nearest_mm > reach_mm[1] else f"at most {farthest_mm:.0f} mm"
            bounds = "[{:g}, {:g}] mm".format(*reach_mm)
            sentence = f"{at} is {away} from the robot's origin, outside the range {bounds} of its reach"
            return [Notice("workspace.reach_mm", sentence, code="sheet-out-of-reach")]
    return []


def _clip_polygon(corners: np.ndarray, inside: np.ndarray) -> np.ndarray:
    """Clip a flat polygon (n, 3) to the side where `inside` (n,), linear at the corners, is not negative."""
    kept = []
    for k in range(len(corners)):
        a, b = inside[k - 1], inside[k]
        if (a < 0) != (b < 0):
            kept.append(corners[k - 1] + (corners[k] - corners[k - 1]) * (a / (a - b)))
        if b >= 0:
            kept.append(corners[k])
    return np.array(kept).reshape(-1, 3)


def _distances_from_origin_mm(corners: np.ndarray) -> tuple[float, float]:
    """Return the range of distances [mm] of a flat convex polygon, corners (n, 3), from the origin."""
    nearest, farthest = distances_from_origin(make_paths([[*corners, corners[0]]]))
    sides = np.roll(corners, -1, axis=0) - corners
    normal = np.cross(sides[0], sides[1]) if len(corners) > 2 else np.zeros(3)
    if size := np.linalg.norm(normal):
        normal = normal / size
        foot = normal * (normal @ corners[0])
        turns = np.cross(sides, foot - corners) @ normal
        if (turns >= 0).all():
            nearest = min(nearest, float(np.linalg.norm(foot)))
    return nearest, farthest


def _check_pen(cell: Cell) -> None:
    pen = cell.pen
    if cell.language == "marlin-servo" and len(set(map(round, pen.servo_values))) != 2:
        sentence = "the servo needs two values, whole degrees: one that lifts the pen, another that lets it down"
        raise Error(sentence, where="pen.servo_values", code="servo-table")
    if cell.language == "marlin-servo" and pen.colours:
        sentence = "the servo holds one pen: it stops for those of other colours"
        raise Error(sentence, where="pen.colours", code="out-of-range")
    frame = robot_from_paper(cell)
    if abs(frame[2, 3]) > 1e-9 or normal_tilt_deg(frame) > 1e-9:
        sentence = "a pen is up or down over the paper: it must be level, at z 0"
        raise Error(sentence, where="paper", code="paper-tilted")
    if pen.down_mm < cell.heights.lowest_mm:
        sentence = f"down_mm {pen.down_mm:g} is below lowest_mm {cell.heights.lowest_mm:g}"
        raise Error(sentence, where="pen.down_mm", code="cell-heights")
    if cell.stations or cell.reload:
        sentence = "a pen that is up or down goes into no vessel: stations and reload must go"
        raise Error(sentence, where="stations", code="cell-station")
    for number, colour in enumerate(pen.colours, 1):
        if not re.fullmatch("#[0-9a-fA-F]{6}", colour) or colour.lower() in map(str.lower, pen.colours[: number - 1]):
            sentence = f"colour {colour[:24]!r} of pen {number} is not written as #rrggbb, or given twice"
            raise Error(sentence, where="pen.colours", code="colour-invalid")


MOST_STEPS_S = 25_000  # largest step rate of each motor of an EBB, in steps per second
MAX_EBB_SERVO_VALUE = 65_535  # largest pulse width of the servo of an EBB, in 1/12 microseconds


def _check_motors(cell: Cell) -> None:
    rows = np.array(cell.motors.steps_per_mm)
    if np.linalg.cond(rows) > 1e3:
        sentence = "both motors move along the same direction: they cannot reach the sheet"
        raise Error(sentence, where="motors.steps_per_mm", code="out-of-range")
    max_mm_s = MOST_STEPS_S / float(np.linalg.norm(rows, axis=1).max())
    for name in ("travel_mm_s", "approach_mm_s", "press_mm_s", "paint_mm_s"):
        if (speed := getattr(cell.speeds, name)) > max_mm_s:
            raise Error(
                f"{speed:g} mm/s is outside the range [{LEAST_SPEED_MM_S['ebb']:g}, {max_mm_s:.1f}] mm/s, in which no "
                f"motor makes more than {MOST_STEPS_S} steps in a second",
                where=f"speeds.{name}",
                code="out-of-range",
            )
    if cell.servo and (value := max((row[1] for row in cell.servo.table), default=0)) > MAX_EBB_SERVO_VALUE:
        sentence = f"value {value:g} is outside the range [0, {MAX_EBB_SERVO_VALUE}] of 1/12 microseconds"
        raise Error(sentence, where="servo.table", code="servo-table")


def _check_servo(cell: Cell) -> None:
    frame = robot_from_paper(cell)
    is_level = abs(frame[2, 3]) < 1e-9 and normal_tilt_deg(frame) < 1e-9
    if not is_level:
        sentence = "a servo's heights are those over the paper: it must be level, at z 0"
        raise Error(sentence, where="paper", code="paper-tilted")
    table = np.array(cell.servo.table)
    steps = np.diff(table, axis=0)
    if len(table) < 2 or not ((steps[:, 0] > 0).all() or (steps[:, 0] < 0).all()):
        sentence = "at least two heights are needed, steadily rising or falling"
        raise Error(sentence, where="servo.table", code="servo-table")
    if not ((steps[:, 1] > 0).all() or (steps[:, 1] < 0).all()):
        raise Error("the values must steadily rise or fall with the height", where="servo.table", code="servo-table")
    if (table[:, 1] < 0).any():
        raise Error(f"value {table[:, 1].min():g} is below 0", where="servo.table", code="servo-table")
    low, high = table[:, 0].min(), table[:, 0].max()
    if not (low <= cell.heights.lowest_mm and cell.heights.safe_mm <= high):
        raise Error(
            f"the heights [{low:g}, {high:g}] mm must hold lowest_mm {cell.heights.lowest_mm:g} and "
            f"safe_mm {cell.heights.safe_mm:g}",
            where="servo.table",
            code="servo-table",
        )
    if (value := value_mm(cell)) > MAX_SERVO_VALUE_MM:
        raise Error(
            f"one value changes the height by {value:.2g} mm, outside the range [0, {MAX_SERVO_VALUE_MM:g}] mm: depths "
            "would be off by half of it",
            where="servo.table",
            code="servo-coarse",
        )
    if cell.heights.clearance_mm < 2 * value:
        raise Error(
            f"clearance_mm {cell.heights.clearance_mm:g} is outside the range [{2 * value:.2g}, "
            f"{cell.heights.safe_mm:g}] mm: one value of the servo changes the height by {value:.2g} mm",
            where="heights.clearance_mm",
            code="cell-heights",
        )


def _check_corrections(cell: Cell) -> None:
    for key, why in list_uncorrectable_keys(cell).items():
        values = np.atleast_1d(getattr(cell.machine, key)).tolist()
        if np.any(values):
            sentence = f"{key} {values} is outside the range [0, 0] of this machine: {why}"
            raise Error(sentence, where=f"machine.{key}", code="cell-machine")
    min_mm = min_backlash_mm(cell)
    for value in cell.machine.backlash_mm:
        if 0 < value < min_mm:
            sentence = f"backlash_mm {value:g} is neither 0 nor in the range [{min_mm:g}, 3] mm"
            raise Error(sentence, where="machine.backlash_mm", code="cell-machine")


def _check_map(map_mm: tuple) -> None:
    where = "machine.map_mm"
    places = [row[:2] for row in map_mm]
    xs, ys = (sorted({place[k] for place in places}) for k in range(2))
    for x, y in places:
        if places.count((x, y)) > 1:
            raise Error(f"the place x {x:g}, y {y:g} mm is given twice", where=where, code="cell-machine")
    missing = [(x, y) for y in ys for x in xs if (x, y) not in set(places)]
    if missing:
        x, y = missing[0]
        sentence = f"no height is given at x {x:g}, y {y:g} mm, one of {len(xs)} x {len(ys)} places of a grid"
        raise Error(sentence, where=where, code="cell-machine")
    if min(len(xs), len(ys)) < 2:
        raise Error(
            f"{len(xs)} x {len(ys)} places are not a grid: at least 2 x 2 are needed", where=where, code="cell-machine"
        )
    for axis, lines in (("x", xs), ("y", ys)):
        for before, after in pairwise(lines):
            if after - before < MIN_GRID_SPACING_MM:
                sentence = f"{axis} {before:g} and {after:g} mm are less than {MIN_GRID_SPACING_MM:g} mm apart"
                raise Error(sentence, where=where, code="cell-machine")
    for x, y, height in map_mm:
        if abs(height) > MAX_MAP_MM:
            sentence = f"{height:g} mm at x {x:g}, y {y:g} mm is outside the range [{-MAX_MAP_MM:g}, {MAX_MAP_MM:g}] mm"
            raise Error(sentence, where=where, code="cell-machine")


def _check_field(machine: Machine) -> None:
    keys = ("field_mm", "field_middle_mm", "field_reach_mm")
    missing = [key for key in keys if not getattr(machine, key)]
    if 0 < len(missing) < len(keys):
        sentence = f"a field needs {', '.join(keys)}: there is no {missing[0]}"
        raise Error(sentence, where=f"machine.{missing[0]}", code="key-missing")
    if machine.field_mm and (slope := max_field_slope(machine)) > MAX_FIELD_SLOPE:
        sentence = (
            f"the field changes by up to {slope:.3g} mm in a mm, outside the range [0, {MAX_FIELD_SLOPE:g}]: with "
            f"field_reach_mm {[*machine.field_reach_mm]} its numbers are too large"
        )
        raise Error(sentence, where="machine.field_mm", code="cell-machine")


def _check_paint(cell: Cell) -> None:
    names = [station.name for station in cell.stations]
    for number, station in enumerate(cell.stations, 1):
        where = f"station {number}"
        if names.index(station.name) != number - 1:
            raise Error(f"the name {station.name!r} is given twice", where=where, code="name-taken")
        _check_station_heights(station, cell, where)
        _check_other_vessels(station, cell, where)
        for colour in station.colours:
            if not re.fullmatch("#[0-9a-fA-F]{6}", colour):
                raise Error(f"colour {colour[:24]!r} is not written as #rrggbb", where=where, code="colour-invalid")
        if station.by_hand and (station.depth_mm or station.wipe_mm or station.stir_mm):
            sentence = "with by_hand a person loads the brush: depth_mm, wipe_mm and stir_mm must go"
            raise Error(sentence, where=where, code="cell-station")
        if not station.by_hand and not station.depth_mm and station.name != getattr(cell.reload, "wash", None):
            raise Error("depth_mm 0 takes no paint", where=where, code="cell-station")
    if cell.stations and not cell.reload:
        raise Error("stations need a table reload that says when to visit them", where="reload", code="cell-reload")
    if not cell.reload:
        return
    if cell.reload.when not in RELOAD_OCCASIONS:
        sentence = f"{cell.reload.when!r} is none of {', '.join(RELOAD_OCCASIONS)}"
        raise Error(sentence, where="reload.when", code="cell-reload")
    if not cell.stations:
        raise Error("there is no station to reload at", where="reload", code="cell-reload")
    if cell.reload.when == "length" and not cell.reload.every_mm > 2 * cell.reload.backtrack_mm:
        raise Error(
            f"every_mm {cell.reload.every_mm:g} must be more than twice backtrack_mm {cell.reload.backtrack_mm:g}",
            where="reload.every_mm",
            code="cell-reload",
        )
    if cell.reload.wash and cell.reload.wash not in names:
        raise Error(f"there is no station {cell.reload.wash!r}", where="reload.wash", code="cell-reload")
    if cell.reload.rinse and not cell.reload.wash:
        raise Error("rinse needs wash, the station of the water", where="reload.rinse", code="cell-reload")


def _check_station_heights(station: Station, cell: Cell, where: str) -> None:
    if station.by_hand:
        if why := reason_for_no_waiting(cell):
            raise Error(f"{why}: by_hand cannot be", where=where, code="cell-station")
        return
    top = cell.heights.safe_mm - cell.heights.clearance_mm
    if not station.surface_mm <= station.rim_mm <= top:
        raise Error(
            f"rim_mm {station.rim_mm:g} is outside the range [{station.surface_mm:g}, {top:g}] mm, from the paint's "
            f"surface to clearance_mm below the safe height",
            where=where,
            code="cell-station",
        )
    bottom = station.surface_mm - station.depth_mm
    if bottom < cell.heights.lowest_mm:
        sentence = f"the tip goes to {bottom:g} mm in the paint, below lowest_mm {cell.heights.lowest_mm:g}"
        raise Error(sentence, where=where, code="cell-station")
    for point in station.wipe_mm:
        if not station.rim_mm <= point[2] <= cell.heights.safe_mm:
            raise Error(
                f"a wipe at {point[2]:g} mm is outside the range [{station.rim_mm:g}, {cell.heights.safe_mm:g}] mm, "
                f"from the rim to the safe height",
                where=where,
                code="cell-station",
            )


def _check_other_vessels(station: Station, cell: Cell, where: str) -> None:
    """Refuse a visit that dips below another vessel's rim; stations at one place are one vessel."""
    if station.by_hand:
        return
    dip = (*station.place_mm, station.surface_mm - station.depth_mm)
    above_rim = (*station.place_mm, max(station.rim_mm, 0.0) + cell.heights.clearance_mm)
    for other in cell.stations:
        if other.by_hand or other.place_mm == station.place_mm:
            continue
        dip_mm = _find_distance_below_rim([dip, dip], other)
        distances_mm = {
            "place_mm": dip_mm,
            "the circle of stir_mm": abs(dip_mm - station.stir_mm),
            "the way along wipe_mm": _find_distance_below_rim([above_rim, *station.wipe_mm], other),
        }
        for name, away_mm in distances_mm.items():
            if away_mm < other.radius_mm:
                raise Error(
                    f"{name} is {away_mm:.3g} mm from the middle of vessel {other.name!r}, less than its radius_mm "
                    f"{other.radius_mm:g}: the tool would hit that vessel below its rim at {other.rim_mm:g} mm",
                    where=where,
                    code="cell-station",
                    advice="move one of them, or correct radius_mm",
                )


def _find_distance_below_rim(path: list, vessel: Station) -> float:
    """Return how far [mm] a vessel's middle is from a path of lines below the rim, inf if it is nowhere below."""
    nearest_mm = math.inf
    for start, end in pairwise(np.array(path, dtype=float)):
        above_mm = np.array([start[2], end[2]]) - vessel.rim_mm
        if above_mm.min() >= 0:
            continue
        first, last = start, end
        if above_mm.max() > 0:
            at_rim = start + (end - start) * above_mm[0] / (above_mm[0] - above_mm[1])
            first, last = (at_rim, end) if above_mm[0] > 0 else (start, at_rim)
        way, to_middle = (last - first)[:2], np.array(vessel.place_mm) - first[:2]
        share = np.clip(to_middle @ way / max(way @ way, 1e-12), 0.0, 1.0)
        nearest_mm = min(nearest_mm, float(np.hypot(*(to_middle - share * way))))
    return nearest_mm


# (key, smallest usual value, largest usual value, why a value outside this range is unusual)
USUAL_RANGES = (
    ("heights.safe_mm", 2.0, 200.0, "clips, vessels and drops of paint may be higher, or the lift takes long"),
    ("heights.lowest_mm", -50.0, -0.5, "few brushes bend this far, or nothing is painted"),
    ("speeds.travel_mm_s", 1.0, 1000.0, "few machines are this fast or slow"),
    ("speeds.approach_mm_s", 1.0, 200.0, "the tool comes down on the paper at this speed"),
    ("speeds.press_mm_s", 0.5, 100.0, "the brush is pressed down at this speed"),
    ("speeds.paint_mm_s", 1.0, 500.0, "bristles whip or dry at such a speed"),
    (
        "speeds.acceleration_mm_s2",
        10.0,
        10000.0,
        "few machines accelerate like this, and the time estimate depends on it",
    ),
    ("paper.flatness_mm", 0.0, 2.0, "half a millimetre already changes the width of a thin line"),
    ("workspace.margin_mm", 5.0, 500.0, "the tool is ahead of the brush by the lag and needs no more room"),
    ("servo.step_mm", 0.0, 0.5, "the depth is off by half of it"),
    ("reload.every_mm", 20.0, 1e5, "few loads of paint last for less or more"),
)


OF_EXAMPLE = Notice(
    "paper",
    "the paper's place is an example: teach the place of your paper",
    code="paper-example",
    advice="brushsvg cell new --taught writes a cell with it",
)


def report_unusual_values(cell: Cell) -> list[Notice]:
    """Report values that are unusual but may be intended. Each notice names the key."""
    notices = []
    for key, least, greatest, why in USUAL_RANGES:
        table, _, name = key.partition(".")
        value = getattr(getattr(cell, table), name, None)
        if value is not None and not least <= value <= greatest:
            sentence = f"{value:g} is outside the usual range [{least:g}, {greatest:g}]: {why}"
            notices.append(Notice(key, sentence, code="unusual-value", about=key))
    if cell.servo and (value := value_mm(cell)) > 0.1:
        sentence = f"one value changes the height by {value:.2g} mm: depths are off by half of it"
        notices.append(Notice("servo.table", sentence, code="servo-coarse"))
    if cell.tool and not 10.0 <= (length_mm := float(np.linalg.norm(cell.tool.tcp_mm))) <= 500.0:
        sentence = f"the tip is {length_mm:.4g} mm from the flange, outside the usual range [10, 500] mm"
        notices.append(Notice("tool.tcp_mm", sentence, code="unusual-value", about="tool.tcp_mm"))
    behind_mm = -float(rotation(cell.tool.rotation_deg)[:, 2] @ cell.tool.tcp_mm) if cell.tool else 0.0
    if behind_mm > MAX_TIP_BEHIND_MM:
        sentence = f"the tip is {behind_mm:.4g} mm behind the flange, so the brush points back past it"
        advice = "check the signs of tcp_mm and rotation_deg: z of the tool points from the holder to the tip"
        notices.append(Notice("tool.tcp_mm", sentence, code="unusual-value", about="tool.tcp_mm", advice=advice))
    for number, station in enumerate(cell.stations, 1):
        if station.stir_mm > station.radius_mm:
            sentence = (
                f"stir_mm {station.stir_mm:g} is more than radius_mm {station.radius_mm:g}: the brush would stir "
                "outside its vessel"
            )
            advice = "lower stir_mm, or set radius_mm to the radius of the vessel"
            notices.append(Notice(f"station {number}", sentence, code="unusual-value", advice=advice))
    if cell.paper.example:
        notices.append(OF_EXAMPLE)
    return notices + _check_facing(cell) + _check_dip_tilt(cell) + _check_sheet_corner(cell)


def _check_facing(cell: Cell) -> list[Notice]:
    """Report paper on a wall that faces away from the robot: its points were probably exchanged."""
    frame = robot_from_paper(cell)
    tilt_deg, ahead_mm = normal_tilt_deg(frame), float(frame[:2, 2] @ frame[:2, 3])
    if not cell.tool or tilt_deg < MIN_WALL_TILT_DEG or ahead_mm <= 0:
        return []
    sentence = (
        f"the paper leans {tilt_deg:.0f} degrees and faces away from the robot's origin, as if painted from behind: "
        "seen from its front, the third point must be to the left of the line from the first to the second"
    )
    return [Notice("paper", sentence, code="paper-faces-away")]


def _check_dip_tilt(cell: Cell) -> list[Notice]:
    """Report dips next to paper that leans, because they go along the paper's normal."""
    tilt_deg = normal_tilt_deg(robot_from_paper(cell))
    if tilt_deg <= MAX_DIP_TILT_DEG or not any(station.depth_mm for station in cell.stations):
        return []
    sentence = (
        f"the paper leans {tilt_deg:.0f} degrees, and the brush dips along the paper's normal: it may hit the rim of a "
        "level vessel"
    )
    return [Notice("stations", sentence, code="paper-tilted", advice="dip the brush yourself, with by_hand = true")]


def _check_sheet_corner(cell: Cell) -> list[Notice]:
    """Report a sheet corner that the tool cannot reach; perhaps nothing is painted near it."""
    corner = make_paths([[(0.0, 0.0, 0.0), (0.0, 0.0, cell.heights.safe_mm)]])
    return [
        replace(notice, where="workspace", sentence=f"over the sheet's lower left corner {notice.sentence}")
        for notice in find_broken_limits(corner, robot_from_paper(cell), replace(cell, servo=None))
    ]
