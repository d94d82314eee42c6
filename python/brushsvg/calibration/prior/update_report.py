"""Report the update of a known brush by a painted job."""

from __future__ import annotations

import math

import numpy as np

from ... import _core
from ...model.confidence import LAWS
from ...reporting.report_text import Report, plural, verdict
from ..law_text import (
    NOT_CONVERGED,
    depths_shown,
    evaluate_law,
    format_coefficients,
    law_table,
    name_and_depths,
    paper_height,
)
from ..marks.machine_found import describe_exact_machine, describe_numbers, format_cell_table, list_machine_numbers
from .from_prior import found_height

MIN_REPORTED_OFFSET_MM = 0.05  # the report mentions a different form of the prior if it moves a law by more


def report(calibration) -> Report:
    """Return the report that `brushsvg calibrate --prior` prints.

    calibration: a from_prior.UpdatedBrush.
    """
    brush, fit, count = calibration.brush, calibration.fit, len(calibration.painted.marks)
    laws = [law for law in LAWS if calibration.is_learned(law)]
    reservations = [
        "" if fit.converged else NOT_CONVERGED,
        "" if laws else "the marks show nothing new, so the brush is unchanged",
        f"{plural(len(calibration.strays), 'mark')} had to be left out" if calibration.strays else "",
        next((remark.sentence for remark in _core.remarks(brush) if remark.code == "law-falls"), ""),
    ]
    machine_numbers = list_machine_numbers(fit, calibration.covariance, calibration.options)
    lines = [
        f"{name_and_depths(brush)}: brush {calibration.before.name}, updated with {plural(count, 'mark')} painted at "
        f"depths up to {calibration.painted.deepest_mm:.3g} mm",
        *(f"{law}: {_describe_law(calibration, law)}" for law in LAWS),
        *_list_remarks(calibration),
        *describe_exact_machine(machine_numbers),
    ]
    table = format_cell_table(fit, machine_numbers)
    details = [*_compare_laws(calibration, laws), *_describe_residuals(calibration)]
    details += [
        f"{law}, uncertainty before: {calibration.known.how[law]}{_describe_prior(calibration, law)}" for law in LAWS
    ]
    details += [
        *(["", "errors of the machine:"] if machine_numbers else []),
        *describe_numbers(machine_numbers),
        *(["", *table] if table else []),
    ]
    return Report(verdict([], reservations), tuple(lines), (*details, "", *format_coefficients(brush)))


def _list_remarks(calibration) -> list[str]:
    lines = []
    if calibration.painted.deepest_mm < calibration.brush.depth_range_mm[1]:
        lines.append(
            f"no mark is deeper than {calibration.painted.deepest_mm:.3g} mm; at greater depths, the laws depend on "
            "the brush before and on their form"
        )
    if calibration.strays:
        lines.append(
            "left out because they do not fit the other marks: "
            f"{', '.join(stray.mark.stroke for stray in calibration.strays)}"
        )
    return lines


def _describe_law(calibration, law: str) -> str:
    share, depth = calibration.doubts_left[law]
    if not calibration.is_learned(law):
        with_width = law == "tip_to_widest" and calibration.is_learned("half_width")
        return "the marks do not determine it; " + (
            "its ratio to the half width is unchanged" if with_width else "it is unchanged"
        )
    return f"updated; at depth {depth:.3g} mm its interval is {share:.2f} times as wide as before"


def _describe_prior(calibration, law: str) -> str:
    """Describe how the prior that was used differs from the brush file."""
    words = ""
    if (off := calibration.known.off_mm[law]) > MIN_REPORTED_OFFSET_MM and calibration.is_learned(law):
        words += f"; the fit uses a simpler law, which differs by {off:.2f} mm at most"
    if (wider := calibration.wider.get(law, 1.0)) > 1.0:
        words += f"; widened {wider:.1f} times, because the marks differ that much from the brush before"
    return words


def _compare_laws(calibration, laws: list[str]) -> list[str]:
    if not laws:
        return []
    depths = depths_shown(calibration.brush)
    columns = []
    for law in laws:
        pairs = zip(
            evaluate_law(calibration.brush, law, depths), evaluate_law(calibration.before, law, depths), strict=True
        )
        columns.append((law, [f"{now} ({was})" for now, was in pairs]))
    return [
        *law_table(depths, columns),
        "  +-: half the 95 % confidence interval of the law; in brackets: before the update",
        "",
    ]


def _describe_residuals(calibration) -> list[str]:
    fit = calibration.fit
    rms = math.sqrt(np.mean([np.square(residual.displacement_mm).sum() for residual in fit.marks]))
    return [
        paper_height(*found_height(calibration)),
        f"marks are displaced by {rms:.2f} mm (rms)",
        f"residuals of the edges: standard deviation {fit.noise_mm:.2f} mm; {fit.samples:.0f} points, which count as "
        f"{fit.effective_samples:.0f} independent points",
    ]
