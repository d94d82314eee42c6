"""Cells: the paper's place, limits of height, speed and space, and paint."""

from __future__ import annotations

from dataclasses import MISSING, dataclass, field, fields, is_dataclass, replace
from functools import lru_cache
from typing import Literal

import numpy as np

from ..frames import frame_of_points, frame_of_pose
from .language_limits import JOINT_PLAY_REASON, LEAST_SPEED_MM_S, MIN_SERVO_SPEED_MM_S, NO_BACKLASH_REASONS, UNITS_MM


@dataclass(frozen=True)
class Entry:
    """What a key of a cell file says and may hold.

    kind: text, yes, whole, number, or the shape of a table of numbers as a tuple, None for any count of rows.
    """

    help: str
    kind: object
    least: float = -1e5
    greatest: float = 1e5


def _key(help: str, kind, least: float = -1e5, greatest: float = 1e5, default=MISSING):
    return field(default=default, metadata={"entry": Entry(help, kind, least, greatest)})


def _number(help: str, least: float, greatest: float, default=MISSING):
    return _key(help, "number", least, greatest, default)


@dataclass(frozen=True)
class Paper:
    """Place of the sheet's lower left corner in the robot's frame: a pose, or points that were taught."""

    origin_mm: tuple = _key("lower left corner of the sheet in the robot's frame", (3,), default=(0.0, 0.0, 0.0))
    rotation_deg: tuple = _key(
        "about the robot's x, then its y, then its z axis", (3,), -360, 360, default=(0.0, 0.0, 0.0)
    )
    taught_mm: tuple = _key(
        "instead of the pose: the brush's tip at the lower left corner, somewhere along the lower edge and somewhere "
        "along the left edge, each just touching; a fourth point anywhere on the paper shows whether it is flat",
        (None, 3),
        default=(),
    )
    flatness_mm: float = _number(
        "largest distance of the fourth point from the plane of the other three", 0.01, 10, default=0.5
    )
    example: bool = _key("true until the paper has been taught: every program warns", "yes", default=False)


DEFAULT_FANUC_CONFIGURATION = "N U T, 0, 0, 0"
DEFAULT_ROS_FRAMES = "base_link", "tool0"  # the names that ROS-Industrial uses
MOST_TILT_DEG = 30.0  # largest tilt of the brush in a plan.json
# A quarter of the speed of most arm joints: some joints turn further than the tool does.
DEFAULT_TOOL_TURN_DEG_S = 45.0


@dataclass(frozen=True)
class Tool:
    """The brush's tip, seen from the robot's flange; the brush stands on the paper's normal."""

    tcp_mm: tuple = _key("the brush's tip in the flange's frame", (3,), -2000, 2000)
    rotation_deg: tuple = _key(
        "of the tool's frame, z along the brush; about x, y, z", (3,), -360, 360, (0.0, 0.0, 0.0)
    )
    spin_deg: float = _number("how the tool is turned about the brush's axis", -360, 360, default=0.0)
    tilt_limit_deg: float = _number(
        "how far a plan may tilt the brush from the paper's normal", 0, 30, default=MOST_TILT_DEG
    )
    turn_deg_s: float = _number(
        "how fast the tool may turn where a plan tilts it", 0.1, 360, default=DEFAULT_TOOL_TURN_DEG_S
    )
    configuration: str = _key(
        "fanuc: configuration of the arm over the sheet, as the pendant shows it",
        "text",
        default=DEFAULT_FANUC_CONFIGURATION,
    )
    base_frame: str = _key("ros2: the robot's frame", "text", default=DEFAULT_ROS_FRAMES[0])
    flange_frame: str = _key("ros2: the link whose poses are written", "text", default=DEFAULT_ROS_FRAMES[1])


@dataclass(frozen=True)
class Heights:
    """Over the paper: z up, 0 where the unbent brush just touches."""

    safe_mm: float = _number("travel between strokes, clear of clips, vessels and wet paint", 0.5, 1000)
    clearance_mm: float = _number("below this only at press_mm_s", 0.01, 1e3)
    lowest_mm: float = _number("never lower than this", -200, -0.01)


@dataclass(frozen=True)
class Speeds:
    """Of the tool's tip."""

    travel_mm_s: float = _number("at or above the safe height", 0.01, 5000)
    approach_mm_s: float = _number("on the way down to the clearance; the brush's limit where that is less", 0.01, 5000)
    press_mm_s: float = _number("straight down into the paper or paint, and up again", 0.01, 5000)
    paint_mm_s: float = _number("limit while painting; the brush has its own limit", 0.01, 5000)
    acceleration_mm_s2: float = _number("for the time estimate, and where the language asks for one", 1, 50000)


DEFAULT_BLEND_STEP_MM = 1.0
DEFAULT_RAMP_S = 0.5


@dataclass(frozen=True)
class Blending:
    """How much of the joint of two moves the machine may cut, so as not to stand still there and bleed."""

    tolerance_mm: float = _number("largest distance from the corner; 0: corners are exact", 0, 10)
    radius_mm: float = _number("robots: largest distance before a corner at which a blend begins", 0, 100, default=0.0)
    step_mm: float = _number(
        "dobot: blends are written in steps of this size, rounded down", 0.001, 1, default=DEFAULT_BLEND_STEP_MM
    )
    ramp_s: float = _number(
        "fanuc: time that the arm needs to reach its speed; CNT cuts corners by it",
        0.02,
        5,
        default=DEFAULT_RAMP_S,
    )


@dataclass(frozen=True)
class Workspace:
    """Where the tool may be."""

    margin_mm: float = _number("how far the TCP may go beyond the sheet's edges: it is ahead of the brush", 0, 1e4)
    tilt_limit_deg: float = _number("how far the paper's normal may lean from the robot's z axis", 0, 180)
    box_mm: tuple = _key("two opposite corners of a box in the robot's frame", (2, 3), default=())
    reach_mm: tuple = _key("least and greatest distance from the robot's origin", (2,), 0, 1e5, default=())
    keep_out_mm: tuple = _key(
        "boxes in the robot's frame that the tool must not go through, each by two opposite corners",
        (None, 2, 3),
        default=(),
    )


@dataclass(frozen=True)
class Servo:
    """A pen lift that knows no millimetres: heights over the paper and the values that give them."""

    table: tuple = _key("rows of height in mm and value; both rise or fall steadily", (None, 2))
    step_mm: float = _number("a new value is written when the height has changed by this much", 0.01, 10, default=0.1)
    settle_s: float = _number("wait after a move of the lift alone", 0, 60, default=0.0)


@dataclass(frozen=True)
class Motors:
    """Two motors that count steps, from the origin on, and the pin of the servo that lifts the brush."""

    steps_per_mm: tuple = _key(
        "a row for each motor: its steps for a mm along x, and for a mm along y", (2, 2), -1e4, 1e4
    )
    servo_pin: int = _key("of the board, RP4 is its pin B1", "whole", 0, 24, default=4)


@dataclass(frozen=True)
class Pen:
    """A lift that knows up and down alone: up is the safe height."""

    down_mm: float = _number(
        "the height that the pen is let down to, below the paper as far as a brush is pressed", -200, -0.01
    )
    colours: tuple = _key(
        "colours of strokes, as in the drawing, '#rrggbb', of pens 1, 2, ... in the plotter; none: it has one",
        "texts",
        default=(),
    )
    servo_values: tuple = _key(
        "marlin-servo: values that lift the pen and let it down, in degrees", (2,), 0, 180, default=()
    )
    servo_number: int = _key("marlin-servo: which of the board's servos it is", "whole", 0, 3, default=0)
    settle_s: float = _number("marlin-servo: wait behind each value until the pen is there", 0, 60, default=0.3)


@dataclass(frozen=True)
class Contact:
    """What ends the program at once: the tool is pressed harder than any brush is. A brush that bends is not felt."""

    force_n: float = _number(
        "urscript: force that stops the arm; above the force of a pressed brush and the sensor's error",
        5,
        100,
        default=0.0,
    )
    sensitivity: int = _key(
        "xarm: how sensitive the arm is to collisions; 5 is the most sensitive", "whole", 1, 5, default=0
    )


@dataclass(frozen=True)
class Machine:
    """Errors of the machine, as `brushsvg calibrate --machine` finds them: programs are corrected, so that the tool
    goes where it should. x and y from the sheet's lower left corner."""

    lean_mm_per_mm: tuple = _key(
        "how far the tool yields in x and y for each mm that it is pressed", (2,), -1.5, 1.5, (0.0, 0.0)
    )
    scale: tuple = _key("how far x and y go for each commanded mm", (2,), 0.9, 1.1, (1.0, 1.0))
    skew: float = _number("how far x goes for each commanded mm of y", -0.1, 0.1, default=0.0)
    height_mm: float = _number("how much higher the paper is at its corner than it was taught", -5, 5, default=0.0)
    tilt_mm_per_mm: tuple = _key("slope of the paper along x and along y", (2,), -0.05, 0.05, (0.0, 0.0))
    map_mm: tuple = _key(
        "x, y and the extra height there, at all places of a grid: linear in between, and constant beyond its edge",
        (None, 3),
        -2e3,
        2e3,
        (),
    )
    backlash_mm: tuple = _key(
        "backlash: how far the machine's own x and y are commanded after a reversal before they move",
        (2,),
        0,
        3,
        (0.0, 0.0),
    )
    field_mm: tuple = _key(
        "displacement of the tool over the sheet: three numbers for x and three for y, at its edges, of u u, u v "
        "and v v, where u and v go from -1 to 1",
        (2, 3),
        -10,
        10,
        (),
    )
    field_middle_mm: tuple = _key("x and y where u and v are 0", (2,), -2e3, 2e3, ())
    field_reach_mm: tuple = _key(
        "distance from there along x and along y where they are 1: the field was measured up to there", (2,), 5, 2e3, ()
    )


@dataclass(frozen=True)
class Arm:
    """The arm's links and joints: `convert`, `check` and `cell place` then follow its joints along the program."""

    name: str = _key("of the arm", "text")
    source: str = _key("where its numbers are from", "text")
    dh: tuple = _key(
        "a row for each joint, a and d in mm, alpha and theta in degrees: turned by theta and the joint about z, "
        "along z by d, along x by a, turned about x by alpha",
        (None, 4),
    )
    limits_deg: tuple = _key("least and greatest angle of each joint", (None, 2), -1e4, 1e4)
    speeds_deg_s: tuple = _key("largest speed of each joint; none: not checked", (None,), 0.1, 1e4, default=())
    base_mm: tuple = _key("place of the first joint's frame in the robot's", (3,), default=(0.0, 0.0, 0.0))
    base_rotation_deg: tuple = _key("of that frame, about x, y, z", (3,), -360, 360, (0.0, 0.0, 0.0))
    flange_rotation_deg: tuple = _key(
        "of the flange behind the last joint, about x, y, z", (3,), -360, 360, (0.0, 0.0, 0.0)
    )
    posture_deg: tuple = _key(
        "joints somewhere over the paper: programs begin in the posture nearest to them; none: in any that reaches "
        "everything",
        (None,),
        -1e4,
        1e4,
        default=(),
    )
    numbers: tuple = _key(
        "of the joints, as the pendant counts them, where one more is held still; none: 1, 2, ...",
        (None,),
        1,
        9,
        default=(),
    )
    prebuilt: str = _key("an arm of the same links that the library ssik has ready", "text", default="")


def joint_number(arm: Arm, joint: int) -> int:
    """Return the pendant's number of a joint, which is counted from 0 here."""
    return int(arm.numbers[joint]) if arm.numbers else joint + 1


@dataclass(frozen=True)
class Station:
    """A vessel, or a place to wait for a person with one. In the paper's frame, as all heights."""

    name: str = _key("as the program's comments call it", "text")
    place_mm: tuple = _key("x and y of its middle", (2,))
    colours: tuple = _key("colours of strokes it serves, as in the drawing, '#rrggbb'; none: all", "texts", default=())
    by_hand: bool = _key("the program stops here until a person has dipped the brush", "yes", default=False)
    surface_mm: float = _number("height of the paint's surface", -1e3, 1e3, default=0.0)
    depth_mm: float = _number("how deep the tip goes below the paint's surface", 0, 100, default=0.0)
    rim_mm: float = _number("height of the vessel's rim", -1e3, 1e3, default=0.0)
    hold_s: float = _number("wait in the paint", 0, 600, default=0.0)
    drip_s: float = _number("wait above it", 0, 600, default=0.0)
    wipe_mm: tuple = _key("points x, y, z that the tip passes afterwards, at press_mm_s", (None, 3), default=())
    stir_mm: float = _number(
        "radius of circles in the paint before it is taken, or in the water; 0: none", 0, 100, default=0.0
    )
    stir_turns: int = _key("how many circles", "whole", 1, 20, default=2)
    radius_mm: float = _number("radius of the vessel, which no stroke enters below the rim", 0, 1e3, default=10.0)


def shorten_visit(station: Station) -> Station:
    """Return a station for a short visit, without stirring.

    A station where nothing is stirred is returned unchanged.
    """
    return replace(station, name=f"{station.name}, short", stir_mm=0.0) if station.stir_mm else station


@dataclass(frozen=True)
class Reload:
    """When to fetch paint. Stations of the stroke's colour are visited."""

    when: str = _key("length, stroke or layer", "text")
    every_mm: float = _number("for length: how far a load of paint lasts", 1, 1e6, default=300.0)
    backtrack_mm: float = _number("how far back in its own mark the brush lands after a reload", 0, 100, default=5.0)
    wash: str = _key("station to visit before the colour changes", "text", default="")
    narrower_percent: float = _number(
        "for length, and a brush with paint data: reload before marks are this much narrower; 0: off",
        0,
        90,
        default=0.0,
    )
    rinse: bool = _key(
        "a short visit to the wash station before more paint of the same colour, too", "yes", default=False
    )


@dataclass(frozen=True)
class RoboDK:
    """Of language robodk: a post processor of RoboDK's kind, which is a program in Python and is run."""

    post: str = _key("path of the post's .py, whose class is RobotPost", "text")


@dataclass(frozen=True)
class Cell:
    """A machine, its limits and its paint. Lengths in mm, speeds in mm/s, heights over the paper."""

    name: str = _key("as --cell calls it", "text")
    description: str = _key("one line", "text")
    language: str = _key("the robot's", "text")
    decimals: int = _key("of lengths in the program", "whole", 3, 6)
    paper: Paper
    heights: Heights
    speeds: Speeds
    blending: Blending
    workspace: Workspace
    arc_segment_mm: float = _number(
        "marlin and klipper: how long the lines are that the firmware makes of circles; 0: no circles are written",
        0,
        10,
        0.0,
    )
    pause_per_colour: bool = _key(
        "without stations: stop for another pen or brush before strokes of another colour",
        "yes",
        default=True,
    )
    tool: Tool | None = None
    servo: Servo | None = None
    pen: Pen | None = None
    motors: Motors | None = None
    contact: Contact | None = None
    reload: Reload | None = None
    machine: Machine | None = None
    robodk: RoboDK | None = None
    arm: Arm | None = None
    stations: tuple[Station, ...] = ()


_REQUIRED_TYPES = (Paper, Heights, Speeds, Blending, Workspace)
_OPTIONAL_TYPES = (Tool, Servo, Pen, Motors, Contact, Reload, Machine, RoboDK, Arm)
# By the name of the field of Cell.
TABLES = {table.__name__.lower(): table for table in _REQUIRED_TYPES + _OPTIONAL_TYPES}
OPTIONAL_TABLES = tuple(table.__name__.lower() for table in _OPTIONAL_TYPES)
# Tilt from which paper counts as a wall that is painted from the robot's side only.
# An arm may reach across flatter paper.
MIN_WALL_TILT_DEG = 45.0
LEAST_BACKLASH_MM = 0.01
RELOAD_OCCASIONS = ("length", "stroke", "layer")


def robot_from_paper(cell: Cell, z_offset_mm: float = 0.0) -> np.ndarray:
    """Return the pose (4, 4) of the paper's frame in the robot's frame.

    z_offset_mm: how much higher the paper is than the cell says.

    Raises Error if the taught points do not form a plane, or if the fourth point is not in the plane.
    """
    paper = cell.paper
    if paper.taught_mm:
        frame = frame_of_points(paper.taught_mm, paper.flatness_mm)
    else:
        frame = frame_of_pose(paper.origin_mm, paper.rotation_deg)
    frame[:3, 3] += z_offset_mm * frame[:3, 2]
    return frame


def unit_mm(cell: Cell) -> float:
    """Return the smallest step [mm] in x or y that the language can express.

    For motors, return twice the largest shift that rounding can cause.
    """
    if cell.motors:
        return _unit_of_motors_mm(cell.motors)
    return UNITS_MM.get(cell.language, 10.0**-cell.decimals)


def round_points(points_mm: np.ndarray, cell: Cell) -> np.ndarray:
    """Round points (n, 3) [mm] to the positions that the cell's language can express."""
    points = np.round(points_mm, cell.decimals)
    if cell.motors:
        points[:, :2] = mm_from_step_counts(steps_from_mm(points_mm, cell.motors), cell.motors)
    if unit := UNITS_MM.get(cell.language):
        points[:, :2] = np.round(np.rint(np.asarray(points_mm)[:, :2] / unit) * unit, cell.decimals)
    return points


def steps_from_mm(points_mm: np.ndarray, motors: Motors) -> np.ndarray:
    """Return motor positions (n, 2) in whole steps from the origin. points_mm: (n, 2 or 3) points [mm]."""
    return np.rint(np.asarray(points_mm)[:, :2] @ _steps_from_mm(motors)).astype(int)


@lru_cache(maxsize=8)
def _steps_from_mm(motors: Motors) -> np.ndarray:
    return np.transpose(motors.steps_per_mm)


def mm_from_step_counts(steps: np.ndarray, motors: Motors) -> np.ndarray:
    """Return x and y (n, 2) [mm] for motor positions (n, 2) in steps."""
    return steps @ mm_from_steps(motors).T


@lru_cache(maxsize=8)
def _unit_of_motors_mm(motors: Motors) -> float:
    return float(np.abs(mm_from_steps(motors)).sum(axis=1).max())


@lru_cache(maxsize=8)
def mm_from_steps(motors: Motors) -> np.ndarray:
    """Return how far [mm] x and y move for one step of each motor, (2, 2)."""
    return np.linalg.inv(motors.steps_per_mm)


def value_mm(cell: Cell) -> float:
    """Return the largest height change [mm] of one value of the servo."""
    steps = np.diff(np.array(cell.servo.table), axis=0)
    return float(np.abs(steps[:, 0] / steps[:, 1]).max())


def servo_stands(steps_mm: np.ndarray, cell: Cell) -> np.ndarray:
    """Return which steps (n, 3) [mm] only lift or lower the servo, (n,). Their sideways part may vanish in rounding."""
    return np.hypot(steps_mm[:, 0], steps_mm[:, 1]) < 0.5 * unit_mm(cell)


def servo_parts(ways_mm: np.ndarray, cell: Cell, longer_mm: float = 0.0) -> np.ndarray:
    """Return the number of parts (n,) of a servo's straight paths (n, 3) [mm].

    A path has one part for each step of height, but no more parts than rounding leaves as moves.
    longer_mm: extra length of each path seen from above, because rounding its ends may change the number.
    """
    steps = np.ceil(np.abs(ways_mm[:, 2]) / cell.servo.step_mm - 1e-9)
    lengths_mm = np.hypot(ways_mm[:, 0], ways_mm[:, 1]) + longer_mm
    return np.maximum(1, np.minimum(lengths_mm // min_part_mm(cell), steps)).astype(int)


def ends_rounded_mm(cell: Cell) -> float:
    """Return how much [mm] rounding both ends may change the length of a path."""
    return 2**0.5 * unit_mm(cell)


def is_too_steep_for_servo(
    ways_mm: np.ndarray, speed_mm_s: float, cell: Cell, ends: Literal["planned", "rounded", "read"] = "planned"
) -> np.ndarray:
    """Return which straight paths are too steep for a moving servo, (n,).

    A path is too steep in three cases:

    - The height would change by more than two steps in one part. A step is at least one servo value.
    - The height would change by more than MAX_SERVO_SLOPE times the path's length. Its rounded parts would say little.
    - The feed, slowed down for the servo, would be below the lowest feed of the firmware.

    ways_mm: (n, 3) displacement of each path [mm].
    ends: "planned", "rounded" as in a program, or "read" from a program, in which each path may be a part of a longer
    one. Rounding may have made a path steeper than planned, and the limits allow for that.
    """
    rises_mm = np.abs(ways_mm[:, 2])
    flat_mm, length_mm = np.hypot(ways_mm[:, 0], ways_mm[:, 1]), np.linalg.norm(ways_mm, axis=1)
    # the smallest number of parts that rounding may leave, the number that is written, or the largest one that may
    # have been read
    longer_mm = {"planned": -ends_rounded_mm(cell), "rounded": 0.0, "read": ends_rounded_mm(cell)}[ends]
    parts = servo_parts(ways_mm, cell, longer_mm)
    if ends != "planned":
        rises_mm, flat_mm = np.maximum(rises_mm - value_mm(cell), 0.0), flat_mm + ends_rounded_mm(cell)
        length_mm = np.hypot(flat_mm, rises_mm)
    min_speed_mm_s = LEAST_SPEED_MM_S.get(cell.language, MIN_SERVO_SPEED_MM_S)
    step_mm = max(cell.servo.step_mm, value_mm(cell))
    has_few_parts = rises_mm > 2 * step_mm * parts
    is_steep = rises_mm > MAX_SERVO_SLOPE * flat_mm
    is_slow = speed_mm_s * flat_mm < min_speed_mm_s * length_mm
    return (rises_mm > step_mm + 1e-9) & (has_few_parts | is_steep | is_slow) & ~servo_stands(ways_mm, cell)


# Largest slope of a path along which the servo moves. On a steeper path the brush is pressed on the spot before the
# path, or lifted on the spot after it.
MAX_SERVO_SLOPE = 10.0


def min_part_mm(cell: Cell) -> float:
    """Return the length [mm] from which a part of a path stays a move.

    Rounding of its ends does not turn such a part into nothing.
    """
    return least_move_mm(cell) + 2**0.5 * unit_mm(cell)


def least_move_mm(cell: Cell) -> float:
    """Return the length [mm] of the shortest move between rounded positions.

    The squared distance of rounded positions is a whole number of squared units. Half a unit is added to the square,
    so that no distance is close to this limit.
    """
    unit = unit_mm(cell)
    return unit * (max(2.0, round(MIN_MOVE_MM / unit)) ** 2 + 0.5) ** 0.5


# Length of the shortest move, which is also at least two units of the last decimal. Rounding would turn a shorter move
# in any direction or delete it, and a robot that blends would stop for it. A larger limit would be visible where a tiny
# brush turns.
MIN_MOVE_MM = 2e-3


def entries_of(table) -> dict[str, Entry]:
    """Return the keys that a table of a cell file may have, each with its Entry."""
    return {item.name: item.metadata["entry"] for item in fields(table) if "entry" in item.metadata}


def required_keys_of(table) -> set[str]:
    """Return the keys that a table of a cell file must have."""
    return {item.name for item in fields(table) if "entry" in item.metadata and item.default is MISSING}


def tables_of(cell: Cell) -> dict[str, object]:
    """Return the tables that the cell has, keyed by table name."""
    return {name: getattr(cell, name) for name in TABLES if is_dataclass(getattr(cell, name))}


def reason_for_no_waiting(cell: Cell) -> str:
    """Return why a program for this cell cannot wait for a person, or "" if it can."""
    if cell.language == "ros2":
        return "a trajectory cannot wait for a person"
    if cell.motors:
        return "the board cannot wait for a person"
    if cell.language == "hpgl":
        return "a pen plotter cannot wait for a person"
    return "a servo's brush falls while the program waits" if cell.servo else ""


def reason_for_no_backlash(cell: Cell) -> str:
    """Return why backlash is not compensated for this cell, or "" if it is."""
    return JOINT_PLAY_REASON if cell.arm else NO_BACKLASH_REASONS.get(cell.language, "")


def list_uncorrectable_keys(cell: Cell) -> dict[str, str]:
    """Return the keys of the table machine that cannot be corrected on a cell.

    The values of the result are the reasons.
    """
    reasons = {}
    if cell.servo:  # the tool would jump sideways at each step of the servo
        reasons |= dict.fromkeys(("lean_mm_per_mm", "tilt_mm_per_mm", "map_mm"), "a servo's depth goes in steps")
    if cell.pen:
        keys = ("lean_mm_per_mm", "tilt_mm_per_mm", "map_mm", "height_mm")
        reasons |= dict.fromkeys(keys, "a pen knows no height")
    if reason := reason_for_no_backlash(cell):
        reasons["backlash_mm"] = reason
    return reasons


# An axis that is turned by less counts as parallel to the paper's edge: its backlash looks the same.
MAX_AXIS_MISALIGNMENT_RAD = 0.1


def axes_along_paper(cell: Cell) -> tuple[int, int] | None:
    """Return which of the machine's axes run along x and along y of the paper.

    Returns None if the paper is askew, or if backlash is not compensated.
    """
    if reason_for_no_backlash(cell):
        return None
    turned = np.abs(robot_from_paper(cell)[:2, :2])
    if min(turned.max(axis=0)) < np.cos(MAX_AXIS_MISALIGNMENT_RAD):
        return None
    return (0, 1) if turned[0, 0] > turned[0, 1] else (1, 0)


def min_backlash_mm(cell: Cell) -> float:
    """Return the smallest backlash [mm] that can be compensated.

    Half of a smaller backlash is less than a whole unit, and taking it up would not be a move.
    """
    return max(LEAST_BACKLASH_MM, 2 * unit_mm(cell))
