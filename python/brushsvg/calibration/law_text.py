"""The laws of a calibrated brush for people: values with intervals in a table, coefficients, and the range of each."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np

from ..model.confidence import LAWS, law_band
from ..model.describe import polynomial
from ..reporting.report_text import table

TABLE_ROWS = 6
NOT_CONVERGED = "the fit stopped before it converged: compare the picture of the next sheet with the drawing"
HALF_95 = "  +-: half the 95 % confidence interval of the law"
EXACT = 1e-9  # an interval below comes from rounding


def name_and_depths(brush) -> str:
    """What a report is about."""
    return f"brush {brush.name}, depth {brush.depth_range_mm[0]:g} to {brush.depth_range_mm[1]:g} mm"


def depths_shown(brush, deepest_mm: float | None = None) -> np.ndarray:
    """The depths of a table of laws."""
    least, greatest = brush.depth_range_mm
    return np.linspace(least, greatest if deepest_mm is None else deepest_mm, TABLE_ROWS)


def values(brush, law: str, depths: np.ndarray) -> list[str]:
    """A law at depths, with half its 95 % interval where that is known."""
    band = law_band(brush, law, depths)
    halves = [f" +- {half:.2f}" for half in band[0]] if band else [""] * len(depths)
    at = [getattr(brush, law).extrapolated(depth) for depth in depths]
    return [f"{value:.2f}{half}" for value, half in zip(at, halves, strict=True)]


def law_table(depths: np.ndarray, columns: Iterable[tuple[str, Sequence[str]]]) -> list[str]:
    """Lines of a table: the depths, and columns of a name and its cells."""
    names, cells = zip(*columns, strict=True)
    head = ("depth", *names)
    return table(head, zip((f"{depth:5.2f}" for depth in depths), *cells, strict=True))


def laws_table(brush) -> list[str]:
    """All laws of a brush at six depths."""
    depths = depths_shown(brush)
    return [*law_table(depths, [(law, values(brush, law, depths)) for law in LAWS]), HALF_95]


def coefficients(brush, laws: Iterable[str] = LAWS) -> list[str]:
    """The polynomial of each law, with the intervals of its coefficients where they are known."""
    lines = []
    for name in laws:
        law = getattr(brush, name)
        lines.append(f"{name} = {polynomial(law.coefficients)}")
        halves = ", ".join(f"{half if half > EXACT else 0:.2g}" for half in law.half_interval_95)
        lines += [f"  95 % confidence intervals +- {halves} (ascending powers)"] if halves else []
    return lines


def in_short(brush) -> str:
    """Lag and width over the depths, with the largest of their intervals."""
    depths = np.linspace(*brush.depth_range_mm, 21)
    parts = []
    for name, law, times in (("lag", "lag", 1.0), ("width", "half_width", 2.0)):
        band, at = law_band(brush, law, depths), [times * getattr(brush, law)(depth) for depth in depths]
        half = f" (+- {times * float(band[0].max()):.2f} at most)" if band else ""
        parts.append(f"{name} {min(at):.1f} to {max(at):.1f} mm{half}")
    return ", ".join(parts)


def paper_height(height_mm: float, half_mm: float | None = None) -> str:
    """How high the paper was in the end."""
    half = f" +- {half_mm:.2f}" if half_mm is not None else ""
    way = "higher" if height_mm >= 0 else "lower"
    return f"the paper is {abs(height_mm):.2f}{half} mm {way} than planned"
