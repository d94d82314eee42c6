"""When the brush fetches paint: which stations are visited before which stroke."""

from __future__ import annotations

import numpy as np

from .cell import Cell, Station
from .errors import Error


def visits(plan, cell: Cell, first_stroke: int = 1) -> tuple[tuple[Station, ...], ...]:
    """For each pass the stations to visit before it; () for a cell without paint.

    Paint is fetched before the first stroke, before every change of colour or layer where that is asked for, and
    where what is on the brush would not last. Error for a colour that no station serves.
    """
    if not cell.reload:
        return ()
    found, last, used_mm = [], None, 0.0
    for number, a_pass in enumerate(plan.passes, 1):
        length_mm = float(np.linalg.norm(np.diff(np.asarray(a_pass.poses_mm), axis=0), axis=1).sum())
        station = _station_for(a_pass, cell)
        if number < first_stroke:
            found.append(())
            continue
        changed = last is not None and _station_for(last, cell) != station
        if last is None or changed or _is_due(a_pass, last, used_mm + length_mm, cell):
            wash = [each for each in cell.stations if each.name == cell.reload.wash]
            found.append((*wash, station) if changed else (station,))
            used_mm = 0.0
        else:
            found.append(())
        used_mm += length_mm
        last = a_pass
    return tuple(found)


def _is_due(a_pass, last, used_mm: float, cell: Cell) -> bool:
    if cell.reload.when == "stroke":
        return True
    if cell.reload.when == "layer":
        return a_pass.layer != last.layer
    return used_mm > cell.reload.every_mm


def _station_for(a_pass, cell: Cell) -> Station:
    colour = a_pass.colour.lower()
    stations = [station for station in cell.stations if station.name != cell.reload.wash]
    for station in stations:
        if colour in [each.lower() for each in station.colours]:
            return station
    for station in stations:
        if not station.colours:
            return station
    served = ", ".join(colour for station in stations for colour in station.colours)
    raise Error(
        f"no station of cell {cell.name} has paint of colour {colour or 'none'}; there are {served}",
        a_pass.stroke,
    )
