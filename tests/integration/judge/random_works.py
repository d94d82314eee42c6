"""Random small drawings and cells.

The cells have leaning paper, boxes and reach rings, stations, servos with any table, and blends.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from brushsvg import _core
from brushsvg.calibration.numbers.from_widths import new_brush
from brushsvg.machine.cells.cell import Blending, Machine, Paper, Reload, Servo, Station
from brushsvg.machine.cells.cell_file import find_cell
from brushsvg.model.library import find_brush

from .verdict import ROBOTS
from .works import CELLS, FLAT, PENS

SHEET = (80.0, 60.0)


def random_svg(random) -> str:
    """Return a drawing of one to four strokes in two colours and layers.

    The strokes are lines, corners, curves, dabs, closed paths and paths that turn back, some of them tiny.
    """
    drawn = []
    for number in range(int(random.integers(1, 5))):
        x, y = random.uniform(14, 66), random.uniform(14, 46)

        def near(x=x, y=y, far=22.0):
            return (
                f"{np.clip(x + random.uniform(-far, far), 10, 70):.3f} "
                f"{np.clip(y + random.uniform(-far, far), 10, 50):.3f}"
            )

        kind, tiny = int(random.integers(14)), float(random.choice((0.01, 0.1, 1.0)))
        there, back = near(), near()
        path = (
            f"M{x:.3f} {y:.3f} "
            + (
                f"L{near()}",
                f"L{near()} L{near()} L{near()}",
                f"C{near()} {near()} {near()}",
                f"L{x:.3f} {y:.3f}",
                f"L{near(far=8)} L{near(far=8)} Z",
                f"Q{near()} {near()} T{near()}",
                "Z",
                f"L{there} L{back} L{there} L{near()}",
                f"C{there} {back} {near()} S{back} {there}",
                f"C{near(far=tiny)} {near(far=tiny)} {near(far=tiny)} L{there}",
                f"A{tiny} {tiny} 0 1 {int(random.integers(2))} {near(far=tiny)} L{near(far=tiny)}",
                f"L{near(far=tiny)} L{near(far=tiny)} L{near(far=tiny)} Z",
                f"Q{near(far=tiny)} {near(far=tiny)} Q{there} {near(far=tiny)} Q{near(far=tiny)} {there}",
                f"A{tiny} {2 * tiny} 30 1 1 {near(far=tiny)} C{there} {near(far=tiny)} {there} L{back}",
            )[kind]
        )
        width, colour = random.uniform(1.2, 4.5), random.choice(("#000000", "#ff0000"))
        drawn.append(f'<path id="s{number}" d="{path}" fill="none" stroke="{colour}" stroke-width="{width:.2f}"/>')
    size = f'width="{SHEET[0]:g}mm" height="{SHEET[1]:g}mm" viewBox="0 0 {SHEET[0]:g} {SHEET[1]:g}"'
    return f'<svg xmlns="http://www.w3.org/2000/svg" {size}><title>random</title>{"".join(drawn)}</svg>'


def random_cell(random, dialect: str):
    """Return a cell of the dialect's language; `read_cell` may refuse it."""
    cell = find_cell(CELLS[dialect][0])
    safe = round(float(random.uniform(4, 25)), 2)
    clear = round(float(random.uniform(0.3, 2.5)), 2)
    lowest = -round(float(random.uniform(5, 10)), 2)
    cell = replace(cell, name="mine", heights=replace(cell.heights, safe_mm=safe, clearance_mm=clear, lowest_mm=lowest))
    speeds = replace(
        cell.speeds,
        travel_mm_s=float(random.uniform(30, 200)),
        approach_mm_s=float(random.uniform(5, 80)),
        press_mm_s=float(random.uniform(2, 40)),
        paint_mm_s=float(random.uniform(5, 60)),
    )
    cell = replace(cell, speeds=speeds, decimals=int(random.choice((3, 3, 3, 4, 5, 6))))
    paper = Paper()
    if dialect in FLAT:
        if random.random() < 0.4:
            paper = Paper((*random.uniform(-300, 300, 2).tolist(), 0.0), (0.0, 0.0, float(random.uniform(0, 360))))
        if dialect == "grbl-servo":
            cell = replace(cell, servo=_servo(random, lowest, safe))
        elif dialect == "ebb":
            servo = _servo(random, lowest, safe)
            table = tuple((height, round(20 * value + 5000)) for height, value in servo.table)
            cell = replace(cell, servo=replace(servo, table=table))
        else:
            speeds = {name: max(10.0, getattr(cell.speeds, name)) for name in NEVER_SLOWER}
            cell = replace(cell, speeds=replace(cell.speeds, **speeds), decimals=3)
    elif random.random() < 0.8:
        leans = random.uniform(-1, 1, 2) * (0 if random.random() < 0.4 else 9 if dialect in ROBOTS else 1.3)
        paper = Paper(tuple(random.uniform(-500, 500, 3).tolist()), (*leans.tolist(), float(random.uniform(0, 360))))
    if dialect == "ebb" and paper.rotation_deg[2]:  # the motors begin over the sheet
        turn = np.radians(paper.rotation_deg[2])
        x, y = random.uniform((0, 0), SHEET)
        place = (-x * np.cos(turn) + y * np.sin(turn), -x * np.sin(turn) - y * np.cos(turn), 0.0)
        paper = replace(paper, origin_mm=tuple(map(float, place)))
    if random.random() < 0.25 and dialect not in FLAT:
        paper = _about_the_robot(random)
    cell = replace(cell, paper=paper)
    if random.random() < 0.6 and dialect in ("linuxcnc", *ROBOTS):
        radius = float(random.uniform(0.2, 5)) if dialect in ROBOTS else 0.0
        cell = replace(cell, blending=Blending(float(random.choice((0.0, 0.005, 0.01, 0.05))), radius))
    if dialect == "ebb":
        cell = replace(cell, blending=Blending(0.01, float(random.uniform(0.2, 5))))
    cell = _with_space(random, cell)
    if dialect == "ebb":  # the motors begin at the robot's origin
        cell = replace(cell, workspace=replace(cell.workspace, reach_mm=()))
    if random.random() < 0.3:
        cell = _with_a_clip(random, cell)
    if random.random() < 0.5 and dialect != "hpgl":
        cell = _with_paint(random, cell)
    # Separate random numbers keep the rest of the cell equal to a cell without machine errors.
    (apart,) = random.spawn(1)
    if apart.random() < 0.5:
        cell = replace(cell, machine=_machine(apart, dialect))
    (apart,) = apart.spawn(1)
    if dialect in ROBOTS or dialect == "ebb" or apart.random() < 0.5:
        return cell
    found = np.round(apart.uniform(0.05, 0.6, 2) * apart.choice(((1, 1), (1, 1), (1, 0), (0, 1))), 3)
    return replace(cell, machine=replace(cell.machine or Machine(), backlash_mm=tuple(found.tolist())))


NEVER_SLOWER = (
    "approach_mm_s",
    "press_mm_s",
    "paint_mm_s",
)  # a pen plotter is never slower than a centimetre per second


def _machine(random, dialect: str) -> Machine:
    """Return a machine with errors, small ones or as large as a cell allows.

    A machine with a servo gets no errors that change the depth.
    """
    much, is_servo = random.random() < 0.3, dialect in FLAT

    def pair(little: float, large: float) -> tuple:
        return tuple((random.uniform(-1, 1, 2) * (large if much else little)).tolist())

    found = Machine()
    if random.random() < 0.5 and not is_servo:
        found = replace(found, lean_mm_per_mm=pair(0.4, 1.4))
    if random.random() < 0.5:
        found = replace(found, scale=tuple(1 + off for off in pair(0.01, 0.09)), skew=pair(0.01, 0.09)[0])
    elif random.random() < 0.5:
        found = replace(found, scale=(1 + pair(0.02, 0.09)[0],) * 2)  # equal scales keep circles round
    if random.random() < 0.5:
        found = found if dialect in PENS else replace(found, height_mm=pair(0.4, 2.0)[0])
        found = found if is_servo else replace(found, tilt_mm_per_mm=pair(0.005, 0.03))
    if random.random() < 0.4 and not is_servo:
        found = replace(found, map_mm=_map(random, 3.0 if much else 0.6))
    if random.random() < 0.4:
        found = replace(found, **_field(random, 3.0 if much else 0.8))
    return found


def _field(random, most_mm: float) -> dict:
    """Return an error field anywhere, at most as steep as a cell allows."""
    reach = random.uniform(30.0, 150.0, 2)
    most_mm = min(most_mm, 0.1 * reach.min() / 3)
    numbers = random.uniform(-most_mm, most_mm, (2, 3)).tolist()
    middle = random.uniform((0, 0), SHEET)
    return {
        "field_mm": tuple(map(tuple, numbers)),
        "field_middle_mm": tuple(middle.tolist()),
        "field_reach_mm": tuple(reach.tolist()),
    }


def _map(random, most_mm: float) -> tuple:
    """Return the heights of a grid that need not cover the sheet."""
    xs, ys = (np.cumsum(random.uniform(5.5, 60.0, random.integers(2, 5))) - 40.0 for _ in range(2))
    rows = [(x, y, random.uniform(-most_mm, most_mm)) for x in xs.tolist() for y in ys.tolist()]
    random.shuffle(rows)
    return tuple(rows)


ABOUT = 0.25  # this flatness_mm marks a paper around the robot, since flatness does not affect a pose


def _about_the_robot(random) -> Paper:
    """Return a paper with the robot's origin over or under the sheet.

    Moves between strokes then pass too close to the robot for its reach.
    """
    from .places import turned_deg

    rotation = (*random.uniform(-1.2, 1.2, 2).tolist(), float(random.uniform(0, 360)))
    origin = np.array([*random.uniform((0, 0), SHEET), random.uniform(-12, 12)])
    return Paper(tuple((-turned_deg(*rotation) @ origin).tolist()), rotation, flatness_mm=ABOUT)


def _servo(random, lowest: float, safe: float) -> Servo:
    """Return a servo with a rising or falling table of any shape, in part steep."""
    low, high = lowest - random.uniform(0, 3), safe + random.uniform(0, 4)
    count = int(random.integers(2, 7))
    heights = np.sort(np.r_[low, high, random.uniform(low, high, count - 2)])
    slopes = random.uniform(3, 60, count - 1)
    values = np.r_[0.0, np.cumsum(np.diff(heights) * slopes)] + random.uniform(0, 300)
    if random.random() < 0.5:
        values = values[::-1]
    if random.random() < 0.5:
        values = np.round(values)
    rows = tuple((round(float(a), 3), round(float(b), 3)) for a, b in zip(heights, values, strict=True))
    return Servo(rows, float(random.choice((0.05, 0.1, 0.25))), float(random.choice((0.0, 0.15))))


def _with_space(random, cell):
    """Return the cell with boxes and reach rings that end near the sheet.

    Moves and dips then come close to these limits.
    """
    from .places import moved, paper_of

    if random.random() < 0.3:
        return replace(cell, workspace=replace(cell.workspace, box_mm=(), reach_mm=()))
    if cell.paper.flatness_mm == ABOUT:
        reach = (float(random.uniform(12, 32)), 400.0)
        return replace(cell, workspace=replace(cell.workspace, box_mm=(), reach_mm=reach))
    pose = {"origin_mm": cell.paper.origin_mm, "rotation_deg": cell.paper.rotation_deg}
    frame = paper_of({"paper": pose}, 0.0)
    safe, low = cell.heights.safe_mm, cell.heights.lowest_mm
    inner = [(x, y, z) for x in (8.0, SHEET[0] - 8) for y in (8.0, SHEET[1] - 8) for z in (low, safe)]
    corners = moved(frame, np.array(inner))
    box, reach = (), ()
    if random.random() < 0.6:
        room = random.uniform(0, 50, (2, 3))
        box = tuple(map(tuple, (np.r_[[corners.min(axis=0) - room[0], corners.max(axis=0) + room[1]]]).tolist()))
    if random.random() < 0.7:
        away = np.linalg.norm(corners, axis=1)
        middle = moved(frame, np.array([[SHEET[0] / 2, SHEET[1] / 2, 0.0]]))[0]
        least = max(0.0, min(away.min(), float(np.linalg.norm(middle))) - random.uniform(-8, 25))
        reach = (float(least), float(away.max() + random.uniform(-3, 25)))
    margin = float(random.uniform(3, 40))
    return replace(cell, workspace=replace(cell.workspace, box_mm=box, reach_mm=reach, margin_mm=margin))


def _with_a_clip(random, cell):
    """Return the cell with an object on the sheet or next to it.

    The object may be higher than the safe height.
    """
    from .places import moved, paper_of

    pose = {"origin_mm": cell.paper.origin_mm, "rotation_deg": cell.paper.rotation_deg}
    place = np.array([*random.uniform((-20, -20), np.array(SHEET) + 20), random.uniform(-2, cell.heights.safe_mm)])
    (middle,) = moved(paper_of({"paper": pose}, 0.0), place[None])
    half = random.uniform(1, 6, 3)
    box = (tuple((middle - half).tolist()), tuple((middle + half).tolist()))
    return replace(cell, workspace=replace(cell.workspace, keep_out_mm=(box,)))


def _with_paint(random, cell):
    safe, clear, lowest = cell.heights.safe_mm, cell.heights.clearance_mm, cell.heights.lowest_mm
    stations = []
    for name, colours, y in (("ink", (), 15.0), ("red", ("#ff0000",), 40.0)):
        top = safe - clear
        rim = float(random.uniform(0.0, max(0.1, min(top, 6))))
        surface = float(random.uniform(-2.0, min(rim, 1.0)))
        depth = float(random.uniform(0.5, 3.0))
        if surface - depth < lowest:
            continue
        x = -float(random.uniform(2, 30)) if random.random() < 0.7 else SHEET[0] + float(random.uniform(2, 25))
        wipes = ()
        if random.random() < 0.5:
            heights = random.uniform(rim, safe, 2)
            wipes = tuple(
                (x + (k + 1) * float(random.uniform(-5, 5)), y + 2.0 * k, float(z)) for k, z in enumerate(heights)
            )
        station = Station(name, (x, y), colours, False, surface, depth, rim, 0.2, 0.3, wipes)
        stations.append(station)
    if not any(not station.colours for station in stations):
        return cell
    if cell.language not in FLAT and random.random() < 0.2:
        stations[0] = Station(stations[0].name, stations[0].place_mm, stations[0].colours, by_hand=True)
    when = str(random.choice(("length", "stroke", "layer")))
    return replace(cell, reload=Reload(when, float(random.uniform(25, 150)), 4.0), stations=tuple(stations))


def random_brush(random) -> _core.Brush:
    """Return round-6, a rigid pen, or a new brush that trails little or far."""
    if random.random() < 0.5:
        return find_brush(str(random.choice(("round-6", "round-6", "rigid"))))
    lag_mm = float(random.choice((0.0, 0.3, 3.0, 8.0, 12.0)))
    return new_brush("mine", lag_mm, [(1.0, 0.6), (float(random.choice((4.0, 8.0))), 6.0)])


def follows_ends(flags: tuple[str, ...]) -> bool:
    """Return whether the compensation of options paints requested ends. With the others, they are refused."""
    return not {"none", "constant"} & set(flags)


def random_flags(random, dialect: str) -> tuple[str, ...]:
    flags: tuple[str, ...] = ()
    if random.random() < 0.4:
        chances = (0.4, 0.4, 0.2)
        how = random.choice(("none", "constant", "refined"), p=chances)
        flags += ("--compensation", str(how))
    if random.random() < 0.3:
        start = str(random.choice(("pointed", "round", "butt")))
        flags += ("--start", start) if follows_ends(flags) else ()
    if random.random() < 0.3:
        flags += ("--corners", "turn")
    if random.random() < 0.2:
        flags += ("--order", "nearest")
    if random.random() < 0.25 and dialect not in FLAT:
        flags += ("--z-offset", f"{random.uniform(-0.5, 1.5):.2f}")
    if random.random() < 0.2:
        flags += ("--tolerance", str(random.choice(("0.02", "0.1"))))
    return flags
