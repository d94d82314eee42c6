"""Draw an overview of a drawing as it was read: numbered strokes with direction and width, and every warning."""

from __future__ import annotations

import math
import re
import textwrap
from dataclasses import dataclass

import numpy as np

from .. import _core
from ..geometry import polylines
from ..geometry.cubics import at
from ..notice_summary import summarize_notices
from ..read.design import Design, Notice
from ..read.layout import bounds_mm
from ..read.text.text_runs import LEFT_TO_RIGHT_MARK
from ..reporting.label_space import LabelSpace
from .canvas import FONT_PX, Canvas, draw_canvas
from .picture_colours import (
    IMPORT_BACKGROUND,
    IMPORT_MUTED_TEXT,
    SHAPE_FILL,
    SHEET_EDGE,
    STROKE_INKS,
    TEXT,
    WARNING_TEXT,
    WHITE,
)

SHEET_PX, MARGIN_PX, LINE_PX = 1500, 40, 30
MAX_LISTED = 120  # entries in each list
MAX_ENTRY_LETTERS = 46  # of an entry for a stroke
LETTER_WIDTH_PX = 10.0  # width per letter of the lists, between the widths of OpenCV's font and of browsers
MAX_LABEL_DISTANCE_PX = 22.0  # from a stroke's start to its number
MIN_LABEL_SPACING_PX = 80.0  # between two numbered dashes of one element
TOLERANCE_MM = 0.02
MIN_STROKES_IN_RUN = 6  # smallest number of similar strokes that become one entry
LABEL_CELL_PX = 8.0  # half the height of a number


@dataclass(frozen=True)
class _Run:
    """Strokes first to last that are one entry of the list.

    is_one_element: they are sub-paths or dashes of one element.
    """

    first: int
    last: int
    is_one_element: bool = False


def draw_import_picture(suffix: str, design: Design, strokes: list, notices: list[Notice]) -> bytes:
    """Return the overview of a drawing as the bytes of an .svg or a .png.

    strokes: the strokes of the design, may be empty; notices: all warnings.
    """
    canvas = _arrange_picture(design, strokes, notices)
    return draw_canvas(suffix, canvas)


def _arrange_picture(design: Design, strokes: list, notices: list[Notice]) -> Canvas:
    w, h = design.sheet_mm
    box = bounds_mm(design.elements)
    x0, y0 = min(0.0, float(box[0])), min(0.0, float(box[1]))
    x1, y1 = max(w, float(box[2])), max(h, float(box[3]))
    px_per_mm = SHEET_PX / max(x1 - x0, y1 - y0)
    canvas = Canvas(max((x1 - x0) * px_per_mm, 900) + 2 * MARGIN_PX, background=IMPORT_BACKGROUND)
    top = MARGIN_PX + 2 * LINE_PX

    def place(points_mm: np.ndarray) -> np.ndarray:
        points = np.asarray(points_mm, float)[:, :2]
        return np.column_stack([MARGIN_PX + (points[:, 0] - x0) * px_per_mm, top + (y1 - points[:, 1]) * px_per_mm])

    canvas.text(MARGIN_PX, MARGIN_PX + FONT_PX, design.title or "Drawing as understood", TEXT, 28)
    count = f"{len(strokes)} strokes" if len(strokes) != 1 else "1 stroke"
    warned = f"{len(notices)} warnings" if len(notices) != 1 else "1 warning"
    # The strokes of filled shapes depend on the brush, which is not known here.
    more = "; preview --show paint shows those that a brush adds" if any(stroke.target_mm for stroke in strokes) else ""
    words = f"sheet {w:.6g} x {h:.6g} mm, {count}, {warned}{more}"
    canvas.text(MARGIN_PX, MARGIN_PX + FONT_PX + LINE_PX, words, IMPORT_MUTED_TEXT)
    sheet = place(np.array([[0, 0], [w, 0], [w, h], [0, h]]))
    canvas.area([sheet], WHITE)
    canvas.line(np.vstack([sheet, sheet[:1]]), SHEET_EDGE, 1.5)
    for element in design.elements:
        if element.fill_rule:
            canvas.area([place(_flatten_cubics(subpath.cubics)) for subpath in element.subpaths], SHAPE_FILL)
    runs = _group_runs(strokes)
    inks = _choose_inks(runs)
    for stroke, ink in zip(strokes, inks, strict=True):
        rings = _core.target_outline(stroke, TOLERANCE_MM)
        canvas.area([place(ring) for ring in rings], ink, 0.3)
    lines = [place(_core.flatten(stroke, TOLERANCE_MM)) for stroke in strokes]
    for line, ink in zip(lines, inks, strict=True):
        _draw_direction(canvas, line, ink)
    _draw_numbers(canvas, lines, inks, runs, top + (y1 - y0) * px_per_mm + LINE_PX)
    y = top + (y1 - y0) * px_per_mm + 2 * LINE_PX
    y = _list_strokes(canvas, strokes, inks, runs, y)
    canvas.height = _list_notices(canvas, notices, y) + MARGIN_PX
    return canvas


def _choose_inks(runs: list[_Run]) -> list[str]:
    inks: list[str] = []
    number = 0
    for run in runs:
        for _ in range(run.first, run.last + 1):
            inks.append(STROKE_INKS[number % len(STROKE_INKS)])
            number += not run.is_one_element
        number += run.is_one_element
    return inks


def _flatten_cubics(cubics: np.ndarray) -> np.ndarray:
    t = np.linspace(0.0, 1.0, 17)[1:, None]
    p0, p1, p2, p3 = (cubics[:, None, k] for k in range(4))
    return np.vstack([cubics[0, :1], at(t, p0, p1, p2, p3).reshape(-1, 2)])


def _draw_direction(canvas: Canvas, line: np.ndarray, ink: str) -> None:
    """Draw a stroke's middle line with arrows, and a dot at its start."""
    length = polylines.length(line)
    if length > 0:
        canvas.line(line, ink, 2.0)
        along_mm = polylines.lengths(line)
        head = min(14.0, 0.4 * length)
        for end in np.arange(min(length, 90.0), length + 1e-9, 180.0) if length > 180 else (0.6 * length,):
            tip, tail = (np.array([np.interp(s, along_mm, line[:, k]) for k in (0, 1)]) for s in (end, end - head))
            if (norm := np.hypot(*(tip - tail))) > 0:
                along = (tip - tail) / norm
                side = np.array([-along[1], along[0]]) * head * 0.45
                canvas.area([np.array([tip, tail + side, tail - side])], ink)
    canvas.dot(line[0], 4.0, ink)


def _draw_numbers(canvas: Canvas, lines: list[np.ndarray], inks: list[str], runs: list[_Run], bottom: float) -> None:
    """Write strokes' numbers near their starts, best behind, where there is room; few of many dashes."""
    space = LabelSpace(_mark_cells(lines, (canvas.width, bottom)), LABEL_CELL_PX, (0, 0, canvas.width, bottom))
    for run in runs:
        last_start = None
        for number in range(run.first, run.last + 1):
            start = lines[number][0]
            if run.is_one_element and last_start is not None and math.dist(last_start, start) < MIN_LABEL_SPACING_PX:
                continue
            label = str(number + 1)
            size = (11.0 * len(label), 16.0)
            placed = space.place(
                start, [size], -_start_direction(lines[number]), reach=MAX_LABEL_DISTANCE_PX, may_cover=False
            )
            if placed is not None:
                canvas.text(placed.left, placed.top + 15, label, inks[number], 18)
                last_start = start


def _list_strokes(canvas: Canvas, strokes: list, inks: list[str], runs: list[_Run], y: float) -> float:
    entries = [_stroke_entry(strokes, run) for run in runs[:MAX_LISTED]]
    room = _letters_per_line(canvas)
    columns = min(3, max(1, room // (max(map(len, entries), default=0) + 2)))
    for k, (run, words) in enumerate(zip(runs, entries, strict=False)):
        x = MARGIN_PX + (k % columns) * (canvas.width - 2 * MARGIN_PX) / columns
        ink = inks[run.first] if run.is_one_element or run.last == run.first else TEXT
        canvas.text(x, y, words, ink, 18)
        y += LINE_PX if k % columns == columns - 1 or k == min(len(runs), MAX_LISTED) - 1 else 0
    if len(runs) > MAX_LISTED:
        canvas.text(MARGIN_PX, y, f"and {len(strokes) - runs[MAX_LISTED].first} more", IMPORT_MUTED_TEXT, 18)
        y += LINE_PX
    return y + LINE_PX / 2


def _stroke_entry(strokes: list, run: _Run) -> str:
    stroke = strokes[run.first]
    number, names, count = f"{run.first + 1}", stroke.id, ""
    if run.last > run.first:
        number, names = f"{number}-{run.last + 1}", f"{names} ... {strokes[run.last].id}"
        count = f" ({run.last - run.first + 1} strokes)"
    layer = f", {stroke.layer}" if stroke.layer else ""
    widths = f": {_width_text(stroke)} mm{count}"
    names = _shorten_middle(names, MAX_ENTRY_LETTERS - len(f"{number}  {widths}"))
    names += "" if names.isascii() else LEFT_TO_RIGHT_MARK  # the width stays behind a Hebrew or Arabic name
    words = f"{number}  {names}{widths}{layer}"
    return words if len(words) <= MAX_ENTRY_LETTERS else words[: MAX_ENTRY_LETTERS - 3] + "..."


def _shorten_middle(name: str, room: int) -> str:
    """Return a name with its beginning and its end, where the number of the stroke is."""
    kept = max(room - 3, 8)
    return name if len(name) <= room else f"{name[: kept // 2]}...{name[-(kept - kept // 2) :]}"


def _letters_per_line(canvas: Canvas) -> int:
    """Return how many letters fit on a line of the lists."""
    return int((canvas.width - 2 * MARGIN_PX) / LETTER_WIDTH_PX)


def _list_notices(canvas: Canvas, notices: list[Notice], y: float) -> float:
    listed = [
        (colour, notice)
        for is_damage, colour in ((True, WARNING_TEXT), (False, TEXT))
        for notice in summarize_notices(notice for notice in notices if notice.damaged == is_damage)
    ]
    for colour, notice in listed[:MAX_LISTED]:
        text = ": ".join(filter(None, (notice.where, notice.text)))
        for line in textwrap.wrap(text, _letters_per_line(canvas), subsequent_indent="    "):
            canvas.text(MARGIN_PX, y, line, colour, 18)
            y += LINE_PX
    if len(listed) > MAX_LISTED:
        canvas.text(MARGIN_PX, y, f"and {len(listed) - MAX_LISTED} warnings more", IMPORT_MUTED_TEXT, 18)
        y += LINE_PX
    return y


def _group_runs(strokes: list) -> list[_Run]:
    """Group consecutive similar strokes into entries of the list.

    The strokes have the same width and layer. The strokes of a group are sub-paths of one element, or elements with
    consecutive numbers. Fewer than MIN_STROKES_IN_RUN strokes stay separate entries.
    """
    runs: list[_Run] = []
    keys = []
    for stroke in strokes:
        keys.append((*_series_key(stroke.origin), _width_text(stroke), stroke.layer))
    first = 0
    for k, key in enumerate(keys):
        kind, number, *alike = key
        follows = k + 1 < len(keys) and keys[k + 1] == (kind, number + 1, *alike) and number >= 0
        if not follows:
            if k - first + 1 < MIN_STROKES_IN_RUN:
                runs += [_Run(single, single) for single in range(first, k + 1)]
            else:
                runs.append(_Run(first, k, strokes[k].origin.part > 0))
            first = k + 1
    return runs


def _series_key(origin) -> tuple[tuple, int]:
    """Return the key that the strokes of one entry share.

    Returns also the running number of the stroke, -1 for none.
    """
    others = (origin.repeat, origin.lane)
    if origin.part:
        return (origin.element, True, *others), origin.part
    stem, number = re.fullmatch("(.*?)([0-9]*)", origin.element, re.DOTALL).groups()
    return (stem, False, *others), int(number[-18:] or -1)


def _width_text(stroke) -> str:
    """Return the width of a stroke [mm] in words, or its smallest and largest width."""
    widths = sorted(2 * knot[1] for knot in stroke.half_width)
    return f"{widths[0]:.3g}" + (f" to {widths[-1]:.3g}" if widths[-1] > widths[0] else "")


def _start_direction(line: np.ndarray) -> np.ndarray:
    """Return the direction in which a line starts, as a unit vector."""
    distances = np.hypot(*(line - line[0]).T)
    ahead = line[int(np.argmax(distances >= 6.0))] if (distances >= 6.0).any() else line[-1]
    length = math.dist(ahead, line[0])
    return (ahead - line[0]) / length if length > 0 else np.array([1.0, 0.0])


def _mark_cells(lines: list[np.ndarray], size: tuple[float, float]) -> np.ndarray:
    """Return the mask (rows, columns) of the cells that lines go through.

    Cells have sides of LABEL_CELL_PX. size: width and height of the picture [px].
    """
    cells = np.zeros((math.ceil(size[1] / LABEL_CELL_PX), math.ceil(size[0] / LABEL_CELL_PX)), bool)
    for line in lines:
        at = polylines.lengths(line)
        dense = np.linspace(0.0, at[-1], math.ceil(2 * at[-1] / LABEL_CELL_PX) + 1)
        points = np.column_stack([np.interp(dense, at, line[:, k]) for k in (0, 1)])
        x, y = (points // LABEL_CELL_PX).astype(int).clip(0, (cells.shape[1] - 1, cells.shape[0] - 1)).T
        cells[y, x] = True
    return cells
