"""What a drawing says, in millimetres of the paper frame: origin lower left, x right, y up."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np


@dataclass(frozen=True)
class Notice:
    """A warning about one element.

    damaged: the geometry itself is broken and was read up to the error; convert refuses it unless lenient.
    """

    where: str
    sentence: str
    damaged: bool = False


@dataclass(frozen=True)
class SubPath:
    """One unbroken line: cubics (n, 4, 2) in mm, n >= 1; the end of each is the start of the next.

    A sub-path without length is one cubic whose four points coincide.
    """

    cubics: np.ndarray
    closed: bool = False


@dataclass(frozen=True)
class Element:
    """One painted element. id: "" if it has none; colour: "#rrggbb"; layer: "" outside of any layer."""

    id: str
    subpaths: tuple[SubPath, ...]
    stroke_width_mm: float
    colour: str = "#000000"
    layer: str = ""
    settings: dict = field(default_factory=dict)


@dataclass(frozen=True)
class Design:
    """A drawing: sheet (width, height) in mm, elements in document order, what was noticed while reading."""

    sheet_mm: tuple[float, float]
    elements: tuple[Element, ...]
    notices: tuple[Notice, ...] = ()
    title: str = ""
