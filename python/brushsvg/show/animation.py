"""Write an HTML page that plays a timeline, without network or library: the page's script draws the data in it."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np

from ..machine.paint_reload import PlanInLoads
from .timeline import Timeline

PAGE_FOLDER = Path(__file__).parents[1] / "data" / "page"
# Joined to one script in this order.
SCRIPTS = ("rows.js", "footprint.js", "canvases.js", "paint_and_tool.js", "controls.js")
# Numbers are written as integers. Fine units are ms, mrad, and um for outlines; coarse units are 0.01 mm for lengths
# and percent for the pull.
FINE_PER_UNIT, COARSE_PER_UNIT = 1000, 100


def animation(
    moves: Timeline, loads: PlanInLoads, brush, marks, target: list, stations, title: str, speed: float
) -> bytes:
    """Return the page of the animation.

    marks: the marks of the loads, with outlines; target: rings [mm] of the drawing, [] if it is not known; speed: the
    initial playing speed, relative to the robot.
    """
    data = {
        "title": title,
        "brush": brush.name,
        "speed": speed,
        "sheet": list(loads.sheet_mm),
        "wanted": [_encode_rings(rings) for rings in target],
        "stations": [[station.name, *station.place_mm] for station in stations],
        "passes": [
            {"name": a_pass.stroke, "colour": a_pass.colour, "rings": _encode_rings(trace.outline_mm)}
            for a_pass, trace in zip(loads.loads, marks.passes, strict=True)
        ],
        "chapters": [[chapter.title, chapter.first_row, chapter.trace] for chapter in moves.chapters],
        "pauses": [[pause.start_s, pause.end_s, pause.message] for pause in moves.pauses],
        "dragged": _encode_footprints(brush.footprints.dragged),
        "pressed": _encode_footprints(brush.footprints.pressed),
        "rows": _encode_rows(moves, brush),
    }
    # "<" is written as an escape, so that no title can end the element that holds the data, or begin another one.
    text = json.dumps(data, separators=(",", ":")).replace("<", "\\u003c")
    page = _read_page_part("page.html").replace("/*STYLE*/", _read_page_part("page.css"))
    page = page.replace("/*SCRIPT*/", "\n".join(map(_read_page_part, SCRIPTS)))
    return page.replace("/*DATA*/", text).encode()


def _read_page_part(name: str) -> str:
    return (PAGE_FOLDER / name).read_text(encoding="utf-8")


def _encode_rows(moves: Timeline, brush) -> dict[str, list[int]]:
    """Return timeline columns as integer steps from row to row; the brush's only on the paper."""
    touching = ~np.isnan(moves.depth_mm)
    gap_mm = [brush.tip_gap(depth) for depth in moves.depth_mm[touching].tolist()]
    columns = {
        "t": moves.time_s * FINE_PER_UNIT,
        **dict(zip("xyz", moves.tcp_mm.T * COARSE_PER_UNIT, strict=True)),
        "on": touching,
    }
    on_paper = {
        "px": moves.contact_mm[touching, 0] * COARSE_PER_UNIT,
        "py": moves.contact_mm[touching, 1] * COARSE_PER_UNIT,
        "heading": moves.heading_rad[touching] * FINE_PER_UNIT,
        "depth": moves.depth_mm[touching] * COARSE_PER_UNIT,
        "pull": moves.pull[touching] * COARSE_PER_UNIT,
        "gap": np.array(gap_mm) * COARSE_PER_UNIT,
    }
    return {name: _encode_steps(column) for name, column in (columns | on_paper).items()}


def _encode_steps(values) -> list[int]:
    return np.diff(np.round(values).astype(np.int64), prepend=0).tolist()


def _encode_rings(rings) -> list[list[int]]:
    """Encode each ring as x, y, x, y, ... in 0.01 mm. The first point is followed by the steps from point to point."""
    encoded = []
    for ring in rings:
        points = np.round(np.asarray(ring) * COARSE_PER_UNIT).astype(np.int64)
        steps = np.diff(points, axis=0, prepend=np.zeros((1, 2), np.int64))
        steps = steps[np.r_[True, steps[1:].any(axis=1)]]
        if len(steps) > 2:
            encoded.append(steps.ravel().tolist())
    return encoded


def _encode_footprints(footprints) -> list[list]:
    """Encode each footprint as its depth [mm] and its outline x, y, x, y, ... in um."""
    return [
        [
            footprint.depth_mm,
            np.round(np.asarray(footprint.outline_mm) * FINE_PER_UNIT).astype(int).ravel().tolist(),
        ]
        for footprint in footprints
    ]
