"""Confidence in the brush, carried into what a plan paints: millimetres on paper.

Linear propagation at the rows of the plan's marks. The law is evaluated only for what the lag changes, by central
differences along the independent directions of its covariance, one standard deviation to either side; the other laws
enter in closed form: m = p + (x_w - b) u, tip = p - b u, width 2 h.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from ... import _core
from ...model.confidence import LAWS, places
from ...model.perturbed import changed_lag

AT_ONCE = 64  # passes whose rows are in memory with all other lags
ROWS = 160  # of a stroke that a band is made from: beyond, it only takes longer
COVARIANCE, RMSE = "covariance", "RMSE"


@dataclass(frozen=True)
class Confidence:
    """95 % half intervals in mm, the largest along a stroke; None where nothing is known or the brush is never taut.

    middle_mm: of the middle of the mark, across its line; ends_mm: of the mark's tip along it, where the brush first
    and last is taut; width_mm: of the mark's width.
    """

    middle_mm: float | None
    ends_mm: float | None
    width_mm: float | None


@dataclass(frozen=True)
class PlanConfidence:
    """source: COVARIANCE, or RMSE where the brush has none: laws as far off as single readings, independently. words:
    the same for people, with the laws that were not measured and do not count."""

    source: str
    words: str
    strokes: tuple[Confidence, ...]
    total: Confidence


@dataclass(frozen=True)
class Band:
    """The 95 % band of the edge of each pass's mark: rings in mm, and its source in words."""

    rings: tuple[list, ...]
    words: str


@dataclass(frozen=True)
class _Effects:
    """What half a 95 % interval along each of K independent directions changes, at rows of a pass."""

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
    """COVARIANCE, RMSE, or None where the brush file says neither."""
    if len(brush.covariance) and np.any(brush.covariance):
        return COVARIANCE
    return RMSE if any(getattr(brush, law).rmse_mm for law in LAWS) else None


def in_words(brush) -> str:
    """For a legend."""
    source = known_from(brush)
    if source is None:
        return "no confidence band: the brush has neither covariance nor RMSE"
    said = "from the brush's covariance" if source == COVARIANCE else "from RMSE, for lack of a covariance"
    missing = [law for law in LAWS if not _counts(brush, law)]
    return f"95 %, {said}" + (f"; without {' and '.join(missing)}, not measured" if missing else "")


def _counts(brush, law: str) -> bool:
    """Whether the variance of a law is known."""
    return bool(np.any(np.diag(covariance_of(brush))[places(brush)[law]]))


def uncertainty(plan, brush, marks) -> PlanConfidence | None:
    """Per pass and in all; None where nothing is known. marks: the plan's, simulated with this brush."""
    source = known_from(brush)
    if source is None:
        return None
    strokes = tuple(_confidence(effects) for effects in _all_effects(plan, brush, marks))
    if not _counts(brush, "half_width"):
        strokes = tuple(replace(each, width_mm=None) for each in strokes)
    return PlanConfidence(source, in_words(brush), strokes, _largest(strokes))


def band(plan, brush, marks) -> Band:
    """Of every pass; without rings where nothing is known. marks: with outlines."""
    if known_from(brush) is None:
        return Band(tuple([] for _ in marks.passes), in_words(brush))
    rings = []
    for effects, trace in zip(_all_effects(plan, brush, marks), marks.passes, strict=True):
        swept = [piece for ring in trace.outline_mm for piece in _swept(ring, effects)]
        rings.append(_core.unite(swept) if swept else [])
    return Band(tuple(rings), in_words(brush))


def covariance_of(brush) -> np.ndarray:
    """Over all coefficients in the order of LAWS; from the RMSE: each law moved as a whole by its own."""
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
    scale = np.concatenate(  # of a coefficient by what it changes at the greatest depth: all in mm
        [brush.depth_range_mm[1] ** np.arange(part.stop - part.start, dtype=float) for part in at.values()]
    )
    covariance = scale[:, None] * covariance_of(brush) * scale
    deviations = np.concatenate(  # each law's half interval in its own standard deviations
        [
            np.full(part.stop - part.start, _core.deviations_of_95(getattr(brush, law).degrees_of_freedom))
            for law, part in at.items()
        ]
    )
    factor, steps = deviations[:, None] * _factor(covariance), _factor(covariance[lag, lag])
    mixing = np.linalg.pinv(steps) @ factor[lag]  # the independent directions of all, in steps of the lag
    sides = [_both_sides(brush, step / scale[lag]) for step in steps.T]
    parts = {law: (factor / scale[:, None])[place] for law, place in at.items()}
    passes, traces = plan.passes, marks.passes  # once: every look copies the list
    for first in range(0, len(traces), AT_ONCE):
        some = slice(first, first + AT_ONCE)
        moved = _moved(brush, passes[some], traces[some], sides)
        for trace, (d_contact, d_along) in zip(traces[some], moved, strict=True):
            yield _effects(brush, trace, parts, d_contact @ mixing, d_along @ mixing)


def _factor(covariance: np.ndarray) -> np.ndarray:
    """L, (n, K) with covariance = L L^T; directions of no weight are left out."""
    values, vectors = np.linalg.eigh((covariance + covariance.T) / 2)
    kept = values > 1e-12 * max(values.max(initial=0.0), 1e-300)
    return vectors[:, kept] * np.sqrt(values[kept])


def _both_sides(brush, step: np.ndarray):
    """The lag a step up and a step down, and how much of the step that was: r stays above 0."""
    depths = np.linspace(*brush.depth_range_mm, 101)
    change = np.abs(np.polynomial.polynomial.polyval(depths, step))
    lag = brush.lag(depths)
    part = min(1.0, 0.5 * float(np.min(lag / np.maximum(change, 1e-300))))
    return *(changed_lag(brush, sign * part * step) for sign in (1, -1)), part


def _moved(brush, passes, traces, sides) -> list[tuple[np.ndarray, np.ndarray]]:
    """By how much each step moves the contact and turns the heading, (n, 2, K) each, at the rows of each pass."""
    if not sides:
        return [(np.zeros((len(trace.pose), 2, 0)),) * 2 for trace in traces]
    up, down, part = zip(*sides, strict=True)
    followed = _core.follow_lags(passes, traces, (*up, *down), brush.depth_range_mm)
    steps, k = 2 * np.array(part), len(sides)
    return [tuple((at[:, :, :k] - at[:, :, k:]) / steps for at in each) for each in followed]


def _effects(brush, trace, parts, d_contact, d_along) -> _Effects:
    depth = np.maximum(trace.depth_mm, 0.0)  # a program that was read may rise over the paper
    contact, along = np.asarray(trace.contact_mm), _unit(np.asarray(trace.heading_rad))
    gap, widest, half = (getattr(brush, law)(depth) for law in LAWS[1:])
    d_gap, d_widest, d_half = (_powers(getattr(brush, law), depth) @ parts[law] for law in LAWS[1:])
    return _Effects(
        contact + (widest - gap)[:, None] * along,
        along,
        widest,
        half,
        np.asarray(trace.taut, bool) & (depth > 0),
        d_contact
        + (widest - gap)[:, None, None] * d_along
        + along[:, :, None] * (d_widest - d_gap)[:, None, :],
        d_contact - gap[:, None, None] * d_along - along[:, :, None] * d_gap[:, None, :],
        d_along,
        d_widest,
        d_half,
    )


def _unit(angle: np.ndarray) -> np.ndarray:
    return np.stack([np.cos(angle), np.sin(angle)], axis=-1)


def _powers(law, depth: np.ndarray) -> np.ndarray:
    """What a law changes with its coefficients; nothing on its floor."""
    powers = np.vander(depth, len(law.coefficients), increasing=True)
    if np.isfinite(law.floor):
        powers[powers @ np.array(law.coefficients) < law.floor + law.floor_slope * depth] = 0.0
    return powers


def _confidence(effects: _Effects) -> Confidence:
    rows = np.flatnonzero(effects.usable)
    if not len(rows):
        return Confidence(None, None, None)
    tangent = _tangents(effects.middle[rows], effects.along[rows])
    normal = np.column_stack([-tangent[:, 1], tangent[:, 0]])
    across = _spread(np.einsum("ij,ijk->ik", normal, effects.d_middle[rows]))
    ends = rows[[0, -1]]
    along = _spread(np.einsum("ij,ijk->ik", effects.along[ends], effects.d_tip[ends]))
    width = 2 * _spread(effects.d_half[rows])
    return Confidence(*(float(values.max()) for values in (across, along, width)))


def _tangents(points: np.ndarray, along: np.ndarray) -> np.ndarray:
    """Unit direction of a line at its points; that of the brush where it stands still."""
    if len(points) < 2:
        return along
    step = np.gradient(points, axis=0)
    length = np.hypot(*step.T)
    return np.where(length[:, None] > 1e-6, step / np.maximum(length, 1e-12)[:, None], along)


def _spread(effects: np.ndarray) -> np.ndarray:
    """Half interval of a sum of independent parts, (n, K) -> (n,)."""
    return np.sqrt(np.sum(np.square(effects), axis=1))


def _largest(strokes: tuple[Confidence, ...]) -> Confidence:
    def largest(name: str):
        return max((value for each in strokes if (value := getattr(each, name)) is not None), default=None)

    return Confidence(*(largest(name) for name in ("middle_mm", "ends_mm", "width_mm")))


def _swept(ring: np.ndarray, effects: _Effects) -> list[np.ndarray]:
    """Return the area in which the edges of an outline may be, as counter-clockwise triangles."""
    if len(ring) < 3 or not len(effects.half):
        return []
    edge = np.roll(ring, -1, axis=0) - ring
    edge /= np.maximum(np.hypot(*edge.T), 1e-12)[:, None]
    outward = np.column_stack([edge[:, 1], -edge[:, 0]])
    outward = outward + np.roll(outward, 1, axis=0)
    outward /= np.maximum(np.hypot(*outward.T), 1e-12)[:, None]
    off = outward * _edge_spread(ring, outward, effects)[:, None]
    outer, inner = ring + off, ring - off
    # two triangles an edge: a quad that is folded over has no area of its own
    next_outer, next_inner = np.roll(outer, -1, axis=0), np.roll(inner, -1, axis=0)
    halves = ((inner, outer, next_outer), (inner, next_outer, next_inner))
    triangles = np.concatenate([np.stack(corners, axis=1) for corners in halves])
    one, two = triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]
    folded = one[:, 0] * two[:, 1] < one[:, 1] * two[:, 0]
    triangles[folded] = triangles[folded, ::-1]
    return list(triangles)


def _edge_spread(ring: np.ndarray, outward: np.ndarray, effects: _Effects) -> np.ndarray:
    """Half interval [mm] of an outline's vertices along its normals: of the footprint that painted each, its
    middle moved, turned with the brush, its tip moved on and its sides spread."""
    rows = np.unique(np.linspace(0, len(effects.half) - 1, ROWS).round().astype(int))
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
    return _spread(moved)
