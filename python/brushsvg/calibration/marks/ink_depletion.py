"""Find where the paint of one load ran out, from the whole marks."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ... import _core
from .mark_input import Painted

# A mark is whole if its area over its predicted area exceeds this share of the median ratio.
MIN_WHOLE_SHARE = 0.75


@dataclass(frozen=True)
class InkDepletion:
    """The last whole stroke and the next stroke, which is not whole.

    No later stroke is whole either.

    whole_mm, dry_mm: path length of the TCP on the paper from the dip to the end of each of the two strokes.
    """

    whole: str
    whole_mm: float
    dry: str
    dry_mm: float

    @property
    def variance_mm2(self) -> float:
        """Return the variance of whole_mm. The load may have run out anywhere between the two lengths."""
        return (self.dry_mm - self.whole_mm) ** 2 / 3

    def describe(self) -> str:
        return (
            f"the load ran dry between {self.whole_mm:.0f} mm and {self.dry_mm:.0f} mm: stroke {self.whole} is the "
            f"last whole mark, and {self.dry} and all later strokes are missing or broken. The brush file has the "
            "smaller number as lasts_mm"
        )


def find_ink_depletion(painted: Painted, predicted: list) -> InkDepletion | None:
    """Find the strokes between which the load ran dry.

    Return None if the last stroke of the plan is whole.

    painted: all marks of the sheet, as freshly dipped. predicted: for each mark, the rings that the fitted brush
    paints.
    """
    areas = np.array([_core.area(mark.outline_mm) for mark in painted.marks])
    shares = areas / np.maximum([_core.area(rings) for rings in predicted], 1e-9)
    min_share = MIN_WHOLE_SHARE * np.median(shares)
    whole = {mark.stroke for mark, share in zip(painted.marks, shares, strict=True) if share > min_share}
    strokes = list(painted.before_mm)
    ends = [*list(painted.before_mm.values())[1:], painted.way_mm]
    last = max(k for k, stroke in enumerate(strokes) if stroke in whole)
    if last + 1 == len(strokes):
        return None
    return InkDepletion(strokes[last], ends[last], strokes[last + 1], ends[last + 1])
