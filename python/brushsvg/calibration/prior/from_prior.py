"""Update a known brush by further painted marks: only the laws that they determine change."""

from __future__ import annotations

import itertools
import json
from dataclasses import dataclass

import numpy as np
from numpy.polynomial.polynomial import polyval

from ... import _core
from ...errors import Error, Notice
from ...model.confidence import (
    LAWS,
    LEARNED,
    fitted_down_to_mm,
    half_interval_mm,
    learned_of,
    places,
)
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
from ..marks.machine_found import ask_for
from ..marks.mark_input import Painted, depths_painted
from ..marks.stray_marks import Stray, find_strays
from .prior import DEPTHS, KnownLaws, known_laws, numbers_of, root_of_inverse

# Ratio of a law's standard deviations after and before, at some depth: above it, the marks add nothing to the law.
LEARNED_BELOW = 0.9
ROUNDS = 20
LOOSE = 0.25  # of a law, standard deviation: further off than brushes of one make are
LIKELY = 1.645  # normal deviate: a brush as far from its prior is met once in twenty times
# Of a law, standard deviation: what a polynomial of low degree leaves of it at the depths that were painted. With 0 the
# marks of shallow strokes would be sure of the depths below: what follows round-6 to 7 mm is 12 % off at 10 mm.
FOLLOWED = 0.01


@dataclass(frozen=True)
class Updated:
    """known: the prior; wider: by law, the factor of its intervals that was needed; doubts_left: by law, the least
    ratio of the standard deviation now to that before, and at which depth. covariance: of all that was fitted."""

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
        return self.doubts_left[law][0] < LEARNED_BELOW


def marks_with_prior(marks: list) -> Painted:
    """Any marks: what they leave open the prior says."""
    ways = [np.array(mark.poses_mm) for mark in marks]
    return Painted(marks, max(float(-poses[:, 2].min()) for poses in ways), depths_painted(ways))


def update_brush(
    painted: Painted,
    brush: _core.Brush,
    name: str,
    edge_mm: float = 0.0,
    machine: tuple[str, ...] = (),
    displacement_mm: float | None = None,
) -> Updated:
    """edge_mm: as for calibrate_marks; machine: parts of it that are found as well; displacement_mm: standard deviation
    of a mark's place, in x and in y, where that is known. Error where the marks are not of this brush at all."""
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
    ask_for(options, machine)
    fit, wider = _fit_wide_enough(painted.marks, known, options)
    refuse_many_outliers(fit, painted)
    astray = tuple(find_strays(painted.marks, fit))
    if astray:
        refuse_many(astray, painted)
        gone = {each.mark.stroke for each in astray}
        painted = marks_with_prior([mark for mark in painted.marks if mark.stroke not in gone])
        fit, wider = _fit_wide_enough(painted.marks, known, options)
    laws, covariance = _followed(known, known.widened(wider), fit, painted.deepest_mm)
    if edge_mm > 0:
        for moved in (
            change_by_edges(fit, painted.marks, options, edge_mm),
            change_by_wetter_marks(fit, options.deepest_mm, edge_mm),
        ):
            covariance += np.outer(moved, moved)
    left = _doubts_left(known.widened(wider), covariance, known.laws, brush)
    changed = {law for law in LAWS if left[law][0] < LEARNED_BELOW}
    made = _brush_of(brush, known, laws, covariance, changed, name, painted)
    _core.check(made)
    return Updated(made, brush, known, wider, left, fit, painted, covariance, astray, options)


def _fit_wide_enough(marks: list, known: KnownLaws, options) -> tuple[object, dict[str, float]]:
    """A law that is further from its prior than that allows is fitted with a wider one. One that is too narrow for
    another brush of the same make would hold the law where it is: edges far from there would count as wild,
    have no say, and leave it sure of itself. So the marks are fitted first with a loose prior."""
    loosened = known.loosened(LOOSE)
    options.laws = known.prior(loosened)
    loose = _core.fit_marks(marks, known.laws, options)
    wider = too_narrow(known, known.widened(loosened), loose)
    options.laws = known.prior(wider)
    return _core.fit_marks(marks, loose.laws, options), wider


def _followed(
    known: KnownLaws, before: np.ndarray, fit, deepest_mm: float
) -> tuple[_core.MarkLaws, np.ndarray]:
    """Laws and covariance where marks down to this depth determine the true law only as far as a polynomial follows it.

    In numbers in which the prior (covariance `before`) is standard normal: the marks' information L becomes that of
    what they measured and F, the covariance of what it does not follow, together: L - L (L + 1/F)^-1 L.
    """
    size = len(before)
    root, after = root_of_inverse(before), np.array(fit.covariance)
    values, vectors = np.linalg.eigh(root @ after[:size, :size] @ root.T)
    information = (vectors * np.maximum(1.0 / np.maximum(values, 1e-12) - 1.0, 0.0)) @ vectors.T
    evidence = (np.eye(size) + information) @ root @ (_numbers(fit.laws) - _numbers(known.laws))
    unfollowed = np.linalg.inv(root @ known.unfollowed(FOLLOWED, deepest_mm) @ root.T)
    kept = np.eye(size) - information @ np.linalg.inv(information + unfollowed)
    now = np.linalg.inv(np.eye(size) + kept @ information)
    back = np.linalg.inv(root)
    numbers = _numbers(known.laws) + back @ now @ kept @ evidence
    after[:size, :size] = back @ (now + now.T) / 2 @ back.T
    at = {law: numbers[place].tolist() for law, place in numbers_of().items()}
    one = fit.laws
    ratio = float(at["tip_to_widest"][0])
    laws = _core.MarkLaws(
        at["lag"], [0.0, *at["tip_gap"]], [0.0, *at["half_width"]], ratio, one.front_per_half, one.round_tail
    )
    return laws, after


def too_narrow(known: KnownLaws, loosened: np.ndarray, loose) -> dict[str, float]:
    """By law, how many times as wide its prior must be for the brush to be a likely one.

    loose: fitted with the covariance `loosened` as prior. With the information L of the marks and the covariance S of
    the fit, it moves from the prior by S L (off + noise of the marks), off having the prior's covariance.
    """
    size = len(known.covariance)
    after = np.array(loose.covariance)[:size, :size]
    root = root_of_inverse(after)
    information = root.T @ root - np.linalg.inv(loosened)
    moved, wider = _numbers(loose.laws) - _numbers(known.laws), {}
    for _ in range(ROUNDS):
        off = after @ information
        expected = off @ known.widened(wider) @ off.T + off @ after
        more = {}
        for law, place in numbers_of().items():
            ratio = _off_as_expected(
                moved[place], expected[place, place], loosened[place, place], after[place, place]
            )
            if ratio > 1.0:
                more[law] = ratio
        if not more:
            break
        wider = {law: wider.get(law, 1.0) * more.get(law, 1.0) for law in LAWS}
    return wider


def _off_as_expected(moved, expected, before, after) -> float:
    """How many times as far it moved as expected (rms), over the directions that the marks determine; 1 where
    that is likely."""
    root = root_of_inverse(before)
    values, vectors = np.linalg.eigh(root @ after @ root.T)
    along = vectors[:, values < LEARNED_BELOW].T @ root
    count = len(along)
    if not count:
        return 1.0
    moved_along = along @ moved
    squared = float(moved_along @ np.linalg.lstsq(along @ expected @ along.T, moved_along, rcond=None)[0])
    return float(np.sqrt(squared / count)) if squared > _quantile(count) else 1.0


def _quantile(freedom: int) -> float:
    """Return the 95 % quantile of chi-square (Wilson and Hilferty)."""
    part = 2.0 / (9.0 * freedom)
    return freedom * (1.0 - part + LIKELY * np.sqrt(part)) ** 3


def _numbers(laws) -> np.ndarray:
    return np.concatenate([laws.lag, laws.tip_gap[1:], laws.half_width[1:], [laws.widest_per_half]])


def bands_mm(covariance: np.ndarray, laws, depths: np.ndarray) -> dict[str, np.ndarray]:
    """By law, half the 95 % interval at depths, of the numbers of a fit."""
    at, out = numbers_of(), {}
    for law in ("lag", "tip_gap", "half_width"):
        block = covariance[at[law], at[law]]
        if law != "lag":
            block = np.pad(block, ((1, 0), (1, 0)))
        out[law] = half_interval_mm(block, depths, None)
    half = polyval(depths, laws.half_width)
    ratio = at["tip_to_widest"].start
    out["tip_to_widest"] = _core.deviations_of_95() * np.sqrt(covariance[ratio, ratio]) * half
    return out


def _doubts_left(before: np.ndarray, after: np.ndarray, laws, brush) -> dict[str, tuple[float, float]]:
    """tip_to_widest: of its ratio to the half width."""
    depths = np.linspace(*brush.depth_range_mm, DEPTHS)[1:]
    was, is_now = bands_mm(before, laws, depths), bands_mm(after, laws, depths)
    out = {}
    for law in LAWS:
        share = is_now[law] / np.maximum(was[law], 1e-12)
        best = int(np.argmin(share))
        out[law] = (float(share[best]), float(depths[best]))
    return out


def _brush_of(brush, known: KnownLaws, laws, covariance, learned: set[str], name: str, painted: Painted):
    """Return the brush with the laws that the marks determine; the others stay as they are."""
    if learned & {"half_width", "tip_to_widest"}:
        learned = learned | {"tip_to_widest"}  # it is counted in half widths
    made = brush_of(laws, name, brush.depth_range_mm, covariance)
    fitted = places(made)
    whole = to_brush_covariance(laws, covariance)
    for law in LAWS:
        setattr(made, law, _law(getattr(brush, law), getattr(made, law), law in learned, painted, brush.name))
    made.kind, made.max_speed_mm_s, made.paint_depth_mm = (
        brush.kind,
        brush.max_speed_mm_s,
        brush.paint_depth_mm,
    )
    made.covariance = _joined(brush, made, learned, whole, fitted).tolist()
    made.extra, made.footprints, made.paint = brush.extra, brush.footprints, brush.paint
    known_mm = {law: max(painted.deepest_mm, fitted_down_to_mm(brush, law)) for law in LAWS if law in learned}
    before_mm = learned_of(brush).get("deepest_mm")
    before_mm = before_mm if isinstance(before_mm, dict) else {}
    new_mm = {law: round(depth, 3) for law, depth in known_mm.items() if np.isfinite(depth)}
    _say_learned(made, learned_of(brush) | {"deepest_mm": before_mm | new_mm})
    if learned & {"half_width", "tip_to_widest"}:
        made.footprints = _reshaped(brush, made, laws.front_per_half / known.laws.front_per_half)
    return made


def _law(before, now, is_learned: bool, painted: Painted, prior: str):
    if not is_learned:
        return before
    least, deepest = before.calibrated_mm or (0.0, 0.0)
    return _core.Profile(
        now.coefficients,
        calibrated_mm=(least, max(deepest, painted.deepest_mm)),
        source=f"That of brush {prior}, updated by {len(painted.marks)} marks of a painted job.",
        half_interval_95=now.half_interval_95,
    )


def _joined(brush, made, learned: set[str], whole: np.ndarray, fitted: dict[str, slice]) -> np.ndarray:
    """Covariance over the coefficients of the brush: of updated laws, and of the others as it was."""
    at, was = places(made), places(brush)
    out = np.zeros((at[LAWS[-1]].stop,) * 2)
    known = np.array(brush.covariance)
    for law, other in itertools.product(LAWS, LAWS):
        if law in learned and other in learned:
            out[at[law], at[other]] = whole[fitted[law], fitted[other]]
        elif len(known) and law not in learned and other not in learned:
            out[at[law], at[other]] = known[was[law], was[other]]
    return out


def _reshaped(brush, made, longer: float) -> _core.FootprintTable:
    """Return its outlines with the half width and widest section of the laws, the part in front of that as much
    longer."""

    def reshaped(shape):
        d = shape.depth_mm
        x, y = np.array(shape.outline_mm).T
        wide = made.half_width.extrapolated(d) / max(brush.half_width.extrapolated(d), 1e-9)
        widest, now = brush.tip_to_widest.extrapolated(d), made.tip_to_widest.extrapolated(d)
        behind = x * (now / widest if widest > 1e-9 else wide)
        x = np.where(x <= widest, behind, now + (x - widest) * wide * longer)
        return _core.Footprint(d, np.column_stack([x, y * wide]))

    table = brush.footprints
    return _core.FootprintTable(list(map(reshaped, table.dragged)), list(map(reshaped, table.pressed)))


def has_learned(brush: _core.Brush, photos: list[str]) -> bool:
    """photos: sha256 of each: whether the brush was updated by one of them."""
    return bool(set(photos) & set(_learned(brush)["photos"]))


def refuse_learned(brush: _core.Brush, photos: list[str]) -> None:
    """photos: sha256 of each."""
    if known := set(photos) & set(_learned(brush)["photos"]):
        raise Error(
            f"brush {brush.name} was made from the same photograph (sha256 {sorted(known)[0][:12]}): used twice, it "
            "would seem twice as sure",
            "prior",
            code="photo-learned-twice",
        )


def other_brush(plan, brush: _core.Brush) -> list[Notice]:
    """A notice where the plan was made neither for this brush nor for one that it was made from."""
    line = {brush.sha256, *_learned(brush)["brushes"]}
    if not plan.brush_sha256 or plan.brush_sha256 in line:
        return []
    sentence = (
        f"the plan was made for another brush, {plan.brush} (sha256 {plan.brush_sha256[:12]}), not for {brush.name} "
        f"({brush.sha256[:12]}) nor one that this was made from"
    )
    advice = f"make sure that the photograph shows paint of brush {brush.name}"
    return [Notice("brush_sha256", sentence, code="plan-of-other-brush", advice=advice)]


def with_lineage(made: _core.Brush, brush: _core.Brush, photos: list[str]) -> None:
    """Writes into a brush what it was made from."""
    before = _learned(brush)
    said = {"brushes": [*before["brushes"], brush.sha256], "photos": [*before["photos"], *photos]}
    _say_learned(made, learned_of(made) | said)


def _say_learned(made: _core.Brush, said: dict) -> None:
    made.extra = json.dumps(json.loads(made.extra or "{}") | {LEARNED: said})


def _learned(brush) -> dict:
    said = learned_of(brush)
    return {
        key: [each for each in values if isinstance(each, str)]
        if isinstance(values := said.get(key), list)
        else []
        for key in ("brushes", "photos")
    }


def found_height(updated: Updated) -> tuple[float, float]:
    """Return how much higher the paper is than taught [mm], and half its 95 % interval."""
    at = height_at(updated.fit)
    return updated.fit.height_mm, float(_core.deviations_of_95() * np.sqrt(updated.covariance[at, at]))
