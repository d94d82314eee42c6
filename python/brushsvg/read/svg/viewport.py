"""Map SVG's user units to paper: viewport, viewBox and preserveAspectRatio."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

from ...errors import Error
from ...units import FONT_PX, MM_PER, length_mm, length_px
from ..design import Notice
from .paths.path_data import parse_numbers, snippet
from .paths.path_to_cubics import MAX_COORDINATE_MM
from .transform import IDENTITY, Matrix, multiply


@dataclass(frozen=True)
class Page:
    """The page of a drawing.

    sheet_mm: (width, height).
    paper_from_user: matrix from user units to mm with y up.
    viewport: (width, height) in user units.
    notices: about the size of the page.
    in_px: whether the size is given in px, or not at all.
    """

    sheet_mm: tuple[float, float]
    paper_from_user: Matrix
    viewport: tuple[float, float]
    notices: tuple[Notice, ...]
    in_px: bool


def nested_viewport(
    attributes: dict[str, str],
    outer: tuple[float, float],
    size: tuple[str | None, str | None] = (None, None),
    em_px: float = FONT_PX,
) -> tuple[Matrix, tuple[float, float], tuple[float, float, float, float], list[Notice]] | None:
    """Read the viewport of an svg or symbol inside a drawing.

    outer: (width, height) of the viewport around it; size: (width, height) of a use, as written.

    Returns four values, or None if the rectangle has no area:

    * the matrix of the content;
    * the viewport (width, height) in units of the content;
    * the rectangle (x, y, width, height) in outer units;
    * notices.

    Raises Error if a length or the viewBox is invalid.
    """
    use_size = dict(zip(("width", "height"), size, strict=True))
    x, y, width, height = (
        length_px(text if text and text.strip() not in ("", "auto") else default, outer[axis], em_px)
        for text, default, axis in (
            (attributes.get("x"), "0", 0),
            (attributes.get("y"), "0", 1),
            (use_size["width"] or attributes.get("width"), "100%", 0),
            (use_size["height"] or attributes.get("height"), "100%", 1),
        )
    )
    if not (width > 0 and height > 0):
        return None
    notices: list[Notice] = []
    box = _view_box(attributes.get("viewBox"))
    inner = (
        IDENTITY if box is None else _fit_view_box(box, width, height, attributes.get("preserveAspectRatio"), notices)
    )
    matrix = multiply((1.0, 0.0, 0.0, 1.0, x, y), inner)
    return matrix, (width, height) if box is None else box[2:], (x, y, width, height), notices


def read_page(
    attributes: dict[str, str],
    sheet_mm: tuple[float, float] | None = None,
    style: Mapping[str, str] = MappingProxyType({}),
) -> Page:
    """Read the page of a root element.

    sheet_mm: replaces the size of the drawing; the upper left corners stay together.
    style: the width and height of the CSS of the root. Browsers use the CSS and Inkscape uses the attributes. So the
    CSS counts if attributes are missing, and a notice reports a difference.

    Raises Error if neither the drawing nor the caller gives a size.
    """
    notices: list[Notice] = []
    box = _view_box(attributes.get("viewBox"))
    in_px = all(attributes.get(name, "").strip("0123456789.+- ") in ("", "px", "%") for name in ("width", "height"))
    width, height = (_side_mm(attributes.get(name), name, bool(box)) for name in ("width", "height"))
    styled = [
        _side_mm(style.get(name), name, bool(box)) if _is_length(style.get(name)) else None
        for name in ("width", "height")
    ]
    for name, own, css_mm in zip(("width", "height"), (width, height), styled, strict=True):
        if own and css_mm and abs(own - css_mm) > 1e-3 * own and sheet_mm is None:
            sentence = (
                f"its {name} is {own:.6g} mm, as Inkscape shows it, and {css_mm:.6g} mm by its style, as browsers do: "
                f"it is read as {own:.6g} mm"
            )
            notices.append(Notice("svg", sentence, code="size-assumed"))
    width, height = (own if own is not None else css_mm for own, css_mm in zip((width, height), styled, strict=True))
    if box is None and sheet_mm is not None:
        width, height = width or sheet_mm[0], height or sheet_mm[1]
    if width is None or height is None:
        if box is None:
            raise Error(
                "the drawing has neither a width and height in absolute units nor a viewBox, so its size is unknown",
                code="size-unknown",
                advice="--sheet WxH gives it in mm",
            )
        if width is None and height is None:
            width, height = box[2] * MM_PER["px"], box[3] * MM_PER["px"]
            reason = "no width and height in absolute units: its viewBox is read in px at 96 to the inch"
        else:
            missing_side = "width" if width is None else "height"
            reason = f"no {missing_side} in absolute units: it follows from the viewBox"
            if width is None:
                width = height * box[2] / box[3]
            else:
                height = width * box[3] / box[2]
        notices.append(Notice("svg", f"the drawing has {reason}, {width:.6g} x {height:.6g} mm", code="size-assumed"))
    for name, value in (("width", width), ("height", height)):
        if not 0 < value <= MAX_COORDINATE_MM:
            sentence = f"the page's {name} {value:.6g} mm is outside the range (0, {MAX_COORDINATE_MM:.0f}] mm"
            raise Error(sentence, where="svg", value=value, range=(0.0, MAX_COORDINATE_MM), code="out-of-range")
    if box is None:
        px = MM_PER["px"]
        page_from_user, viewport = (px, 0.0, 0.0, px, 0.0, 0.0), (width / px, height / px)
    else:
        page_from_user = _fit_view_box(box, width, height, attributes.get("preserveAspectRatio"), notices)
        viewport = box[2:]
    sheet = sheet_mm or (width, height)
    flip = (1.0, 0.0, 0.0, -1.0, 0.0, sheet[1])
    return Page(sheet, multiply(flip, page_from_user), viewport, tuple(notices), in_px)


def _view_box(text: str | None) -> tuple[float, float, float, float] | None:
    if text is None or not text.strip():
        return None
    values = parse_numbers(text.strip())
    if values is None or len(values) != 4 or not all(map(math.isfinite, values)):
        raise Error(f"viewBox {snippet(text, 0, 40)} is not four numbers", where="svg", code="viewbox-invalid")
    if values[2] <= 0 or values[3] <= 0:
        raise Error(f"viewBox {snippet(text, 0, 40)} has no area", where="svg", code="viewbox-invalid")
    return tuple(values)


def _is_length(text: str | None) -> bool:
    """Whether a CSS value is an absolute length, not auto or a percentage."""
    return text is not None and re.fullmatch(r"\s*\d*\.?\d+(?:px|mm|cm|in|pt|pc|q)\s*", text, re.I) is not None


_FONT_RELATIVE = re.compile(r".*[0-9.]\s*(?:em|ex|rem|ch)\s*", re.I)


def _side_mm(text: str | None, name: str, has_box: bool) -> float | None:
    """Return a side of the page in mm, None if it depends on something else.

    A side can depend on a window. If a viewBox gives the size of the drawing, it can also depend on a font: icons are
    1em high.
    """
    if text is None or text.strip() in ("", "auto") or text.strip().endswith("%"):
        return None
    try:
        if _FONT_RELATIVE.fullmatch(text):
            return None if has_box else length_px(text, 0.0) * MM_PER["px"]
        return length_mm(text, "px")
    except Error as error:
        raise Error(f"the page's {name}: {error}", where="svg", code=error.code) from None


_ALIGN = re.compile(r"(?:defer )?(?:(none)|x(Min|Mid|Max)Y(Min|Mid|Max))(?: (meet|slice))?")
_SHARE = {"Min": 0.0, "Mid": 0.5, "Max": 1.0}


def _fit_view_box(box, width: float, height: float, text: str | None, notices: list[Notice]) -> Matrix:
    x, y, box_width, box_height = box
    sx, sy = width / box_width, height / box_height
    align = _ALIGN.fullmatch(" ".join((text or "").split() or ["xMidYMid"]))
    if not align:
        unknown = snippet(text, 0, 40)
        notices.append(
            Notice(
                "svg",
                f"preserveAspectRatio {unknown} is not known: read as xMidYMid meet",
                code="aspect-ratio-unread",
            )
        )
        align = _ALIGN.fullmatch("xMidYMid")
    if align[1]:
        return (sx, 0.0, 0.0, sy, -x * sx, -y * sy)
    s = max(sx, sy) if align[4] == "slice" else min(sx, sy)
    left, top = (width - s * box_width) * _SHARE[align[2]], (height - s * box_height) * _SHARE[align[3]]
    return (s, 0.0, 0.0, s, left - x * s, top - y * s)


def rectangle_corners(matrix: Matrix, rectangle: tuple[float, float, float, float]) -> list[tuple[float, float]]:
    """Return the corners [mm] of a rectangle, in order.

    rectangle: (x, y, width, height) in user units; matrix: user units to paper.
    """
    a, b, c, d, e, f = matrix
    x, y, width, height = rectangle
    places = [(x, y), (x + width, y), (x + width, y + height), (x, y + height)]
    return [(a * u + c * v + e, b * u + d * v + f) for u, v in places]
