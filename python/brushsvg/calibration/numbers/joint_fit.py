"""Fit lag, tip gap and widest section in one joint fit.

The measurements are single values, sums of laws and centre lines of turns.

The fit also estimates how much the values of each kind of measurement scatter about the laws, and weights them by it.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import comb

import numpy as np
from scipy.linalg import block_diag

from ... import _core

MIN_LAG_MM = 0.01  # a lag must stay above this, because a lever without length has no heading
ROUNDING_MM = 1e-6  # scatter below this is rounding
MAX_ROUNDS = 100  # rounds of reweighting
# A kind with few values may match the laws by chance and would then outweigh all others. Its scatter is therefore
# estimated with this many additional values. They scatter as its own points predict, or as the mean of all kinds if
# no points predict the scatter.
BORROWED_VALUES = 2.0


@dataclass(frozen=True)
class Reading:
    """One measurement: k lengths [mm] at a depth [mm], each a sum of laws.

    sums: the laws of each length, with the sign +1 or -1. from_touch: the length counts from first touch, so the lag
    at first touch is subtracted. scatter: scatter of the values relative to others of the same kind.
    own_covariance_mm2: covariance (k, k) that the points predict from which the values were read, or None.
    """

    kind: str
    where: str
    depth_mm: float
    values_mm: tuple[float, ...]
    sums: tuple[dict[str, int], ...]
    from_touch: bool = False
    scatter: float = 1.0
    own_covariance_mm2: np.ndarray | None = None

    def spread_mm(self) -> np.ndarray:
        """Return the matrix (k, k) from unit scatter to the scatter of the values.

        The values are this matrix times numbers that scatter equally for all measurements of the kind.
        """
        if self.own_covariance_mm2 is None:
            return self.scatter * np.eye(len(self.values_mm))
        return np.linalg.cholesky(self.own_covariance_mm2 + ROUNDING_MM**2 * np.eye(len(self.values_mm)))


@dataclass(frozen=True)
class KindScatter:
    """The scatter of one kind of measurement about the laws.

    count: number of measurements. scatter_mm: one value for each length of a measurement. freedom: degrees of freedom
    of the scatter. weight_scatter: the scatter used as weight, divided by Reading.spread_mm. It is 1 if the values
    scatter as their own points predict.
    """

    name: str
    count: int
    scatter_mm: tuple[float, ...]
    weight_scatter: tuple[float, ...]
    freedom: float


@dataclass(frozen=True)
class JointFit:
    """Laws that were fitted jointly, with the covariance of all their coefficients.

    laws: name of a law -> its profile. places: name of a law -> its slice of the covariance. residual_mm, spare and
    scatter_mm (n,) follow the order of the readings and their lengths. They are: measured value minus law; 1 minus
    the leverage of the value; standard deviation used as weight. held: without a constraint the lag or the tip gap
    would be negative at some depth.
    """

    laws: dict[str, _core.Profile]
    covariance: np.ndarray
    places: dict[str, slice]
    residual_mm: np.ndarray
    spare: np.ndarray
    scatter_mm: np.ndarray
    kinds: tuple[KindScatter, ...]
    held: bool

    def predict(self, depth_mm: float, sums: tuple[dict[str, int], ...]) -> tuple[np.ndarray, np.ndarray]:
        """Return sums of laws at a depth [mm] and their covariance [mm^2].

        sums: for each sum, the laws with their signs +1 or -1.
        """
        rows = np.zeros((len(sums), len(self.covariance)))
        for row, signs in zip(rows, sums, strict=True):
            for name, sign in signs.items():
                # A polynomial below its floor could also be above it, so it is equally uncertain.
                row[self.places[name]] = sign * depth_mm ** np.arange(len(self.laws[name].coefficients))
        values = [sum(sign * self.laws[name](depth_mm) for name, sign in signs.items()) for signs in sums]
        return np.array(values), rows @ self.covariance @ rows.T

    def widened(self, other: JointFit, share: float) -> JointFit:
        """Return these laws with intervals that allow for another fit.

        share: the probability that the laws of the other fit are the true ones.
        """
        coefficients = [np.concatenate([fit.laws[name].coefficients for name in self.places]) for fit in (self, other)]
        difference = coefficients[1] - coefficients[0]
        covariance = (1.0 - share) * self.covariance + share * (other.covariance + np.outer(difference, difference))
        laws = {}
        for name, law in self.laws.items():
            variance = np.diag(covariance)[self.places[name]]
            half = _core.interval_factor_95(law.degrees_of_freedom) * np.sqrt(np.maximum(variance, 0.0))
            laws[name] = _core.Profile(
                law.coefficients,
                floor=law.floor,
                calibrated_mm=law.calibrated_mm,
                half_interval_95=half.tolist(),
                degrees_of_freedom=law.degrees_of_freedom,
            )
        return replace(self, laws=laws, covariance=covariance)


def fit_together(
    readings: list[Reading], start: dict[str, _core.Profile], range_mm: tuple[float, float], absolute: bool
) -> JointFit:
    """Fit several laws jointly, weighting each kind of measurement by its scatter.

    start: a rough version of each law. The number of its coefficients sets the degree. A first coefficient of 0 makes
    the law pass through 0, and its floor is its least value. range_mm: the depth range in which lag and tip gap must
    not be negative. absolute: minimise absolute residuals instead of squares.
    """
    unknowns = _Unknowns(readings, start, range_mm)
    groups = _group_by_kind(readings)
    x = unknowns.start
    weights = np.ones(len(unknowns.values))
    whites, kinds = [np.eye(group.at.shape[1]) for group in groups], ()
    for _ in range(MAX_ROUNDS):
        rows = unknowns.rows(x)
        residuals = unknowns.values - rows @ x
        before, scatters = x, [kind.scatter_mm for kind in kinds]
        spare = _free_share(_whiten(groups, whites, rows))
        whites, kinds = _estimate_scatters(groups, residuals, spare, absolute)
        if absolute:
            weights = 1.0 / np.sqrt(np.maximum(np.abs(_whiten(groups, whites, residuals)), 1e-6))
        a = weights[:, None] * _whiten(groups, whites, rows)
        y = weights * _whiten(groups, whites, unknowns.values)
        x = np.linalg.lstsq(a, y, rcond=None)[0]
        settled = scatters and np.allclose(
            np.concatenate(scatters),
            np.concatenate([kind.scatter_mm for kind in kinds]),
            rtol=1e-6,
            atol=1e-9,
        )
        if settled and np.abs(rows @ (x - before)).max() < 1e-9:
            break
    held = not unknowns.satisfies_bounds(x)
    if held:
        x = unknowns.solve_with_bounds(a, y)
    rows = unknowns.rows(x)
    residuals = unknowns.values - rows @ x
    white = _whiten(groups, whites, rows)
    spare = _free_share(white)
    inverse = np.linalg.pinv(white.T @ white)
    variance_factor = 0.5 * np.pi if absolute else 1.0  # variance of a median / variance of a mean
    covariance = variance_factor * inverse
    parts = [inverse @ (white[at].T @ white[at]) @ inverse for at in (group.rows for group in groups)]
    freedoms = [kind.freedom for kind in kinds]
    scale = unknowns.scale
    laws = {}
    for name, law in start.items():
        at = unknowns.places[name]
        variance = np.diag(covariance)[at]
        # Satterthwaite: degrees of freedom of a sum of variances, each of which has its own degrees of freedom
        freedoms_of_variance = [
            variance[i] ** 2
            / max(
                sum((variance_factor * p[k, k]) ** 2 / n for p, n in zip(parts, freedoms, strict=True)),
                1e-300,
            )
            for i, k in enumerate(range(at.start, at.stop))
        ]
        freedom = float(np.clip(min(freedoms_of_variance), 1.0, 1e6))
        zeros = [0.0] * unknowns.first[name]
        depths = [r.depth_mm for r in readings if any(name in signs for signs in r.sums)]
        half = _core.interval_factor_95(freedom) * np.sqrt(variance) * scale[at]
        laws[name] = _core.Profile(
            [*zeros, *(x * scale)[at]],
            floor=law.floor,
            calibrated_mm=(min(depths), max(depths)),
            half_interval_95=[*zeros, *half],
            degrees_of_freedom=freedom,
        )
    full_covariance, places = _insert_zeros(covariance * np.outer(scale, scale), unknowns)
    scatter = np.empty_like(residuals)
    for group, white in zip(groups, whites, strict=True):
        spread = unknowns.spread_mm[group.at[:, :, None], group.at[:, None, :]] @ np.linalg.inv(white)
        scatter[group.at] = np.sqrt((spread**2).sum(axis=2))
    return JointFit(laws, full_covariance, places, unknowns.spread_mm @ residuals, spare, scatter, kinds, held)


class _Unknowns:
    """The unknown coefficients, and the readings as linear functions of them.

    Coefficients are in powers of depth / deepest depth.
    """

    def __init__(self, readings: list[Reading], start: dict[str, _core.Profile], range_mm):
        self.readings, self.range_mm = readings, range_mm
        self.floors = {name: law.floor for name, law in start.items()}
        self.first = {name: int(law.coefficients[0] == 0.0) for name, law in start.items()}
        self.sizes = {name: len(law.coefficients) - self.first[name] for name, law in start.items()}
        ends = np.cumsum([0, *self.sizes.values()]).tolist()
        self.places = {name: slice(a, b) for name, a, b in zip(start, ends[:-1], ends[1:], strict=True)}
        powers = np.concatenate([self.first[name] + np.arange(n) for name, n in self.sizes.items()])
        self.scale = range_mm[1] ** -powers.astype(float)
        self.start = np.concatenate([law.coefficients[self.first[n] :] for n, law in start.items()]) / self.scale
        # Values and rows are divided by their spread, so that all values of one kind scatter equally.
        self.spread_mm = block_diag(*[reading.spread_mm() for reading in readings])
        values = [value for reading in readings for value in reading.values_mm]
        self.per_spread = np.linalg.inv(self.spread_mm)
        self.values = self.per_spread @ np.array(values)

    def powers(self, name: str, depth_mm) -> np.ndarray:
        size = self.first[name] + self.sizes[name]
        depth = np.atleast_1d(np.asarray(depth_mm, float)) / self.range_mm[1]
        return np.vander(depth, size, increasing=True)[:, self.first[name] :]

    def rows(self, x: np.ndarray) -> np.ndarray:
        """Return d value / d unknown, divided by the spread.

        The derivative is 0 where a polynomial is below its floor.
        """
        all_rows = []
        for reading in self.readings:
            for signs in reading.sums:
                row = np.zeros(len(x))
                for name, sign in signs.items():
                    powers = self.powers(name, reading.depth_mm)[0]
                    if powers @ x[self.places[name]] >= self.floors[name]:
                        row[self.places[name]] = sign * powers
                if reading.from_touch:
                    row[self.places["lag"]] -= self.powers("lag", 0.0)[0]
                all_rows.append(row)
        return self.per_spread @ np.array(all_rows)

    def _sample_depths(self) -> np.ndarray:
        return np.linspace(*self.range_mm, 201)

    def satisfies_bounds(self, x: np.ndarray) -> bool:
        """Check that the lag is above 0 and the tip gap not below 0 at all depths."""
        lower_bounds_mm = {"lag": MIN_LAG_MM, "tip_gap": -1e-9}
        return all(
            (self.powers(name, self._sample_depths()) @ x[self.places[name]]).min() >= mm
            for name, mm in lower_bounds_mm.items()
            if name in self.places
        )

    def solve_with_bounds(self, a: np.ndarray, y: np.ndarray) -> np.ndarray:
        """Solve the least squares problem with bounds.

        The control points of lag and tip gap have lower bounds.
        """
        from scipy.optimize import lsq_linear

        control_to_power = np.eye(a.shape[1])
        lower_bounds = np.full(a.shape[1], -np.inf)
        for name in ("lag", "tip_gap"):
            if name in self.places:
                at = self.places[name]
                control_to_power[at, at] = self._control_to_power(name)
                lower_bounds[at] = MIN_LAG_MM if name == "lag" else 0.0
        solution = lsq_linear(a @ control_to_power, y, bounds=(lower_bounds, np.inf), method="bvls")
        return control_to_power @ solution.x

    def _control_to_power(self, name: str) -> np.ndarray:
        """Return the matrix from Bernstein to power coefficients; laws through 0 have a range from depth 0."""
        lo = 0.0 if self.first[name] else self.range_mm[0]
        degree = self.first[name] + self.sizes[name] - 1
        at = np.linspace(lo, self.range_mm[1], degree + 2)[1:]
        t = (at - lo) / (self.range_mm[1] - lo)
        bernstein = np.column_stack(
            [comb(degree, k) * t**k * (1 - t) ** (degree - k) for k in range(self.first[name], degree + 1)]
        )
        return np.linalg.lstsq(self.powers(name, at), bernstein, rcond=None)[0]


@dataclass(frozen=True)
class _Group:
    """Measurements of one kind.

    at: indices of their values among all values (measurements, lengths). unit_mm: root mean square of the spread of
    each length. of_points: the spread is predicted by the points of each measurement.
    """

    name: str
    at: np.ndarray
    unit_mm: np.ndarray
    of_points: bool

    @property
    def rows(self) -> np.ndarray:
        return self.at.ravel()


def _group_by_kind(readings: list[Reading]) -> list[_Group]:
    places: dict[str, list] = {}
    kinds: dict[str, list[Reading]] = {}
    at = 0
    for reading in readings:
        count = len(reading.values_mm)
        places.setdefault(reading.kind, []).append(range(at, at + count))
        kinds.setdefault(reading.kind, []).append(reading)
        at += count
    return [
        _Group(
            kind,
            np.array(places[kind]),
            np.sqrt(np.mean([(reading.spread_mm() ** 2).sum(axis=1) for reading in of_kind], axis=0)),
            of_kind[0].own_covariance_mm2 is not None,
        )
        for kind, of_kind in kinds.items()
    ]


def _free_share(rows: np.ndarray) -> np.ndarray:
    """Return 1 minus the leverage of each row."""
    q, r = np.linalg.qr(rows)
    kept = np.abs(np.diag(r)) > 1e-12 * max(np.abs(np.diag(r)).max(), 1e-300)
    return np.clip(1.0 - (q[:, kept] ** 2).sum(axis=1), 0.0, 1.0)


def _whiten(groups: list[_Group], whites: list[np.ndarray], rows: np.ndarray) -> np.ndarray:
    out = np.empty_like(rows)
    for group, white in zip(groups, whites, strict=True):
        out[group.at] = np.einsum("ij,nj...->ni...", white, rows[group.at])
    return out


def _estimate_scatters(
    groups, residuals: np.ndarray, spare: np.ndarray, absolute: bool
) -> tuple[list, tuple[KindScatter, ...]]:
    """Estimate the scatter of each kind from the residuals.

    Return one whitening matrix per kind, and the kinds. Whitened values scatter by 1, and the lengths of one
    measurement are independent.
    """

    def scatter(part: np.ndarray) -> np.ndarray:
        if not absolute:
            return part.T @ part
        deviation = 1.482602218505602 * np.median(np.abs(part), axis=0)  # standard deviation of normal noise
        return np.diag(len(part) * deviation**2)

    sums = [scatter(residuals[group.at]) for group in groups]
    freedoms = [spare[group.at].sum(axis=0) for group in groups]  # one for each length
    of_lengths = [k for k, group in enumerate(groups) if not group.of_points]
    mean = sum(np.trace(sums[k]) for k in of_lengths) / max(sum(freedoms[k].sum() for k in of_lengths), 1.0)
    whites, kinds = [], []
    for group, squares, freedom in zip(groups, sums, freedoms, strict=True):
        root_freedom = np.sqrt(freedom + BORROWED_VALUES)
        predicted = 1.0 if group.of_points else mean
        covariance = (squares + BORROWED_VALUES * predicted * np.eye(len(root_freedom))) / np.outer(
            root_freedom, root_freedom
        )
        covariance += ROUNDING_MM**2 * np.eye(len(root_freedom))
        if group.of_points:  # a line cannot scatter less than its points
            squared, axes = np.linalg.eigh(covariance)
            covariance = (axes * np.maximum(squared, 1.0)) @ axes.T
        whites.append(np.linalg.inv(np.linalg.cholesky(covariance)))
        estimated = np.sqrt(np.diag(squares) / np.maximum(freedom, 1e-9)) * (freedom > 1e-6)
        weight_scatter = np.sqrt(np.diag(covariance))
        total_freedom = float(freedom.min()) + BORROWED_VALUES
        scatter_mm = estimated * group.unit_mm
        kinds.append(
            KindScatter(
                group.name,
                len(group.at),
                tuple(scatter_mm.tolist()),
                tuple(weight_scatter.tolist()),
                total_freedom,
            )
        )
    return whites, tuple(kinds)


def _insert_zeros(covariance: np.ndarray, unknowns: _Unknowns) -> tuple[np.ndarray, dict[str, slice]]:
    """Extend the covariance to all coefficients of the laws.

    The additional coefficients are 0 because a law passes through 0.

    Return it with the slice of each law.
    """
    sizes = [unknowns.first[name] + size for name, size in unknowns.sizes.items()]
    ends = np.cumsum([0, *sizes]).tolist()
    places = {n: slice(a, b) for n, a, b in zip(unknowns.sizes, ends[:-1], ends[1:], strict=True)}
    at = np.concatenate([np.arange(places[n].start + unknowns.first[n], places[n].stop) for n in places])
    full = np.zeros((ends[-1], ends[-1]))
    full[np.ix_(at, at)] = covariance
    return full, places
