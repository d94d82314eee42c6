"""Vessels that the tool must not enter, at stations where it fetches paint or water."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

import numpy as np

from ...errors import Notice
from ..cells.cell import Cell
from ..moves import Section
from .move_extents import ROUNDING_MM, Ways, find_place_inside, group_sections, make_paths, paths_of_moves


def find_strokes_in_vessels(strokes: Iterable[Section], cell: Cell) -> list[Notice]:
    """Report vessels that strokes enter below the rim. Each notice names the stroke."""
    notices = []
    for group in group_sections(section for section in strokes if section.moves):
        # Most strokes enter no vessel, so the whole group is checked first.
        if find_vessels_entered(paths_of_moves([move for section in group for move in section.moves], None), cell):
            for section in group:
                entered = find_vessels_entered(paths_of_moves(section.moves, None), cell)
                notices += [replace(notice, where=section.name) for notice in entered]
    return notices


def find_vessels_entered(moves: Ways, cell: Cell, slack_mm: float = ROUNDING_MM) -> list[Notice]:
    """Report vessels that moves in the paper's frame enter below the rim. The notices name no stroke yet.

    A vessel counts as the square about its circle.
    """
    notices = []
    for vessel in (station for station in cell.stations if not station.by_hand):
        reach_mm = np.full(2, max(vessel.radius_mm, vessel.stir_mm) - slack_mm)
        low, high = np.array(vessel.place_mm) - reach_mm, np.array(vessel.place_mm) + reach_mm
        place = find_place_inside(moves, (*low, -np.inf), (*high, vessel.rim_mm - slack_mm))
        if place is not None:
            where = ", ".join(f"{axis} {value:.1f}" for axis, value in zip("xyz", place, strict=True))
            sentence = (
                f"the tool goes through {where} mm, in the vessel {vessel.name!r} of cell {cell.name}, which is "
                f"{vessel.radius_mm:g} mm in radius and has its rim at {vessel.rim_mm:g} mm"
            )
            advice = "place it further from the sheet, or correct its radius_mm"
            notices.append(Notice("", sentence, code="vessel-entered", about=vessel.name, advice=advice))
    return notices


def find_vessels_near_travel(cell: Cell, z_offset_mm: float) -> list[Notice]:
    """Report vessels that the tool does not clear at the safe height of lower paper.

    A program lowers the visits to stations together with its strokes, but a vessel on the table stays where it is.

    z_offset_mm: how much higher the paper is than the cell says. Higher paper also raises the safe height.
    """
    top_mm = cell.heights.safe_mm + z_offset_mm - cell.heights.clearance_mm
    return [
        Notice(
            station.name,
            f"rim_mm {station.rim_mm:g} is above {top_mm:g} mm, clearance_mm below the safe height with --z-offset "
            f"{z_offset_mm:g}: a vessel on the table does not move down with the paper",
            code="cell-station",
            advice="raise safe_mm of the cell, or teach the paper again",
        )
        for station in (cell.stations if z_offset_mm < 0 else ())
        if not station.by_hand and station.rim_mm > top_mm + ROUNDING_MM
    ]


def find_stations_on_sheet(cell: Cell, sheet_mm) -> list[Notice]:
    """Report stations that are on the sheet or wipe over it."""
    problems = []
    for station in cell.stations:
        if station.by_hand:
            continue  # the tool stays at the safe height
        width, height = sheet_mm
        on_sheet = (0.0, 0.0, -1.0), (width, height, 1.0)
        path = [(*point[:2], 0.0) for point in (station.place_mm, *station.wipe_mm)]
        (x, y), r = station.place_mm, station.stir_mm
        stirred = [((x + r, y, 0.0), (x + r, y, 0.0), (x, y, 1))] if r else []
        if find_place_inside(make_paths([[point] for point in path], stirred), *on_sheet) is not None:
            sentence = f"its place is on the sheet of {width:g} x {height:g} mm"
            problems.append(Notice(station.name, sentence, code="station-on-sheet"))
        elif find_place_inside(make_paths([path]), *on_sheet) is not None:
            sentence = f"its wipe goes over the sheet of {width:g} x {height:g} mm"
            problems.append(Notice(station.name, sentence, code="station-on-sheet"))
    return problems
