"""Attribute errors: the difference of paint and prediction, split by the effect of each cause on the edges of all
marks.

Least squares, linear in numbers of the sheet, the machine, the paper and the brush, in a place of its own of each
stroke, and in the part of the width that the reading of edges leaves open; repeated at its result until it converges.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ... import _core
from ...errors import Error
from ..edge_offsets import EVERY_MM, LEVEL, Outline, along, offsets_of, seen
from ..photographs import Comparison, TargetStroke
from ..placing import Canvas
from .model import BRUSH, MACHINE, PAPER, SHEET, FaultModel, Number

OWN, DRY = "each stroke's own place", "missing paint"
CAUSES = (SHEET, MACHINE, PAPER, BRUSH, OWN, DRY)
REACHES_MM = (2.5, 1.2, 0.8, 0.8)  # of the search for edges: first those of a brush that is 20 % off
OWN_MM = (0.02, 0.2, 1.0)  # standard deviation of own places: at least, to begin with, at most
EDGE_MM = 0.03  # the same of what reading an edge leaves open
FLOOR_MM = 0.01  # of edges, standard deviation: no photograph is read better
# A brush is never quite its model. Where it is not, whole sides of a mark are elsewhere, which the fit then takes for
# this or that number: two simulators that know the same brush differ so far (standard deviation), over such lengths.
MISFIT_MM, MISFIT_LONG_MM = 0.03, 6.0
LEAST_EDGES = 60  # on fewer the numbers rest on their priors
FEW_STROKES, MOST_STROKES = (
    3,
    40,
)  # fewer do not separate a common place from their own; of more the largest are used
TUNING = 1.345  # Huber's
DRAWS = 200
FINE_PX_PER_MM = 8.0
ALIKE = 0.3  # share of a cause's doubt that is left once another is known: below, they are hard to separate
MODEL_ERROR_MM = 0.04  # distance of a model from the paint all round by its own doubt
DOUBT_MM = 0.05  # less of it matters to nobody


@dataclass(frozen=True)
class Found:
    """An error of one number, and half its 95 % interval."""

    number: Number
    value: float
    half: float


@dataclass(frozen=True)
class Share:
    """The gain in overlap if one cause alone were corrected, with its 95 % interval."""

    cause: str
    gain: float
    low: float
    high: float


@dataclass(frozen=True)
class Faults:
    """overlap: with the target, of paint with these faults alone; own_mm: rms of the strokes' own places; rest_mm:
    rms of edges beyond all that; alike: pairs of causes that these marks hardly separate; first: what to fix first,
    None where no gain is certain."""

    found: tuple[Found, ...]
    shares: tuple[Share, ...]
    overlap: float
    own_mm: float
    rest_mm: float
    edges: int
    alike: tuple[tuple[str, str], ...]
    first: str | None


def attribute_errors(
    plan, brush, strokes: list[TargetStroke], seen_of: Comparison, learned: bool = False
) -> Faults | None:
    """plan: as commanded; strokes: those that were compared; learned: whether the brush was made from them. None
    where too few edges are seen, where things are on the sheet, or where no brush has the numbers that would explain
    them."""
    painting = [stroke for stroke in strokes if stroke.predicted]
    if len(painting) < FEW_STROKES or seen_of.has_things:
        return None
    size = {stroke.stroke: sum(len(ring) for ring in stroke.predicted) for stroke in painting}
    largest = sorted(size, key=size.get, reverse=True)[:MOST_STROKES]
    strokes = [stroke for stroke in painting if stroke.stroke in largest]
    common, middle = seen_of.common, seen_of.middle_mm
    neighbours = [
        [common.moved(ring, middle) for ring in stroke.predicted]
        for stroke in painting
        if stroke.stroke not in largest
    ]
    names = [stroke.stroke for stroke in strokes]
    model = FaultModel(plan, brush, tuple(names), middle, learned)
    try:
        fit = _fit(model, names, seen_of, neighbours)
    except Error:
        return None
    if fit is None:
        return None
    fault_values, own, covariance, outline, slopes, residual, edges = fit
    count = len(model.numbers)
    halves = _core.deviations_of_95() * np.sqrt(np.diag(covariance)[:count])
    found = tuple(
        Found(number, float(value), float(half))
        for number, value, half in zip(model.numbers, fault_values, halves, strict=True)
    )
    shares, overlap = _shares(model, names, strokes, fault_values, own, covariance, outline, slopes, seen_of)
    sure = [share for share in shares if share.low > 0.005]
    return Faults(
        found,
        shares,
        overlap,
        float(np.sqrt(np.square(own).sum(axis=1).mean())),
        float(np.sqrt(np.mean(np.square(residual)))),
        edges,
        _alike(model, covariance, slopes),
        max(sure, key=lambda share: share.gain).cause if sure else None,
    )


def _fit(model: FaultModel, names, found: Comparison, neighbours):
    numbers = model.numbers
    count, sigma_own = len(numbers), OWN_MM[1]
    fault_values = np.zeros(count)
    fault_values[:3] = (*found.common.shift_mm, np.degrees(found.common.turn_rad))
    own = np.zeros((len(names), 2))
    for reach in REACHES_MM:
        rings = _rings(model, names, fault_values, own)
        outline = along(rings)
        off = seen(outline, rings, neighbours, found.painted, found.canvas, reach)
        slopes = _slopes(model, names, fault_values, own, outline, rings)
        here = ~np.isnan(off)
        if here.sum() < LEAST_EDGES:
            return None
        now = np.concatenate([fault_values, own.ravel(), [0.0]])
        for _ in range(2):
            sigmas = [number.sigma for number in numbers]
            prior = np.array([*sigmas, *[sigma_own] * own.size, EDGE_MM]) ** -2.0
            step, covariance, residual = _solved(slopes[here], off[here], outline.stroke[here], prior, now)
            moved = (own.ravel() + step[count:-1]).reshape(-1, 2)
            spread = np.diag(covariance)[count:-1].reshape(-1, 2)
            sigma_own = float(np.clip(np.sqrt(np.mean(moved**2 + spread)), OWN_MM[0], OWN_MM[2]))
        fault_values, own = fault_values + step[:count], moved
        fault_values[8:10] = np.maximum(fault_values[8:10], 0.0)
    return fault_values, own, covariance, outline, slopes, residual, int(here.sum())


def _solved(slopes, off, stroke, prior, now):
    """A step, its covariance, and what is left: Huber's weights, as many edges as are independent of each other, and
    the model's misfit in addition."""
    weight, like = np.ones(len(off)), 1.0
    scale = max(1.4826 * float(np.median(np.abs(off - np.median(off)))), FLOOR_MM)
    misfit = MISFIT_MM**2 * MISFIT_LONG_MM / EVERY_MM
    for _ in range(5):
        weights = weight / (scale**2 / like + misfit)
        information = (slopes.T * weights) @ slopes + np.diag(prior)
        step = np.linalg.solve(information, slopes.T @ (weights * off) - prior * now)
        residual = off - slopes @ step
        scale = max(1.4826 * float(np.median(np.abs(residual))), FLOOR_MM)
        weight = np.minimum(1.0, TUNING * scale / np.maximum(np.abs(residual), 1e-9))
        clipped = np.clip(residual, -3 * scale, 3 * scale)
        same = stroke[1:] == stroke[:-1]
        together = float(np.mean((clipped[1:] * clipped[:-1])[same]) / max(np.mean(clipped**2), 1e-9))
        like = (1 - min(max(together, 0.0), 0.9)) / (1 + min(max(together, 0.0), 0.9))
    return step, np.linalg.inv(information), residual


def _rings(model, names, fault_values, own) -> list[list[np.ndarray]]:
    rings = model.rings(fault_values)
    return [[ring + shift for ring in rings.get(name, [])] for name, shift in zip(names, own, strict=True)]


def _slopes(model, names, fault_values, own, outline: Outline, rings) -> np.ndarray:
    """(n, numbers + 2 strokes + 1) mm outward of each edge for one of each number."""
    base = offsets_of(outline, rings)
    lever = np.radians(outline.at - model.middle_mm - fault_values[:2])
    turned = outline.normal[:, 1] * lever[:, 0] - outline.normal[:, 0] * lever[:, 1]
    columns = [*outline.normal.T, turned]  # of shift and turn, which come first
    for k, number in list(enumerate(model.numbers))[len(columns) :]:
        step = np.zeros(len(fault_values))
        step[k] = number.step
        columns.append(
            (offsets_of(outline, _rings(model, names, fault_values + step, own)) - base) / number.step
        )
    out = np.zeros((len(outline.at), len(columns) + 2 * len(names) + 1))
    out[:, : len(columns)] = np.column_stack(columns)
    for axis in (0, 1):
        out[np.arange(len(out)), len(columns) + 2 * outline.stroke + axis] = outline.normal[:, axis]
    out[:, -1] = 1.0
    return out


def _shares(model, names, strokes, fault_values, own, covariance, outline, slopes, found: Comparison):
    fine = min(found.canvas.px_per_mm, FINE_PX_PER_MM)
    canvas = Canvas(found.canvas.window_mm, fine)
    has_target = all(stroke.target is not None for stroke in strokes)
    whole = [ring for each in strokes for ring in ((each.target if has_target else each.predicted) or ())]
    target = canvas.filled(whole) > 0.5

    def reached(numbers, places):
        rings = [ring for rings in _rings(model, names, numbers, places) for ring in rings]
        return _overlap(canvas.filled(rings) > 0.5, target)

    overlap = reached(fault_values, own)
    shares = []
    drawn = np.random.default_rng(1).multivariate_normal(np.zeros(len(covariance)), covariance, DRAWS)
    for cause in CAUSES[:-1]:
        numbers, places = fault_values.copy(), own.copy()
        of_it = np.array([number.cause == cause for number in model.numbers])
        numbers[of_it] = 0.0
        if cause == OWN:
            places[:] = 0.0
            of_it = np.concatenate([of_it, np.ones(own.size, bool), [False]])
        else:
            of_it = np.concatenate([of_it, np.zeros(own.size + 1, bool)])
        gain = reached(numbers, places) - overlap
        low, high = _interval(
            outline, slopes, np.concatenate([fault_values, own.ravel(), [0.0]]), of_it, drawn
        )
        shares.append(Share(cause, gain, gain + low, gain + high))
    shares.append(_missing_paint(model, names, fault_values, own, found, whole))
    return tuple(shares), overlap


def _interval(outline, slopes, numbers, of_it, drawn) -> tuple[float, float]:
    """What the gain may be less or more than it is, by the area between edges: 2.5 and 97.5 % of the draws."""

    def gain(each):
        edges, corrected = slopes[:, :-1] @ each[:-1], slopes[:, :-1] @ np.where(of_it, 0.0, each)[:-1]
        return _by_edges(corrected, outline) - _by_edges(edges, outline)

    middle = gain(numbers)
    gains = [gain(numbers + each) - middle for each in drawn]
    return tuple(float(value) for value in np.quantile(gains, (0.025, 0.975)))


def _by_edges(outward: np.ndarray, outline: Outline) -> float:
    """Return the intersection over union of edges with these offsets; the area inside by the divergence theorem."""
    area = 0.5 * float(np.sum((outline.at * outline.normal).sum(axis=1) * outline.length))
    less, more = (float(np.sum(np.maximum(way * outward, 0.0) * outline.length)) for way in (-1, 1))
    return max(area - less, 0.0) / (area + more)


def _missing_paint(model, names, fault_values, own, found: Comparison, whole) -> Share:
    """Return the paint missing inside of marks at their places: more than a displaced model misses."""
    rings = _rings(model, names, fault_values, own)
    canvas = found.canvas
    target = canvas.filled(whole) > 0.5
    painted = found.painted > LEVEL
    missing = np.zeros_like(painted)
    for each in rings:
        inner = canvas.filled(each) > 0.5 if each else np.zeros_like(painted)
        missing |= inner & ~painted & target
    overlap = _overlap(painted, target)
    gain = _overlap(painted | missing, target) - overlap
    around = float(sum(np.hypot(*np.diff(ring, axis=0).T).sum() for each in rings for ring in each))
    doubt = MODEL_ERROR_MM * around * canvas.px_per_mm**2 / max(float(missing.sum()), 1.0)
    gain, low, high = (gain * max(0.0, 1 - times * doubt) for times in (1.0, 2.0, 0.0))
    return Share(DRY, gain, low, high if gain else 0.0)


def _overlap(one: np.ndarray, other: np.ndarray) -> float:
    union = float((one | other).sum())
    return float((one & other).sum()) / union if union else 1.0


def _alike(model: FaultModel, covariance, slopes) -> tuple[tuple[str, str], ...]:
    """Pairs of which one's doubt is mostly gone once the other is known."""
    causes = (SHEET, MACHINE, PAPER, BRUSH, OWN)
    count = len(model.numbers)
    of = {cause: np.flatnonzero([number.cause == cause for number in model.numbers]) for cause in causes[:-1]}
    of[OWN] = np.arange(count, len(covariance) - 1)

    def doubt(cause, block):
        some = slopes[:, of[cause]]
        return float(np.mean(np.einsum("ij,jk,ik->i", some, block, some)))

    pairs = []
    for a, one in enumerate(causes):
        for other in causes[a + 1 :]:
            for first, second in ((one, other), (other, one)):
                i, j = of[first], of[second]
                mine = covariance[np.ix_(i, i)]
                cross = covariance[np.ix_(i, j)]
                left = mine - cross @ np.linalg.solve(covariance[np.ix_(j, j)], cross.T)
                before = doubt(first, mine)
                if before > DOUBT_MM**2 and doubt(first, left) < ALIKE * before and (one, other) not in pairs:
                    pairs.append((one, other))
    return tuple(pairs)
