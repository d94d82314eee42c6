"""Compensate strokes as the options request, with ends that the machine can run."""

from __future__ import annotations

from copy import copy

from ... import _core
from ...machine.job_program import POSES_KEPT, Job
from ...machine.paint_reload import split_into_loads
from ...machine.preflight import check_limits
from ..options import Options
from ..prepared_drawing import KnownSimulation


def make_compensation(brush, sheet_mm, options: Options, stage=lambda text: None):
    """Return a function that compensates strokes and returns the result of the core.

    The method is by default the requested one, or closed form if refinement follows.
    """
    default_method = "closed" if options.compensation == "refined" else options.compensation

    def compensated(strokes, method=default_method):
        return _core.compensate(
            strokes,
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
    """Replace automatic ends of strokes that the machine cannot run.

    Where "auto" chose a terminal that the machine cannot run, plainer terminals are tried. A round start lands on
    the far side, where the tool may not be allowed, and its front may be wider than the drawing. At a butt terminal
    the tool moves sideways.

    added: ids of the strokes that the search added. They are left out where they cannot be run, and their areas
        stay unpainted.

    Returns the strokes, and the simulation of the plan. The strokes are the given list itself if all of them can be
    run. The simulation is None if none was made or if it is too large to keep.
    """

    def simulate(a_plan) -> KnownSimulation:
        loads = split_into_loads(a_plan, brush, options.cell)
        marks = _core.simulate(a_plan, brush, progress=lambda now, all_: stage(f"simulated {now} of {all_} strokes"))
        walk = check_limits(loads, brush, marks, options.cell, Job(options.z_offset_mm))
        return KnownSimulation(copy(a_plan), marks, walk)

    def find_refused(simulation: KnownSimulation) -> set[str]:
        return {problem.where for problem in simulation.walk.problems}

    automatic = [stroke for stroke in painted if "auto" in _get_requested_ends(stroke, options)]
    if not automatic and not added:
        return painted, None
    simulated = simulate(plan)
    unresolved = {stroke.id for stroke in automatic} & find_refused(simulated)
    replaced = {}
    for terminals in (
        {"end": "round"},
        {"start": "round"},
        {"start": "round", "end": "round"},
        {"start": "pointed", "end": "round"},
    ):
        candidates = {
            stroke.id: _replace_auto_ends(stroke, options, terminals) for stroke in automatic if stroke.id in unresolved
        }
        fits = (
            candidates.keys() - find_refused(simulate(compensated(list(candidates.values())).plan))
            if candidates
            else set()
        )
        replaced |= {name: candidates[name] for name in fits}
        unresolved -= fits
    is_small = sum(len(run.poses_mm) for run in plan.passes) <= POSES_KEPT
    dropped = added & find_refused(simulated) - replaced.keys()
    if not replaced and not dropped:
        return painted, simulated if is_small else None
    return [replaced.get(stroke.id, stroke) for stroke in painted if stroke.id not in dropped], None


def _get_requested_ends(stroke, options: Options) -> tuple[str, str]:
    return stroke.settings.start or options.start, stroke.settings.end or options.end


def _replace_auto_ends(stroke, options: Options, terminals: dict[str, str]):
    """Return the stroke with these terminals at its automatic ends."""
    requested = {name: getattr(stroke.settings, name) or getattr(options, name) for name in terminals}
    replaced = {name: terminals[name] for name, value in requested.items() if value == "auto"}
    return stroke.replaced(settings=stroke.settings.replaced(**replaced))
