"""Timeline -> one HTML page that plays it, without network or library: the page's script draws what stands here."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np

from ..machine.paint_reload import PlanInLoads
from .timeline import Timeline

PAGE = Path(__file__).parents[1] / "data" / "page"
SCRIPTS = ("rows.js", "footprint.js", "layers.js", "drawing.js", "controls.js")  # one script, in this order
FINE, COARSE = 1000, 100  # whole numbers are written: ms, mrad, outlines in um; lengths in 0.01 mm, pull in %


def animation(
    moves: Timeline, loads: PlanInLoads, brush, marks, target: list, stations, title: str, speed: float
) -> bytes:
    """Return the page of the animation.

    marks: of the loads, with outlines; target: rings [mm] of the drawing, [] if it is not known; speed: how many times
    faster than the robot it plays at first.
    """
    data = {
        "title": title,
        "brush": brush.name,
        "speed": speed,
        "sheet": list(loads.sheet_mm),
        "wanted": [_rings(rings) for rings in target],
        "stations": [[station.name, *station.place_mm] for station in stations],
        "passes": [
            {"name": a_pass.stroke, "colour": a_pass.colour, "rings": _rings(trace.outline_mm)}
            for a_pass, trace in zip(loads.loads, marks.passes, strict=True)
        ],
        "chapters": [[chapter.title, chapter.first_row, chapter.trace] for chapter in moves.chapters],
        "pauses": [[pause.start_s, pause.end_s, pause.message] for pause in moves.pauses],
        "dragged": _outlines(brush.footprints.dragged),
        "pressed": _outlines(brush.footprints.pressed),
        "rows": _rows(moves, brush),
    }
    # < is written as an escape: no title can end the element that the data stands in, or begin another
    text = json.dumps(data, separators=(",", ":")).replace("<", "\\u003c")
    page = _part("page.html").replace("/*STYLE*/", _part("page.css"))
    page = page.replace("/*SCRIPT*/", "\n".join(map(_part, SCRIPTS)))
    return page.replace("/*DATA*/", text).encode()


def _part(name: str) -> str:
    return (PAGE / name).read_text(encoding="utf-8")


def _rows(moves: Timeline, brush) -> dict[str, list[int]]:
    """Columns of steps from row to row, whole numbers. In the air the brush's columns stay at 0."""
    touching = ~np.isnan(moves.depth_mm)
    gap_mm = [brush.tip_gap(depth) for depth in moves.depth_mm[touching].tolist()]
    columns = {
        "t": moves.time_s * FINE,
        **dict(zip("xyz", moves.tcp_mm.T * COARSE, strict=True)),
        "on": touching,
    }
    on_paper = {
        "px": moves.contact_mm[touching, 0] * COARSE,
        "py": moves.contact_mm[touching, 1] * COARSE,
        "heading": moves.heading_rad[touching] * FINE,
        "depth": moves.depth_mm[touching] * COARSE,
        "pull": moves.pull[touching] * COARSE,
        "gap": np.array(gap_mm) * COARSE,
    }
    return {name: _steps(column) for name, column in (columns | on_paper).items()}


def _steps(values) -> list[int]:
    return np.diff(np.round(values).astype(np.int64), prepend=0).tolist()


def _rings(rings) -> list[list[int]]:
    """Each ring as x, y, x, y, ... in 0.01 mm: its first point, then steps."""
    found = []
    for ring in rings:
        points = np.round(np.asarray(ring) * COARSE).astype(np.int64)
        steps = np.diff(points, axis=0, prepend=np.zeros((1, 2), np.int64))
        steps = steps[np.r_[True, steps[1:].any(axis=1)]]
        if len(steps) > 2:
            found.append(steps.ravel().tolist())
    return found


def _outlines(footprints) -> list[list]:
    """Depth [mm] and the outline's x, y, x, y, ... in um."""
    return [
        [each.depth_mm, np.round(np.asarray(each.outline_mm) * FINE).astype(int).ravel().tolist()]
        for each in footprints
    ]
