"""Attribute the difference of paint and prediction to causes.

Each cause has its own effect on the edges of all marks. The method is least squares, repeated at its result until it
converges. The model is linear in the numbers of the sheet, the machine, the paper and the brush. Each stroke also has a
displacement of its own, and all edges share an offset for the uncertainty of reading edges.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ... import _core
from ...errors import Error
from ..edge_offsets import (
    EDGE_LEVEL,
    SAMPLE_STEP_MM,
    Outline,
    measure_paint_edges,
    sample_outlines,
    signed_offsets_mm,
)
from ..photographs import Comparison, TargetStroke, overlap_of_masks
from ..placing import Canvas
from .model import BRUSH, MACHINE, PAPER, SHEET, FaultModel, Number

OWN_PLACE, MISSING_PAINT = "each stroke's own place", "missing paint"
CAUSES = (SHEET, MACHINE, PAPER, BRUSH, OWN_PLACE, MISSING_PAINT)
# Search distances for edges: the first finds the edges of a brush that is 20 % off.
SEARCH_DISTANCES_MM = (2.5, 1.2, 0.8, 0.8)
OWN_PLACE_SIGMAS_MM = (0.02, 0.2, 1.0)  # standard deviation of own places: smallest, initial, largest
EDGE_SIGMA_MM = 0.03  # standard deviation of the common offset of edges by their reading
MIN_EDGE_SIGMA_MM = 0.01  # smallest standard deviation of edges: no photograph is read better
# A brush never matches its model exactly. A misfit displaces whole sides of a mark, which the fit attributes to some
# number. Two simulators of the same brush differ by MISFIT_SIGMA_MM, over lengths of MISFIT_LENGTH_MM.
MISFIT_SIGMA_MM, MISFIT_LENGTH_MM = 0.03, 6.0
MIN_EDGES = 60  # with fewer edges, the numbers depend on their priors
# Fewer strokes do not separate a common place from their own places. Of more strokes, only the largest are used.
MIN_STROKES, MAX_STROKES = 3, 40
HUBER_TUNING = 1.345  # constant of Huber's weights
DRAWS = 200
MAX_PX_PER_MM = 8.0
# Remaining share of a cause's variance once another is known, below which both are hard to separate.
MAX_INSEPARABLE_SHARE = 0.3
MODEL_EDGE_ERROR_MM = 0.04  # uncertainty of the model's edges relative to the paint
MIN_DOUBT_MM = 0.05  # uncertainty of edges: a smaller one does not matter


@dataclass(frozen=True)
class EstimatedFault:
    """The estimated value of one number, and half its 95 % interval."""

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
    """The faults of a job and their effects.

    overlap: overlap with the target, of paint with these faults alone; own_mm: rms of the strokes' own places; rest_mm:
    rms of the remaining offsets of edges; alike: pairs of causes that these marks hardly separate; first: the cause to
    fix first, None where no gain is certain.
    """

    found: tuple[EstimatedFault, ...]
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
    """Attribute the differences of a comparison to causes.

    plan: as commanded; strokes: the strokes that were compared; learned: whether the brush was made from them. Returns
    None where too few edges are seen, where things are on the sheet, or where no brush has the numbers that would
    explain the differences.
    """
    painting = [stroke for stroke in strokes if stroke.predicted]
    if len(painting) < MIN_STROKES or seen_of.has_things:
        return None
    size = {stroke.stroke: sum(len(ring) for ring in stroke.predicted) for stroke in painting}
    largest = sorted(size, key=size.get, reverse=True)[:MAX_STROKES]
    strokes = [stroke for stroke in painting if stroke.stroke in largest]
    common, middle = seen_of.common, seen_of.middle_mm
    neighbours = [
        [common.moved(ring, middle) for ring in stroke.predicted] for stroke in painting if stroke.stroke not in largest
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
    halves = _core.interval_factor_95() * np.sqrt(np.diag(covariance)[:count])
    found = tuple(
        EstimatedFault(number, float(value), float(half))
        for number, value, half in zip(model.numbers, fault_values, halves, strict=True)
    )
    shares, overlap = _gains_of_causes(model, names, strokes, fault_values, own, covariance, outline, slopes, seen_of)
    certain = [share for share in shares if share.low > 0.005]
    return Faults(
        found,
        shares,
        overlap,
        float(np.sqrt(np.square(own).sum(axis=1).mean())),
        float(np.sqrt(np.mean(np.square(residual)))),
        edges,
        _inseparable_causes(model, covariance, slopes),
        max(certain, key=lambda share: share.gain).cause if certain else None,
    )


def _fit(model: FaultModel, names, found: Comparison, neighbours):
    numbers = model.numbers
    count, sigma_own = len(numbers), OWN_PLACE_SIGMAS_MM[1]
    fault_values = np.zeros(count)
    fault_values[:3] = (*found.common.shift_mm, np.degrees(found.common.turn_rad))
    own = np.zeros((len(names), 2))
    for reach in SEARCH_DISTANCES_MM:
        rings = _rings_with_own_places(model, names, fault_values, own)
        outline = sample_outlines(rings)
        offsets = measure_paint_edges(outline, rings, neighbours, found.painted, found.canvas, reach)
        slopes = _jacobian(model, names, fault_values, own, outline, rings)
        measured = ~np.isnan(offsets)
        if measured.sum() < MIN_EDGES:
            return None
        estimate = np.concatenate([fault_values, own.ravel(), [0.0]])
        for _ in range(2):
            sigmas = [number.sigma for number in numbers]
            prior = np.array([*sigmas, *[sigma_own] * own.size, EDGE_SIGMA_MM]) ** -2.0
            step, covariance, residual = _solve_step(
                slopes[measured], offsets[measured], outline.stroke[measured], prior, estimate
            )
            moved = (own.ravel() + step[count:-1]).reshape(-1, 2)
            spread = np.diag(covariance)[count:-1].reshape(-1, 2)
            sigma_own = float(
                np.clip(np.sqrt(np.mean(moved**2 + spread)), OWN_PLACE_SIGMAS_MM[0], OWN_PLACE_SIGMAS_MM[2])
            )
        fault_values, own = fault_values + step[:count], moved
        fault_values[8:10] = np.maximum(fault_values[8:10], 0.0)
    return fault_values, own, covariance, outline, slopes, residual, int(measured.sum())


def _solve_step(slopes, offsets, stroke, prior, estimate):
    """Solve one step of least squares.

    Returns the step, its covariance and the residuals (n,) [mm]. Edges have Huber's weights. Their number is reduced to
    the number of independent ones, and the misfit of the model is added to their variance.
    """
    weight, independent_share = np.ones(len(offsets)), 1.0
    scale = max(1.4826 * float(np.median(np.abs(offsets - np.median(offsets)))), MIN_EDGE_SIGMA_MM)
    misfit = MISFIT_SIGMA_MM**2 * MISFIT_LENGTH_MM / SAMPLE_STEP_MM
    for _ in range(5):
        weights = weight / (scale**2 / independent_share + misfit)
        information = (slopes.T * weights) @ slopes + np.diag(prior)
        step = np.linalg.solve(information, slopes.T @ (weights * offsets) - prior * estimate)
        residual = offsets - slopes @ step
        scale = max(1.4826 * float(np.median(np.abs(residual))), MIN_EDGE_SIGMA_MM)
        weight = np.minimum(1.0, HUBER_TUNING * scale / np.maximum(np.abs(residual), 1e-9))
        clipped = np.clip(residual, -3 * scale, 3 * scale)
        same = stroke[1:] == stroke[:-1]
        correlation = float(np.mean((clipped[1:] * clipped[:-1])[same]) / max(np.mean(clipped**2), 1e-9))
        independent_share = (1 - min(max(correlation, 0.0), 0.9)) / (1 + min(max(correlation, 0.0), 0.9))
    return step, np.linalg.inv(information), residual


def _rings_with_own_places(model, names, fault_values, own) -> list[list[np.ndarray]]:
    rings = model.rings(fault_values)
    return [[ring + shift for ring in rings.get(name, [])] for name, shift in zip(names, own, strict=True)]


def _jacobian(model, names, fault_values, own, outline: Outline, rings) -> np.ndarray:
    """Return the outward shift of each edge [mm] per unit of each number.

    The shape is (n, numbers + 2 * strokes + 1).
    """
    base = signed_offsets_mm(outline, rings)
    lever = np.radians(outline.at - model.middle_mm - fault_values[:2])
    turned = outline.normal[:, 1] * lever[:, 0] - outline.normal[:, 0] * lever[:, 1]
    columns = [*outline.normal.T, turned]  # of shift and turn, which come first
    for k, number in list(enumerate(model.numbers))[len(columns) :]:
        step = np.zeros(len(fault_values))
        step[k] = number.step
        columns.append(
            (signed_offsets_mm(outline, _rings_with_own_places(model, names, fault_values + step, own)) - base)
            / number.step
        )
    out = np.zeros((len(outline.at), len(columns) + 2 * len(names) + 1))
    out[:, : len(columns)] = np.column_stack(columns)
    for axis in (0, 1):
        out[np.arange(len(out)), len(columns) + 2 * outline.stroke + axis] = outline.normal[:, axis]
    out[:, -1] = 1.0
    return out


def _gains_of_causes(model, names, strokes, fault_values, own, covariance, outline, slopes, found: Comparison):
    fine = min(found.canvas.px_per_mm, MAX_PX_PER_MM)
    canvas = Canvas(found.canvas.window_mm, fine)
    has_target = all(stroke.target is not None for stroke in strokes)
    whole = [ring for each in strokes for ring in ((each.target if has_target else each.predicted) or ())]
    target = canvas.filled(whole) > 0.5

    def reached(numbers, places):
        rings = [ring for rings in _rings_with_own_places(model, names, numbers, places) for ring in rings]
        return overlap_of_masks(canvas.filled(rings) > 0.5, target)

    overlap = reached(fault_values, own)
    shares = []
    samples = np.random.default_rng(1).multivariate_normal(np.zeros(len(covariance)), covariance, DRAWS)
    for cause in CAUSES[:-1]:
        numbers, places = fault_values.copy(), own.copy()
        of_cause = np.array([number.cause == cause for number in model.numbers])
        numbers[of_cause] = 0.0
        if cause == OWN_PLACE:
            places[:] = 0.0
            of_cause = np.concatenate([of_cause, np.ones(own.size, bool), [False]])
        else:
            of_cause = np.concatenate([of_cause, np.zeros(own.size + 1, bool)])
        gain = reached(numbers, places) - overlap
        low, high = _gain_interval(
            outline, slopes, np.concatenate([fault_values, own.ravel(), [0.0]]), of_cause, samples
        )
        shares.append(Share(cause, gain, gain + low, gain + high))
    shares.append(_missing_paint_gain(model, names, fault_values, own, found, whole))
    return tuple(shares), overlap


def _gain_interval(outline, slopes, numbers, of_cause, samples) -> tuple[float, float]:
    """Return the 95 % interval, relative to the gain, of gains that follow from the areas between edges."""

    def gain(sample):
        edges, corrected = slopes[:, :-1] @ sample[:-1], slopes[:, :-1] @ np.where(of_cause, 0.0, sample)[:-1]
        return _overlap_from_edges(corrected, outline) - _overlap_from_edges(edges, outline)

    middle = gain(numbers)
    gains = [gain(numbers + sample) - middle for sample in samples]
    return tuple(float(value) for value in np.quantile(gains, (0.025, 0.975)))


def _overlap_from_edges(outward: np.ndarray, outline: Outline) -> float:
    """Return the intersection over union of marks whose edges have these offsets.

    The area inside the edges follows from the divergence theorem.
    """
    area = 0.5 * float(np.sum((outline.at * outline.normal).sum(axis=1) * outline.length))
    less, more = (float(np.sum(np.maximum(way * outward, 0.0) * outline.length)) for way in (-1, 1))
    return max(area - less, 0.0) / (area + more)


def _missing_paint_gain(model, names, fault_values, own, found: Comparison, whole) -> Share:
    """Return the gain from the paint that is missing inside marks at their places.

    The gain is reduced by what the uncertainty of the model's edges explains.
    """
    rings = _rings_with_own_places(model, names, fault_values, own)
    canvas = found.canvas
    target = canvas.filled(whole) > 0.5
    painted = found.painted > EDGE_LEVEL
    missing = np.zeros_like(painted)
    for each in rings:
        inner = canvas.filled(each) > 0.5 if each else np.zeros_like(painted)
        missing |= inner & ~painted & target
    overlap = overlap_of_masks(painted, target)
    gain = overlap_of_masks(painted | missing, target) - overlap
    around = float(sum(np.hypot(*np.diff(ring, axis=0).T).sum() for each in rings for ring in each))
    doubt = MODEL_EDGE_ERROR_MM * around * canvas.px_per_mm**2 / max(float(missing.sum()), 1.0)
    gain, low, high = (gain * max(0.0, 1 - times * doubt) for times in (1.0, 2.0, 0.0))
    return Share(MISSING_PAINT, gain, low, high if gain else 0.0)


def _inseparable_causes(model: FaultModel, covariance, slopes) -> tuple[tuple[str, str], ...]:
    """Return pairs of causes that are hard to separate.

    If one of the two causes were known, most of the uncertainty of the other would vanish.
    """
    causes = (SHEET, MACHINE, PAPER, BRUSH, OWN_PLACE)
    count = len(model.numbers)
    columns_of = {cause: np.flatnonzero([number.cause == cause for number in model.numbers]) for cause in causes[:-1]}
    columns_of[OWN_PLACE] = np.arange(count, len(covariance) - 1)

    def doubt(cause, block):
        columns = slopes[:, columns_of[cause]]
        return float(np.mean(np.einsum("ij,jk,ik->i", columns, block, columns)))

    pairs = []
    for a, cause_a in enumerate(causes):
        for cause_b in causes[a + 1 :]:
            for first, second in ((cause_a, cause_b), (cause_b, cause_a)):
                i, j = columns_of[first], columns_of[second]
                mine = covariance[np.ix_(i, i)]
                cross = covariance[np.ix_(i, j)]
                remaining = mine - cross @ np.linalg.solve(covariance[np.ix_(j, j)], cross.T)
                before = doubt(first, mine)
                if (
                    before > MIN_DOUBT_MM**2
                    and doubt(first, remaining) < MAX_INSEPARABLE_SHARE * before
                    and (cause_a, cause_b) not in pairs
                ):
                    pairs.append((cause_a, cause_b))
    return tuple(pairs)
