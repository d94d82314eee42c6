"""Make the moves of a visit to a paint station: dip, stir, drip and wipe."""

from __future__ import annotations

import numpy as np

from .cells.cell import Cell, Station, shorten_visit
from .limits.speeds import touching_mm_s
from .moves import Move, Section, Wait
from .posts.text import make_unique_names
from .stroke_moves import approach_mm_s, point_above, safe_point_above


def names_of_stations(cell: Cell) -> dict[Station, str]:
    """Return a unique name for each station and for each short visit."""
    stations = list(
        dict.fromkeys(visited for station in cell.stations for visited in (station, shorten_visit(station)))
    )
    names = make_unique_names([station.name for station in stations])
    return dict(zip(stations, names, strict=True))


def make_visit(station: Station, brush, cell: Cell) -> Section:
    """Make the moves to the paint and back up to the safe height.

    At a station that is served by hand, a person does the rest.
    """
    name = names_of_stations(cell).get(station, station.name)
    speeds = cell.speeds
    if not station.place_mm:
        return Section(f"paint: {name}", (Wait(None, f"take the {name}"),))
    steps = [Move("travel", safe_point_above(station.place_mm, cell), speeds.travel_mm_s)]
    if station.by_hand:
        return Section(f"paint: {name}", (*steps, Wait(None, f"dip the brush: {name}")))
    # a vessel may be lower than the paper, but no move below the paper's height is fast
    rim_mm = max(station.rim_mm, 0.0) + cell.heights.clearance_mm
    press_mm_s = min(speeds.press_mm_s, touching_mm_s(brush, cell))
    steps += [
        Move("approach", point_above(station.place_mm, rim_mm), approach_mm_s(brush, cell)),
        Move("dip", point_above(station.place_mm, station.surface_mm - station.depth_mm), press_mm_s),
    ]
    if station.stir_mm:
        steps.append(Move("dip", _stir_circles(station), press_mm_s))
    steps += [Wait(station.hold_s)] if station.hold_s else []
    steps.append(Move("dip", point_above(station.place_mm, rim_mm), press_mm_s))
    steps += [Wait(station.drip_s)] if station.drip_s else []
    last_mm = station.place_mm
    if station.wipe_mm:
        steps.append(Move("wipe", np.array(station.wipe_mm, dtype=float), press_mm_s))
        last_mm = station.wipe_mm[-1]
        if last_mm[2] < rim_mm:
            steps.append(Move("dip", point_above(last_mm, rim_mm), press_mm_s))
    steps.append(Move("retract", safe_point_above(last_mm, cell), speeds.travel_mm_s))
    return Section(f"paint: {name}", tuple(steps))


POINTS_PER_STIR_CIRCLE = 24


def _stir_circles(station: Station) -> np.ndarray:
    """Return points (n, 3) [mm] of circles in the paint, which end in the middle."""
    turn = np.linspace(0, 2 * np.pi * station.stir_turns, POINTS_PER_STIR_CIRCLE * station.stir_turns + 1)
    x, y = station.place_mm
    circles = np.column_stack([x + station.stir_mm * np.cos(turn), y + station.stir_mm * np.sin(turn)])
    places = np.vstack([circles, [x, y]])
    return np.column_stack([places, np.full(len(places), station.surface_mm - station.depth_mm)])
