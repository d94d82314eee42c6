"""Refined passes, taken where they are better than those in closed form.

They aim at the marks that a brush can reach, stay within a machine's limits, and make no letter worse.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .. import _core
from ..errors import Notice
from .touching_strokes import find_worse_strokes

# Greatest mean of the half width that a stroke's target has more than the brush, as a share of the brush's greatest
# half width. At 0.1 of it a bar's middle waves by 0.2 mm to cover more of a shape that is too wide anyway, at 0.2
# by 0.5 mm, at 2 it becomes a C. Letters that are too wide only at their crossings stay below; without their
# outlines they would lose 0.007 of overlap.
MAX_EXCESS_WIDTH = 0.1


@dataclass(frozen=True)
class Refined:
    """The refined passes of strokes, with one entry of each list per pass.

    passes, tracking_errors: of each stroke; moved: whether the pass differs from the one in closed form; kept: the
    reason if it does not.
    """

    passes: list
    tracking_errors: list
    moved: list[bool]
    kept: list[str]

    def nothing_moved(self) -> Notice | None:
        """Return a notice if all passes are those in closed form, with the reasons."""
        if any(self.moved) or not self.moved:
            return None
        count = {why: self.kept.count(why) for why in self.kept}
        counts = (f"for {n} {'stroke' if n == 1 else 'strokes'} {why}" for why, n in count.items())
        return Notice(
            "",
            f"refining changed nothing, the plan is the one of closed compensation: {', '.join(counts)}",
            code="flag-without-effect",
            about="compensation",
        )


# Reasons why a stroke keeps its pass in closed form.
NO_GAIN = "no path was found that paints the drawing better"
FORBIDDEN = "a refined path would break a limit of the cell or the sheet"
WORSE = "a refined path would paint the letter worse"


def refine_where_better(painted: list, targets: list, brush, closed, compensated, forbidden=None) -> Refined:
    """Return refined passes where they are allowed and paint no letter worse.

    Other strokes keep their passes in closed form. painted: strokes that the brush can paint; targets: what they
    should become; closed: their compensation in closed form; compensated: a function of strokes and method, with
    the result of _core.compensate; forbidden: a function from a plan to the sentences that forbid it.
    """
    aims = [limit_target_to_reach(*pair, brush) for pair in zip(painted, targets, strict=True)]
    done = compensated(aims, "refined")
    passes, tracking_errors, moved = list(done.plan.passes), list(done.tracking_errors), [True] * len(painted)
    kept = [""] * len(painted)
    fallback = list(zip(closed.plan.passes, closed.tracking_errors, strict=True))

    def keep_closed(numbers, why):
        for k in numbers:
            passes[k], tracking_errors[k] = fallback[k]
            moved[k], kept[k] = False, kept[k] or why

    def worse_of(groups):
        return find_worse_strokes(passes, closed.plan.passes, targets, brush, groups)

    unchanged = [k for k, (other, _) in enumerate(fallback) if np.array_equal(passes[k].poses_mm, other.poses_mm)]
    keep_closed(unchanged, NO_GAIN)
    if forbidden:
        keep_closed(_find_forbidden(passes, closed.plan, moved, forbidden), FORBIDDEN)
    if redirected := [[k] for k, aim in enumerate(aims) if aim is not painted[k]]:
        # Refinement judged these strokes by other targets.
        keep_closed(worse_of(redirected), WORSE)
    keep_closed(worse_of(_core.group_touching(targets)), WORSE)
    return Refined(passes, tracking_errors, moved, kept)


def limit_target_to_reach(painted, target, brush):
    """Return the target of refinement for a stroke.

    These are its discs alone, if the outline in which it was found is far too wide. All of the shape next to the
    paint would pull the stroke's line to it.
    """
    if not painted.target_mm or not brush.width_follows_depth():
        return painted
    greatest = brush.half_width_range_mm()[1]
    half = np.interp(np.linspace(0, 1, 101), *np.array(target.half_width).T)
    if np.maximum(half - greatest, 0).mean() <= MAX_EXCESS_WIDTH * greatest:
        return painted
    return painted.replaced(target_mm=[])


def _find_forbidden(passes: list, closed, moved: list[bool], forbidden) -> list[int]:
    """Return the numbers of refined passes that break more limits than closed form."""

    def sentences(*some) -> list:
        return forbidden(_core.Plan(closed.brush, closed.brush_sha256, closed.sheet_mm, list(some)))

    if not sentences(*passes):
        return []
    return [
        k
        for k, (mine, other) in enumerate(zip(passes, closed.passes, strict=True))
        if moved[k] and (broken := sentences(mine)) and len(sentences(other)) < len(broken)
    ]
