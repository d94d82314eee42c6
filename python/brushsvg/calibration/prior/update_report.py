"""What a painted job told of a brush that was known before, law by law, in words."""

from __future__ import annotations

import math

import numpy as np

from ...model.confidence import LAWS, law_band
from ...model.describe import polynomial
from ..marks.machine_found import cell_table, describe_numbers, numbers
from ..marks.mark_report import TABLE_ROWS
from .from_prior import found_height

OFF_MM = 0.05  # a prior is told to be taken another way where that moves a law by more


def report(made) -> str:
    """The text that `brushsvg calibrate --prior` prints. made: a from_prior.Updated."""
    brush, before, count = made.brush, made.before, len(made.painted.marks)
    lines = [
        f"brush {brush.name}, depth {brush.depth_range_mm[0]:g} to {brush.depth_range_mm[1]:g} mm: {before.name}, "
        f"updated by {count} mark{'s' * (count > 1)} painted at depths to {made.painted.deepest_mm:.3g} mm",
        "",
    ]
    for law in LAWS:
        now = getattr(brush, law)
        lines += [f"{law} = {polynomial(now.coefficients)}", *_halves(now), f"  {_describe(made, law)}"]
        lines.append(f"  the prior: {made.known.how[law]}{_taken(made, law)}")
    lines += ["", *_table(made), *_stays(made), *_machine(made)]
    return "\n".join([*lines, ""])


def _machine(made) -> list[str]:
    found = numbers(made.fit, made.covariance, made.options)
    table = cell_table(made.fit, made.options, found)
    return [
        *(["", "of the machine:"] if found else []),
        *describe_numbers(found),
        *(["", *table] if table else []),
    ]


def _halves(law) -> list[str]:
    halves = ", ".join(f"{half:.2g}" for half in law.half_interval_95)
    return [f"  95 % confidence intervals +- {halves} (ascending powers)"] if halves else []


def _describe(made, law: str) -> str:
    share, depth = made.doubts_left[law]
    if not made.is_learned(law):
        with_width = law == "tip_to_widest" and made.is_learned("half_width")
        return "the marks tell nothing of it: " + (
            "it keeps its ratio to the half width" if with_width else "left as it was"
        )
    return f"told by the marks: its intervals are {share:.2f} times as wide as before, most at depth {depth:.3g} mm"


def _taken(made, law: str) -> str:
    """How else the prior was taken than it stands in its file."""
    words = ""
    if (off := made.known.off_mm[law]) > OFF_MM and made.is_learned(law):
        words += f"; as the law that marks are fitted with, {off:.2f} mm off at most"
    if (wider := made.wider.get(law, 1.0)) > 1.0:
        words += f"; taken {wider:.1f} times as wide, since the marks lie that far from it"
    return words


def _table(made) -> list[str]:
    laws = [law for law in LAWS if made.is_learned(law)]
    if not laws:
        return []
    lines = ["  depth" + "".join(law.rjust(30) for law in laws)]
    depths = np.linspace(*made.brush.depth_range_mm, TABLE_ROWS)
    for i, depth in enumerate(depths):
        cells = (_cell(made, law, depths, i) for law in laws)
        lines.append(f"{depth:7.2f}" + "".join(cell.rjust(30) for cell in cells))
    return [*lines, "  now +- half the 95 % confidence interval, in brackets the prior", ""]


def _cell(made, law: str, depths: np.ndarray, i: int) -> str:
    now, was = (
        f"{getattr(brush, law).extrapolated(depths[i]):.2f}" + (f" +- {band[0][i]:.2f}" if band else "")
        for brush in (made.brush, made.before)
        for band in [law_band(brush, law, depths)]
    )
    return f"{now} ({was})"


def _stays(made) -> list[str]:
    fit = made.fit
    height, half = found_height(made)
    rms = math.sqrt(np.mean([np.square(residual.displacement_mm).sum() for residual in fit.marks]))
    lines = [
        f"the paper lies {abs(height):.2f} +- {half:.2f} mm {'higher' if height >= 0 else 'lower'} than the plan took "
        "it to be",
        f"marks are displaced by {rms:.2f} mm (rms)",
        f"residuals of the edges: standard deviation {fit.noise_mm:.2f} mm; {fit.samples:.0f} points, worth "
        f"{fit.effective_samples:.0f} independent ones",
    ]
    if made.painted.deepest_mm < made.brush.depth_range_mm[1]:
        lines.append(
            f"deeper than {made.painted.deepest_mm:.3g} mm nothing was painted: there laws rest on the prior and on "
            "their form"
        )
    if made.strays:
        names = ", ".join(stray.mark.stroke for stray in made.strays)
        lines.append(f"note: left out, not being where or what the other marks say: {names}")
    if not fit.converged:
        lines.append("note: the fit had not converged when it was stopped")
    return lines
