"""Strokes from path objects of a program, and back.

Paths are svgpathtools' Path, path data as text, or cubics as an array.
"""

from __future__ import annotations

import itertools
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from .. import _core
from ..errors import Error, as_number, need_number, require_type
from ..read.svg.paths.path_data import MOST_COMMANDS, parse_path, snippet
from ..read.svg.paths.path_to_cubics import trace

if TYPE_CHECKING:
    import svgpathtools


def stroke_from_path(
    path: str | svgpathtools.Path | ArrayLike,
    width_mm: float,
    id: str = "stroke1",
    page_height_mm: float | None = None,
) -> _core.Stroke:
    """Return one stroke along a path, as wide as width_mm everywhere.

    path: a svgpathtools.Path, SVG path data as text, or cubics as an array of shape (n, 4, 2), or (n, 4) complex,
    or (n, 8). It is one unbroken line in mm, in painting direction, in the paper's frame with y up. With
    page_height_mm, y points down from the upper edge of a page of that height, as in SVG. Path data that end in Z
    are closed, and so are a Path or an array that end where they began.

    Raises Error if the path is damaged, empty, broken into several lines or beyond 1e6 mm, or the width is outside
    the range (0, 1e6] mm.
    """
    width_mm = as_number(width_mm, "a width in mm")
    require_type(id, str, "a stroke's id")
    if not 0 < width_mm <= 1e6:
        raise Error(f"the width {width_mm:g} mm is outside the range (0, 1e6] mm", where=id, code="out-of-range")
    if isinstance(path, str):
        cubics, closed = _read_text(path, id)
    elif hasattr(path, "d") and hasattr(path, "isclosed"):
        cubics, _ = _read_text(path.d(), id)
        closed = bool(len(path)) and path.isclosed()
    else:
        cubics = _read_array(path, id)
        closed = len(cubics) > 0 and np.ptp(cubics.reshape(-1, 2), axis=0).any() and _meets(cubics[-1, 3], cubics[0, 0])
    page_height_mm = _need_height(page_height_mm)
    if page_height_mm is not None:
        cubics = cubics * (1.0, -1.0) + (0.0, page_height_mm)
    half_mm = width_mm / 2
    stroke = _core.Stroke(id, cubics.reshape(-1, 8), bool(closed), [(0.0, half_mm), (1.0, half_mm)])
    _core.flatten(stroke, 1.0)  # refuses lines that cannot be a stroke
    return stroke


def path_from_stroke(stroke: _core.Stroke, page_height_mm: float | None = None) -> svgpathtools.Path:
    """Return the middle line as a svgpathtools.Path of cubics [mm].

    y points up, or down from the upper edge of a page of page_height_mm.
    """
    from svgpathtools import CubicBezier, Path

    require_type(stroke, _core.Stroke, "a stroke")
    points = _as_complex(np.asarray(stroke.middle_mm).reshape(-1, 4, 2), page_height_mm)
    return Path(*(CubicBezier(*each) for each in points.tolist()))


def path_from_pass(a_pass: _core.Pass, page_height_mm: float | None = None) -> svgpathtools.Path:
    """Return the TCP's way over the paper as a svgpathtools.Path of lines and arcs of circles [mm].

    y points up, or down from the upper edge of a page of page_height_mm. Each move along one of the arcs of the pass
    is a svgpathtools.Arc, each other move a Line. Poses where the tool only rises or sinks add nothing to it.

    Raises Error if an arc does not agree with its poses.
    """
    from svgpathtools import Line, Path

    require_type(a_pass, _core.Pass, "a pass of a plan")
    if a_pass.arcs:
        _core.write_plan(_core.Plan("", "", (1.0, 1.0), [a_pass]))  # refuses arcs that do not agree with their poses
    points = _as_complex(np.asarray(a_pass.poses_mm)[:, :2], page_height_mm).tolist()
    arcs = {row: arc for arc in a_pass.arcs for row in range(arc.first, arc.last)}
    return Path(
        *(
            _arc_between(here, there, arcs[row], page_height_mm) if row in arcs else Line(here, there)
            for row, (here, there) in enumerate(itertools.pairwise(points))
            if here != there
        )
    )


def _arc_between(
    here: complex, there: complex, arc: _core.Arc, page_height_mm: float | None
) -> svgpathtools.Arc | svgpathtools.Line:
    from svgpathtools import Arc, Line

    radius = float(abs(here - _as_complex(np.array(arc.centre_mm), page_height_mm)))
    is_counter_clockwise = (arc.direction > 0) == (page_height_mm is None)
    piece = Arc(here, radius * (1 + 1j), 0.0, False, is_counter_clockwise, there)
    # poses of a circle are less than half a turn apart, so rounding has reversed an arc that turns more
    return piece if abs(piece.delta) <= 180 else Line(here, there)


def _as_complex(points: np.ndarray, page_height_mm: float | None) -> np.ndarray:
    page_height_mm = _need_height(page_height_mm)
    y = points[..., 1] if page_height_mm is None else page_height_mm - points[..., 1]
    return points[..., 0] + 1j * y


def _need_height(page_height_mm) -> float | None:
    if page_height_mm is None:
        return None
    return need_number(page_height_mm, "a page's height [mm]", -1e6, 1e6)


def _read_text(text: str, id: str) -> tuple[np.ndarray, bool]:
    commands, damaged_at = parse_path(text)
    if len(commands) >= MOST_COMMANDS:
        sentence = f"the path data have {MOST_COMMANDS} commands or more: no stroke has"
        raise Error(sentence, where=id, code="list-too-long")
    if damaged_at is not None:
        raise Error(f"the path data are damaged at {snippet(text, damaged_at)}", where=id, code="geometry-damaged")
    line = trace(commands, (1.0, 0.0, 0.0, 1.0, 0.0, 0.0), 1.0)
    if line.beyond is not None:
        sentence = f"the path data go beyond 1e6 mm at {snippet(text, line.beyond)}"
        raise Error(sentence, where=id, code="geometry-out-of-range")
    if len(line.subpaths) != 1:
        count = len(line.subpaths) or "no"
        raise Error(f"the path has {count} unbroken lines: a stroke is one", where=id, code="wrong-type")
    return line.subpaths[0].cubics, line.subpaths[0].closed


def _read_array(path, id: str) -> np.ndarray:
    _need_short_list(path, id)
    try:
        table = np.asarray(path)
        if np.iscomplexobj(table):
            table = np.stack([table.real, table.imag], axis=-1)
        cubics = np.asarray(table, dtype=float).reshape(len(table), 4, 2)
    except (TypeError, ValueError, OverflowError):
        raise _not_cubics_error(id) from None
    broken = [k for k in range(1, len(cubics)) if not _meets(cubics[k - 1, 3], cubics[k, 0])]
    if broken:
        sentence = f"cubic {broken[0] + 1} does not begin where the one before it ends: a stroke is one line"
        raise Error(sentence, where=id, code="wrong-type")
    return cubics


def _not_cubics_error(id: str) -> Error:
    sentence = "cubics are an array of shape (n, 4, 2), (n, 8) or, complex, (n, 4)"
    return Error(sentence, where=id, code="wrong-type")


def _need_short_list(path, id: str, levels: int = 3) -> int:
    """Return the number of entries of a list, and refuse a list that is too long.

    Raises Error before numpy allocates memory for more entries than are ever read.
    """
    if not hasattr(path, "__len__") or isinstance(path, str | bytes):
        return 1
    if levels == 0:
        raise _not_cubics_error(id)
    count = path.size if isinstance(path, np.ndarray) else len(path)
    if not isinstance(path, np.ndarray) and count <= _core.MAX_ENTRIES:
        count = 0
        for each in path:
            count += _need_short_list(each, id, levels - 1)
            if count > _core.MAX_ENTRIES:
                break
    if count > _core.MAX_ENTRIES:
        sentence = f"a list has {count} entries, but at most {_core.MAX_ENTRIES} are allowed"
        raise Error(sentence, where=id, value=count, range=(0, _core.MAX_ENTRIES), code="list-too-long")
    return count


def _meets(end: np.ndarray, start: np.ndarray) -> bool:
    # Rounding may part one point by this much.
    return bool(np.abs(end - start).max() <= 1e-6)
