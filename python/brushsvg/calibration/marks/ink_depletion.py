"""Where the paint of one load came to its end, by which marks of its sheet are whole."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ... import _core
from .mark_input import Painted

WHOLE = 0.75  # of the area that the brush paints, by the usual mark's share of it


@dataclass(frozen=True)
class RanDry:
    """The last stroke that is whole and the one behind it, which is not, nor any after it; the way of the TCP on the
    paper from the dip to the end of each."""

    whole: str
    whole_mm: float
    dry: str
    dry_mm: float

    @property
    def variance_mm2(self) -> float:
        """About whole_mm: anywhere between both ways the load may have come to its end."""
        return (self.dry_mm - self.whole_mm) ** 2 / 3

    def describe(self) -> str:
        return (
            f"the load ran dry between {self.whole_mm:.0f} mm, where stroke {self.whole} ends, the last whole mark, "
            f"and {self.dry_mm:.0f} mm, the end of {self.dry}, which is missing or broken, as all after it are: "
            "lasts_mm is the former"
        )


def ran_dry(painted: Painted, predicted: list) -> RanDry | None:
    """None where the last stroke of the plan is whole. painted: all marks of the sheet, as freshly dipped; predicted:
    for each of them the rings that the brush that was found paints."""
    areas = np.array([_core.area(mark.outline_mm) for mark in painted.marks])
    shares = areas / np.maximum([_core.area(rings) for rings in predicted], 1e-9)
    least = WHOLE * np.median(shares)
    whole = {mark.stroke for mark, share in zip(painted.marks, shares, strict=True) if share > least}
    strokes = list(painted.before_mm)
    ends = [*list(painted.before_mm.values())[1:], painted.way_mm]
    last = max(k for k, stroke in enumerate(strokes) if stroke in whole)
    if last + 1 == len(strokes):
        return None
    return RanDry(strokes[last], ends[last], strokes[last + 1], ends[last + 1])
