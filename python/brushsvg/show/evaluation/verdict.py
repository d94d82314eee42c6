"""Judge a planned job for `report`, `check` and `convert --report`.

The limits of the overlap, 0.70 and 0.95, are USABLE_OVERLAP and GOOD_OVERLAP of reporting.report_text, because
`compare` and `calibrate` judge overlaps as well.

do not use:   a limit forbids running the program; no stroke can be painted; the overlap is below 0.70
usable, but:  strokes are left out; the overlap is below 0.95; paint visibly misses the drawing; a law of the brush was
              never measured, has no confidence interval, or is so uncertain that paint may be 1 mm from the
              prediction; the drawing, or the part of it that the program paints, is not known
good:         none of these

An overlap of 0.95 is where differences become hard to see. The shipped brush in place of the real one gives about 0.6.
"""

from __future__ import annotations

from collections.abc import Iterable

from ...reporting.report_text import overlap_reasons, plural, verdict

UNCERTAIN_MM = 1.0  # half of the 95 % interval of the middle of a mark
OFF_DRAWING = ("off-middle-line", "paint-outside")  # codes of warnings about paint that misses the drawing


def verdict_of(report) -> str:
    """Return the verdict on a report.Report in one line."""
    against = [notice.sentence for notice in report.forbidden[:1]]
    if not report.strokes:
        against.append("no stroke can be painted" if report.refused else "there is nothing to paint")
    too_low, low = overlap_reasons(report.total.overlap, "paint and drawing")
    return verdict(
        [*against, *too_low],
        [*_left_out_reasons(report), *low, *_off_drawing_reasons(report.warnings), *_brush_reasons(report)],
    )


def _left_out_reasons(report) -> list[str]:
    count, total = len(report.refused), len(report.strokes) + len(report.refused)
    left_out = [f"{count} of {plural(total, 'stroke')} cannot be painted"] if count else []
    if report.strokes and report.total.overlap is None:
        unknown = "the drawing" if report.tolerance_mm is None else "the part of a stroke that the program begins with"
        left_out.append(f"{unknown} is not known, so nobody can say whether the paint matches it")
    return left_out


def _off_drawing_reasons(warnings: Iterable) -> list[str]:
    strokes_off = {notice.where for notice in warnings if notice.code in OFF_DRAWING}
    return (
        [f"{plural(len(strokes_off), 'stroke')} visibly {'miss' if len(strokes_off) > 1 else 'misses'} the drawing"]
        if strokes_off
        else []
    )


def _brush_reasons(report) -> list[str]:
    if report.assumed:
        names, verb = " and ".join(report.assumed), "was" if len(report.assumed) == 1 else "were"
        return [f"the {names} of brush {report.brush} {verb} never measured: calibrate your brush"]
    reasons = []
    if report.without_interval:
        names = " and ".join(report.without_interval)
        verb, pronoun = ("has", "it") if len(report.without_interval) == 1 else ("have", "them")
        reasons.append(
            f"the {names} of brush {report.brush} {verb} no confidence interval: measure {pronoun} at three depths or "
            "more"
        )
    middle_mm = report.confidence.total.middle_mm if report.confidence else None
    if middle_mm is not None and middle_mm >= UNCERTAIN_MM:
        reasons.append(
            f"brush {report.brush} is known so badly that paint may be {middle_mm:.1f} mm from the prediction"
        )
    return reasons
