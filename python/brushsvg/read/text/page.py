"""Set text to an SVG document in mm: its place on the sheet, and its letters."""

from __future__ import annotations

from xml.sax.saxutils import escape

import numpy as np

from ...errors import Error
from ...geometry.cubics import extremes
from ..design import SubPath
from ..svg.paths.path_to_cubics import LARGEST_MM
from .setting import Placed, Setting

_MARGIN_MM = 20  # as around a drawing without a sheet of its own
_CUBICS = 2_000_000  # a book page has a hundredth of it; beyond, the document alone takes 100 MB
_STRAIGHT_MM = 1e-6  # handles this close to the thirds of a line: rounding errors, far below the decimals


def document(
    setting: Setting,
    title: str,
    leading_mm: float,
    width_mm: float,
    sheet_mm: tuple[float, float] | None,
    script: str = "auto",
) -> str:
    """The SVG document: one path a glyph, the ink in the middle of the sheet.

    leading_mm: from line to line; width_mm: of strokes, 0 for filled shapes; sheet_mm: None for the ink and
    20 mm around it; script: of all glyphs, "auto": each of its own. Error if there is no ink, too much of it, or more
    than the sheet takes.
    """
    placed = [
        (glyph, np.array([glyph.x_mm, glyph.y_mm + row * leading_mm]))
        for row, line in enumerate(setting.lines)
        for glyph in line
    ]
    count = sum(len(subpath.cubics) for glyph, _ in placed for subpath in glyph.subpaths)
    if count > _CUBICS:
        raise Error(
            f"the text takes {count} curves, beyond the limit of {_CUBICS}",
            "",
            count,
            (0, _CUBICS),
            code="text-too-long",
        )
    least, most = _extents(placed)
    size = most - least + width_mm
    if not (size < LARGEST_MM).all():
        raise Error(
            f"the text is {size.max():.4g} mm long, beyond the range [0, 1e6] mm",
            "text",
            code="text-too-long",
        )
    if sheet_mm is None:
        sheet = np.ceil((size + 2 * _MARGIN_MM) * 1e4 - 1e-3) / 1e4
    else:
        sheet = np.array(sheet_mm)
        if (size > sheet + 1e-9).any():
            raise Error(
                f"the text takes {size[0]:.2f} x {size[1]:.2f} mm, more than the sheet's "
                f"{sheet[0]:g} x {sheet[1]:g} mm",
                "text",
                code="text-does-not-fit",
            )
    shift = (sheet - least - most) / 2
    style = (
        'fill="#000000" fill-rule="nonzero" stroke="none"'
        if setting.filled
        else f'fill="none" stroke="#000000" stroke-width="{_plain(width_mm)}" '
        'stroke-linecap="round" stroke-linejoin="round"'
    )
    width, height = map(_plain, sheet)
    return "\n".join(
        (
            '<?xml version="1.0" encoding="UTF-8"?>',
            f'<svg xmlns="http://www.w3.org/2000/svg" width="{width}mm" height="{height}mm" '
            f'viewBox="0 0 {width} {height}">',
            f"  <title>{escape(title)}</title>",
            *(
                f'  <path id="glyph-{number}-{_label(glyph.label)}" {style} {_script(glyph, script)}'
                f'd="{_path(glyph.subpaths, origin + shift)}"/>'
                for number, (glyph, origin) in enumerate(placed, 1)
            ),
            "</svg>\n",
        )
    )


def _script(glyph: Placed, script: str) -> str:
    said = glyph.script if script == "auto" else script
    return "" if said == "auto" else f'data-brushsvg-script="{said}" '


def _extents(placed: list[tuple[Placed, np.ndarray]]) -> tuple[np.ndarray, np.ndarray]:
    """Least and greatest x and y [mm] of the curves themselves."""
    known: dict[int, tuple[np.ndarray, np.ndarray]] = {}
    corners = []
    for glyph, origin in placed:
        if id(glyph.subpaths) not in known:
            points = np.concatenate([extremes(subpath.cubics) for subpath in glyph.subpaths])
            known[id(glyph.subpaths)] = points.min(axis=0), points.max(axis=0)
        corners += [corner + origin for corner in known[id(glyph.subpaths)]]
    if not corners:
        raise Error("the text leaves nothing to paint", "text", code="nothing-to-paint")
    return np.min(corners, axis=0), np.max(corners, axis=0)


def _path(subpaths: tuple[SubPath, ...], shift: np.ndarray) -> str:
    return " ".join(_subpath(subpath.cubics + shift, subpath.closed) for subpath in subpaths)


def _subpath(cubics: np.ndarray, closed: bool) -> str:
    thirds = cubics[:, :1] + (cubics[:, 3:] - cubics[:, :1]) * np.array([1, 2])[:, None] / 3
    straight = np.abs(cubics[:, 1:3] - thirds).max(axis=(1, 2)) < _STRAIGHT_MM
    if closed and straight[-1] and len(cubics) > 1:
        cubics = cubics[:-1]  # closing draws it
    words = ["M", *_numbers(cubics[0, :1])]
    for cubic, is_line in zip(cubics, straight, strict=False):
        words += ["L" if is_line else "C", *_numbers(cubic[3:] if is_line else cubic[1:])]
    return " ".join([*words, "Z"] if closed else words)


def _numbers(points: np.ndarray) -> list[str]:
    return [f"{x + 0.0:.4f},{y + 0.0:.4f}" for x, y in points.round(4).tolist()]


def _plain(value: float) -> str:
    return f"{value:.4f}".rstrip("0").rstrip(".")


def _label(characters: str) -> str:
    """What stands behind the number in an id: letters and digits of ASCII as they are, the rest by number."""
    return "".join(each if each.isascii() and each.isalnum() else f"u{ord(each):04X}" for each in characters)
