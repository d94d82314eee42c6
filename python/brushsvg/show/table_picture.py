"""Draw the table in front of an arm from above, or a wall: its reach, the paper, and where the paper could be."""

from __future__ import annotations

import numpy as np

from ..machine.arm.place import LIMITED, REACHED, SINGULAR, UNREACHED, ReachTable
from ..machine.cells.cell import Cell
from ..machine.frames import transform_points
from .canvas import FONT_PX, Canvas, draw_canvas
from .picture_colours import (
    ALTERNATIVE_SHEET_OUTLINE,
    GRID_LINE,
    LIMITED_AREA,
    REACHED_AREA,
    SHEET_OUTLINE,
    SINGULAR_AREA,
    TEXT,
    UNREACHED_AREA,
)

REACH_COLOURS = {
    REACHED: (REACHED_AREA, "reached"),
    LIMITED: (LIMITED_AREA, "beyond a joint's limits"),
    SINGULAR: (SINGULAR_AREA, "near a singularity"),
    UNREACHED: (UNREACHED_AREA, "out of reach"),
}
LONG_SIDE_PX = 1200
GRID_MM = 100.0
HEAD_PX, LINE_PX, SMALL_PX = 40, 40, 15
MIN_WIDTH_PX = 720  # of the legend


def table_picture(suffix: str, table: ReachTable, cell: Cell, sheet_mm, frame, found) -> str | bytes:
    """Draw the table as .svg or .png.

    frame: (4, 4) pose of the paper in the robot's frame; found: (4, 4) pose where the paper could be, or None.
    """
    half_mm = float(np.diff(table.x_mm)[0]) / 2
    low = np.minimum(np.array([table.x_mm[0], table.y_mm[0]]) - half_mm, -40.0)
    high = np.maximum(np.array([table.x_mm[-1], table.y_mm[-1]]) + half_mm, 40.0)
    corners = np.array([(0, 0, 0), (sheet_mm[0], 0, 0), (*sheet_mm, 0), (0, sheet_mm[1], 0)], dtype=float)
    sheets = [(transform_points(frame, corners)[:, table.axes], SHEET_OUTLINE, "paper")]
    if found is not None:
        sheets.append((transform_points(found, corners)[:, table.axes], ALTERNATIVE_SHEET_OUTLINE, "would do here"))
    for ring, _, _ in sheets:
        low, high = np.minimum(low, ring.min(axis=0) - 10), np.maximum(high, ring.max(axis=0) + 10)
    px_per_mm = LONG_SIDE_PX / (high - low).max()
    width, height = (high - low) * px_per_mm
    foot = HEAD_PX + height
    canvas = Canvas(max(width, MIN_WIDTH_PX), foot + (len(REACH_COLOURS) // 2 + 1) * LINE_PX, px_per_mm=px_per_mm)

    def place(points_mm) -> np.ndarray:
        return (np.asarray(points_mm) - (low[0], high[1])) * (px_per_mm, -px_per_mm) + (0, HEAD_PX)

    square = half_mm * np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)])
    for what, (colour, _) in REACH_COLOURS.items():
        rows, columns = np.nonzero(table.what == what)
        centres = np.column_stack([table.x_mm[columns], table.y_mm[rows]])
        canvas.area([place(centre + square) for centre in centres], colour)
    for x in _ticks(low[0], high[0]):
        canvas.line(place([(x, low[1]), (x, high[1])]), GRID_LINE, 1)
        canvas.text(place((x, 0))[0] + 3, foot - 4, f"{x:g}", size=SMALL_PX)
    for y in _ticks(low[1], high[1]):
        canvas.line(place([(low[0], y), (high[0], y)]), GRID_LINE, 1)
        if (at := place((0, y))[1]) < foot - LINE_PX:  # keep clear of the numbers of x
            canvas.text(3, at - 3, f"{y:g}", size=SMALL_PX)
    x, y = place((0, 0))
    canvas.dot((x, y), 9, TEXT)
    canvas.text(x + 14, y + 7, "robot")
    for ring, colour, words in sheets:
        points = place(ring)
        canvas.line(np.vstack([points, points[:1]]), colour, 3, "sheet")
        canvas.dot(points[0], 6, colour)
        x, y = points.mean(axis=0)
        canvas.text(x - 5 * len(words), y + 7, words, colour)
    shown = "" if table.axes == (0, 1) else " and ".join("xyz"[axis] for axis in table.axes) + ", "
    title = f"{cell.name}: arm {cell.arm.name}, {shown}mm of the robot's frame; white: beyond the cell's box"
    canvas.text(FONT_PX / 2, FONT_PX + 6, title)
    for number, (colour, words) in enumerate(REACH_COLOURS.values()):
        x, y = FONT_PX / 2 + number % 2 * MIN_WIDTH_PX / 2, foot + FONT_PX + number // 2 * LINE_PX
        canvas.area([(x, y) + FONT_PX * np.array([(0, -0.5), (1, -0.5), (1, 0.5), (0, 0.5)])], colour)
        canvas.text(x + 1.5 * FONT_PX, y + 7, words)
    picture = draw_canvas(suffix, canvas)
    return picture if suffix == ".png" else picture.decode()


def _ticks(low: float, high: float) -> np.ndarray:
    return np.arange(np.ceil(low / GRID_MM), np.floor(high / GRID_MM) + 1) * GRID_MM + 0.0  # no -0
