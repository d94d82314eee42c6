"""When the brush fetches paint: which stations are visited before which stroke, and where a long one is interrupted."""

from __future__ import annotations

import math
from contextlib import suppress
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from .. import _core
from ..errors import Error, Notice
from ..geometry.polylines import length, lengths
from .cells.cell import Cell, Station, reason_for_no_waiting, robot_from_paper, shorten_visit
from .frames import is_upright
from .posts import POSTS, circles_by
from .realised.arc_chords import chords, cut_at_extremes, with_chords
from .realised.distortion import goes_straight, in_lines_mm, is_similar
from .realised.retimed import on_way
from .realised.tilt import in_steps, refuse_where_upright
from .tool_axes import axes_of, unit


@dataclass(frozen=True)
class PlanInLoads:
    """A plan as a machine runs it: each stroke in one or more passes, between which paint can be fetched.

    Not a plan, which its names show: what is counted here are loads, not strokes, and none is cut again. Of a part
    load says which of its stroke it is, in a plan.json, too: as a rule plans are kept as they were planned, and cut for
    the machine.
    """

    sheet_mm: tuple[float, float]
    loads: tuple
    lasts_mm: float = math.inf  # of a brush that says so, on a cell that counts the way

    def strokes(self) -> list[str]:
        """For each load the stroke that it paints, or a part of."""
        names: list[str] = []
        for a_pass in self.loads:
            names.append(names[-1] if is_later_part(a_pass) else a_pass.stroke)
        return names

    def left(self, first_stroke: int) -> PlanInLoads:
        """The loads from that one on, counted from 1."""
        return PlanInLoads(self.sheet_mm, self.loads[first_stroke - 1 :], self.lasts_mm)

    def as_plan(self):
        """For who simulates what is run."""
        return _core.Plan(sheet_mm=self.sheet_mm, passes=list(self.loads))


def in_loads(plan: _core.Plan, brush: _core.Brush, cell: Cell) -> PlanInLoads:
    """Every stroke that is longer than one load of paint lasts in parts: stroke, stroke+2, ...

    Whole are all strokes of cells that do not count the length, and those whose setting reload is false. What is a part
    Whole are strokes already cut: a part stays as it is. What begins or ends below the paper is set down and lifted
    there. For a machine without circles, arcs have poses enough for lines; where its axes have backlash, arcs end where
    one turns back; where the cell has a map of the paper or a field, lines have enough for that.
    Where the brush turns, there are poses enough for a robot that turns evenly between them. Error for a part that does
    not follow the one before it, and for a tilted brush where the cell cannot tilt it.
    """
    refuse_where_upright(plan.passes, cell)
    loads, last, lasts_mm = list(plan.passes), None, math.inf
    for a_pass in loads:
        if is_later_part(a_pass) and (last is None or last.load != a_pass.load - 1):
            number = a_pass.load
            sentence = f"load {number} of a stroke stands where no load {number - 1} of it comes before"
            raise Error(sentence, a_pass.stroke, code="load-out-of-order")
        last = a_pass
    if cell.reload and cell.reload.when == "length":
        every_mm, back_mm = load_lasts_mm(brush, cell), cell.reload.backtrack_mm
        lasts_mm = every_mm if brush.paint else math.inf
        loads = []
        for a_pass in plan.passes:
            whole = painted_mm(a_pass) <= every_mm or a_pass.settings.reload is False or a_pass.load > 0
            loads += [a_pass] if whole else _core.interrupted(a_pass, brush, every_mm, every_mm, back_mm)
    if not _writes_circles(cell):
        loads = map(with_chords, loads)
    elif cell.machine and any(cell.machine.backlash_mm):
        axes = robot_from_paper(cell)[:2, 0]
        loads = (cut_at_extremes(each, float(np.arctan2(axes[1], axes[0]))) for each in loads)
    if not goes_straight(cell.machine):
        loads = (_in_lines(each, cell.machine) for each in map(in_steps, loads))
    else:
        loads = map(in_steps, loads)
    return PlanInLoads(tuple(plan.sheet_mm), tuple(map(_from_paper_to_paper, loads)), lasts_mm)


def _in_lines(a_pass, machine):
    axes = axes_of(a_pass)
    rows = in_lines_mm(
        np.asarray(a_pass.poses_mm if axes is None else np.hstack([a_pass.poses_mm, axes])), machine
    )
    return on_way(a_pass, rows[:, :3], (), None if axes is None else unit(rows[:, 3:]))


def load_lasts_mm(brush: _core.Brush, cell: Cell) -> float:
    """The way that a load of paint lasts, for a cell that counts it: its own, until the brush's hairs run dry, and
    until marks are as much narrower as the cell allows, whichever is the shortest. Error where no part could be so
    short."""
    reload = cell.reload
    ways = [reload.every_mm]
    if brush.paint and brush.paint.lasts_mm:
        ways.append(brush.paint.lasts_mm)
    if brush.paint and reload.narrower_percent:
        ways.append(brush.paint.way_to_share_mm(1 - reload.narrower_percent / 100))
    if min(ways) <= 2 * reload.backtrack_mm:
        sentence = (
            f"paint of brush {brush.name} lasts for {min(ways):.1f} mm on cell {cell.name}, which must be more than "
            f"twice backtrack_mm {reload.backtrack_mm:g}"
        )
        raise Error(sentence, code="load-too-short")
    return min(ways)


def without_paint(brush: _core.Brush, cell: Cell) -> list[Notice]:
    """A notice where the cell allows marks to get narrower, and the brush does not say that they do."""
    if not cell.reload or not cell.reload.narrower_percent or brush.paint:
        return []
    sentence = (
        f"brush {brush.name} does not say how its marks narrow: narrower_percent of the cell has no effect"
    )
    return [Notice("", sentence, code="paint-unknown", advice='measure it: "paint" of a brush file')]


def _writes_circles(cell: Cell) -> bool:
    """On paper that leans a robot's circles would be in no plane that it knows, and a machine that is commanded other
    places than the true ones may need ellipses."""
    post = POSTS.get(cell.language)
    if not is_similar(cell.machine):
        return False
    if not circles_by(cell):
        return False
    return not post or not post.in_robot_frame or is_upright(robot_from_paper(cell))


def _from_paper_to_paper(a_pass):
    """The pass; where it begins or ends below the paper, set down or lifted on the spot there."""
    poses = np.asarray(a_pass.poses_mm)
    below = poses[[0, -1], 2] < 0 if len(poses) else np.zeros(2, dtype=bool)
    if not below.any():
        return a_pass
    ends = poses[[0, -1]] * (1, 1, 0) + 0.0  # no -0
    before, after = ends[:1][below[:1]], ends[1:][below[1:]]
    arcs = [
        _core.Arc(arc.first + len(before), arc.last + len(before), arc.centre_mm, arc.direction)
        for arc in a_pass.arcs
    ]
    axes = np.asarray(a_pass.tool_axes).reshape(-1, 3)
    if len(axes):
        axes = np.vstack([axes[:1][below[:1]], axes, axes[-1:][below[1:]]])
    return on_way(a_pass, np.vstack([before, poses, after]), arcs, axes)


def too_long(loads: PlanInLoads, brush: _core.Brush, cell: Cell) -> list[Notice]:
    """A notice of the stroke for parts that are longer than a load of paint lasts, unless they may not be cut."""
    if not cell.reload or cell.reload.when != "length":
        return []
    every_mm, deepest_mm = load_lasts_mm(brush, cell), brush.depth_range_mm[1]
    last_mm = every_mm + brush.lag(deepest_mm) + deepest_mm  # the lift comes back over its own mark
    sentence = "mm are painted without a place where the brush could be lifted, the range is [0,"
    return [
        Notice(
            a_pass.stroke,
            f"{length_mm:.0f} {sentence} {every_mm:.4g}] mm of a load of paint",
            code="load-too-long",
        )
        for a_pass in loads.loads
        if (length_mm := painted_mm(a_pass)) > last_mm and a_pass.settings.reload is not False
    ]


def visits(loads: PlanInLoads, cell: Cell, first_stroke: int = 1) -> tuple[tuple[Station, ...], ...]:
    """For each load the stations to visit before it, none before loads that are not run; () for a cell without paint
    and for strokes of one colour, or where nobody can be waited for.

    Paint is fetched before the first stroke, before every change of colour, before every stroke or layer where the
    cell says so, and where what is on the brush would not last. More paint of the same colour is a short visit. A
    stroke's setting reload asks for paint or goes without. Error for a colour that no station serves.
    """
    if not cell.reload:
        return _pens(loads, cell, first_stroke) if may_pause(cell) else ()
    painted, due = loads.loads[: first_stroke - 1], loads.loads[first_stroke - 1 :]
    found, last, used_mm = [()] * len(painted), None, 0.0
    with suppress(Error):  # what no station serves is not on the brush
        last = painted[-1] if painted and _station_for(painted[-1], cell) else None
    for number, a_pass in enumerate(due, len(painted) + 1):
        station = _station_for(a_pass, cell)
        length_mm = painted_mm(a_pass)
        changed = last is not None and _station_for(last, cell) != station
        wash = [each for each in cell.stations if each.name == cell.reload.wash]
        fetch = (
            last is None
            or changed
            or number == first_stroke
            or _is_due(a_pass, last, used_mm + length_mm, cell.reload, loads.lasts_mm)
        )
        if last is not None and not changed and number != first_stroke:
            wash, station = (
                [shorten_visit(each) for each in wash if cell.reload.rinse],
                shorten_visit(station),
            )
        elif not changed:
            wash = []
        found.append((*wash, station) if fetch else ())
        used_mm = length_mm + (0.0 if fetch else used_mm)
        last = a_pass
    return tuple(found)


def dips_mm(passes, loads: PlanInLoads, cell: Cell) -> list[list[float]]:
    """For each pass the ways [mm] of the TCP along it at which paint was just fetched, as `narrow` takes them.

    passes: of the plan, or the loads themselves. Where no cell fetches paint every pass begins freshly dipped but those
    that are to be painted without: with what the pass before them left.
    """
    if not cell.reload:
        return dips_without_cell(passes)
    requested, found, k = visits(loads, cell), [], 0
    for a_pass in passes:
        dips = [0.0] if requested[k] else []
        k += 1
        while not a_pass.load and k < len(loads.loads) and is_later_part(loads.loads[k]):
            dips.append(_begins_at_mm(a_pass, loads.loads[k], dips[-1] if dips else 0.0))
            k += 1
        found.append(dips)
    return found


def fetched_mm(plan: _core.Plan, brush: _core.Brush, cell: Cell | None) -> list[list[float]]:
    """The same of a plan's passes, with a cell or without."""
    if cell:
        with suppress(Error):  # a colour that no station serves is reported where a program is made
            return dips_mm(plan.passes, in_loads(plan, brush, cell), cell)
    return dips_without_cell(plan.passes)


def dips_without_cell(passes) -> list[list[float]]:
    """The same where nobody fetches paint by a program."""
    return [[] if k and each.settings.reload is False else [0.0] for k, each in enumerate(passes)]


def _begins_at_mm(stroke, part, after_mm: float) -> float:
    """The way along a stroke at which one of its parts begins, its landing counted: by the moves that both share, and
    that are further along the stroke than the part before began. Where there is none, by its first pose."""
    line, poses = (chords(np.asarray(each.poses_mm), each.arcs)[:, :2] for each in (stroke, part))
    along, way = lengths(line), lengths(poses)
    start, step = line[:-1], np.diff(line, axis=0)
    size = np.maximum((step**2).sum(axis=1), 1e-18)
    share = np.clip((((poses[:, None] - start) * step).sum(axis=2)) / size, 0.0, 1.0)
    off = np.linalg.norm(start + share[..., None] * step - poses[:, None], axis=2)
    place = along[:-1] + share * np.sqrt(size)
    off[place <= after_mm] = np.inf
    nearest = off.argmin(axis=1)
    rows = np.arange(len(poses))
    at, off = place[rows, nearest], off[rows, nearest]
    shared = (off[:-1] < SHARED_MM) & (off[1:] < SHARED_MM) & (np.abs(np.diff(at) - np.diff(way)) < SHARED_MM)
    begins = (at - way)[:-1]
    if not shared.any():
        return float(max(at[0], after_mm + SHARED_MM))
    return float(max(np.median(begins[shared]), after_mm + SHARED_MM))


SHARED_MM = (
    0.02  # arcs of both are cut into chords at other places, which are up to 0.01 mm off their circles
)


def may_pause(cell: Cell) -> bool:
    """Whether the program stops for another pen, or takes it by itself."""
    return cell.pause_per_colour and (has_pens(cell) or not reason_for_no_waiting(cell))


def has_pens(cell: Cell) -> bool:
    """Whether the machine takes pens of several colours by itself."""
    return bool(cell.pen and cell.pen.colours)


def pen(colour: str) -> Station:
    """Wait for a person, or the plotter, to change the pen or brush: at the safe height, from any place."""
    return Station(f"pen {colour.lower().lstrip('#')}", (), by_hand=True)


def _pens(loads: PlanInLoads, cell: Cell, first_stroke: int) -> tuple[tuple[Station, ...], ...]:
    if has_pens(cell):
        return _pens_of_plotter(loads, cell, first_stroke)
    changed = [False] + [
        bool(a.colour and b.colour) and a.colour.lower() != b.colour.lower() for a, b in pairwise(loads.loads)
    ]
    changed[:first_stroke] = [False] * len(
        changed[:first_stroke]
    )  # with which one it begins the person sees to
    if not any(changed):
        return ()
    return tuple(
        (pen(a_pass.colour),) if is_new else () for a_pass, is_new in zip(loads.loads, changed, strict=True)
    )


def _pens_of_plotter(loads: PlanInLoads, cell: Cell, first_stroke: int) -> tuple[tuple[Station, ...], ...]:
    """The first pen is taken, too. Strokes without a colour are drawn with pen 1. Error for a colour that none has."""
    colours = [colour.lower() for colour in cell.pen.colours]
    found, last = [()] * (first_stroke - 1), ""
    for a_pass in loads.loads[first_stroke - 1 :]:
        colour = a_pass.colour.lower() or colours[0]
        if colour not in colours:
            raise Error(
                f"no pen of cell {cell.name} has colour {colour}; there are {', '.join(colours)}",
                a_pass.stroke,
                code="colour-not-served",
            )
        found.append((pen(colour),) if colour != last else ())
        last = colour
    return tuple(found)


def pens_changed(loads: PlanInLoads, cell: Cell, first_stroke: int = 1) -> int:
    """How often strokes ask for another pen than the one before, on a cell without paint."""
    taken = () if cell.reload else _pens(loads, cell, first_stroke)
    return sum(map(bool, taken)) - (1 if taken and has_pens(cell) else 0)


def with_one_pen(loads: PlanInLoads, cell: Cell, first_stroke: int = 1) -> list[Notice]:
    """Return a notice if strokes of several colours are painted in one run without an explicit option."""
    if not cell.pause_per_colour or may_pause(cell) or not pens_changed(loads, cell, first_stroke):
        return []
    sentence = f"strokes of several colours are painted with one pen: {reason_for_no_waiting(cell)}"
    return [Notice("", sentence, code="colours-as-one", advice="--per-colour writes a program for each")]


def painted_mm(a_pass: _core.Pass) -> float:
    """Length of the TCP's path on the paper [mm]."""
    poses = np.asarray(a_pass.poses_mm)
    return length(chords(poses, a_pass.arcs) if len(a_pass.arcs) else poses)


def _is_due(a_pass, last, used_mm: float, reload, lasts_mm: float) -> bool:
    if is_later_part(a_pass):
        return True
    requested = a_pass.settings.reload
    if requested is not None:
        return requested
    if reload.when == "stroke":
        return True
    if reload.when == "layer":
        return a_pass.layer != last.layer
    return used_mm > min(reload.every_mm, lasts_mm)


def is_later_part(a_pass: _core.Pass) -> bool:
    """Whether a load goes on with the stroke that the load before it paints."""
    return a_pass.load > 1


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
        code="colour-not-served",
    )
