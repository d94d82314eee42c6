"""Update a known brush by further painted marks.

Only the laws that the marks determine change.
"""

from __future__ import annotations

import itertools
import json
from dataclasses import dataclass

import numpy as np
from numpy.polynomial.polynomial import polyval

from ... import _core
from ...errors import Error, Notice
from ...model.confidence import LAWS, LEARNED, fitted_down_to_mm, half_interval_mm, learned_of, places
from ...model.extra_keys import read_extra_keys
from ...model.laws.fitted import need_fits
from ..marks.from_marks import (
    GAP_TERMS,
    HALF_TERMS,
    LAG_TERMS,
    brush_of,
    change_by_edges,
    change_by_wetter_marks,
    height_at,
    refuse_many,
    refuse_many_outliers,
    to_brush_covariance,
)
from ..marks.machine_found import request_machine_parts
from ..marks.mark_input import Painted, count_painted_depths
from ..marks.stray_marks import Stray, find_strays
from .known_laws import DEPTH_COUNT, KnownLaws, known_laws, numbers_of, root_of_inverse

# Largest ratio of the standard deviations of a law after and before, at its best depth. Above it, the marks add nothing
# to the law.
MAX_LEARNED_RATIO = 0.9
MAX_ROUNDS = 20  # rounds of widening the prior
LOOSE_SIGMA = 0.25  # relative standard deviation of the loose prior; brushes of one make differ less
LIKELY_DEVIATE = 1.645  # normal deviate: one brush in twenty is further from its prior
# Relative standard deviation of the part of a law that a polynomial of low degree does not follow at the painted
# depths. With 0, marks of shallow strokes would also determine greater depths with certainty. A law that follows
# round-6 down to 7 mm is 12 % off at 10 mm.
UNFOLLOWED_SIGMA = 0.01


@dataclass(frozen=True)
class UpdatedBrush:
    """A brush updated by painted marks.

    known: the prior. wider: for each law, the factor by which its prior intervals had to be widened. doubts_left: for
    each law, the least ratio of the standard deviations now and before, and its depth. covariance: of all fitted
    numbers.
    """

    brush: _core.Brush
    before: _core.Brush
    known: KnownLaws
    wider: dict[str, float]
    doubts_left: dict[str, tuple[float, float]]
    fit: object
    painted: Painted
    covariance: np.ndarray
    strays: tuple[Stray, ...]
    options: object

    def is_learned(self, law: str) -> bool:
        return self.doubts_left[law][0] < MAX_LEARNED_RATIO


def marks_with_prior(marks: list) -> Painted:
    """Return marks as Painted without checks. The prior supplies what the marks do not determine."""
    ways = [np.array(mark.poses_mm) for mark in marks]
    return Painted(marks, max(float(-poses[:, 2].min()) for poses in ways), count_painted_depths(ways))


def update_brush(
    painted: Painted,
    brush: _core.Brush,
    name: str,
    edge_mm: float = 0.0,
    machine: tuple[str, ...] = (),
    displacement_mm: float | None = None,
) -> UpdatedBrush:
    """Update a known brush by painted marks.

    edge_mm: as for calibrate_marks. machine: parts of the machine that are fitted as well. displacement_mm: standard
    deviation of the place of a mark, in x and in y, if it is known.

    Raises Error if the marks cannot belong to this brush.
    """
    need_fits()
    known = known_laws(brush)
    options = _core.MarkOptions()
    options.deepest_mm = brush.depth_range_mm[1]
    options.lag_terms, options.tip_gap_terms, options.half_width_terms = LAG_TERMS, GAP_TERMS, HALF_TERMS
    options.round_tail = known.laws.round_tail
    options.widest_per_half = _core.Prior(known.laws.widest_per_half, np.inf)
    options.front_per_half = _core.Prior(known.laws.front_per_half, options.front_per_half.sigma)
    if displacement_mm is not None:
        options.displacement_mm = displacement_mm
    request_machine_parts(options, machine)
    fit, wider = _fit_wide_enough(painted.marks, known, options)
    refuse_many_outliers(fit, painted)
    astray = tuple(find_strays(painted.marks, fit))
    if astray:
        refuse_many(astray, painted)
        left_out = {stray.mark.stroke for stray in astray}
        painted = marks_with_prior([mark for mark in painted.marks if mark.stroke not in left_out])
        fit, wider = _fit_wide_enough(painted.marks, known, options)
    laws, covariance = _allow_for_polynomial_error(known, known.widened(wider), fit, painted.deepest_mm)
    if edge_mm > 0:
        for change in (
            change_by_edges(fit, painted.marks, options, edge_mm),
            change_by_wetter_marks(fit, options.deepest_mm, edge_mm),
        ):
            covariance += np.outer(change, change)
    interval_ratios = _interval_ratios(known.widened(wider), covariance, known.laws, brush)
    changed = {law for law in LAWS if interval_ratios[law][0] < MAX_LEARNED_RATIO}
    contradicted = {law for law, factor in wider.items() if factor > 1.0}
    updated_brush = _merge_brush(brush, known, laws, covariance, changed, contradicted, name, painted)
    _core.check(updated_brush)
    return UpdatedBrush(updated_brush, brush, known, wider, interval_ratios, fit, painted, covariance, astray, options)


def _fit_wide_enough(marks: list, known: KnownLaws, options) -> tuple[object, dict[str, float]]:
    """Fit marks with a prior that is wide enough.

    Return the fit and the factors of widening.

    A law that is further from its prior than the prior allows gets a wider prior. A prior that is too narrow for
    another brush of the same make would fix the law. Edges far from its prediction would be masked as outliers, so the
    law would remain certain. The marks are therefore fitted with a loose prior first.
    """
    loosened = known.loosened(LOOSE_SIGMA)
    options.laws = known.prior(loosened)
    loose = _core.fit_marks(marks, known.laws, options)
    wider = find_widening(known, known.widened(loosened), loose)
    options.laws = known.prior(wider)
    return _core.fit_marks(marks, loose.laws, options), wider


def _allow_for_polynomial_error(
    known: KnownLaws, before: np.ndarray, fit, deepest_mm: float
) -> tuple[_core.MarkLaws, np.ndarray]:
    """Return laws and covariance that allow for the error of polynomials.

    Marks down to deepest_mm determine the true law only as far as a polynomial follows it. F is the covariance of the
    rest. In numbers for which the prior with the covariance `before` is standard normal, the information L of the marks
    becomes L - L (L + 1/F)^-1 L.
    """
    size = len(before)
    root, after = root_of_inverse(before), np.array(fit.covariance)
    values, vectors = np.linalg.eigh(root @ after[:size, :size] @ root.T)
    information = (vectors * np.maximum(1.0 / np.maximum(values, 1e-12) - 1.0, 0.0)) @ vectors.T
    evidence = (np.eye(size) + information) @ root @ (_numbers_of_laws(fit.laws) - _numbers_of_laws(known.laws))
    unfollowed = np.linalg.inv(root @ known.unfollowed(UNFOLLOWED_SIGMA, deepest_mm) @ root.T)
    kept = np.eye(size) - information @ np.linalg.inv(information + unfollowed)
    posterior = np.linalg.inv(np.eye(size) + kept @ information)
    inverse_root = np.linalg.inv(root)
    after[:size, :size] = inverse_root @ (posterior + posterior.T) / 2 @ inverse_root.T
    numbers = _numbers_of_laws(known.laws) + inverse_root @ posterior @ kept @ evidence
    numbers = _keep_width_rising(numbers, after[:size, :size], known.deepest_mm)
    by_law = {law: numbers[place].tolist() for law, place in numbers_of().items()}
    fitted_laws = fit.laws
    ratio = float(by_law["tip_to_widest"][0])
    laws = _core.MarkLaws(
        by_law["lag"],
        [0.0, *by_law["tip_gap"]],
        [0.0, *by_law["half_width"]],
        ratio,
        fitted_laws.front_per_half,
        fitted_laws.round_tail,
    )
    return laws, after


def _keep_width_rising(numbers: np.ndarray, covariance: np.ndarray, deepest_mm: float) -> np.ndarray:
    """Return the most likely numbers for which the half width does not fall down to deepest_mm.

    A half width of two coefficients that rises at touch falls first at the greatest depth. There, its slope is g x for
    the numbers x. If g x < 0, the condition g x = 0 moves x by -C g (g x) / (g C g).
    """
    slope_of = np.zeros(len(numbers))
    place = numbers_of()["half_width"]
    powers = np.arange(1, place.stop - place.start + 1)
    slope_of[place] = powers * deepest_mm ** (powers - 1)
    slope = min(slope_of @ numbers, 0.0)
    moved = covariance @ slope_of
    return numbers - moved * slope / (slope_of @ moved)


def find_widening(known: KnownLaws, loosened: np.ndarray, loose) -> dict[str, float]:
    """Return for each law the factor that makes the brush likely.

    The prior of the law must be wider by this factor.

    loose: a fit with the covariance `loosened` as prior. With the information L of the marks and the covariance S of
    the fit, the fit moves from the prior by S L (d + noise of the marks). The deviation d has the covariance of the
    prior.
    """
    size = len(known.covariance)
    after = np.array(loose.covariance)[:size, :size]
    root = root_of_inverse(after)
    information = root.T @ root - np.linalg.inv(loosened)
    movement, wider = _numbers_of_laws(loose.laws) - _numbers_of_laws(known.laws), {}
    for _ in range(MAX_ROUNDS):
        response = after @ information
        expected = response @ known.widened(wider) @ response.T + response @ after
        ratios = {}
        for law, place in numbers_of().items():
            ratio = _movement_ratio(
                movement[place], expected[place, place], loosened[place, place], after[place, place]
            )
            if ratio > 1.0:
                ratios[law] = ratio
        if not ratios:
            break
        wider = {law: wider.get(law, 1.0) * ratios.get(law, 1.0) for law in LAWS}
    return wider


def _movement_ratio(moved, expected, before, after) -> float:
    """Return the rms ratio of actual to expected movement.

    It is taken in the directions that the marks determine.

    The ratio is 1 if the movement is likely.
    """
    root = root_of_inverse(before)
    values, vectors = np.linalg.eigh(root @ after @ root.T)
    along = vectors[:, values < MAX_LEARNED_RATIO].T @ root
    count = len(along)
    if not count:
        return 1.0
    moved_along = along @ moved
    squared = float(moved_along @ np.linalg.lstsq(along @ expected @ along.T, moved_along, rcond=None)[0])
    return float(np.sqrt(squared / count)) if squared > _chi_square_95(count) else 1.0


def _chi_square_95(freedom: int) -> float:
    """Return the 95 % quantile of chi-square (Wilson and Hilferty)."""
    part = 2.0 / (9.0 * freedom)
    return freedom * (1.0 - part + LIKELY_DEVIATE * np.sqrt(part)) ** 3


def _numbers_of_laws(laws) -> np.ndarray:
    return np.concatenate([laws.lag, laws.tip_gap[1:], laws.half_width[1:], [laws.widest_per_half]])


def bands_mm(covariance: np.ndarray, laws, depths: np.ndarray) -> dict[str, np.ndarray]:
    """Return for each law half the 95 % interval at depths. covariance: of the numbers of a fit."""
    at, out = numbers_of(), {}
    for law in ("lag", "tip_gap", "half_width"):
        block = covariance[at[law], at[law]]
        if law != "lag":
            block = np.pad(block, ((1, 0), (1, 0)))
        out[law] = half_interval_mm(block, depths, None)
    half = polyval(depths, laws.half_width)
    ratio = at["tip_to_widest"].start
    out["tip_to_widest"] = _core.interval_factor_95() * np.sqrt(covariance[ratio, ratio]) * half
    return out


def _interval_ratios(before: np.ndarray, after: np.ndarray, laws, brush) -> dict[str, tuple[float, float]]:
    """Return for each law the least ratio of its intervals, and its depth.

    The ratio is the interval after the update over the interval before.

    For tip_to_widest, it is the interval of its ratio to the half width.
    """
    depths = np.linspace(*brush.depth_range_mm, DEPTH_COUNT)[1:]
    bands_before, bands_after = bands_mm(before, laws, depths), bands_mm(after, laws, depths)
    out = {}
    for law in LAWS:
        share = bands_after[law] / np.maximum(bands_before[law], 1e-12)
        best = int(np.argmin(share))
        out[law] = (float(share[best]), float(depths[best]))
    return out


def _merge_brush(
    brush, known: KnownLaws, laws, covariance, learned: set[str], contradicted: set[str], name: str, painted: Painted
):
    """Return the brush with the laws that the marks determine; the other laws stay as they are.

    contradicted: laws whose prior the marks contradict.
    """
    if learned & {"half_width", "tip_to_widest"}:
        learned = learned | {"tip_to_widest"}  # it is stored in half widths
    updated_brush = brush_of(laws, name, brush.depth_range_mm, covariance)
    fitted = places(updated_brush)
    brush_covariance = to_brush_covariance(laws, covariance)
    for law in LAWS:
        setattr(
            updated_brush,
            law,
            _choose_law(
                getattr(brush, law),
                getattr(updated_brush, law),
                law in learned,
                law in contradicted,
                painted,
                brush.name,
            ),
        )
    updated_brush.kind = brush.kind
    updated_brush.max_speed_mm_s = brush.max_speed_mm_s
    updated_brush.paint_depth_mm = brush.paint_depth_mm
    updated_brush.covariance = _join_covariance(brush, updated_brush, learned, brush_covariance, fitted).tolist()
    updated_brush.extra = brush.extra
    updated_brush.footprints = brush.footprints
    updated_brush.paint = brush.paint
    known_mm = {
        law: max(painted.deepest_mm, 0.0 if law in contradicted else fitted_down_to_mm(brush, law))
        for law in LAWS
        if law in learned
    }
    before_mm = learned_of(brush).get("deepest_mm")
    before_mm = before_mm if isinstance(before_mm, dict) else {}
    new_mm = {law: round(depth, 3) for law, depth in known_mm.items() if np.isfinite(depth)}
    _write_learned(updated_brush, learned_of(brush) | {"deepest_mm": before_mm | new_mm})
    if learned & {"half_width", "tip_to_widest"}:
        updated_brush.footprints = _reshape_outlines(
            brush, updated_brush, laws.front_per_half / known.laws.front_per_half
        )
    return updated_brush


def _choose_law(before, now, is_learned: bool, is_contradicted: bool, painted: Painted, prior: str):
    """Return a law with the range of depths that marks and prior support together.

    Marks support all depths down to the deepest of them. The prior adds its own range, because the fit carries its
    measurements on to the depths without marks. A prior that was assumed, or that the marks contradict, adds nothing.
    """
    if not is_learned:
        return before
    is_measured = before.calibrated_mm and not (before.assumed or is_contradicted)
    least, deepest = before.calibrated_mm if is_measured else (0.0, 0.0)
    return _core.Profile(
        now.coefficients,
        calibrated_mm=(least, max(deepest, painted.deepest_mm)),
        source=f"Law of brush {prior}, updated with {len(painted.marks)} marks of a painted job.",
        half_interval_95=now.half_interval_95,
    )


def _join_covariance(
    brush, updated_brush, learned: set[str], whole: np.ndarray, fitted: dict[str, slice]
) -> np.ndarray:
    """Return the covariance of all coefficients: new for updated laws, unchanged for the others."""
    new_places, old_places = places(updated_brush), places(brush)
    out = np.zeros((new_places[LAWS[-1]].stop,) * 2)
    old_covariance = np.array(brush.covariance)
    for law, other in itertools.product(LAWS, LAWS):
        if law in learned and other in learned:
            out[new_places[law], new_places[other]] = whole[fitted[law], fitted[other]]
        elif len(old_covariance) and law not in learned and other not in learned:
            out[new_places[law], new_places[other]] = old_covariance[old_places[law], old_places[other]]
    return out


def _reshape_outlines(brush, updated_brush, longer: float) -> _core.FootprintTable:
    """Scale outlines to the new half width and widest section; longer: factor in front of that section."""

    def reshape(shape):
        d = shape.depth_mm
        x, y = np.array(shape.outline_mm).T
        wide = updated_brush.half_width.extrapolated(d) / max(brush.half_width.extrapolated(d), 1e-9)
        widest, now = brush.tip_to_widest.extrapolated(d), updated_brush.tip_to_widest.extrapolated(d)
        behind = x * (now / widest if widest > 1e-9 else wide)
        x = np.where(x <= widest, behind, now + (x - widest) * wide * longer)
        return _core.Footprint(d, np.column_stack([x, y * wide]))

    table = brush.footprints
    return _core.FootprintTable(list(map(reshape, table.dragged)), list(map(reshape, table.pressed)))


def has_learned(brush: _core.Brush, photos: list[str]) -> bool:
    """Return whether the brush was already updated by one of the photographs. photos: sha256 of each."""
    return bool(set(photos) & set(_read_learned(brush)["photos"]))


def refuse_learned(brush: _core.Brush, photos: list[str]) -> None:
    """Raise Error if the brush was already updated by one of the photographs. photos: sha256 of each."""
    if used := set(photos) & set(_read_learned(brush)["photos"]):
        raise Error(
            f"brush {brush.name} was already updated with this photograph (sha256 {sorted(used)[0][:12]}): use each "
            "photograph once, or the intervals become too small",
            "prior",
            code="photo-learned-twice",
        )


def other_brush(plan, brush: _core.Brush) -> list[Notice]:
    """Return a notice if the plan was made for an unrelated brush.

    Related brushes are this brush and its predecessors.
    """
    lineage = {brush.sha256, *_read_learned(brush)["brushes"]}
    if not plan.brush_sha256 or plan.brush_sha256 in lineage:
        return []
    sentence = (
        f"the plan was made for another brush, {plan.brush} (sha256 {plan.brush_sha256[:12]}), not for {brush.name} "
        f"({brush.sha256[:12]}) or one of its earlier versions"
    )
    advice = f"make sure that the photograph shows paint of brush {brush.name}"
    return [Notice("brush_sha256", sentence, code="plan-of-other-brush", advice=advice)]


def with_lineage(updated_brush: _core.Brush, brush: _core.Brush, photos: list[str]) -> None:
    """Write into a brush the brush and the photographs from which it was made."""
    before = _read_learned(brush)
    lineage = {"brushes": [*before["brushes"], brush.sha256], "photos": [*before["photos"], *photos]}
    _write_learned(updated_brush, learned_of(updated_brush) | lineage)


def _write_learned(updated_brush: _core.Brush, learned: dict) -> None:
    updated_brush.extra = json.dumps(read_extra_keys(updated_brush.extra) | {LEARNED: learned})


def _read_learned(brush) -> dict:
    learned = learned_of(brush)
    return {
        key: [value for value in values if isinstance(value, str)]
        if isinstance(values := learned.get(key), list)
        else []
        for key in ("brushes", "photos")
    }


def found_height(updated: UpdatedBrush) -> tuple[float, float]:
    """Return how much higher the paper is than taught [mm]. Half the 95 % interval is returned as well."""
    at = height_at(updated.fit)
    return updated.fit.height_mm, float(_core.interval_factor_95() * np.sqrt(updated.covariance[at, at]))
