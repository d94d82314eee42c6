"""Write typeset text as an SVG document in mm, and place it on the sheet."""

from __future__ import annotations

from decimal import Decimal
from xml.sax.saxutils import escape

import numpy as np

from ...errors import Error
from ...geometry.cubics import extremes
from ..design import SubPath
from ..svg.paths.path_to_cubics import MAX_COORDINATE_MM
from .setting import PlacedGlyph, TypesetText

_MARGIN_MM = 20  # the same margin as around a drawing without a sheet
_MAX_CUBICS = 2_000_000  # a book page has a hundredth of this; with more, the document alone needs 100 MB
_MAX_STRAIGHT_ERROR_MM = 1e-6  # distance of handles from the thirds of a line due to rounding, far below the decimals


def svg_document(
    typeset: TypesetText,
    title: str,
    size_mm: float,
    line_spacing: float,
    width_mm: float,
    sheet_mm: tuple[float, float] | None,
    script: str = "auto",
) -> str:
    """Return the SVG document of a text, with one path per glyph.

    The ink is in the middle of the sheet.

    size_mm: the em of the font, with which the text was typeset.
    line_spacing: distance of the lines in ems.
    width_mm: width of the strokes, 0 for filled shapes.
    sheet_mm: (width, height), None for the bounding box of the ink plus a margin of 20 mm.
    script: the script of all glyphs; "auto": the script of each glyph.

    Raises Error if there is no ink or too much ink, or if the ink does not fit the sheet.
    """
    placed = [
        (glyph, np.array([glyph.x_mm, glyph.y_mm + row * line_spacing * size_mm]))
        for row, line in enumerate(typeset.lines)
        for glyph in line
    ]
    count = sum(len(subpath.cubics) for glyph, _ in placed for subpath in glyph.subpaths)
    if count > _MAX_CUBICS:
        sentence = f"the text takes {count} curves, beyond the limit of {_MAX_CUBICS}"
        raise Error(sentence, "", count, (0, _MAX_CUBICS), code="text-too-long")
    lower, upper = _curve_extents(placed)
    size = upper - lower + width_mm
    if not (size < MAX_COORDINATE_MM).all():
        sentence = f"the text is {size.max():.4g} mm long, beyond the range [0, 1e6] mm"
        raise Error(sentence, "text", code="text-too-long")
    if sheet_mm is None:
        sheet = np.ceil((size + 2 * _MARGIN_MM) * 1e4 - 1e-3) / 1e4
    else:
        sheet = np.array(sheet_mm)
        if (size > sheet + 1e-9).any():
            too_large = size > sheet
            room_mm, ink_mm = (sheet - width_mm)[too_large], (size - width_mm)[too_large]
            has_room = (room_mm > 0).all()
            smaller = f"--size {_round_down(size_mm * (room_mm / ink_mm).min())}" if has_room else "a smaller --width"
            raise Error(
                f"the text takes {size[0]:.2f} x {size[1]:.2f} mm, more than the sheet's "
                f"{sheet[0]:g} x {sheet[1]:g} mm",
                "text",
                code="text-does-not-fit",
                advice=f"give {smaller} or a larger --sheet",
            )
    shift = (sheet - lower - upper) / 2
    style = (
        'fill="#000000" fill-rule="nonzero" stroke="none"'
        if typeset.filled
        else f'fill="none" stroke="#000000" stroke-width="{_format_number(width_mm)}" '
        'stroke-linecap="round" stroke-linejoin="round"'
    )
    width, height = map(_format_number, sheet)
    return "\n".join(
        (
            '<?xml version="1.0" encoding="UTF-8"?>',
            f'<svg xmlns="http://www.w3.org/2000/svg" width="{width}mm" height="{height}mm" '
            f'viewBox="0 0 {width} {height}">',
            f"  <title>{escape(title)}</title>",
            *(
                f'  <path id="glyph-{number}-{_id_label(glyph.label)}" {style} {_script_attribute(glyph, script)}'
                f'd="{_path_data(glyph.subpaths, origin + shift)}"/>'
                for number, (glyph, origin) in enumerate(placed, 1)
            ),
            "</svg>\n",
        )
    )


def _round_down(value: float) -> str:
    """Return a positive number with three significant digits, rounded down."""
    unit = Decimal(1).scaleb(Decimal(value).adjusted() - 2)
    return f"{(Decimal(value) // unit * unit).normalize():f}"


def _script_attribute(glyph: PlacedGlyph, script: str) -> str:
    glyph_script = glyph.script if script == "auto" else script
    return "" if glyph_script == "auto" else f'data-brushsvg-script="{glyph_script}" '


def _curve_extents(placed: list[tuple[PlacedGlyph, np.ndarray]]) -> tuple[np.ndarray, np.ndarray]:
    """Return the least and the greatest x and y [mm] of the curves without widths."""
    known_extents: dict[int, tuple[np.ndarray, np.ndarray]] = {}
    corners = []
    for glyph, origin in placed:
        if id(glyph.subpaths) not in known_extents:
            points = np.concatenate([extremes(subpath.cubics) for subpath in glyph.subpaths])
            known_extents[id(glyph.subpaths)] = points.min(axis=0), points.max(axis=0)
        corners += [corner + origin for corner in known_extents[id(glyph.subpaths)]]
    if not corners:
        raise Error("the text has nothing to paint", "text", code="nothing-to-paint")
    return np.min(corners, axis=0), np.max(corners, axis=0)


def _path_data(subpaths: tuple[SubPath, ...], shift: np.ndarray) -> str:
    return " ".join(_subpath_data(subpath.cubics + shift, subpath.closed) for subpath in subpaths)


def _subpath_data(cubics: np.ndarray, closed: bool) -> str:
    thirds = cubics[:, :1] + (cubics[:, 3:] - cubics[:, :1]) * np.array([1, 2])[:, None] / 3
    straight = np.abs(cubics[:, 1:3] - thirds).max(axis=(1, 2)) < _MAX_STRAIGHT_ERROR_MM
    if closed and straight[-1] and len(cubics) > 1:
        cubics = cubics[:-1]  # the command Z draws this line
    words = ["M", *_format_points(cubics[0, :1])]
    for cubic, is_line in zip(cubics, straight, strict=False):
        words += ["L" if is_line else "C", *_format_points(cubic[3:] if is_line else cubic[1:])]
    return " ".join([*words, "Z"] if closed else words)


def _format_points(points: np.ndarray) -> list[str]:
    return [f"{x + 0.0:.4f},{y + 0.0:.4f}" for x, y in points.round(4).tolist()]


def _format_number(value: float) -> str:
    return f"{value:.4f}".rstrip("0").rstrip(".")


def _id_label(characters: str) -> str:
    """Return an id's last part: ASCII letters and digits stay, other characters become numbers."""
    return "".join(letter if letter.isascii() and letter.isalnum() else f"u{ord(letter):04X}" for letter in characters)
