"""Letters of touching strokes: refined strokes that make their letter worse.

Each refined stroke may be better by itself and still make a worse letter.
"""

from __future__ import annotations

from .. import _core

# Costs in units of a letter's overlap: of a full turn of its outline more than in closed form, and of one more
# thorn.
TURN_COST, THORN_COST = 0.15, 0.03
# Greatest number of strokes of a letter. Larger groups are words of script, and each of their strokes would be
# tried against the whole word.
MAX_STROKES = 12


def find_worse_strokes(refined: list, closed: list, targets: list, brush, groups: list[list[int]]) -> list[int]:
    """Return the numbers of strokes that refined passes paint worse than closed form.

    groups: numbers of strokes that are judged together, such as letters; targets: what the passes should become,
    one each. Groups are judged by the overlap of all they paint with all targets, as in the report, and by how calm
    their outline is. Where a letter becomes calmer without some of its refined strokes, by more than it loses of
    overlap, these strokes are worse.
    """
    first, second = (_core.simulate(_core.Plan(passes=each), brush).passes for each in (refined, closed))
    worse = []
    for members in groups:
        members_targets = [targets[k] for k in members]
        refined_areas, closed_areas = (
            _core.common_area([marks[k] for k in members], members_targets, brush) for marks in (first, second)
        )
        if refined_areas.overlap < closed_areas.overlap:
            worse += members
        elif 1 < len(members) <= MAX_STROKES:  # single strokes were judged when they were refined
            worse += _find_restless(members, first, second, members_targets, brush)
    return worse


def _find_restless(members: list[int], refined: list, closed: list, members_targets: list, brush) -> list[int]:
    """Return a letter's strokes without whose refined marks it is better, one by one."""
    shape = _core.unite([ring for each in members_targets for ring in _core.target_outline(each, 0.01)])

    def measure_turns_and_thorns(marks: list) -> tuple[float, int]:
        whole = _core.Marks()
        whole.passes = marks
        _core.trace_outlines(whole, brush)
        return _core.excess_turning(whole.outline_mm, shape), _core.thorns(whole.outline_mm, shape)

    turning, thorns = measure_turns_and_thorns([closed[k] for k in members])

    def penalty_of(marks: list) -> float:
        turns, has = measure_turns_and_thorns(marks)
        return TURN_COST * max(0.0, turns - turning) + THORN_COST * max(0, has - thorns)

    def overlap(marks: list) -> float:
        return _core.common_area(marks, members_targets, brush).overlap

    marks, worse = [refined[k] for k in members], []
    best = overlap(marks) - (best_penalty := penalty_of(marks))
    for place, k in enumerate(members):
        if best_penalty == 0.0:
            break
        without = [*marks[:place], closed[k], *marks[place + 1 :]]
        penalty = penalty_of(without)
        if (reached := overlap(without) - penalty) > best:
            marks, best, best_penalty = without, reached, penalty
            worse.append(k)
    return worse
