"""The choices for a drawing, with their values and ranges.

Choices come from flags, from keywords, and from the drawing itself.
"""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from typing import TypedDict

from ... import _core
from ...machine.cells.cell import Cell
from ...read import BACKGROUNDS, PENS, SCRIPTS, UNITS

# The name of the choice that a flag makes, where both names differ.
CHOICE_BY_FLAG = {"as": "paths_as", "speed": "paint_speed", "z-offset": "z_offset", "paper-z": "paper_z"} | {
    name: name.replace("-", "_") for name in ("skip-region", "skip-comment", "margin-strokes")
}
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


def choose_margin_strokes(chosen: Choices) -> Choices:
    """Choose margin strokes for a page that will be painted and photographed.

    They are painted where the brush is not calibrated, unless the choices say otherwise.
    """
    if chosen.margin_strokes or suffix_of(chosen.input) == ".json":
        return chosen
    return replace(chosen, margin_strokes="auto")


CHOICES = tuple(field.name for field in fields(Choices) if field.name != "from_project")
