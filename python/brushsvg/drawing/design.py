"""What a drawing says, in millimetres of the paper frame: origin lower left, x right, y up."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from ..array_values import ArrayValue
from ..errors import Notice


@dataclass(frozen=True, eq=False, repr=False)
class SubPath(ArrayValue):
    """One unbroken line: cubics (n, 4, 2) in mm, n >= 1; the end of each is the start of the next.

    A sub-path without length is one cubic whose four points coincide. widths: (k, 2), fraction of the arc
    length in [0, 1] and width [mm] there, linear in between; None where the element's one width serves.
    """

    cubics: np.ndarray
    closed: bool = False
    widths: np.ndarray | None = None


@dataclass(frozen=True, repr=False)
class Element:
    """One painted element: a stroked line, a filled shape, or both.

    id: as in the drawing, strokeN for the N-th without one; stroke_width_mm: 0 without a stroke; colour: "#rrggbb"
    of the stroke, of the fill where there is none; layer: "" outside of any layer; settings: what the drawing says
    to brushsvg itself; fill_rule: "nonzero" or "evenodd" of a filled shape, "" without a fill. fill_colour: of the fill
    of a shape whose stroke has another colour, "" of any other element.
    """

    id: str
    subpaths: tuple[SubPath, ...]
    stroke_width_mm: float
    colour: str = "#000000"
    layer: str = ""
    settings: dict = field(default_factory=dict)
    fill_rule: str = ""
    fill_colour: str = ""

    @property
    def is_stroked(self) -> bool:
        """Whether it is a line with a width, rather than a shape alone."""
        return self.stroke_width_mm > 0 or any(subpath.widths is not None for subpath in self.subpaths)

    def by_colour(self) -> tuple[Element, ...]:
        """The shape in the colour of its fill, and the line around it in its own, on top; itself in one colour."""
        if not self.fill_colour:
            return (self,)
        plain = tuple(replace(subpath, widths=None) for subpath in self.subpaths)
        shape = replace(self, subpaths=plain, stroke_width_mm=0.0, colour=self.fill_colour, fill_colour="")
        name = f"{self.id}-stroke" if self.id else ""
        return shape, replace(self, id=name, fill_rule="", fill_colour="")

    def __repr__(self) -> str:
        painted = [f"stroked {self.stroke_width_mm:g} mm wide"] * self.is_stroked + ["filled"] * bool(
            self.fill_rule
        )
        return f"<Element {self.id!r}: {len(self.subpaths)} sub-paths, {', '.join(painted) or 'nothing painted'}>"


@dataclass(frozen=True, repr=False)
class Design:
    """A drawing: sheet (width, height) in mm, elements in document order, what was noticed while reading.

    layers: why a layer by that name ("Ink/Fine" for one in another) is not painted, "" where nothing forbids it.
    """

    sheet_mm: tuple[float, float]
    elements: tuple[Element, ...]
    notices: tuple[Notice, ...] = ()
    title: str = ""
    layers: dict[str, str] = field(default_factory=dict)

    def __repr__(self) -> str:
        width, height = self.sheet_mm
        counts = f"{len(self.elements)} elements, {len(self.notices)} notices"
        return f"<Design {self.title!r}: {counts}, sheet {width:g} x {height:g} mm>"
