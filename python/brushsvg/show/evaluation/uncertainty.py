"""Propagate the uncertainty of the brush into the marks of a plan, in millimetres on the paper.

The propagation is linear, at the rows of the plan's marks. Only changes of the lag need new evaluations of the law:
central differences along the independent directions of the lag's covariance, one standard deviation to either side.
The other laws enter in closed form: middle m = p + (x_w - b) u, tip = p - b u, width 2 h, with the contact p, the
heading u, the distance x_w from the tip to the widest point, the tip gap b and the half width h.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from ... import _core
from ...model.confidence import LAWS, places
from ...model.perturbed import changed_lag

PASSES_AT_ONCE = 64  # passes whose rows with all changed lags are in memory together
MAX_BAND_ROWS = 160  # rows of a stroke that a band is made from: more only need more time
COVARIANCE, RMSE = "covariance", "RMSE"


@dataclass(frozen=True)
class Confidence:
    """Halves of 95 % intervals in mm, the largest along a stroke.

    middle_mm: of the middle of the mark, across its line; ends_mm: of the mark's tip along the line, where the brush is
    first and last taut; width_mm: of the mark's width. None where nothing is known or the brush is never taut.
    """

    middle_mm: float | None
    ends_mm: float | None
    width_mm: float | None


@dataclass(frozen=True)
class PlanConfidence:
    """The confidence in the marks of a plan.

    source: COVARIANCE, or RMSE where the brush has no covariance: then each law is off by as much as a single reading,
    independently of the others; words: the source in words, with the laws that were not measured and do not count.
    """

    source: str
    words: str
    strokes: tuple[Confidence, ...]
    total: Confidence


@dataclass(frozen=True)
class Band:
    """The 95 % bands of the edges of marks.

    rings: rings in mm per pass; words: the source of the bands in words.
    """

    rings: tuple[list, ...]
    words: str


@dataclass(frozen=True)
class _Effects:
    """Changes at the n rows of a pass by uncertain laws, in K independent directions.

    The laws change by half a 95 % interval along each direction.
    """

    middle: np.ndarray  # (n, 2)
    along: np.ndarray  # (n, 2), u
    widest: np.ndarray  # (n,), x_w
    half: np.ndarray  # (n,), h
    usable: np.ndarray  # (n,), taut rows on the paper
    d_middle: np.ndarray  # (n, 2, K)
    d_tip: np.ndarray  # (n, 2, K)
    d_along: np.ndarray  # (n, 2, K)
    d_widest: np.ndarray  # (n, K)
    d_half: np.ndarray  # (n, K)


def known_from(brush) -> str | None:
    """Return COVARIANCE, RMSE, or None where the brush file has neither."""
    if len(brush.covariance) and np.any(brush.covariance):
        return COVARIANCE
    return RMSE if any(getattr(brush, law).rmse_mm for law in LAWS) else None


def in_words(brush) -> str:
    """Return the source of the confidence in words, for a legend."""
    source = known_from(brush)
    if source is None:
        return "no confidence band: the brush has neither covariance nor RMSE"
    source_words = "from the brush's covariance" if source == COVARIANCE else "from RMSE, for lack of a covariance"
    missing = [law for law in LAWS if not _is_law_measured(brush, law)]
    return f"95 %, {source_words}" + (f"; without {' and '.join(missing)}, not measured" if missing else "")


def _is_law_measured(brush, law: str) -> bool:
    """Return whether the variance of a law is known."""
    return bool(np.any(np.diag(covariance_of(brush))[places(brush)[law]]))


def is_law_interval_known(brush, law: str) -> bool:
    """Return whether it is known how exact a law is. An RMSE of 0 means that the law is exact."""
    return _is_law_measured(brush, law) or getattr(brush, law).rmse_mm is not None


def estimate_confidence(plan, brush, marks) -> PlanConfidence | None:
    """Return the confidence in the marks of a plan, per pass and in total.

    Returns None where nothing is known. marks: the plan's marks, simulated with this brush.
    """
    source = known_from(brush)
    if source is None:
        return None
    strokes = tuple(_stroke_confidence(effects) for effects in _all_effects(plan, brush, marks))
    if not _is_law_measured(brush, "half_width"):
        strokes = tuple(replace(each, width_mm=None) for each in strokes)
    return PlanConfidence(source, in_words(brush), strokes, _largest(strokes))


def make_band(plan, brush, marks) -> Band:
    """Return the band of every pass. It has no rings where nothing is known. marks: with outlines."""
    if known_from(brush) is None:
        return Band(tuple([] for _ in marks.passes), in_words(brush))
    rings = []
    for effects, trace in zip(_all_effects(plan, brush, marks), marks.passes, strict=True):
        swept = [piece for ring in trace.outline_mm for piece in _swept_triangles(ring, effects)]
        rings.append(_core.unite(swept) if swept else [])
    return Band(tuple(rings), in_words(brush))


def covariance_of(brush) -> np.ndarray:
    """Return the covariance of all coefficients in the order of LAWS.

    Without a covariance it is diagonal: each law is moved as a whole by its RMSE.
    """
    if len(brush.covariance) and np.any(brush.covariance):
        return np.array(brush.covariance)
    variances = []
    for law in LAWS:
        profile = getattr(brush, law)
        variances += [(profile.rmse_mm or 0.0) ** 2] + [0.0] * (len(profile.coefficients) - 1)
    return np.diag(variances)


def _all_effects(plan, brush, marks):
    _core.refuse_tilted(plan.passes, "how sure a mark is is known of a brush held upright")
    at = places(brush)
    lag = at["lag"]
    scale = np.concatenate(  # converts each coefficient to its effect at the greatest depth, in mm
        [brush.depth_range_mm[1] ** np.arange(part.stop - part.start, dtype=float) for part in at.values()]
    )
    covariance = scale[:, None] * covariance_of(brush) * scale
    deviations = np.concatenate(  # half a 95 % interval of each law in standard deviations
        [
            np.full(part.stop - part.start, _core.interval_factor_95(getattr(brush, law).degrees_of_freedom))
            for law, part in at.items()
        ]
    )
    factor = deviations[:, None] * _covariance_factor(covariance)
    steps = _covariance_factor(covariance[lag, lag])
    # The independent directions of all laws, in steps of the lag.
    mixing = np.linalg.pinv(steps) @ factor[lag]
    sides = [_lag_steps(brush, step / scale[lag]) for step in steps.T]
    parts = {law: (factor / scale[:, None])[place] for law, place in at.items()}
    passes, traces = plan.passes, marks.passes  # fetched once, because every access copies the list
    for first in range(0, len(traces), PASSES_AT_ONCE):
        block = slice(first, first + PASSES_AT_ONCE)
        changes = _moved_by_steps(brush, passes[block], traces[block], sides)
        for trace, (d_contact, d_along) in zip(traces[block], changes, strict=True):
            yield _effects(brush, trace, parts, d_contact @ mixing, d_along @ mixing)


def _covariance_factor(covariance: np.ndarray) -> np.ndarray:
    """Return L (n, K) with covariance = L L^T. Directions without variance are left out."""
    values, vectors = np.linalg.eigh((covariance + covariance.T) / 2)
    is_kept = values > 1e-12 * max(values.max(initial=0.0), 1e-300)
    return vectors[:, is_kept] * np.sqrt(values[is_kept])


def _lag_steps(brush, step: np.ndarray):
    """Return the laws of the lag a step up and a step down.

    Returns also the share of the step that was taken. The share is limited so that the lag r stays above 0.
    """
    least, deepest = brush.depth_range_mm
    # When it is set down, the brush also passes smaller depths than its range has. A floor keeps its lag from being
    # negative.
    depths = np.linspace(least if brush.lag.floor >= 0 else 0.0, deepest, 101)
    change = np.abs(np.polynomial.polynomial.polyval(depths, step))
    lag = brush.lag(depths)
    # Where the step changes nothing, it has no limit: a lag may be 0 at depth 0.
    part = min(1.0, 0.5 * float(np.min(np.divide(lag, change, out=np.full_like(lag, np.inf), where=change > 0.0))))
    return *(changed_lag(brush, sign * part * step) for sign in (1, -1)), part


def _moved_by_steps(brush, passes, traces, sides) -> list[tuple[np.ndarray, np.ndarray]]:
    """Return the changes of contact and heading by each step, (n, 2, K), at each pass's rows."""
    if not sides:
        return [(np.zeros((len(trace.pose), 2, 0)),) * 2 for trace in traces]
    up, down, part = zip(*sides, strict=True)
    followed = _core.follow_lags(passes, traces, (*up, *down), brush.depth_range_mm)
    steps, k = 2 * np.array(part), len(sides)
    return [tuple((at[:, :, :k] - at[:, :, k:]) / steps for at in pair) for pair in followed]


def _effects(brush, trace, parts, d_contact, d_along) -> _Effects:
    depth = np.maximum(trace.depth_mm, 0.0)  # the brush of a program that was read may rise above the paper
    contact, along = np.asarray(trace.contact_mm), _unit_vectors(np.asarray(trace.heading_rad))
    gap, widest, half = (getattr(brush, law)(depth) for law in LAWS[1:])
    d_gap, d_widest, d_half = (_law_derivatives(getattr(brush, law), depth) @ parts[law] for law in LAWS[1:])
    return _Effects(
        contact + (widest - gap)[:, None] * along,
        along,
        widest,
        half,
        np.asarray(trace.taut, bool) & (depth > 0),
        d_contact + (widest - gap)[:, None, None] * d_along + along[:, :, None] * (d_widest - d_gap)[:, None, :],
        d_contact - gap[:, None, None] * d_along - along[:, :, None] * d_gap[:, None, :],
        d_along,
        d_widest,
        d_half,
    )


def _unit_vectors(angle: np.ndarray) -> np.ndarray:
    return np.stack([np.cos(angle), np.sin(angle)], axis=-1)


def _law_derivatives(law, depth: np.ndarray) -> np.ndarray:
    """Return the derivatives (n, coefficients) of a law by its coefficients.

    The derivatives are 0 on the floor of the law.
    """
    powers = np.vander(depth, len(law.coefficients), increasing=True)
    if np.isfinite(law.floor):
        powers[powers @ np.array(law.coefficients) < law.floor + law.floor_slope * depth] = 0.0
    return powers


def _stroke_confidence(effects: _Effects) -> Confidence:
    rows = np.flatnonzero(effects.usable)
    if not len(rows):
        return Confidence(None, None, None)
    tangent = _tangents(effects.middle[rows], effects.along[rows])
    normal = np.column_stack([-tangent[:, 1], tangent[:, 0]])
    across = _half_interval(np.einsum("ij,ijk->ik", normal, effects.d_middle[rows]))
    ends = rows[[0, -1]]
    along = _half_interval(np.einsum("ij,ijk->ik", effects.along[ends], effects.d_tip[ends]))
    width = 2 * _half_interval(effects.d_half[rows])
    return Confidence(*(float(values.max()) for values in (across, along, width)))


def _tangents(points: np.ndarray, along: np.ndarray) -> np.ndarray:
    """Return unit directions (n, 2) of a line at its points.

    Where the line does not move, it is the direction of the brush.
    """
    if len(points) < 2:
        return along
    step = np.gradient(points, axis=0)
    length = np.hypot(*step.T)
    return np.where(length[:, None] > 1e-6, step / np.maximum(length, 1e-12)[:, None], along)


def _half_interval(effects: np.ndarray) -> np.ndarray:
    """Return half the interval of a sum of independent parts, (n, K) -> (n,)."""
    return np.sqrt(np.sum(np.square(effects), axis=1))


def _largest(strokes: tuple[Confidence, ...]) -> Confidence:
    def largest(name: str):
        return max((value for stroke in strokes if (value := getattr(stroke, name)) is not None), default=None)

    return Confidence(*(largest(name) for name in ("middle_mm", "ends_mm", "width_mm")))


def _swept_triangles(ring: np.ndarray, effects: _Effects) -> list[np.ndarray]:
    """Return the area in which the edge of an outline may be. The area is given by counter-clockwise triangles."""
    if len(ring) < 3 or not len(effects.half):
        return []
    edge = np.roll(ring, -1, axis=0) - ring
    edge /= np.maximum(np.hypot(*edge.T), 1e-12)[:, None]
    outward = np.column_stack([edge[:, 1], -edge[:, 0]])
    outward = outward + np.roll(outward, 1, axis=0)
    outward /= np.maximum(np.hypot(*outward.T), 1e-12)[:, None]
    offset = outward * _edge_half_interval(ring, outward, effects)[:, None]
    outer, inner = ring + offset, ring - offset
    # Each edge gives two triangles instead of a quad, because a quad that is folded over has no proper area.
    next_outer, next_inner = np.roll(outer, -1, axis=0), np.roll(inner, -1, axis=0)
    halves = ((inner, outer, next_outer), (inner, next_outer, next_inner))
    triangles = np.concatenate([np.stack(corners, axis=1) for corners in halves])
    side_1, side_2 = triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]
    is_clockwise = side_1[:, 0] * side_2[:, 1] < side_1[:, 1] * side_2[:, 0]
    triangles[is_clockwise] = triangles[is_clockwise, ::-1]
    return list(triangles)


def _edge_half_interval(ring: np.ndarray, outward: np.ndarray, effects: _Effects) -> np.ndarray:
    """Return half the interval [mm] of an outline's vertices along its normals, (n,).

    Each vertex belongs to the footprint that painted it. The footprint's middle moves, it turns with the brush, its tip
    moves along, and its sides spread.
    """
    rows = np.unique(np.linspace(0, len(effects.half) - 1, MAX_BAND_ROWS).round().astype(int))
    half = np.maximum(effects.half[rows], 1e-3)
    away = np.linalg.norm(ring[:, None] - effects.middle[rows], axis=2) / half
    row = rows[away.argmin(axis=1)]
    along = effects.along[row]
    left = np.column_stack([-along[:, 1], along[:, 0]])
    offset = ring - effects.middle[row]
    ahead, sideways = np.sum(offset * along, axis=1), np.sum(offset * left, axis=1)
    turn = np.einsum("ij,ijk->ik", left, effects.d_along[row])  # d(theta)
    moved = np.einsum("ij,ijk->ik", outward, effects.d_middle[row])
    moved += turn * np.sum(outward * (ahead[:, None] * left - sideways[:, None] * along), axis=1)[:, None]
    share = np.clip(-ahead / np.maximum(effects.widest[row], 1e-3), 0, 1)  # 1 at the tip
    moved -= effects.d_widest[row] * (share * np.sum(outward * along, axis=1))[:, None]
    spread = np.clip(sideways / np.maximum(effects.half[row], 1e-3), -1, 1)
    moved += effects.d_half[row] * (spread * np.sum(outward * left, axis=1))[:, None]
    return _half_interval(moved)
