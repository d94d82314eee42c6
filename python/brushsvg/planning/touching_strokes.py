"""Strokes that touch are one letter: refined strokes, each better by itself, may make a worse one."""

from __future__ import annotations

from .. import _core


def worse(refined: list, closed: list, wanted: list, brush, groups: list[list[int]]) -> list[int]:
    """Numbers of the strokes of those groups, such as letters, that refined passes paint worse than those in closed
    form.

    wanted: what the passes should become, one each. Groups are judged by the overlap of all they paint with all that is
    wanted, as the report does.
    """
    first, second = (_core.simulate(_core.Plan(passes=each), brush).passes for each in (refined, closed))
    found = []
    for members in groups:
        meant = [wanted[k] for k in members]
        now, then = (
            _core.common_area([marks[k] for k in members], meant, brush) for marks in (first, second)
        )
        if now.overlap < then.overlap:
            found += members
    return found
