"""Ten small jobs for every dialect: drawing, options and machine."""

from __future__ import annotations

import itertools
import json
import tomllib
from dataclasses import dataclass, replace
from pathlib import Path

from brushsvg.machine.cells.cell import Contact, Machine, Paper, Reload, Station, reason_for_no_backlash
from brushsvg.machine.cells.cell_file import find_cell, write_cell
from brushsvg.machine.cells.language_limits import CONTACT_KEYS
from brushsvg.model.library import find_brush

from .checked import converted, put
from .verdict import Job, Sound, job_of, sound

CELLS = {
    "linuxcnc": ("linuxcnc-3axis", ".ngc"),
    "grbl": ("grbl-3axis", ".gcode"),
    "grbl-servo": ("grbl-servo", ".nc"),
    "fluidnc": ("fluidnc-3axis", ".gcode"),
    "marlin": ("marlin-3axis", ".gcode"),
    "klipper": ("klipper-3axis", ".gcode"),
    "marlin-servo": ("marlin-servo", ".gcode"),
    "urscript": ("ur5e", ".script"),
    "jaka": ("jaka-zu3", ".jks"),
    "rapid": ("irb120", ".mod"),
    "xarm": ("xarm6", ".py"),
    "krl": ("kr6-r900", ".src"),
    "dobot": ("cr5", ".lua"),
    "fanuc": ("lrmate200id", ".ls"),
    "doosan": ("m0609", ".drl"),
    "ros2": ("fr3", ".csv"),
    "ebb": ("axidraw-ebb", ".ebb"),
    "hpgl": ("hpgl-plotter", ".hpgl"),
}
PENS = ("hpgl", "marlin-servo")  # a pen has one height
FLAT = ("grbl-servo", "ebb", *PENS)  # these need level paper at z 0
LIKE_GRBL = ("klipper", "fluidnc")  # these share writer, reader and judge with other dialects
FEWER = ("marlin", *LIKE_GRBL, "ebb", *PENS)  # these have fewer tests
OPEN = '<svg xmlns="http://www.w3.org/2000/svg" width="70mm" height="50mm" viewBox="0 0 70 50"><title>small</title>'


def lines(*paths: str, width="2") -> str:
    drawn = "".join(
        f'<path id="p{k}" d="{d}" fill="none" stroke="#000" stroke-width="{width}"/>' for k, d in enumerate(paths, 1)
    )
    return f"{OPEN}{drawn}</svg>"


@dataclass(frozen=True)
class Work:
    """A job.

    flags: the options of convert.
    check_flags: the flags that check needs as well.
    change: a function that changes the cell by its language.
    """

    svg: str
    flags: tuple[str, ...] = ()
    check_flags: tuple[str, ...] = ()
    change: object = None
    by_plan: bool = False


def _finely_blended(cell):
    return replace(cell, blending=replace(cell.blending, step_mm=0.001))


def _with_arcs(cell):
    return replace(cell, arc_segment_mm=0.1)


def _turned(cell):
    """Return the cell with turned and higher paper.

    Arms with a contact setting stop where the tool is pressed. Machines that can have backlash get backlash.
    """
    if not reason_for_no_backlash(cell):
        cell = replace(cell, machine=Machine(backlash_mm=(0.4, 0.25)))
    if by := CONTACT_KEYS.get(cell.language):
        cell = replace(cell, contact=Contact(**{by: 3 if by == "sensitivity" else 12.5}))
    if cell.language in FLAT:
        near = (15.0, 10.0, 0.0) if cell.motors else (40.0, 30.0, 0.0)  # motors begin near the paper's origin
        return replace(cell, paper=Paper(origin_mm=near, rotation_deg=(0.0, 0.0, 30.0)))
    paper = Paper(origin_mm=(-30.0, -450.0, 12.5), rotation_deg=(0.0, 0.0, 30.0))
    return replace(cell, paper=paper)


def _leaning(cell):
    if cell.language == "grbl-servo":
        return replace(
            cell, servo=replace(cell.servo, table=((-10.0, 900.0), (-2.0, 660.0), (0.0, 600.0), (5.0, 400.0)))
        )
    if cell.language == "ebb":  # each axis has its own motor, and the servo is reversed
        table = ((-10.0, 25000.0), (-2.0, 18000.0), (0.0, 16000.0), (6.0, 11000.0))
        motors = replace(cell.motors, steps_per_mm=((80.0, 0.0), (0.0, -100.0)), servo_pin=5)
        return replace(cell, servo=replace(cell.servo, table=table), motors=motors)
    if cell.pen:
        return _turned(cell)
    paper = Paper(origin_mm=(-30.0, -450.0, 12.5), rotation_deg=(1.0, -0.7, 10.0))
    return replace(cell, paper=paper)


def _higher(cell):
    """Return the cell with a servo that can lift the brush over higher paper."""
    if cell.language == "grbl-servo":
        return replace(cell, servo=replace(cell.servo, table=((-10.0, 200.0), (0.0, 600.0), (8.0, 920.0))))
    if cell.language == "ebb":
        return replace(cell, servo=replace(cell.servo, table=((-10.0, 9000.0), (0.0, 17000.0), (8.0, 24000.0))))
    return cell


def _painted(cell):
    if cell.language == "marlin-servo":  # a pen on a Marlin stops for another colour
        return cell
    if cell.pen:  # a plotter changes its pen
        return replace(cell, pen=replace(cell.pen, colours=("#000000", "#ff0000")))
    safe = cell.heights.safe_mm
    rim = min(2.0, safe - cell.heights.clearance_mm)
    ink = Station("ink", (-15.0, 20.0), surface_mm=-1.0, depth_mm=3.0, rim_mm=rim, hold_s=0.4, drip_s=0.5)
    red = Station("red", (-15.0, 35.0), ("#ff0000",), surface_mm=0.0, depth_mm=2.0, rim_mm=rim)
    red = replace(red, wipe_mm=((-10.0, 35.0, rim + 0.5), (-7.0, 35.0, rim + 0.5)))
    return replace(cell, reload=Reload("stroke"), stations=(red, ink))


WORKS = {
    "two lines": Work(lines("M20 25 L48 27", "M20 35 L50 33")),
    "a curve": Work(lines("M18 30 C28 10 42 10 52 32", "M20 40 C30 36 40 44 50 40", width="3")),
    "corners": Work(lines("M20 38 L34 14 L48 38", "M27 28 L42 28")),
    "circles": Work(lines("M20 38 L34 16 L48 38", "M22 42 L44 42"), ("--compensation", "constant", "--lag", "4")),
    "a dab and a hook": Work(lines("M25 20 L25 20", "M30 16 L44 16 L44 30", "M25 38 L32 38")),
    "askew": Work(lines("M20 25 L46 30", "M24 34 C34 30 40 40 48 36"), change=_turned),
    "leaning": Work(lines("M20 22 L46 30", "M24 34 L34 38 L48 33"), change=_leaning),
    "paint": Work(lines("M20 20 L44 22", "M22 30 L44 31").replace('#000"', '#ff0000"', 1), change=_painted),
    "higher, in another order": Work(
        lines("M20 20 L30 20", "M50 40 L40 40", "M34 22 L46 22"),
        ("--z-offset", "0.3", "--order", "nearest"),
        change=_higher,
    ),
    "a plan, resumed": Work(
        lines("M20 20 L32 20", "M20 30 L34 28", "M20 40 L30 40"), ("--from-stroke", "2"), by_plan=True
    ),
}


@dataclass(frozen=True)
class Made:
    """A written job.

    words: the arguments of check.
    program: the file for damaged programs.
    """

    name: str
    dialect: str
    whole: Sound
    program: Path
    words: tuple


def cell_of(dialect: str, change=None):
    cell = find_cell(CELLS[dialect][0])
    if (
        dialect == "dobot" and change is None
    ):  # otherwise no corner of small jobs has a blend that a damage could change
        change = _finely_blended
    if dialect == "klipper" and change is None:
        change = _with_arcs
    cell = change(cell) if change else cell
    return replace(cell, name="mine") if change else cell


def flags_for(flags: tuple[str, ...], dialect: str) -> tuple[str, ...]:
    """Return the flags, for a pen without the flags that need several heights."""
    if dialect not in PENS:
        return flags
    pairs = zip(flags[::2], flags[1::2], strict=True)
    pairs = [pair for pair in pairs if pair[0] not in ("--z-offset", "--compensation", "--lag")]
    return (*itertools.chain(*pairs), "--brush", "rigid")


def job_for(cell_toml: str, plan_json: str, brush_name: str, flags=()) -> Job:
    options = dict(itertools.pairwise(flags))
    brush = find_brush(brush_name)
    z_offset, first = float(options.get("--z-offset", 0)), int(options.get("--from-stroke", 1))
    return job_of(tomllib.loads(cell_toml), plan_json, brush.max_speed_mm_s, z_offset, first)


def make(name: str, dialect: str, folder: Path) -> Made:
    """Convert a job with the command, and check that the judge finds it sound."""
    work, suffix = WORKS[name], CELLS[dialect][1]
    folder.mkdir(parents=True, exist_ok=True)
    cell_toml = write_cell(cell_of(dialect, work.change))
    cell = put(folder / "mine.toml", cell_toml)
    svg = put(folder / "drawing.svg", work.svg)
    plan, program = folder / "plan.json", folder / f"program{suffix}"
    flags = flags_for(work.flags, dialect)
    planned = [
        flag for k, flag in enumerate(flags) if not {"--z-offset", "--from-stroke"} & set(flags[max(0, k - 1) : k + 1])
    ]
    assert not (refusals := converted(svg, plan, "--cell", cell, *planned)), refusals
    source = plan if work.by_plan else svg
    assert not (refusals := converted(source, program, "--cell", cell, *flags)), refusals
    text = program.read_text(encoding="ascii")
    brush = json.loads(plan.read_text())["brush"]
    job = job_for(cell_toml, plan.read_text(), brush, flags)
    whole = sound(text, job)
    return Made(name, dialect, whole, folder / f"damaged{suffix}", (source, "--cell", cell, *work.check_flags))
