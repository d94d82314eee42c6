"""The choices for a drawing, and the options that they make.

Choices come from flags, from keywords, and from the drawing itself.
"""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, fields, replace
from typing import TypedDict

from .. import _core
from ..comparison.corrections import SheetBefore, read_sheet_before
from ..errors import (
    Error,
    Notice,
    name_file_in_errors,
    need_number,
    need_numbers,
    need_one_of,
    need_truth,
    require_type,
)
from ..files import find_file_used_twice
from ..machine.cells.cell import Cell
from ..machine.cells.cell_file import cell_names, find_cell, parse_cell, write_cell
from ..machine.posts import GCODE
from ..model.library import brush_names, find_brush
from ..read import BACKGROUNDS, PENS, SCRIPTS, SIZE_MM, UNITS, ReadOptions, need_regions, need_texts, settings_in
from ..read.layout import Layout
from ..suggestions import did_you_mean
from .json_files import read_plan
from .options import Options

GCODE_FLAGS = ("pen", "paper-z", "skip-region", "skip-comment")
LAYOUT_FLAGS = (
    *"sheet units select layer background".split(),
    *GCODE_FLAGS,
    *"width fit scale origin as".split(),
)
# The name of the choice that a flag makes, where both names differ.
CHOICE_BY_FLAG = {"as": "paths_as", "speed": "paint_speed", "z-offset": "z_offset", "paper-z": "paper_z"} | {
    name: name.replace("-", "_") for name in ("skip-region", "skip-comment", "margin-strokes")
}
PLANNING_FLAGS = tuple(
    "wide corners detail script join compensation lag tolerance terminals start end margin-strokes".split()
)
TERMINALS = ("auto", "round", "butt", "pointed")
CHOICE_RANGES = {  # equal to the range of the flag; lengths in mm, speed in mm/s
    "width": (0.001, 1000.0),
    "scale": (1e-4, 1e4),
    "lag": (0.0, 1000.0),
    "tolerance": (1e-5, 10.0),
    "paint_speed": (0.001, 5000.0),
    "z_offset": (-20.0, 20.0),
    "paper_z": (-1000.0, 1000.0),
}
END_CHOICES = ("terminals", "start", "end")
METHODS_WITHOUT_ENDS = ("none", "constant")  # compensations that follow the drawn line up to its ends
CHOICE_VALUES = {
    "units": UNITS,
    "background": BACKGROUNDS,
    "pen": PENS,
    "paths_as": ("stroke", "outline"),
    "wide": ("auto", "clamp", "passes", "refuse"),
    "corners": ("auto", "turn"),
    "detail": ("draft", "normal", "fine"),
    "script": SCRIPTS,
    "compensation": ("none", "constant", "closed", "refined"),
    "terminals": TERMINALS,
    "start": TERMINALS,
    "end": TERMINALS,
    "margin_strokes": ("auto", "on", "off"),
}


@dataclass(frozen=True)
class Choices:
    """The choices that a drawing or plan is read and painted with.

    A choice that nobody makes is None. Lengths are in mm, the speed is in mm/s.

    input: a path, or a drawing of another kind that read_drawing accepts.
    brush, cell: a name, a path, or the Brush or Cell itself.
    from_project: the names of the choices that a project file makes. The drawing, a plan and a program take
        precedence over these, see `drop_overruled`.
    """

    input: object = None
    brush: object = None
    cell: object = None
    sheet: tuple[float, float] | None = None
    units: str | None = None
    layer: list[str] | None = None
    select: str | None = None
    background: str | None = None
    pen: str | None = None
    paper_z: float | None = None
    skip_region: list[tuple[float, float, float, float]] | None = None
    skip_comment: list[str] | None = None
    colour: str | None = None
    width: float | None = None
    paths_as: str | None = None
    fit: tuple[float, float] | None = None
    scale: float | None = None
    origin: tuple[float, float] | None = None
    wide: str | None = None
    corners: str | None = None
    detail: str | None = None
    script: str | None = None
    join: bool | None = None
    compensation: str | None = None
    lag: float | None = None
    paint_speed: float | None = None
    tolerance: float | None = None
    terminals: str | None = None
    start: str | None = None
    end: str | None = None
    z_offset: float | None = None
    corrections: str | os.PathLike[str] | None = None
    margin_strokes: str | None = None
    from_project: tuple[str, ...] = ()


class ChoiceKeywords(TypedDict, total=False):
    """Keyword arguments for Choices, for editors and type checkers; see `convert`."""

    brush: str | os.PathLike[str] | _core.Brush | None
    cell: str | os.PathLike[str] | Cell | None
    sheet: tuple[float, float] | None
    units: str | None
    layer: Sequence[str] | None
    select: str | None
    background: str | None
    pen: str | None
    paper_z: float | None
    skip_region: Sequence[tuple[float, float, float, float]] | None
    skip_comment: Sequence[str] | None
    colour: str | None
    width: float | None
    paths_as: str | None
    fit: tuple[float, float] | None
    scale: float | None
    origin: tuple[float, float] | None
    wide: str | None
    corners: str | None
    detail: str | None
    script: str | None
    join: bool | None
    compensation: str | None
    lag: float | None
    paint_speed: float | None
    tolerance: float | None
    terminals: str | None
    start: str | None
    end: str | None
    z_offset: float | None
    corrections: str | os.PathLike[str] | None
    margin_strokes: str | None


def check_choices(chosen: Choices) -> Choices:
    """Return the choices, validated and with values in their final types.

    Raises Error for a value that the flag of the command line would refuse as well.
    """
    require_type(chosen.from_project, (tuple, list), "a list of choices", "from_project")
    for name in chosen.from_project:
        need_one_of(name, CHOICES, "a name of from_project")
    chosen = drop_overruled(chosen)
    for name, choices in CHOICE_VALUES.items():
        if getattr(chosen, name) is not None:
            need_one_of(getattr(chosen, name), choices, name)
    for name, limits in CHOICE_RANGES.items():
        if getattr(chosen, name) is not None:
            chosen = replace(chosen, **{name: need_number(getattr(chosen, name), name, *limits)})
    for name, limits in (("sheet", SIZE_MM), ("fit", SIZE_MM), ("origin", (-1e6, 1e6))):
        if getattr(chosen, name) is not None:
            chosen = replace(chosen, **{name: need_numbers(getattr(chosen, name), name, 2, *limits)})
    if chosen.skip_region is not None:
        chosen = replace(chosen, skip_region=[*need_regions(chosen.skip_region, "skip_region")])
    if chosen.colour is not None:
        require_type(chosen.colour, str, "a colour, as #1a237e")
        chosen = replace(chosen, colour=read_colour(chosen.colour))
    if chosen.join is not None:
        need_truth(chosen.join, "join")
    for name in ("layer", "skip_comment"):
        if getattr(chosen, name) is not None:
            need_texts(getattr(chosen, name), name)
    if chosen.select is not None:
        require_type(chosen.select, str, "a text", "select")
    for name in ("brush", "cell", "corrections"):
        kinds = {"brush": (_core.Brush,), "cell": (Cell,)}.get(name, ())
        if getattr(chosen, name) is not None:
            require_type(getattr(chosen, name), (str, os.PathLike, *kinds), f"the name or the path of {name}")
    if isinstance(chosen.brush, _core.Brush):
        _core.check(chosen.brush)
    if isinstance(chosen.cell, Cell):  # a cell made in Python must also be valid as a file
        chosen = replace(chosen, cell=parse_cell(write_cell(chosen.cell)))
    if chosen.fit is not None and chosen.scale is not None:
        raise Error("fit and scale exclude each other", code="options-contradict")
    if chosen.compensation is not None or chosen.input is None:  # otherwise the drawing may name one
        _refuse_lag_without_effect(chosen)
    suffix = suffix_of(chosen.input)
    if chosen.units and suffix in (".svg", ".svgz"):
        sentence = "units are for drawings that do not define their unit; an SVG does"
        raise Error(sentence, "units", code="options-contradict")
    if chosen.select and suffix == ".dxf":
        sentence = "select is for SVG; layers of a DXF are chosen by layer"
        raise Error(sentence, "select", code="options-contradict")
    return chosen


def _refuse_lag_without_effect(chosen: Choices) -> None:
    if chosen.lag is not None and chosen.compensation != "constant":
        advice = "give --compensation constant"
        raise Error("a lag needs compensation constant", "lag", code="options-contradict", advice=advice)


def refuse_ends_without_effect(chosen: Choices) -> None:
    """Raise Error for ends that were chosen for this call, if the compensation has no choice of ends.

    The ends of a project file or of a drawing are no mistake: they hold for other compensations, too.
    """
    if chosen.compensation not in METHODS_WITHOUT_ENDS:
        return
    for name in END_CHOICES:
        end = getattr(chosen, name)
        if end not in (None, "auto") and name not in chosen.from_project:
            sentence = f"{name} {end} needs compensation closed or refined, not {chosen.compensation}"
            raise Error(sentence, name, code="options-contradict")


def read_colour(text: str) -> str:
    """Return a colour, written as in SVG, as "#rrggbb". Error for any other text."""
    from ..read.svg.colour import parse_colour

    colour = parse_colour(text.strip())
    if colour is None or not colour.startswith("#"):
        sentence = f"{text[:24]!r} is not a colour; write for example #1a237e or red"
        raise Error(sentence, "colour", code="colour-invalid")
    return colour[:7]


def suffix_of(source) -> str:
    """Return the extension of a path or of a Document.

    Returns ".json" for a Plan and "" for anything else.
    """
    if isinstance(source, _core.Plan):
        return ".json"
    if isinstance(source, str | os.PathLike):
        return os.path.splitext(os.fspath(source))[1].lower()
    return getattr(source, "extension", "")


def path_of(source) -> str:
    """Return the path of a source, or "" if the source is not a path."""
    return os.fspath(source) if isinstance(source, str | os.PathLike) else ""


def refuse_file_used_twice(chosen: Choices, written: Iterable[object], more_read: Iterable[object] = ()) -> None:
    """Raise Error if a written file is also read, or written twice.

    written, more_read: paths; everything else, such as None or a Brush, is no path.
    """
    read = (chosen.input, chosen.brush, chosen.cell, chosen.corrections, *more_read)
    if twice := find_file_used_twice(read, written):
        sentence = "this file is named twice: each file that is read or written needs its own path"
        raise Error(sentence, file=twice, code="options-contradict")


def fill_from_drawing(chosen: Choices, drawing, alone: bool = False) -> Choices:
    """Fill choices that nobody made with the settings in the drawing.

    A drawing can only name shipped brushes and cells, because its settings read no other file.

    alone: read nothing of the drawing except its settings.
    """
    settings = settings_in(drawing, alone)
    chosen = drop_overruled(chosen, settings)
    if chosen.terminals is not None and "terminals" not in chosen.from_project:
        settings = {name: value for name, value in settings.items() if name not in ("start", "end")}
    for kind, names in (("brush", brush_names()), ("cell", cell_names())):
        if getattr(chosen, kind) is None and settings.get(kind, names[0]) not in names:
            sentence = (
                f"data-brushsvg-{kind} asks for {kind} {settings[kind]!r}, which brushsvg does not ship"
                f"{did_you_mean(settings[kind], names)} Known are {', '.join(names)}"
            )
            raise Error(sentence, where="svg", code=f"{kind}-unknown", advice=f"give --{kind}")
    filled = replace(chosen, **{name: value for name, value in settings.items() if getattr(chosen, name) is None})
    _refuse_lag_without_effect(filled)
    refuse_ends_without_effect(replace(chosen, compensation=filled.compensation))
    return filled


def drop_overruled(chosen: Choices, settings: Mapping[str, object] | None = None) -> Choices:
    """Drop project choices that are overruled or have no effect.

    The choices of this call, the settings of the drawing, and the brush that a plan names are more specific.
    A project file serves many drawings, so a choice that does not suit one of them is no mistake.
    """
    if not chosen.from_project:
        return chosen
    settings = settings or {}
    made_here = {name for name in CHOICES if getattr(chosen, name) is not None} - {*chosen.from_project}
    ineffective = {CHOICE_BY_FLAG.get(flag, flag) for flag in _list_ineffective_flags(chosen.input)[0]}
    dropped = {*settings} - {"brush", "cell"} | ineffective
    if "terminals" in made_here:
        dropped |= {"start", "end"}
    for option, excluded_by in (("fit", "scale"), ("scale", "fit")):
        if excluded_by in made_here:
            dropped.add(option)
    compensation = chosen.compensation
    if "compensation" not in made_here:
        compensation = settings.get("compensation", compensation)
    if compensation != "constant":
        dropped.add("lag")
    if compensation in METHODS_WITHOUT_ENDS:
        dropped.update(END_CHOICES)
    names = settings if suffix_of(chosen.input) != ".json" else {"brush": _find_plan_brush(chosen)}
    return drop_from_project(chosen, dropped | find_overruled_names(chosen, names))


def drop_from_project(chosen: Choices, names: Iterable[str]) -> Choices:
    """Return the choices without project choices of these names.

    Choices of these names that were made elsewhere stay.
    """
    dropped = {*names} & {*chosen.from_project}
    kept = tuple(name for name in chosen.from_project if name not in dropped)
    return replace(chosen, from_project=kept, **dict.fromkeys(dropped))


def find_overruled_names(chosen: Choices, named: Mapping[str, object], unknown: bool = True) -> set[str]:
    """Return "brush" and "cell" where a source names another one than the project.

    The source is a drawing, a plan or a program.

    unknown: also count a name that is not shipped with brushsvg.
    """
    overruled = set()
    for kind, names, read in (("brush", brush_names(), load_brush), ("cell", cell_names(), load_cell)):
        name = named.get(kind)
        if name is None or kind not in chosen.from_project or not (unknown or name in names):
            continue
        if read(getattr(chosen, kind)).name != name:
            overruled.add(kind)
    return overruled


def _find_plan_brush(chosen: Choices) -> str | None:
    """Return the shipped brush of a plan, if a project file names a brush too."""
    plan = chosen.input
    if "brush" in chosen.from_project and isinstance(plan, str | os.PathLike):
        with suppress(Error):  # preparation reports what is wrong with the plan
            plan = read_plan(plan)
    name = getattr(plan, "brush", None)
    return name if name in brush_names() else None


def _list_ineffective_flags(source) -> tuple[tuple[str, ...], str]:
    """Return the flags that have no effect on this kind of drawing, and the kind in words."""
    suffix = suffix_of(source)
    if suffix == ".json":
        return (*LAYOUT_FLAGS, *PLANNING_FLAGS), "a plan, whose poses are fixed"
    if suffix in GCODE:
        return ("units", "select", "background"), "G-code"
    if suffix == ".dxf":
        return (*GCODE_FLAGS, "select", "background"), "a DXF"
    if suffix in (".svg", ".svgz"):
        return (*GCODE_FLAGS, "units"), "an SVG"
    return (() if source is None else GCODE_FLAGS), "a drawing that is not G-code"


def report_ineffective_flags(chosen: Choices) -> list[Notice]:
    """Return notices on the flags that have no effect on this kind of drawing."""
    return report_flags_without_effect(chosen, *_list_ineffective_flags(chosen.input))


def report_flags_without_effect(chosen: Choices, flags: Iterable[str], subject: str) -> list[Notice]:
    """Return a notice on each of these flags that was given.

    Settings of a project file are no mistake: they serve many drawings and commands.

    subject: what the flags have no effect on, in words.
    """
    names = {flag: CHOICE_BY_FLAG.get(flag, flag) for flag in flags}
    return [
        Notice("", f"--{flag} has no effect on {subject}", code="flag-without-effect", about=flag)
        for flag, name in names.items()
        if getattr(chosen, name) is not None and name not in chosen.from_project
    ]


def choose_margin_strokes(chosen: Choices) -> Choices:
    """Choose margin strokes for a page that will be painted and photographed.

    They are painted where the brush is not calibrated, unless the choices say otherwise.
    """
    if chosen.margin_strokes or suffix_of(chosen.input) == ".json":
        return chosen
    return replace(chosen, margin_strokes="auto")


def load_brush(given):
    """Return the brush with this name or path. Return a Brush or None as it is."""
    if given is None or isinstance(given, _core.Brush):
        return given
    with name_file_in_errors(given):
        return find_brush(given)


def load_cell(given) -> Cell:
    """Return the cell with this name or path.

    A Cell is returned as it is. None stands for the default cell.
    """
    if given is None or isinstance(given, Cell):
        return given or find_cell()
    with name_file_in_errors(given):
        return find_cell(given)


def load_sheet_before(path: str | os.PathLike[str] | None) -> SheetBefore:
    if path is None:
        return SheetBefore()
    with name_file_in_errors(path):
        return read_sheet_before(path)


def make_read_options(chosen: Choices) -> ReadOptions:
    return ReadOptions(
        chosen.sheet,
        chosen.units,
        chosen.select,
        chosen.background or ReadOptions.background,
        chosen.pen,
        chosen.paper_z,
        tuple(chosen.skip_region or ()),
        tuple(chosen.skip_comment or ()),
        lenient=True,  # damaged geometry is reported together with the other notices
    )


def make_layout(chosen: Choices) -> Layout:
    needs_layers = "layer" not in chosen.from_project  # a project also serves drawings without layers
    return Layout(tuple(chosen.layer or ()), chosen.width, chosen.fit, chosen.scale, chosen.origin, needs_layers)


def make_options(chosen: Choices, cell: Cell | None = None, brush=None) -> Options:
    """Return the options for these choices.

    cell, brush: the loaded cell and brush, if they are known already.
    """
    cell = cell or load_cell(chosen.cell)
    return Options(
        brush=brush or load_brush(chosen.brush),
        reading=make_read_options(chosen),
        layout=make_layout(chosen),
        compensation=chosen.compensation or Options.compensation,
        lag_mm=chosen.lag,
        tolerance_mm=(suffix_of(chosen.input) != ".json" and chosen.tolerance) or Options.tolerance_mm,
        start=chosen.start or chosen.terminals or Options.start,
        end=chosen.end or chosen.terminals or Options.end,
        paths_as=chosen.paths_as,
        wide=chosen.wide or Options.wide,
        corners=chosen.corners or Options.corners,
        detail=chosen.detail or Options.detail,
        script=chosen.script or Options.script,
        colour=chosen.colour,
        join=bool(chosen.join),
        margin_strokes=chosen.margin_strokes or Options.margin_strokes,
        speed_mm_s=min(Options.speed_mm_s, cell.speeds.paint_mm_s),
        speed_of_all_mm_s=chosen.paint_speed,
        cell=cell,
        z_offset_mm=chosen.z_offset or 0.0,
        corrections=load_sheet_before(chosen.corrections).corrections,
    )


CHOICES = tuple(field.name for field in fields(Choices) if field.name != "from_project")
