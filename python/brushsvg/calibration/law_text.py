"""Describe the laws of a calibrated brush in words and tables."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np

from ..model.confidence import LAWS, law_band
from ..model.describe import polynomial
from ..reporting.report_text import table

TABLE_ROWS = 6
NOT_CONVERGED = "the fit stopped before it converged: compare the picture of the next sheet with the drawing"
HALF_95 = "  +-: half the 95 % confidence interval of the law"
ROUNDING = 1e-9  # a smaller interval comes from rounding


def name_and_depths(brush) -> str:
    """Return the heading of a report: the brush and its depth range."""
    return f"brush {brush.name}, depth {brush.depth_range_mm[0]:g} to {brush.depth_range_mm[1]:g} mm"


def depths_shown(brush, deepest_mm: float | None = None) -> np.ndarray:
    """Return the depths [mm] of a table of laws."""
    least, greatest = brush.depth_range_mm
    return np.linspace(least, greatest if deepest_mm is None else deepest_mm, TABLE_ROWS)


def evaluate_law(brush, law: str, depths: np.ndarray) -> list[str]:
    """Return the values of a law at depths, with half the 95 % interval."""
    band = law_band(brush, law, depths)
    halves = [f" +- {half:.2f}" for half in band[0]] if band else [""] * len(depths)
    at = [getattr(brush, law).extrapolated(depth) for depth in depths]
    return [f"{value:.2f}{half}" for value, half in zip(at, halves, strict=True)]


def law_table(depths: np.ndarray, columns: Iterable[tuple[str, Sequence[str]]]) -> list[str]:
    """Return the lines of a table of laws over depths. columns: (name, cells) of each column."""
    names, cells = zip(*columns, strict=True)
    head = ("depth", *names)
    return table(head, zip((f"{depth:5.2f}" for depth in depths), *cells, strict=True))


def laws_table(brush) -> list[str]:
    """Return a table of all laws of a brush at six depths."""
    depths = depths_shown(brush)
    return [*law_table(depths, [(law, evaluate_law(brush, law, depths)) for law in LAWS]), HALF_95]


def format_coefficients(brush, laws: Iterable[str] = LAWS) -> list[str]:
    """Return the polynomial of each law, with intervals if they are known."""
    lines = []
    for name in laws:
        law = getattr(brush, name)
        lines.append(f"{name} = {polynomial(law.coefficients)}")
        halves = ", ".join(f"{half if half > ROUNDING else 0:.2g}" for half in law.half_interval_95)
        lines += [f"  95 % confidence intervals +- {halves} (ascending powers)"] if halves else []
    return lines


def summarize_laws(brush) -> str:
    """Return the ranges of lag and width, with their largest intervals."""
    depths = np.linspace(*brush.depth_range_mm, 21)
    parts = []
    for name, law, times in (("lag", "lag", 1.0), ("width", "half_width", 2.0)):
        band, at = law_band(brush, law, depths), [times * getattr(brush, law)(depth) for depth in depths]
        half = f" (+- {times * float(band[0].max()):.2f} at most)" if band else ""
        parts.append(f"{name} {min(at):.1f} to {max(at):.1f} mm{half}")
    return ", ".join(parts)


def paper_height(height_mm: float, half_mm: float | None = None) -> str:
    """Return a phrase that says how much higher or lower the paper was than planned."""
    half = f" +- {half_mm:.2f}" if half_mm is not None else ""
    way = "higher" if height_mm >= 0 else "lower"
    return f"the paper is {abs(height_mm):.2f}{half} mm {way} than planned"
