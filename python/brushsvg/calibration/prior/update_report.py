"""Report the update of a known brush by a painted job.

The report has a verdict, the changes of each law, and tables.
"""

from __future__ import annotations

import math

import numpy as np

from ...model.confidence import LAWS
from ...reporting.report_text import Report, plural, verdict
from ..law_text import (
    NOT_CONVERGED,
    coefficients,
    depths_shown,
    law_table,
    name_and_depths,
    paper_height,
    values,
)
from ..marks.machine_found import cell_table, describe_numbers, numbers
from .from_prior import found_height

MIN_REPORTED_OFFSET_MM = 0.05  # the report mentions a different form of the prior if it moves a law by more


def report(calibration) -> Report:
    """Return the report that `brushsvg calibrate --prior` prints.

    calibration: a from_prior.Updated.
    """
    brush, fit, count = calibration.brush, calibration.fit, len(calibration.painted.marks)
    laws = [law for law in LAWS if calibration.is_learned(law)]
    reservations = [
        "" if fit.converged else NOT_CONVERGED,
        "" if laws else "the marks show nothing new: the brush is as it was before",
        f"{plural(len(calibration.strays), 'mark')} had to be left out" if calibration.strays else "",
    ]
    lines = [
        f"{name_and_depths(brush)}: {calibration.before.name}, updated by {plural(count, 'mark')} painted at depths to "
        f"{calibration.painted.deepest_mm:.3g} mm",
        *(f"{law}: {_describe_law(calibration, law)}" for law in LAWS),
        *_list_remarks(calibration),
    ]
    machine_numbers = numbers(fit, calibration.covariance, calibration.options)
    table = cell_table(fit, calibration.options, machine_numbers)
    details = [*_compare_laws(calibration, laws), *_describe_residuals(calibration)]
    details += [f"{law}, the prior: {calibration.known.how[law]}{_describe_prior(calibration, law)}" for law in LAWS]
    details += [
        *(["", "of the machine:"] if machine_numbers else []),
        *describe_numbers(machine_numbers),
        *(["", *table] if table else []),
    ]
    return Report(verdict([], reservations), tuple(lines), (*details, "", *coefficients(brush)))


def _list_remarks(calibration) -> list[str]:
    lines = []
    if calibration.painted.deepest_mm < calibration.brush.depth_range_mm[1]:
        lines.append(
            f"deeper than {calibration.painted.deepest_mm:.3g} mm nothing was painted: there laws rest on the prior "
            "and on their form"
        )
    if calibration.strays:
        lines.append(
            f"left out, unlike the other marks: {', '.join(stray.mark.stroke for stray in calibration.strays)}"
        )
    return lines


def _describe_law(calibration, law: str) -> str:
    share, depth = calibration.doubts_left[law]
    if not calibration.is_learned(law):
        with_width = law == "tip_to_widest" and calibration.is_learned("half_width")
        return "the marks show nothing of it: " + (
            "it keeps its ratio to the half width" if with_width else "left as it was"
        )
    return f"learned from the marks: its intervals are {share:.2f} times as wide as before, at depth {depth:.3g} mm"


def _describe_prior(calibration, law: str) -> str:
    """Describe how the prior that was used differs from the brush file."""
    words = ""
    if (off := calibration.known.off_mm[law]) > MIN_REPORTED_OFFSET_MM and calibration.is_learned(law):
        words += f"; as the law that marks are fitted with, {off:.2f} mm off at most"
    if (wider := calibration.wider.get(law, 1.0)) > 1.0:
        words += f"; taken {wider:.1f} times as wide, since the marks are that far from it"
    return words


def _compare_laws(calibration, laws: list[str]) -> list[str]:
    if not laws:
        return []
    depths = depths_shown(calibration.brush)
    columns = []
    for law in laws:
        pairs = zip(values(calibration.brush, law, depths), values(calibration.before, law, depths), strict=True)
        columns.append((law, [f"{now} ({was})" for now, was in pairs]))
    return [
        *law_table(depths, columns),
        "  now +- half the 95 % confidence interval, in brackets the prior",
        "",
    ]


def _describe_residuals(calibration) -> list[str]:
    fit = calibration.fit
    rms = math.sqrt(np.mean([np.square(residual.displacement_mm).sum() for residual in fit.marks]))
    return [
        paper_height(*found_height(calibration)),
        f"marks are displaced by {rms:.2f} mm (rms)",
        f"residuals of the edges: standard deviation {fit.noise_mm:.2f} mm; {fit.samples:.0f} points, worth "
        f"{fit.effective_samples:.0f} independent ones",
    ]
