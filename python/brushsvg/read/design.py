"""The content of a drawing in mm.

All coordinates are in the paper frame: origin lower left, x right, y up.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from ..array_values import ArrayValue
from ..errors import Notice


@dataclass(frozen=True, eq=False, repr=False)
class SubPath(ArrayValue):
    """One unbroken line.

    cubics: (n, 4, 2) control points in mm, n >= 1; each cubic starts where the one before it ends. A sub-path
    without length is one cubic whose four points coincide.
    closed: whether the line ends where it begins.
    widths: (k, 2), a fraction of the arc length in [0, 1] and the width [mm] there, linear in between; None if the
    whole line has the width of its element.
    """

    cubics: np.ndarray
    closed: bool = False
    widths: np.ndarray | None = None


@dataclass(frozen=True, repr=False)
class Element:
    """One painted element: a stroked line, a filled shape, or both.

    id: as in the drawing; strokeN for the N-th element without an id.
    stroke_width_mm: 0 without a stroke.
    colour: "#rrggbb" of the stroke, or of the fill if there is no stroke.
    layer: "" outside of any layer.
    settings: the settings for brushsvg that the drawing contains.
    fill_rule: "nonzero" or "evenodd" for a filled shape, "" without a fill.
    fill_colour: colour of the fill if the stroke has another colour, otherwise "".
    dash_gap_mm: the smallest gap between the dashes of the stroke, 0 without dashes.
    is_under_fill: the drawing has the stroke below a fill of another colour, but brushsvg paints it on top.
    """

    id: str
    subpaths: tuple[SubPath, ...]
    stroke_width_mm: float
    colour: str = "#000000"
    layer: str = ""
    settings: dict = field(default_factory=dict)
    fill_rule: str = ""
    fill_colour: str = ""
    dash_gap_mm: float = 0.0
    is_under_fill: bool = False

    @property
    def is_stroked(self) -> bool:
        """Whether the element has a stroke, and not only a fill."""
        return self.stroke_width_mm > 0 or any(subpath.widths is not None for subpath in self.subpaths)

    def by_colour(self) -> tuple[Element, ...]:
        """Split an element whose fill and stroke have different colours.

        Returns the filled shape and, on top of it, the stroke. An element with one colour is returned as it is.
        """
        if not self.fill_colour:
            return (self,)
        plain = tuple(replace(subpath, widths=None) for subpath in self.subpaths)
        shape = replace(
            self, subpaths=plain, stroke_width_mm=0.0, colour=self.fill_colour, fill_colour="", is_under_fill=False
        )
        name = f"{self.id}-stroke" if self.id else ""
        return shape, replace(self, id=name, fill_rule="", fill_colour="")

    def __repr__(self) -> str:
        painted = [f"stroked {self.stroke_width_mm:g} mm wide"] * self.is_stroked + ["filled"] * bool(self.fill_rule)
        return f"<Element {self.id!r}: {len(self.subpaths)} sub-paths, {', '.join(painted) or 'nothing painted'}>"


@dataclass(frozen=True, repr=False)
class Design:
    """A drawing.

    sheet_mm: (width, height).
    elements: in document order.
    notices: about the parts of the drawing that were read differently than drawn, or not at all.
    layers: for each layer name ("Ink/Fine" for a layer inside another) the reason why the layer is not painted, or
    "" if it is painted.
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
