"""Strokes to a plan as options ask for, and strokes begun where the tool may be."""

from __future__ import annotations

from copy import copy

from ... import _core
from ...machine.paint_reload import in_loads
from ...machine.preflight import within_limits
from ...machine.program import POSES_KEPT, Job
from ..options import Options
from ..work import KnownSimulation


def make_compensation(brush, sheet_mm, options: Options, stage=lambda text: None):
    """What compensates strokes, by default as the options ask for, or in closed form where that is to be refined."""
    first = "closed" if options.compensation == "refined" else options.compensation

    def compensated(some, method=first):
        return _core.compensate(
            some,
            brush,
            sheet_mm,
            method,
            options.tolerance_mm,
            options.lag_mm,
            options.speed_mm_s,
            progress=lambda now, all_: stage(f"compensated {now} of {all_} strokes"),
            start=options.start,
            end=options.end,
        )

    return compensated


def fit_ends_to_machine(
    painted: list, brush, plan, compensated, options: Options, stage, added: frozenset[str] = frozenset()
) -> tuple[list, KnownSimulation | None]:
    """The strokes, with plainer terminals where "auto" chose some that the machine cannot run. A round start is landed
    on the far side, where the tool may not be allowed, and its front may be wider than the drawing; at a butt terminal
    the tool moves sideways. Added strokes, given by their ids, are left out where they cannot be run: their areas stay
    unpainted. The list itself where all can be run. Also the simulated plan, if it was simulated and is
    small enough to keep.
    """

    def tried(of) -> KnownSimulation:
        loads = in_loads(of, brush, options.cell)
        marks = _core.simulate(
            of, brush, progress=lambda now, all_: stage(f"simulated {now} of {all_} strokes")
        )
        walk = within_limits(loads, brush, marks, options.cell, Job(options.z_offset_mm))
        return KnownSimulation(copy(of), marks, walk)

    def astray(of: KnownSimulation) -> set[str]:
        return {problem.where for problem in of.walk.problems}

    choosing = [stroke for stroke in painted if "auto" in _get_requested_ends(stroke, options)]
    if not choosing and not added:
        return painted, None
    whole = tried(plan)
    left = {stroke.id for stroke in choosing} & astray(whole)
    found = {}
    for plain in (
        {"end": "round"},
        {"start": "round"},
        {"start": "round", "end": "round"},
        {"start": "pointed", "end": "round"},
    ):
        some = {
            stroke.id: _replace_auto_ends(stroke, options, plain) for stroke in choosing if stroke.id in left
        }
        fits = some.keys() - astray(tried(compensated(list(some.values())).plan)) if some else set()
        found |= {name: some[name] for name in fits}
        left -= fits
    is_little = sum(len(run.poses_mm) for run in plan.passes) <= POSES_KEPT
    no_room = added & astray(whole) - found.keys()
    if not found and not no_room:
        return painted, whole if is_little else None
    return [found.get(stroke.id, stroke) for stroke in painted if stroke.id not in no_room], None


def _get_requested_ends(stroke, options: Options) -> tuple[str, str]:
    return stroke.settings.start or options.start, stroke.settings.end or options.end


def _replace_auto_ends(stroke, options: Options, plain: dict[str, str]):
    """The stroke with these terminals, where it would choose."""
    said = {name: getattr(stroke.settings, name) or getattr(options, name) for name in plain}
    chosen = {name: plain[name] for name, value in said.items() if value == "auto"}
    return stroke.replaced(settings=stroke.settings.replaced(**chosen))
