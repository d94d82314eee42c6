"""Draw the table in front of an arm from above, or a wall: its reach, the paper, and where the paper could be."""

from __future__ import annotations

from html import escape

import cv2
import numpy as np

from ..machine.arm.place import LIMITED, REACHED, SINGULAR, UNREACHED, ReachTable
from ..machine.cells.cell import Cell
from ..machine.frames import transform_points
from .picture_colours import (
    ALTERNATIVE_SHEET_OUTLINE,
    GRID_LINE,
    LIMITED_AREA,
    REACHED_AREA,
    SHEET_OUTLINE,
    SINGULAR_AREA,
    TEXT,
    UNREACHED_AREA,
    WHITE,
)
from .png_canvas import bgr, blank_canvas, encode_png, write_text
from .svg_text import printable

REACH_COLOURS = {
    REACHED: (REACHED_AREA, "reached"),
    LIMITED: (LIMITED_AREA, "beyond a joint's limits"),
    SINGULAR: (SINGULAR_AREA, "near a singularity"),
    UNREACHED: (UNREACHED_AREA, "out of reach"),
}
LONG_SIDE_PX = 1200
GRID_MM = 100.0
TEXT_PX = 20


def table_picture(suffix: str, table: ReachTable, cell: Cell, sheet_mm, frame, found) -> str | bytes:
    """Draw the table as .svg or .png.

    frame: (4, 4) pose of the paper in the robot's frame; found: (4, 4) pose where the paper could be, or None.
    """
    step_mm = float(np.diff(table.x_mm)[0])
    low = np.array([table.x_mm[0], table.y_mm[0]]) - step_mm / 2
    low = np.minimum(low, -40.0)
    high = np.maximum(np.array([table.x_mm[-1], table.y_mm[-1]]) + step_mm / 2, 40.0)
    corners = np.array([(0, 0, 0), (sheet_mm[0], 0, 0), (*sheet_mm, 0), (0, sheet_mm[1], 0)], dtype=float)
    sheets = [(transform_points(frame, corners)[:, table.axes], SHEET_OUTLINE, "paper")]
    if found is not None:
        sheets.append((transform_points(found, corners)[:, table.axes], ALTERNATIVE_SHEET_OUTLINE, "would do here"))
    for ring, _, _ in sheets:
        low, high = np.minimum(low, ring.min(axis=0) - 10), np.maximum(high, ring.max(axis=0) + 10)
    shown = "" if table.axes == (0, 1) else " and ".join("xyz"[axis] for axis in table.axes) + ", "
    drawn = _draw_png if suffix == ".png" else _draw_svg
    return drawn(
        table,
        step_mm,
        low,
        high,
        sheets,
        f"{cell.name}: arm {cell.arm.name}, {shown}mm of the robot's frame; white: beyond the cell's box",
    )


def _ticks(low: float, high: float) -> np.ndarray:
    return np.arange(np.ceil(low / GRID_MM), np.floor(high / GRID_MM) + 1) * GRID_MM + 0.0  # no -0


def _draw_png(table: ReachTable, step_mm: float, low, high, sheets, title: str) -> bytes:
    px_per_mm = LONG_SIDE_PX / (high - low).max()
    width, height = np.ceil((high - low) * px_per_mm).astype(int)
    head = 2 * TEXT_PX
    foot = (len(REACH_COLOURS) // 2 + 1) * 2 * TEXT_PX
    image = blank_canvas((head + height + foot, max(width, 36 * TEXT_PX)), WHITE)

    def at(x, y) -> tuple[int, int]:
        return round((x - low[0]) * px_per_mm), head + round((high[1] - y) * px_per_mm)

    half = step_mm / 2
    for y, row in zip(table.y_mm, table.what, strict=True):
        for x, what in zip(table.x_mm, row, strict=True):
            cv2.rectangle(image, at(x - half, y + half), at(x + half, y - half), bgr(REACH_COLOURS[int(what)][0]), -1)
    for x in _ticks(low[0], high[0]):
        cv2.line(image, at(x, low[1]), at(x, high[1]), bgr(GRID_LINE), 1)
        write_text(image, f"{x:g}", (at(x, 0)[0] + 3, head + height - 4), TEXT_PX * 3 // 4, 400, TEXT)
    for y in _ticks(low[1], high[1]):
        cv2.line(image, at(low[0], y), at(high[0], y), bgr(GRID_LINE), 1)
        if at(0, y)[1] < head + height - 2 * TEXT_PX:  # keep clear of the numbers of x
            write_text(image, f"{y:g}", (3, at(0, y)[1] - 3), TEXT_PX * 3 // 4, 400, TEXT)
    cv2.circle(image, at(0, 0), 9, bgr(TEXT), -1, cv2.LINE_AA)
    write_text(image, "robot", (at(0, 0)[0] + 14, at(0, 0)[1] + 7), TEXT_PX, 400, TEXT)
    for ring, colour, words in sheets:
        points = np.array([at(*point) for point in ring], dtype=np.int32)
        cv2.polylines(image, [points], True, bgr(colour), 3, cv2.LINE_AA)
        cv2.circle(image, points[0].tolist(), 6, bgr(colour), -1, cv2.LINE_AA)
        x, y = points.mean(axis=0).astype(int)
        write_text(image, words, (x - 5 * len(words), y + 7), TEXT_PX, 400, colour)
    write_text(image, title, (TEXT_PX // 2, TEXT_PX + 6), TEXT_PX, 600, TEXT)
    for number, (colour, words) in enumerate(REACH_COLOURS.values()):
        x, y = TEXT_PX // 2 + number % 2 * 18 * TEXT_PX, head + height + TEXT_PX + number // 2 * 2 * TEXT_PX
        cv2.rectangle(image, (x, y - TEXT_PX // 2), (x + TEXT_PX, y + TEXT_PX // 2), bgr(colour), -1)
        write_text(image, words, (x + 3 * TEXT_PX // 2, y + 7), TEXT_PX, 400, TEXT)
    return encode_png(image)


def _draw_svg(table: ReachTable, step_mm: float, low, high, sheets, title: str) -> str:
    width, height = high - low
    head, foot, size = 30.0, 60.0, 13.0
    whole = max(float(width), 470.0)

    def at(x, y) -> str:
        return f"{x - low[0]:.1f},{head + high[1] - y:.1f}"

    lines = [
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{whole:.0f}mm" height="{head + height + foot:.0f}mm" '
        f'viewBox="0 0 {whole:.0f} {head + height + foot:.0f}" font-family="sans-serif" font-size="{size:g}">',
        f"<title>{escape(printable(title), quote=False)}</title>",
        f'<rect width="100%" height="100%" fill="{WHITE}"/>',
        f'<text x="6" y="20" font-weight="bold">{escape(printable(title), quote=False)}</text>',
    ]
    half = step_mm / 2
    for what, (colour, _) in REACH_COLOURS.items():
        rows, columns = np.nonzero(table.what == what)
        squares = "".join(
            f"M{at(table.x_mm[c] - half, table.y_mm[r] + half)}h{step_mm:g}v{step_mm:g}h{-step_mm:g}z"
            for r, c in zip(rows, columns, strict=True)
        )
        lines.append(f'<path fill="{colour}" d="{squares}"/>')
    for x in _ticks(low[0], high[0]):
        lines.append(f'<path stroke="{GRID_LINE}" d="M{at(x, low[1])}L{at(x, high[1])}"/>')
        lines.append(f'<text x="{x - low[0] + 2:.1f}" y="{head + height - 3:.1f}" font-size="10">{x:g}</text>')
    for y in _ticks(low[1], high[1]):
        lines.append(f'<path stroke="{GRID_LINE}" d="M{at(low[0], y)}L{at(high[0], y)}"/>')
        if high[1] - y < height - 2 * size:  # keep clear of the numbers of x
            lines.append(f'<text x="2" y="{head + high[1] - y - 2:.1f}" font-size="10">{y:g}</text>')
    lines.append(f'<circle cx="{-low[0]:.1f}" cy="{head + high[1]:.1f}" r="6" fill="{TEXT}"/>')
    lines.append(f'<text x="{10 - low[0]:.1f}" y="{head + high[1] + 5:.1f}">robot</text>')
    for ring, colour, words in sheets:
        data = "M" + "L".join(at(*point) for point in ring) + "Z"
        lines.append(f'<path class="sheet" fill="none" stroke="{colour}" stroke-width="2" d="{data}"/>')
        x, y = ring.mean(axis=0)
        place = f'x="{x - low[0]:.1f}" y="{head + high[1] - y:.1f}"'
        lines.append(f'<text {place} text-anchor="middle" fill="{colour}">{words}</text>')
    for number, (colour, words) in enumerate(REACH_COLOURS.values()):
        x, y = 6 + number % 2 * 230, head + height + 12 + number // 2 * 24
        lines.append(f'<rect x="{x}" y="{y:.1f}" width="14" height="14" fill="{colour}"/>')
        lines.append(f'<text x="{x + 20}" y="{y + 11:.1f}">{words}</text>')
    return "\n".join([*lines, "</svg>", ""])
