"""The robot's side of the table: the place of the paper, how high, how fast and how far the tool may go, the paint."""

from __future__ import annotations

from dataclasses import MISSING, dataclass, field, fields, is_dataclass, replace
from functools import lru_cache

import numpy as np

from ..frames import frame_of_points, frame_of_pose


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

    origin_mm: tuple = _key(
        "lower left corner of the sheet in the robot's frame", (3,), default=(0.0, 0.0, 0.0)
    )
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
        "how far off the plane of three the fourth point may be", 0.01, 10, default=0.5
    )
    example: bool = _key("true until the paper has been taught: every program warns", "yes", default=False)


FANUC_CONFIGURATION = "N U T, 0, 0, 0"
ROS_FRAMES = "base_link", "tool0"  # as ROS-Industrial names them
MOST_TILT_DEG = 30.0  # of a plan.json
TURN_DEG_S = (
    45.0  # a quarter of what most joints of arms turn by in a second: some turn further than the tool does
)


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
        "how fast the tool may turn where a plan tilts it", 0.1, 360, default=TURN_DEG_S
    )
    configuration: str = _key(
        "fanuc: of the arm over the sheet, as the pendant shows it", "text", default=FANUC_CONFIGURATION
    )
    base_frame: str = _key("ros2: the robot's frame", "text", default=ROS_FRAMES[0])
    flange_frame: str = _key("ros2: the link whose poses are written", "text", default=ROS_FRAMES[1])


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
    approach_mm_s: float = _number(
        "on the way down to the clearance; the brush's limit where that is less", 0.01, 5000
    )
    press_mm_s: float = _number("straight down into the paper or paint, and up again", 0.01, 5000)
    paint_mm_s: float = _number("the most while painting; the brush has a limit of its own", 0.01, 5000)
    acceleration_mm_s2: float = _number(
        "for the time estimate, and where the language asks for one", 1, 50000
    )


BLEND_STEP_MM = 1.0
RAMP_S = 0.5


@dataclass(frozen=True)
class Blending:
    """How much of the joint of two moves the machine may cut, so as not to stand still there and bleed."""

    tolerance_mm: float = _number("at most so far from the joint; 0: joints are met exactly", 0, 10)
    radius_mm: float = _number("robots: blends begin so far before the joint at most", 0, 100, default=0.0)
    step_mm: float = _number(
        "dobot: blends are written in steps of so much, rounded down", 0.001, 1, default=BLEND_STEP_MM
    )
    ramp_s: float = _number(
        "fanuc: how long the arm takes to its speed, by which CNT cuts corners", 0.02, 5, default=RAMP_S
    )


@dataclass(frozen=True)
class Workspace:
    """Where the tool may be."""

    margin_mm: float = _number("beyond the sheet's edges: the TCP leads the brush", 0, 1e4)
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
    step_mm: float = _number(
        "the value is renewed when the height has changed by so much", 0.01, 10, default=0.1
    )
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
    settle_s: float = _number(
        "marlin-servo: wait behind each value until the pen is there", 0, 60, default=0.3
    )


@dataclass(frozen=True)
class Contact:
    """What ends the program at once: the tool is pressed harder than any brush is. A brush that bends is not felt."""

    force_n: float = _number(
        "urscript: more newtons than a brush may be pressed with, and than the sensor is off by",
        5,
        100,
        default=0.0,
    )
    sensitivity: int = _key(
        "xarm: how soon the arm takes a resistance for a collision, 5 the soonest", "whole", 1, 5, default=0
    )


@dataclass(frozen=True)
class Machine:
    """Errors of the machine, as `brushsvg calibrate --machine` finds them: programs are corrected, so that the tool
    goes where it should. x and y from the sheet's lower left corner."""

    lean_mm_per_mm: tuple = _key(
        "x and y by which the tool gives way for each mm that it is pressed", (2,), -1.5, 1.5, (0.0, 0.0)
    )
    scale: tuple = _key("how far x and y go for each commanded mm", (2,), 0.9, 1.1, (1.0, 1.0))
    skew: float = _number("how far x goes for each commanded mm of y", -0.1, 0.1, default=0.0)
    height_mm: float = _number(
        "how much higher the paper is at its corner than it was taught", -5, 5, default=0.0
    )
    tilt_mm_per_mm: tuple = _key("by how much it rises along x and along y", (2,), -0.05, 0.05, (0.0, 0.0))
    map_mm: tuple = _key(
        "x, y and how much higher still it is there, at all places of a grid: straight in between, and beyond the "
        "grid as at its edge",
        (None, 3),
        -2e3,
        2e3,
        (),
    )
    backlash_mm: tuple = _key(
        "commanded way of the machine's own x and y before they follow, where they turn back",
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
        "how far from there along x and along y they are 1: the field was measured so far", (2,), 5, 2e3, ()
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
    speeds_deg_s: tuple = _key(
        "the most that each joint turns by in a second; none: not checked", (None,), 0.1, 1e4, default=()
    )
    base_mm: tuple = _key("place of the first joint's frame in the robot's", (3,), default=(0.0, 0.0, 0.0))
    base_rotation_deg: tuple = _key("of that frame, about x, y, z", (3,), -360, 360, (0.0, 0.0, 0.0))
    flange_rotation_deg: tuple = _key(
        "of the flange behind the last joint, about x, y, z", (3,), -360, 360, (0.0, 0.0, 0.0)
    )
    posture_deg: tuple = _key(
        "joints somewhere over the paper: programs begin in the posture nearest to them; none: in any that does it all",
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
    """What the pendant calls a joint, counted from 0."""
    return int(arm.numbers[joint]) if arm.numbers else joint + 1


@dataclass(frozen=True)
class Station:
    """A vessel, or a place to wait for a person with one. In the paper's frame, as all heights."""

    name: str = _key("as the program's comments call it", "text")
    place_mm: tuple = _key("x and y of its middle", (2,))
    colours: tuple = _key(
        "colours of strokes it serves, as in the drawing, '#rrggbb'; none: all", "texts", default=()
    )
    by_hand: bool = _key("the program stops here until a person has dipped the brush", "yes", default=False)
    surface_mm: float = _number("height of the paint's surface", -1e3, 1e3, default=0.0)
    depth_mm: float = _number("how deep the tip goes below the paint's surface", 0, 100, default=0.0)
    rim_mm: float = _number("height of the vessel's rim", -1e3, 1e3, default=0.0)
    hold_s: float = _number("wait in the paint", 0, 600, default=0.0)
    drip_s: float = _number("wait above it", 0, 600, default=0.0)
    wipe_mm: tuple = _key(
        "points x, y, z that the tip passes afterwards, at press_mm_s", (None, 3), default=()
    )
    stir_mm: float = _number(
        "radius of circles in the paint before it is taken, or in the water; 0: none", 0, 100, default=0.0
    )
    stir_turns: int = _key("how many circles", "whole", 1, 20, default=2)


def briefly(station: Station) -> Station:
    """A short visit: without stirring. The same station where nothing is stirred."""
    return replace(station, name=f"{station.name}, short", stir_mm=0.0) if station.stir_mm else station


@dataclass(frozen=True)
class Reload:
    """When to fetch paint. Stations of the stroke's colour are visited."""

    when: str = _key("length, stroke or layer", "text")
    every_mm: float = _number("for length: paint lasts so far", 1, 1e6, default=300.0)
    backtrack_mm: float = _number("a stroke goes on so far back in its own mark", 0, 100, default=5.0)
    wash: str = _key("station to visit before the colour changes", "text", default="")
    narrower_percent: float = _number(
        "for length, and a brush that says how its marks narrow: paint lasts until they are so much narrower; 0: not "
        "looked at",
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


TABLES = {
    "paper": Paper,
    "heights": Heights,
    "speeds": Speeds,
    "blending": Blending,
    "workspace": Workspace,
    "tool": Tool,
    "servo": Servo,
    "pen": Pen,
    "motors": Motors,
    "contact": Contact,
    "reload": Reload,
    "machine": Machine,
    "robodk": RoboDK,
    "arm": Arm,
}
OPTIONAL_TABLES = ("tool", "servo", "pen", "motors", "contact", "reload", "machine", "robodk", "arm")
NEEDED_BY = {
    "grbl-servo": ("servo",),
    "ebb": ("servo", "motors"),
    "hpgl": ("pen",),
    "marlin-servo": ("pen",),
    "robodk": ("tool", "robodk"),
} | dict.fromkeys(("urscript", "jaka", "rapid", "xarm", "krl", "dobot", "fanuc", "doosan", "ros2"), ("tool",))
CONTACT_BY = {"urscript": "force_n", "xarm": "sensitivity"}  # the key for the contact that ends a program
OF_JOINTS = "joints of an arm have play of their own"
NO_BACKLASH = dict.fromkeys(  # and why it is not undone
    ("urscript", "jaka", "rapid", "xarm", "krl", "dobot", "fanuc", "doosan", "ros2", "robodk"), OF_JOINTS
) | {"ebb": "its motors share x and y, and have play of their own"}
LEAST_BACKLASH_MM = 0.01
LEAST_ACCELERATION_MM_S2 = {"rapid": 100.0}  # of PathAccLim
LEAST_SPEED_MM_S = {
    "dobot": 1.0,
    "fanuc": 1.0,
    "hpgl": 10.0,
    "ebb": 0.1,
}  # of a line; all speeds are whole multiples of it
LEAST_SERVO_SPEED_MM_S = 1 / 60  # grbl runs a lower feed at this one
UNITS_MM = {"hpgl": 0.025}  # of places in languages that know no fractions
ARCS_IN_SEGMENTS = ("marlin", "klipper")  # whose firmware makes lines of circles, where it knows any
RADII_MM = {"fluidnc": 0.005}  # a circle's ends may be so much further from its centre than each other
MOST_POINTS = {"fanuc": 1000}  # of one program: longer jobs are parted between strokes
MOST_LINES = {"urscript": 1000, "krl": 2500}  # the same; a stroke that has more is a program by itself
RELOADS = ("length", "stroke", "layer")


def robot_from_paper(cell: Cell, z_offset_mm: float = 0.0) -> np.ndarray:
    """(4, 4): the paper's frame in the robot's, the paper z_offset_mm higher than the cell says.

    Error when taught points do not make a plane or the fourth one is not in it.
    """
    paper = cell.paper
    if paper.taught_mm:
        frame = frame_of_points(paper.taught_mm, paper.flatness_mm)
    else:
        frame = frame_of_pose(paper.origin_mm, paper.rotation_deg)
    frame[:3, 3] += z_offset_mm * frame[:3, 2]
    return frame


def unit_mm(cell: Cell) -> float:
    """Return the distance between places of x, and of y, that the cell's language can express; of motors, twice the
    greatest shift by rounding."""
    if cell.motors:
        return _unit_of_motors_mm(cell.motors)
    return UNITS_MM.get(cell.language, 10.0**-cell.decimals)


def rounded(points_mm: np.ndarray, cell: Cell) -> np.ndarray:
    """Points (n, 3) of a program as the cell's language has them."""
    points = np.round(points_mm, cell.decimals)
    if cell.motors:
        points[:, :2] = places_of(steps_of(points_mm, cell.motors), cell.motors)
    if unit := UNITS_MM.get(cell.language):
        points[:, :2] = np.round(np.rint(np.asarray(points_mm)[:, :2] / unit) * unit, cell.decimals)
    return points


def steps_of(points_mm: np.ndarray, motors: Motors) -> np.ndarray:
    """(n, 2) where the motors are at points (n, 2 or 3), in whole steps from the origin."""
    return np.rint(np.asarray(points_mm)[:, :2] @ _steps_from_mm(motors)).astype(int)


@lru_cache(maxsize=8)
def _steps_from_mm(motors: Motors) -> np.ndarray:
    return np.transpose(motors.steps_per_mm)


def places_of(steps: np.ndarray, motors: Motors) -> np.ndarray:
    """(n, 2) x and y [mm] for steps (n, 2)."""
    return steps @ mm_from_steps(motors).T


@lru_cache(maxsize=8)
def _unit_of_motors_mm(motors: Motors) -> float:
    return float(np.abs(mm_from_steps(motors)).sum(axis=1).max())


@lru_cache(maxsize=8)
def mm_from_steps(motors: Motors) -> np.ndarray:
    """(2, 2) how far x and y go for a step of each motor."""
    return np.linalg.inv(motors.steps_per_mm)


def value_mm(cell: Cell) -> float:
    """The most that one value of the servo changes the height by [mm]."""
    steps = np.diff(np.array(cell.servo.table), axis=0)
    return float(np.abs(steps[:, 0] / steps[:, 1]).max())


def servo_stands(steps_mm: np.ndarray, cell: Cell) -> np.ndarray:
    """(n,) which steps (n, 3) are a servo's lift alone: rounding need not leave their sideways part."""
    return np.hypot(steps_mm[:, 0], steps_mm[:, 1]) < 0.5 * unit_mm(cell)


def servo_parts(ways_mm: np.ndarray, cell: Cell, longer_mm: float = 0.0) -> np.ndarray:
    """(n,) how many parts a servo's straight ways (n, 3) have: one for each step of height, as long as rounding leaves
    each a move. longer_mm: of each way seen from above, by which the rounding of its ends may change the number."""
    steps = np.ceil(np.abs(ways_mm[:, 2]) / cell.servo.step_mm - 1e-9)
    lengths_mm = np.hypot(ways_mm[:, 0], ways_mm[:, 1]) + longer_mm
    return np.maximum(1, np.minimum(lengths_mm // least_part_mm(cell), steps)).astype(int)


def ends_rounded_mm(cell: Cell) -> float:
    """By how much the rounding of both ends may change the length of a way."""
    return 2**0.5 * unit_mm(cell)


def servo_is_outrun(
    ways_mm: np.ndarray, speed_mm_s: float, cell: Cell, are_rounded: bool = False
) -> np.ndarray:
    """(n,) which straight ways (n, 3) are too steep for a servo that moves along: its height would change by more than
    two steps in a part, no step being less than a value; or by more than STEEP times its length, whose parts say little
    once they are rounded; or the feed, slowed down for it, would be less than the firmware runs. are_rounded: as a
    program has them, which may be steeper than what was planned, by as much."""
    rises_mm = np.abs(ways_mm[:, 2])
    flat_mm, length_mm = np.hypot(ways_mm[:, 0], ways_mm[:, 1]), np.linalg.norm(ways_mm, axis=1)
    # as many parts as are written at least; of what is read, at most
    parts = servo_parts(ways_mm, cell, ends_rounded_mm(cell) if are_rounded else -ends_rounded_mm(cell))
    if are_rounded:
        rises_mm, flat_mm = np.maximum(rises_mm - value_mm(cell), 0.0), flat_mm + ends_rounded_mm(cell)
        length_mm = np.hypot(flat_mm, rises_mm)
    least_mm_s = LEAST_SPEED_MM_S.get(cell.language, LEAST_SERVO_SPEED_MM_S)
    step_mm = max(cell.servo.step_mm, value_mm(cell))
    has_few_parts = rises_mm > 2 * step_mm * parts
    is_steep = rises_mm > STEEP * flat_mm
    is_slow = speed_mm_s * flat_mm < least_mm_s * length_mm
    return (rises_mm > step_mm + 1e-9) & (has_few_parts | is_steep | is_slow) & ~servo_stands(ways_mm, cell)


STEEP = 10.0  # of a way that a servo's brush is pressed before, or lifted after, on the spot


def least_part_mm(cell: Cell) -> float:
    """Parts of a way that are as long are moves, however their ends are rounded."""
    return least_move_mm(cell) + 2**0.5 * unit_mm(cell)


def least_move_mm(cell: Cell) -> float:
    """No move is shorter, between places as they are written: of rounded ones the square of a distance is whole, in
    units, and none is as long as that by a hair."""
    unit = unit_mm(cell)
    return unit * (max(2.0, round(LEAST_MM / unit)) ** 2 + 0.5) ** 0.5


# no move is shorter, nor than two units of the last decimal: rounded, it would go anywhere or nowhere, and a robot that
# blends would stop for it; longer ones are seen where a tiny brush turns
LEAST_MM = 2e-3


def entries(table) -> dict[str, Entry]:
    """The keys that a table of a cell file may have, with what each means."""
    return {item.name: item.metadata["entry"] for item in fields(table) if "entry" in item.metadata}


def required(table) -> set[str]:
    """Those of its keys that must be there."""
    return {item.name for item in fields(table) if "entry" in item.metadata and item.default is MISSING}


def tables_of(cell: Cell) -> dict[str, object]:
    """Return the tables that the cell has, in a dictionary of names."""
    return {name: getattr(cell, name) for name in TABLES if is_dataclass(getattr(cell, name))}


def why_no_waiting(cell: Cell) -> str:
    """Why a program for this cell cannot wait for a person; "" where it can."""
    if cell.language == "ros2":
        return "a trajectory cannot wait for a person"
    if cell.motors:
        return "the board cannot wait for a person"
    if cell.language == "hpgl":
        return "a pen plotter cannot wait for a person"
    return "a servo's brush falls while the program waits" if cell.servo else ""


def why_no_backlash(cell: Cell) -> str:
    """Why backlash is not undone for this cell; "" where it is."""
    return OF_JOINTS if cell.arm else NO_BACKLASH.get(cell.language, "")


def not_undone(cell: Cell) -> dict[str, str]:
    """The keys of a table machine that this machine cannot undo, each with the reason."""
    found = {}
    if cell.servo:  # at its steps a way would jump sideways
        found |= dict.fromkeys(
            ("lean_mm_per_mm", "tilt_mm_per_mm", "map_mm"), "a servo's depth goes in steps"
        )
    if cell.pen:
        keys = ("lean_mm_per_mm", "tilt_mm_per_mm", "map_mm", "height_mm")
        found |= dict.fromkeys(keys, "a pen knows no height")
    if why := why_no_backlash(cell):
        found["backlash_mm"] = why
    return found


ALONG_RAD = 0.1  # an axis that is turned by less goes along the paper's edge, as far as its play shows


def axes_along_paper(cell: Cell) -> tuple[int, int] | None:
    """Which of the machine's axes go along x and along y of the paper; None where it is askew, or backlash is not
    undone."""
    if why_no_backlash(cell):
        return None
    turned = np.abs(robot_from_paper(cell)[:2, :2])
    if min(turned.max(axis=0)) < np.cos(ALONG_RAD):
        return None
    return (0, 1) if turned[0, 0] > turned[0, 1] else (1, 0)


def least_backlash_mm(cell: Cell) -> float:
    """Less is none: its half is no whole unit, and taking it up no move."""
    return max(LEAST_BACKLASH_MM, 2 * unit_mm(cell))
