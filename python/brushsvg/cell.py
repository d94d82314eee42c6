"""The robot's side of the table: where the paper lies, how high, how fast and how far the tool may go, the paint."""

from __future__ import annotations

from dataclasses import MISSING, dataclass, field, fields, is_dataclass

import numpy as np

from .errors import Error
from .frame import frame_of_points, frame_of_pose, normal_tilt_deg


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
    """Where the sheet's lower left corner lies in the robot's frame: a pose, or points that were taught."""

    origin_mm: tuple = _key(
        "lower left corner of the sheet in the robot's frame", (3,), default=(0.0, 0.0, 0.0)
    )
    rotation_deg: tuple = _key(
        "about the robot's x, then its y, then its z axis", (3,), -360, 360, default=(0.0, 0.0, 0.0)
    )
    taught_mm: tuple = _key(
        "instead of the pose: the brush's tip at the lower left corner, somewhere along the lower edge and somewhere "
        "along the left edge, each just touching; a fourth point anywhere on the paper tells whether it is flat",
        (None, 3),
        default=(),
    )
    flatness_mm: float = _number(
        "how far off the plane of three the fourth point may lie", 0.01, 10, default=0.5
    )
    example: bool = _key("true until the paper has been taught: every program warns", "yes", default=False)


@dataclass(frozen=True)
class Tool:
    """The brush's tip, seen from the robot's flange; the brush stands on the paper's normal."""

    tcp_mm: tuple = _key("the brush's tip in the flange's frame", (3,))
    rotation_deg: tuple = _key(
        "of the tool's frame, z along the brush; about x, y, z", (3,), -360, 360, (0.0, 0.0, 0.0)
    )
    spin_deg: float = _number("how the tool is turned about the brush's axis", -360, 360, default=0.0)


@dataclass(frozen=True)
class Heights:
    """Over the paper: z up, 0 where the unbent brush just touches."""

    safe_mm: float = _number("travel between strokes, clear of clips, vessels and wet paint", 0.1, 1e4)
    clearance_mm: float = _number("below this only at press_mm_s", 0.01, 1e3)
    lowest_mm: float = _number("never lower than this", -1e3, -0.01)


@dataclass(frozen=True)
class Speeds:
    """Of the tool's tip."""

    travel_mm_s: float = _number("at or above the safe height", 0.01, 1e4)
    approach_mm_s: float = _number(
        "on the way down to the clearance; the brush's limit where that is less", 0.01, 1e4
    )
    press_mm_s: float = _number("straight down into the paper or paint, and up again", 0.01, 1e4)
    paint_mm_s: float = _number("the most while painting; the brush has a limit of its own", 0.01, 1e4)
    acceleration_mm_s2: float = _number("for the time estimate, and where the language asks for one", 1, 1e5)


@dataclass(frozen=True)
class Blending:
    """How much of the joint of two moves the machine may cut, so as not to stand still there and bleed."""

    tolerance_mm: float = _number("at most so far from the joint; 0: joints are met exactly", 0, 10)
    radius_mm: float = _number("robots: blends begin so far before the joint at most", 0, 100, default=0.0)


@dataclass(frozen=True)
class Workspace:
    """Where the tool may be."""

    margin_mm: float = _number("beyond the sheet's edges: the TCP leads the brush", 0, 1e4)
    tilt_limit_deg: float = _number("how far the paper's normal may lean from the robot's z axis", 0, 180)
    box_mm: tuple = _key("two opposite corners of a box in the robot's frame", (2, 3), default=())
    reach_mm: tuple = _key("least and greatest distance from the robot's origin", (2,), 0, 1e5, default=())


@dataclass(frozen=True)
class Servo:
    """A pen lift that knows no millimetres: heights over the paper and the values that give them."""

    table: tuple = _key("rows of height in mm and value; both rise or fall steadily", (None, 2))
    step_mm: float = _number(
        "the value is renewed when the height has changed by so much", 0.01, 10, default=0.1
    )
    settle_s: float = _number("wait after a move of the lift alone", 0, 60, default=0.0)


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
    depth_mm: float = _number("how deep the tip dips below the surface", 0, 100, default=0.0)
    rim_mm: float = _number("height of the vessel's rim", -1e3, 1e3, default=0.0)
    hold_s: float = _number("wait in the paint", 0, 600, default=0.0)
    drip_s: float = _number("wait above it", 0, 600, default=0.0)
    wipe_mm: tuple = _key(
        "points x, y, z that the tip passes afterwards, at press_mm_s", (None, 3), default=()
    )


@dataclass(frozen=True)
class Reload:
    """When to fetch paint. Stations of the stroke's colour are visited."""

    when: str = _key("length, stroke or layer", "text")
    every_mm: float = _number("for length: paint lasts so far", 1, 1e6, default=300.0)
    backtrack_mm: float = _number("a stroke goes on so far back in its own mark", 0, 100, default=5.0)
    wash: str = _key("station to visit before the colour changes", "text", default="")


@dataclass(frozen=True)
class Cell:
    """A machine, its limits and its paint. Lengths in mm, speeds in mm/s, heights over the paper."""

    name: str = _key("as --cell calls it", "text")
    description: str = _key("one line", "text")
    language: str = _key("the robot's", "text")
    decimals: int = _key("of lengths in the program", "whole", 1, 6)
    paper: Paper
    heights: Heights
    speeds: Speeds
    blending: Blending
    workspace: Workspace
    tool: Tool | None = None
    servo: Servo | None = None
    reload: Reload | None = None
    stations: tuple[Station, ...] = ()


TABLES = {
    "paper": Paper,
    "heights": Heights,
    "speeds": Speeds,
    "blending": Blending,
    "workspace": Workspace,
    "tool": Tool,
    "servo": Servo,
    "reload": Reload,
}
OPTIONAL_TABLES = ("tool", "servo", "reload")
NEEDED_BY = {"grbl-servo": "servo", "urscript": "tool"}
RELOADS = ("length", "stroke", "layer")


def robot_from_paper(cell: Cell, z_offset_mm: float = 0.0) -> np.ndarray:
    """(4, 4): the paper's frame in the robot's, the paper z_offset_mm higher than the cell says.

    Error when taught points do not make a plane or the fourth one does not lie in it.
    """
    paper = cell.paper
    if paper.taught_mm:
        frame = frame_of_points(paper.taught_mm, paper.flatness_mm)
    else:
        frame = frame_of_pose(paper.origin_mm, paper.rotation_deg)
    frame[:3, 3] += z_offset_mm * frame[:3, 2]
    return frame


def check(cell: Cell) -> None:
    """Error, with the key in `where`, for what no single key tells."""
    heights = cell.heights
    if not heights.clearance_mm <= heights.safe_mm:
        raise Error(
            f"clearance_mm {heights.clearance_mm:g} must not be above safe_mm {heights.safe_mm:g}",
            where="heights.clearance_mm",
        )
    if (table := NEEDED_BY.get(cell.language)) and getattr(cell, table) is None:
        raise Error(f"language {cell.language!r} needs a table {table}", where=table)
    _check_paper(cell)
    _check_workspace(cell)
    if cell.servo:
        _check_servo(cell)
    _check_paint(cell)


def _check_paper(cell: Cell) -> None:
    if cell.paper.taught_mm and len(cell.paper.taught_mm) not in (3, 4):
        raise Error(f"{len(cell.paper.taught_mm)} points were taught, not 3 or 4", where="paper.taught_mm")
    if cell.paper.taught_mm and (any(cell.paper.origin_mm) or any(cell.paper.rotation_deg)):
        raise Error("the paper has both a pose and taught points: one must go", where="paper.taught_mm")
    try:
        tilt_deg = normal_tilt_deg(robot_from_paper(cell))
    except Error as refusal:
        refusal.where = "paper.taught_mm"
        raise
    limit_deg = cell.workspace.tilt_limit_deg
    if tilt_deg > limit_deg + 1e-9:
        raise Error(
            f"the paper leans {tilt_deg:.2f} degrees, outside the range [0, {limit_deg:g}] degrees of tilt_limit_deg",
            where="paper",
        )


def _check_workspace(cell: Cell) -> None:
    box_mm, reach_mm = cell.workspace.box_mm, cell.workspace.reach_mm
    if box_mm and not all(low < high for low, high in zip(*box_mm, strict=True)):
        raise Error("the first corner must be the lower one in x, y and z", where="workspace.box_mm")
    if reach_mm and not reach_mm[0] < reach_mm[1]:
        raise Error("the least distance must be below the greatest", where="workspace.reach_mm")


def _check_servo(cell: Cell) -> None:
    frame = robot_from_paper(cell)
    lies_level = abs(frame[2, 3]) < 1e-9 and normal_tilt_deg(frame) < 1e-9
    if NEEDED_BY.get(cell.language) == "servo" and not lies_level:
        raise Error("a servo's heights are those over the paper: it must lie level, at z 0", where="paper")
    table = np.array(cell.servo.table)
    steps = np.diff(table, axis=0)
    if len(table) < 2 or not ((steps[:, 0] > 0).all() or (steps[:, 0] < 0).all()):
        raise Error("at least two heights are needed, steadily rising or falling", where="servo.table")
    if not ((steps[:, 1] > 0).all() or (steps[:, 1] < 0).all()):
        raise Error("the values must steadily rise or fall with the height", where="servo.table")
    if (table[:, 1] < 0).any():
        raise Error(f"value {table[:, 1].min():g} is below 0", where="servo.table")
    low, high = table[:, 0].min(), table[:, 0].max()
    if not (low <= cell.heights.lowest_mm and cell.heights.safe_mm <= high):
        raise Error(
            f"the heights [{low:g}, {high:g}] mm must hold lowest_mm {cell.heights.lowest_mm:g} and "
            f"safe_mm {cell.heights.safe_mm:g}",
            where="servo.table",
        )


def _check_paint(cell: Cell) -> None:
    names = [station.name for station in cell.stations]
    for number, station in enumerate(cell.stations, 1):
        where = f"station {number}"
        if names.index(station.name) != number - 1:
            raise Error(f"the name {station.name!r} is given twice", where=where)
        _check_heights_of(station, cell, where)
        if station.by_hand and (station.depth_mm or station.wipe_mm):
            raise Error("a person dips here: depth_mm and wipe_mm have no meaning", where=where)
        if (
            not station.by_hand
            and not station.depth_mm
            and station.name != getattr(cell.reload, "wash", None)
        ):
            raise Error("depth_mm 0 takes no paint", where=where)
    if cell.stations and not cell.reload:
        raise Error("stations need a table reload that says when to visit them", where="reload")
    if not cell.reload:
        return
    if cell.reload.when not in RELOADS:
        raise Error(f"{cell.reload.when!r} is none of {', '.join(RELOADS)}", where="reload.when")
    if not cell.stations:
        raise Error("there is no station to reload at", where="reload")
    if cell.reload.wash and cell.reload.wash not in names:
        raise Error(f"there is no station {cell.reload.wash!r}", where="reload.wash")


def _check_heights_of(station: Station, cell: Cell, where: str) -> None:
    if station.by_hand:
        if cell.servo:
            raise Error("a servo's brush falls while the program waits: by_hand cannot be", where=where)
        return
    top = cell.heights.safe_mm - cell.heights.clearance_mm
    if not station.surface_mm <= station.rim_mm <= top:
        raise Error(
            f"rim_mm {station.rim_mm:g} is outside the range [{station.surface_mm:g}, {top:g}] mm, from the paint's "
            f"surface to clearance_mm below the safe height",
            where=where,
        )
    bottom = station.surface_mm - station.depth_mm
    if bottom < cell.heights.lowest_mm:
        raise Error(f"it dips to {bottom:g} mm, below lowest_mm {cell.heights.lowest_mm:g}", where=where)
    for point in station.wipe_mm:
        if not station.rim_mm <= point[2] <= cell.heights.safe_mm:
            raise Error(
                f"a wipe at {point[2]:g} mm is outside the range [{station.rim_mm:g}, {cell.heights.safe_mm:g}] mm, "
                f"from the rim to the safe height",
                where=where,
            )


def entries(table) -> dict[str, Entry]:
    """The keys that a table of a cell file may have, with what each means."""
    return {item.name: item.metadata["entry"] for item in fields(table) if "entry" in item.metadata}


def required(table) -> set[str]:
    """Those of its keys that must be there."""
    return {item.name for item in fields(table) if "entry" in item.metadata and item.default is MISSING}


def tables_of(cell: Cell) -> dict[str, object]:
    """The tables that the cell has, by name."""
    return {name: getattr(cell, name) for name in TABLES if is_dataclass(getattr(cell, name))}
