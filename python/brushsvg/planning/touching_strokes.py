"""Strokes that touch are one letter: refined strokes, each better by itself, may make a worse one."""

from __future__ import annotations

from .. import _core

# Of a letter's overlap, a full turn of its outline beyond that in closed form, and a thorn more.
CALM, THORN = 0.15, 0.03
# Strokes of a letter. Larger groups are words of script: each of their strokes would be tried against all of the word.
MOST = 12


def worse(refined: list, closed: list, targets: list, brush, groups: list[list[int]]) -> list[int]:
    """Numbers of the strokes of those groups, such as letters, that refined passes paint worse than those in closed
    form.

    targets: what the passes should become, one each. Groups are judged by the overlap of all they paint with all
    targets, as in the report, and by how calm their outline is. Where a letter is the calmer without some of its
    refined strokes, by more than it loses of overlap, those are worse.
    """
    first, second = (_core.simulate(_core.Plan(passes=each), brush).passes for each in (refined, closed))
    found = []
    for members in groups:
        members_targets = [targets[k] for k in members]
        now, then = (
            _core.common_area([marks[k] for k in members], members_targets, brush)
            for marks in (first, second)
        )
        if now.overlap < then.overlap:
            found += members
        elif 1 < len(members) <= MOST:  # single ones were looked at when they were refined
            found += _restless(members, first, second, members_targets, brush)
    return found


def _restless(members: list[int], refined: list, closed: list, members_targets: list, brush) -> list[int]:
    """Those of a letter's strokes without whose refined marks it looks better, one after the other."""
    shape = _core.unite([ring for each in members_targets for ring in _core.wanted_outline(each, 0.01)])

    def restless(marks: list) -> tuple[float, int]:
        whole = _core.Marks()
        whole.passes = marks
        _core.trace_outlines(whole, brush)
        return _core.excess_turning(whole.outline_mm, shape), _core.thorns(whole.outline_mm, shape)

    turning, thorns = restless([closed[k] for k in members])

    def cost(marks: list) -> float:
        turns, has = restless(marks)
        return CALM * max(0.0, turns - turning) + THORN * max(0, has - thorns)

    def overlap(marks: list) -> float:
        return _core.common_area(marks, members_targets, brush).overlap

    marks, found = [refined[k] for k in members], []
    best = overlap(marks) - (paid := cost(marks))
    for place, k in enumerate(members):
        if paid == 0.0:
            break
        without = [*marks[:place], closed[k], *marks[place + 1 :]]
        less = cost(without)
        if (reached := overlap(without) - less) > best:
            marks, best, paid = without, reached, less
            found.append(k)
    return found
