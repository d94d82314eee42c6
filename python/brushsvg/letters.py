"""Strokes that touch are one letter: refined strokes, each better by itself, may make a worse one."""

from __future__ import annotations

from . import _core


def no_letter_worse(refined, closed, wanted: list, brush):
    """(passes, misses) of the refined compensation, but in closed form where a letter as a whole is painted better so.

    refined, closed: what _core.compensate returns for the same strokes; wanted: what those should become, one per pass.
    Letters are strokes whose wanted marks touch; judged by the overlap of all they paint with all that is wanted, as
    the report does.
    """
    passes, misses = list(refined.plan.passes), list(refined.misses)
    first, second = (_core.simulate(done.plan, brush).passes for done in (refined, closed))
    for members in _core.touching(wanted):
        meant = [wanted[k] for k in members]
        now, then = (
            _core.common_area([marks[k] for k in members], meant, brush) for marks in (first, second)
        )
        if now.overlap < then.overlap:
            for k in members:
                passes[k], misses[k] = closed.plan.passes[k], closed.misses[k]
    return passes, misses
