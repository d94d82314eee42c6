"""Report a fit of painted marks, in words and as a picture."""

from __future__ import annotations

import math

import numpy as np

from ... import _core
from ...errors import Notice
from ...geometry.rotation import rotation
from ...model.confidence import law_band, paint_interval_per_m
from ...model.plot import INK, brush_picture_on, encoded, fill_rings, new_figure, shortened
from ...reporting.report_text import Report, format_overlap, overlap_reasons, plural, verdict
from ..law_text import NOT_CONVERGED, format_coefficients, laws_table, name_and_depths, paper_height, summarize_laws
from . import machine_found
from .from_marks import (
    GAP_TERMS,
    HALF_TERMS,
    LAG_TERMS,
    MIN_CHI_SQUARE,
    find_ignored_errors,
    find_undetermined_laws,
    front_ratio,
    height_at,
    simulate_fitted_brush,
    widest_ratio,
)
from .stray_marks import MAX_RESIDUAL_SIGMAS

MAX_MASKED_SHARE = 0.1  # share of all points: if more are masked, they are not only blots and gaps
# Overlap of painted and predicted marks: least usable and least good one. Photographs of hairy strokes have 0.6 to 0.8.
MIN_USABLE_OVERLAP, MIN_GOOD_OVERLAP = 0.5, 0.9
# Largest multiples of the expected size: of one number, and of the rms of the displacements.
MAX_SIZE_PER_SIGMA, MAX_RMS_PER_SIGMA = 3.0, 1.5
WORST_MARKS = 3  # number of marks that the report lists
PAINT, PREDICTED, PATH = "#c9ced8", "#c0392b", "#3f8fd9"


def report(calibration, of_photo: bool = False, advised_parts: tuple[str, ...] = machine_found.BIASING_PARTS) -> Report:
    """Return the report that `brushsvg calibrate` prints.

    calibration: a from_marks.MarkCalibration. of_photo: the marks come from a photograph, for which remedies are flags
    instead of keys of a measurement file. advised_parts: the parts of the machine that may be advised to be fitted.

    "Do not use" means that marks overlap with their predictions by 0.5 or less without displacements. "Usable, but"
    means one of the following: the overlap is less than 0.9; the lag or the half width is undetermined at some depths,
    though at too few for a refusal; the fit stopped before it converged; marks were left out or are astray; the sheet
    differs from the expected one; the marks show errors of the machine that the fit leaves out; a tenth of the edges is
    masked; too few depths were painted for the usual lag.
    """
    brush, fit = calibration.brush, calibration.fit
    in_place, moved = measure_mean_overlaps(calibration)
    unexpected = _unexpected(calibration, of_photo)
    reasons_against, low_overlap = judge_overlap(moved)
    strays = plural(len(calibration.strays), "mark")
    ignored = find_ignored_errors(calibration, advised_parts)
    reservations = [
        *low_overlap,
        *(f"the {law.replace('_', ' ')} is only known as {value}" for law, _, value in find_undetermined_laws(brush)),
        "" if fit.converged else NOT_CONVERGED,
        (f"{strays} had to be left out" if calibration.strays_left_out else f"the fit does not explain {strays}")
        if calibration.strays
        else "",
        f"{plural(len(unexpected), 'value')} of the sheet {'is' if len(unexpected) == 1 else 'are'} larger than "
        "expected"
        if unexpected
        else "",
        machine_found.IGNORED_ERRORS if ignored else "",
        f"{100 * fit.outlier_share:.0f} % of the edge points are outliers"
        if fit.outlier_share > MAX_MASKED_SHARE
        else "",
        f"only {calibration.painted.depths} depths were painted" if len(brush.lag.coefficients) < LAG_TERMS else "",
    ]
    machine_numbers = machine_found.list_machine_numbers(fit, calibration.covariance, calibration.expected)
    cell = machine_found.format_cell_table(fit, machine_numbers)
    lines = [
        f"{name_and_depths(brush)}: {summarize_laws(brush)}, from {len(calibration.painted.marks)} painted marks",
        f"painted and predicted marks overlap by {format_overlap(in_place)} as painted, and by {format_overlap(moved)} "
        "after each mark is moved to its predicted place (mean of intersection over union)",
        *(_describe_paint(calibration) if brush.paint else []),
        _describe_displacements(calibration),
        _list_worst_marks(calibration),
        *(
            ["the cell file can correct errors of this machine: copy the table [machine] from the details"]
            if cell
            else machine_found.describe_exact_machine(machine_numbers)
        ),
        *machine_found.advise_parts(ignored, machine_found.list_requested_parts(calibration.expected)),
        *_describe_strays(calibration),
        *unexpected,
        *_warn_of_poor_fit(fit, moved),
        *_warn_of_few_depths(calibration),
        *_list_undetermined(brush),
        *fit.remarks,
    ]
    details = [*laws_table(brush), "", _describe_tail(calibration), *_list_departing_laws(calibration)]
    details += [
        "",
        *_describe_sheet_and_machine(calibration),
        "",
        *_describe_residuals(calibration),
        *(["", "for the cell file:", *cell] if cell else []),
    ]
    return Report(verdict(reasons_against, reservations), tuple(lines), (*details, "", *format_coefficients(brush)))


def judge_overlap(moved: float) -> tuple[list[str], list[str]]:
    """Judge a brush by the overlap of painted and predicted marks.

    Return reasons against the brush, and reservations.

    moved: the mean overlap without displacements.
    """
    return overlap_reasons(moved, "painted and predicted marks", MIN_GOOD_OVERLAP, MIN_USABLE_OVERLAP + 1e-9)


def _describe_displacements(calibration) -> str:
    sizes = [math.hypot(*residual.displacement_mm) for residual in calibration.fit.marks]
    farthest = int(np.argmax(sizes))
    half = _core.interval_factor_95() * float(
        np.sqrt(calibration.covariance[height_at(calibration.fit), height_at(calibration.fit)])
    )
    return (
        f"{paper_height(calibration.fit.height_mm, half)}; marks are displaced by {_rms(sizes):.2f} mm (rms), at most "
        f"by {sizes[farthest]:.2f} mm (stroke {calibration.painted.marks[farthest].stroke})"
    )


def _list_worst_marks(calibration) -> str:
    """List the marks that fit worst."""
    rms_mm = np.array([residual.rms_mm for residual in calibration.fit.marks])
    worst = np.argsort(-rms_mm, kind="stable")[:WORST_MARKS]
    listed = ", ".join(f"{calibration.painted.marks[k].stroke} {rms_mm[k]:.2f} mm" for k in worst)
    return f"worst marks, by the residual of their edges (rms): {listed}"


def _describe_paint(calibration) -> list[str]:
    paint, bends = calibration.brush.paint, calibration.paint_bends
    half = paint_interval_per_m(paint)
    unsure = "" if paint.narrows_per_m > half else ", which may be chance"
    lines = [
        f"marks narrow by {paint.narrows_per_m:.3f} +- {half:.2g} per metre painted since the dip (95 %, measured up "
        f"to {paint.calibrated_mm[1]:.0f} mm){unsure}"
    ]
    if bends > _core.interval_factor_95(paint.degrees_of_freedom):
        lines.append(
            f"marks do not narrow at a constant rate (off by {bends:.1f} standard deviations). The rate is a mean over "
            "the whole path, and the freshly dipped width may be off by more than its interval"
        )
    lines.append(
        calibration.dry.describe()
        if calibration.dry
        else f"no mark ran dry: one load lasts for at least {calibration.painted.way_mm:.0f} mm"
    )
    return lines


def _describe_tail(calibration) -> str:
    gain = calibration.round_tail_gain
    if abs(gain) < MIN_CHI_SQUARE:
        return "these marks do not show whether the footprint's tail is pointed or round; a pointed tail is assumed"
    kinds = ("round", "pointed") if gain > 0 else ("pointed", "round")
    return "footprints with a {} tail fit these marks better than {} ones (chi-square {:.0f} less)".format(
        *kinds, abs(gain)
    )


def _warn_of_few_depths(calibration) -> list[str]:
    terms = len(calibration.brush.lag.coefficients)
    if terms >= LAG_TERMS:
        return []
    return [
        f"the lag is a polynomial of degree {terms - 1} instead of {LAG_TERMS - 1}, because only "
        f"{calibration.painted.depths} depths were painted. Between these depths its error may exceed its confidence "
        "interval"
    ]


def _list_undetermined(brush) -> list[str]:
    """Return a sentence for each law that the marks leave undetermined at some depths."""
    return [
        f"these marks do not determine the {law.replace('_', ' ')} at {100 * share:.0f} % of the depths: paint curved "
        "strokes there"
        for law, share, _ in find_undetermined_laws(brush)
    ]


def _list_departing_laws(calibration) -> list[str]:
    """List the laws that have more than the usual number of coefficients."""
    laws = calibration.fit.laws
    departing = [
        name
        for name, terms, usual in (
            ("lag", len(laws.lag), LAG_TERMS),
            ("tip gap", len(laws.tip_gap) - 1, GAP_TERMS),
            ("half width", len(laws.half_width) - 1, HALF_TERMS),
            ("widest section", len(widest_ratio(laws)), 1),
            ("front of the footprint", len(front_ratio(laws)), 1),
        )
        if terms > usual
    ]
    if not departing:
        return []
    return [
        f"these marks need more coefficients than usual for: {', '.join(departing)}. The intervals include the "
        "remaining uncertainty about the form of the laws"
    ]


def _unexpected(calibration, of_photo: bool = False) -> list[str]:
    """Return a sentence for each value that is too large for its sigma, and so biases the laws."""
    fit, expected = calibration.fit, calibration.expected
    astray = {stray.mark.stroke for stray in calibration.strays}
    displaced = [
        residual.displacement_mm
        for mark, residual in zip(calibration.painted.marks, fit.marks, strict=True)
        if mark.stroke not in astray
    ]
    turn_deg, turn_sigma_deg = math.degrees(abs(fit.turn_rad)), math.degrees(expected.turn_rad)
    checks = (
        (
            "displacement_mm",
            "marks are displaced (rms) by",
            _rms(displaced),
            expected.displacement_mm,
            MAX_RMS_PER_SIGMA,
        ),
        (
            "placement_mm",
            "the sheet is shifted by",
            max(map(abs, fit.shift_mm)),
            expected.placement_mm,
            MAX_SIZE_PER_SIGMA,
        ),
        (
            "height_mm",
            "the paper's height is off by",
            abs(fit.height_mm),
            expected.height_mm.sigma,
            MAX_SIZE_PER_SIGMA,
        ),
        ("turn_deg", "the sheet is turned by", turn_deg, turn_sigma_deg, MAX_SIZE_PER_SIGMA),
    )
    return [
        f"{what} {size:.2g} {_unit(key)}, but the fit expects {sigma:.2g} {_unit(key)} (standard deviation). This "
        f"biases the laws{_remedy(key, _round_up(size), sigma, of_photo)}"
        for key, what, size, sigma, times in checks
        if size > times * sigma > 0
    ]


def _unit(key: str) -> str:
    return "degrees" if key.endswith("_deg") else "mm"


def _remedy(key: str, sigma: float, expected_sigma: float, of_photo: bool) -> str:
    if not of_photo:
        return f': if the sheet is no more exact than this, add "expected": {{"{key}": {sigma:g}}} to the measurements'
    is_measured = expected_sigma < _core.MarkOptions().height_mm.sigma
    of_flags = {
        "height_mm": (
            f": if you measured the height, keep --height {expected_sigma:g}, because lines of a liner are wide at "
            f"first touch, which looks like high paper. If you did not, use --height {sigma:g}"
            if is_measured
            else f": if you do not know the height better, add --height {sigma:g}. Lines of a liner are wide at first "
            "touch, which looks like high paper: for a liner, measure the height (brushsvg setup height) and add "
            "--height 0.05"
        ),
        "displacement_mm": ": add --spread FILE, which brushsvg compare --sheets writes",
    }
    return of_flags.get(key, ": compare the picture (--marks-picture) with the page that you painted")


def _describe_strays(calibration) -> list[str]:
    if calibration.strays_left_out and calibration.strays:
        names = ", ".join(stray.mark.stroke for stray in calibration.strays)
        return [f"left out because they do not fit the other marks: {names}"]
    return [f"{notice.where}: {notice.text}" for notice in list_strays(calibration)]


def list_strays(calibration) -> list[Notice]:
    """Return a notice for each stray mark.

    It has the found and expected place, and the cost of leaving the mark out.
    """
    notices = []
    for stray in calibration.strays:
        (rings,) = predict_outlines(calibration, [stray.mark])
        found, expected = (
            _describe_extent(np.vstack(shape))
            for shape in (stray.mark.outline_mm, to_sheet_frame(calibration, rings) or [np.zeros((1, 2))])
        )
        if stray.is_displaced:
            dx, dy = stray.displacement_mm
            what = (
                f"its mark is displaced by {math.hypot(dx, dy):.1f} mm ({dx:+.1f}, {dy:+.1f}), while the "
                f"displacements of the other marks scatter by {stray.spread_mm:.2f} mm"
            )
        else:
            what = (
                f"its outline is off by {stray.rms_mm:.2f} mm (rms), the other outlines by "
                f"{stray.usual_rms_mm:.2f} mm: something covers the mark, or it is smeared or torn"
            )
        sentence = f"{what}; found in {found}, expected in {expected}; {_describe_cost(calibration, stray.mark)}"
        notices.append(Notice(stray.mark.stroke, sentence, code="mark-astray", about=stray.mark.stroke))
    return notices


def _describe_extent(points: np.ndarray) -> str:
    (x0, y0), (x1, y1) = points.min(axis=0), points.max(axis=0)
    return f"x [{x0:.1f}, {x1:.1f}], y [{y0:.1f}, {y1:.1f}] mm"


def _describe_cost(calibration, mark) -> str:
    if not calibration.strays_left_out:
        return "check the picture, and leave the mark out if another stroke painted it"
    depth = deepest_mm(mark)
    alike = sum(abs(deepest_mm(other) - depth) < 0.01 for other in calibration.painted.marks)
    at = min(depth, calibration.brush.depth_range_mm[1])
    half = float(law_band(calibration.brush, "lag", np.array([at]))[0][0])
    return (
        f"it is left out; {plural(alike, 'other mark')} of depth {depth:.4g} mm remain, where the lag is known to +- "
        f"{half:.2f} mm"
    )


def _warn_of_poor_fit(fit, moved: float) -> list[str]:
    """Return warnings about many masked points and a small overlap; moved: the overlap without displacements."""
    out = []
    if fit.outlier_share > MAX_MASKED_SHARE:
        out.append(
            f"{100 * fit.outlier_share:.0f} % of the edge points are masked outliers, outside the range [0, "
            f"{100 * MAX_MASKED_SHARE:.0f}] %: the tail and the confidence intervals may be wrong. Remove blots, "
            "borders and slits from the outlines"
        )
    if moved <= MIN_USABLE_OVERLAP:
        out.append(
            f"painted and predicted marks overlap by {moved:.2f}, outside the range [{MIN_USABLE_OVERLAP:g}, 1]: check "
            "the picture before you use the brush"
        )
    return out


def _rms(values: np.ndarray) -> float:
    return float(np.sqrt(np.mean(np.square(values))))


def _round_up(size: float) -> float:
    """Round up to one significant digit."""
    unit = 10.0 ** math.floor(math.log10(size))
    return unit * math.ceil(size / unit)


def _describe_sheet_and_machine(calibration) -> list[str]:
    """Describe the sheet's position and the machine's errors, which are fitted together with the laws."""
    fit = calibration.fit
    half_intervals = _core.interval_factor_95() * np.sqrt(np.diag(calibration.covariance))
    first = height_at(fit)
    shift, turn = half_intervals[first + 1 : first + 3], half_intervals[first + 3]
    lines = [
        f"the sheet is shifted by {fit.shift_mm[0]:+.2f} +- {shift[0]:.2f}, {fit.shift_mm[1]:+.2f} +- {shift[1]:.2f} "
        f"mm and turned by {math.degrees(fit.turn_rad):+.2f} +- {math.degrees(turn):.2f} degrees",
    ]
    lines += machine_found.describe_numbers(
        machine_found.list_machine_numbers(fit, calibration.covariance, calibration.expected)
    )
    if calibration.scale:
        lines.append(
            f"according to the places of its marks, the sheet is "
            f"{calibration.scale.describe(calibration.scale.both)} than the plan"
        )
    return lines


def _describe_residuals(calibration) -> list[str]:
    fit = calibration.fit
    lines = [
        f"residuals of the edges: standard deviation {fit.noise_mm:.2f} mm; {fit.samples:.0f} points, which count as "
        f"{fit.effective_samples:.0f} independent points",
    ]
    if calibration.edge_mm > 0:
        lines.append(
            f"the picture may show all edges too far out or in by {calibration.edge_mm:.2f} mm (standard deviation); "
            "the intervals include this"
        )
    if fit.outlier_share > 0.01:
        bound = f"residual above {MAX_RESIDUAL_SIGMAS:g} standard deviations"
        lines.append(f"ignored as outliers: {100 * fit.outlier_share:.0f} % of the points ({bound})")
    if fit.slim > 0.01:
        lines.append(
            f"ignored near ends that are hardly wider than the residuals: {100 * fit.slim:.0f} % of the points"
        )
    outliers = [
        mark.stroke for mark, residual in zip(calibration.painted.marks, fit.marks, strict=True) if residual.outlier
    ]
    if outliers:
        lines.append(f"ignored marks, which differ as a whole: {', '.join(outliers)}. Check them and paint them again")
    return lines


def measure_mean_overlaps(calibration) -> tuple[float, float]:
    """Return the mean overlap of painted with predicted marks.

    The two values are in place and without the displacements of the marks.

    The overlap shows how well the brush predicts the position of paint. The confidence of its laws shows less.
    """
    marks, in_place, moved = calibration.painted.marks, [], []
    predicted = predict_outlines(calibration, marks)
    for mark, residual, rings in zip(marks, calibration.fit.marks, predicted, strict=True):
        in_place.append(_core.overlap(_to_plan_frame(calibration, mark.outline_mm, (0.0, 0.0)), rings))
        moved.append(_core.overlap(_to_plan_frame(calibration, mark.outline_mm, residual.displacement_mm), rings))
    return float(np.mean(in_place)), float(np.mean(moved))


def report_picture(calibration, suffix: str) -> bytes:
    """Draw the laws with bands, and the best, median and worst mark.

    Marks have their painted and predicted outlines.
    """
    figure = new_figure((11, 11))
    laws, marks = figure.subfigures(2, 1, height_ratios=(1.6, 1))
    brush_picture_on(laws, calibration.brush)
    order = np.argsort([residual.rms_mm for residual in calibration.fit.marks])
    chosen = [("best", order[0]), ("median", order[len(order) // 2]), ("worst", order[-1])]
    predicted = predict_outlines(calibration, [calibration.painted.marks[int(k)] for _, k in chosen])
    for axes, (what, k), rings in zip(marks.subplots(1, 3), chosen, predicted, strict=True):
        mark, residual = calibration.painted.marks[int(k)], calibration.fit.marks[int(k)]
        fill_rings(axes, _to_plan_frame(calibration, mark.outline_mm, residual.displacement_mm), PAINT)
        for ring in rings:
            axes.plot(*np.vstack([ring, ring[:1]]).T, color=PREDICTED, linewidth=1)
        axes.plot(*mark.poses_mm[:, :2].T, color=PATH, linewidth=0.8)
        axes.set_aspect("equal")
        title = f"{what}: {shortened(mark.stroke, 16)}, {residual.rms_mm:.2f} mm (rms)"
        axes.set_title(title, fontsize=9, color=INK)
        axes.tick_params(labelsize=7)
    marks.suptitle("grey: painted; red: predicted; blue: path of the tool", fontsize=8)
    return encoded(figure, suffix)


def _to_plan_frame(calibration, rings, displacement) -> list[np.ndarray]:
    """Transform rings of the sheet to the plan's frame, by the sheet's fitted pose and the mark's displacement."""
    fit = calibration.fit
    centre, back = np.array(fit.centre_mm), rotation(-fit.turn_rad)
    return [(ring - fit.shift_mm - centre) @ back + centre - displacement for ring in rings]


def to_sheet_frame(calibration, rings) -> list[np.ndarray]:
    """Transform rings of the plan to the frame of the sheet. The transformation is the fitted pose of the sheet."""
    fit = calibration.fit
    centre, turned = np.array(fit.centre_mm), rotation(fit.turn_rad)
    return [(ring - centre) @ turned + centre + fit.shift_mm for ring in rings]


def deepest_mm(mark) -> float:
    return float(-np.array(mark.poses_mm)[:, 2].min())


def predict_outlines(calibration, marks: list) -> list:
    """Return the rings that the fitted brush paints along the paths of marks.

    The rings are in the frame of the plan.
    """
    brush, traces = simulate_fitted_brush(calibration, marks)
    painted = _core.Marks()
    painted.passes = traces
    _core.trace_outlines(painted, brush)
    return [painted_pass.outline_mm for painted_pass in painted.passes]
