"""Predict a job's marks with faults of sheet, machine, paper and brush."""

from __future__ import annotations

import os
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ... import _core
from ...geometry.rotation import rotation
from ...machine.cells.cell import Machine
from ...machine.realised.passes import as_run
from ...model.confidence import law_band
from ...model.perturbed import with_factors

SHEET, MACHINE, PAPER, BRUSH = "place of the sheet", "machine", "height and tilt of the paper", "brush"
# Relative standard deviation of a law between brushes of one make: of its size, and of its bend with depth.
LAW_SIZE_SIGMA, LAW_BEND_SIGMA = 0.15, 0.1
MIN_LAW_SIGMA = 0.005  # smallest relative standard deviation of a law: on real paper no brush is more certain
MAX_THREADS = min(8, os.cpu_count() or 1)
MARK_ROW_SPACING_MM = 0.02  # distance between rows of a mark: with 0.1 outlines are as rough as a number moves them


@dataclass(frozen=True)
class Number:
    """One number that may be wrong; 0 means no fault.

    sigma: prior standard deviation; step: change that moves edges by about 0.1 mm.
    """

    cause: str
    name: str
    unit: str
    sigma: float
    step: float


@dataclass(frozen=True)
class FaultModel:
    """A model of the marks of a job under faults.

    plan: as commanded; names: names of the examined strokes. The frame is that of the sheet. Turn, height and tilt are
    about the middle of the marks; scale and skew are about the work zero, which is the sheet's corner. learned: the
    brush was made from these marks, and its laws are as certain as its file says; otherwise the brush may be another
    one of its make.
    """

    plan: object
    brush: object
    names: tuple[str, ...]
    middle_mm: np.ndarray
    learned: bool = False

    @cached_property
    def _depths_mm(self) -> tuple[float, float]:
        """Return the usual depth, and the distance at which a law's bend counts fully: to the deepest pose or paper."""
        depths = -np.concatenate([np.array(a_pass.poses_mm)[:, 2] for a_pass in self.plan.passes])
        usual = float(np.median(depths[depths > 0.1])) if (depths > 0.1).any() else 1.0
        return usual, max(float(depths.max()) - usual, usual)

    @cached_property
    def numbers(self) -> tuple[Number, ...]:
        half = 0.5 * np.array(self.plan.sheet_mm)
        deepest = max(float(-np.array(a_pass.poses_mm)[:, 2].min()) for a_pass in self.plan.passes)
        deepest_lag = self.brush.lag(deepest)
        deepest_half_width = self.brush.half_width(deepest)
        law_sigmas = {law: self._law_sigma(law) for law in ("lag", "half_width")} if self.learned else {}
        lag_step = min(0.1, 0.15 / max(deepest_lag, 0.5))
        width_step = min(0.1, 0.1 / max(deepest_half_width, 0.5))
        return (
            Number(SHEET, "shift in x", "mm", 2.0, 0.1),
            Number(SHEET, "shift in y", "mm", 2.0, 0.1),
            Number(SHEET, "turn", "degrees", 1.0, 0.15),
            Number(MACHINE, "scale in x", "", 0.01, 0.2 / half[0]),
            Number(MACHINE, "scale in y", "", 0.01, 0.2 / half[1]),
            Number(MACHINE, "skew", "mm in x per mm in y", 0.005, 0.2 / half[1]),
            Number(MACHINE, "lean in x", "mm per mm of depth", 0.1, 0.1 / max(deepest, 1.0)),
            Number(MACHINE, "lean in y", "mm per mm of depth", 0.1, 0.1 / max(deepest, 1.0)),
            Number(MACHINE, "backlash in x", "mm", 0.3, 0.1),
            Number(MACHINE, "backlash in y", "mm", 0.3, 0.1),
            Number(PAPER, "height", "mm", 0.3, 0.1),
            Number(PAPER, "tilt in x", "mm per mm", 1.0 / half[0], 0.1 / half[0]),
            Number(PAPER, "tilt in y", "mm per mm", 1.0 / half[1], 0.1 / half[1]),
            Number(BRUSH, "lag", "of it", law_sigmas.get("lag", LAW_SIZE_SIGMA), lag_step),
            Number(BRUSH, "lag, deepest against usual", "of it", law_sigmas.get("lag", LAW_BEND_SIGMA), lag_step),
            Number(BRUSH, "width", "of it", law_sigmas.get("half_width", LAW_SIZE_SIGMA), width_step),
            Number(
                BRUSH,
                "width, deepest against usual",
                "of it",
                law_sigmas.get("half_width", LAW_BEND_SIGMA),
                width_step,
            ),
        )

    def _law_sigma(self, law: str) -> float:
        """Return the relative standard deviation of a law at the usual depth."""
        usual = self._depths_mm[0]
        band = law_band(self.brush, law, np.array([usual]))
        if band is None:
            return LAW_SIZE_SIGMA
        share = float(band[0][0]) / _core.interval_factor_95() / max(getattr(self.brush, law)(usual), 1e-6)
        return min(max(share, MIN_LAW_SIGMA), LAW_SIZE_SIGMA)

    def rings(self, fault_values: np.ndarray) -> dict[str, list[np.ndarray]]:
        """Return the rings of each stroke on the sheet [mm].

        Strokes that would not be painted are left out.
        """
        shift, turn = fault_values[:2], np.radians(fault_values[2])
        scale = 1 + fault_values[3:5]
        skew = fault_values[5]
        lean = fault_values[6:8]
        backlash = fault_values[8:10]
        height = fault_values[10]
        tilt = fault_values[11:13]
        lag = fault_values[13:15]
        width = fault_values[15:17]
        middle = self.middle_mm
        machine = Machine(
            tuple(lean.tolist()),
            tuple(scale.tolist()),
            float(skew),
            float(height - tilt @ middle),  # true_mm measures height and tilt from the sheet's corner
            tuple(tilt.tolist()),
        )
        deepest = self.brush.depth_range_mm[1]
        run = as_run(self.plan.passes, machine, np.maximum(backlash, 0.0), deepest)
        if (backlash < 0).any():  # no backlash: only a derivative at 0 uses negative values
            run = as_run(self.plan.passes, machine, (0.0, 0.0), deepest)
        examined = [a_pass for a_pass in run if a_pass.stroke in self.names]
        usual, spread = self._depths_mm
        factors = {
            name: (1 + even - slope * usual / spread, slope / spread)
            for name, (even, slope) in (("lag", lag), ("half_width", width))
        }
        brush = with_factors(self.brush, factors)
        marks = _core.simulate(
            _core.Plan("", "", self.plan.sheet_mm, examined), brush, MARK_ROW_SPACING_MM, may_rise=True
        )
        turned = rotation(turn)
        with ThreadPoolExecutor(MAX_THREADS) as pool:  # tracing releases the interpreter's lock
            outlines = list(pool.map(lambda mark: _trace_outline(mark, brush), marks.passes))
        return {
            mark.stroke: [(np.array(ring) - middle) @ turned + middle + shift for ring in outline]
            for mark, outline in zip(marks.passes, outlines, strict=True)
        }


def _trace_outline(mark, brush):
    """Return the rings of one stroke, without the area that all paint covers together."""
    alone = _core.Marks()
    alone.passes = [mark]
    _core.trace_outlines(alone, brush)
    return alone.passes[0].outline_mm
