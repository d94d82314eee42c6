"""Lag, tip gap and widest section in one fit to all that speaks of them: single values, sums, centre lines of turns.

What a kind of measurement is worth is found along with the laws: the scatter of its values about them.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import comb

import numpy as np
from scipy.linalg import block_diag

from ... import _core

LEAST_MM = 0.01  # of a lag that must stay above 0: a lever of no length has no heading
EXACT_MM = 1e-6  # scatter below is rounding
MOST_ROUNDS = 100
# A kind with few values may match the laws by chance and would then outweigh all others. Its scatter is estimated as if
# it had this many values more, which scatter as its own points predict or, where nothing predicts it, as the mean kind.
BORROWED = 2.0


@dataclass(frozen=True)
class Reading:
    """One measurement: lengths [mm] at a depth [mm], and of which laws each is the sum, with +1 or -1.

    from_touch: counted from first touch, so less the lag there. scatter: of its values, by what others of its kind do.
    own_covariance_mm2: covariance (k, k) of its k values as predicted by the points they were read from, or None.
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
        """(k, k): its values are this times numbers that scatter alike for all of its kind."""
        if self.own_covariance_mm2 is None:
            return self.scatter * np.eye(len(self.values_mm))
        return np.linalg.cholesky(self.own_covariance_mm2 + EXACT_MM**2 * np.eye(len(self.values_mm)))


@dataclass(frozen=True)
class Kind:
    """What measurements of one kind say: how many, their scatter about the laws [mm], one for each length of a
    measurement, and on how many values to spare that rests.

    weight_scatter: the scatter that they were weighted by, over that of Reading.spread_mm (so 1 where each scatters as
    its own points predict).
    """

    name: str
    count: int
    scatter_mm: tuple[float, ...]
    weight_scatter: tuple[float, ...]
    freedom: float


@dataclass(frozen=True)
class Together:
    """Return laws in a dictionary of names, with the covariance of all their coefficients, those of the laws one after
    the other.

    residual_mm, spare and scatter_mm (n,): measured less law, the share of each value that is left to spare, and the
    standard deviation it was weighted by, in the order of the readings and their lengths. held: without a constraint
    the lag or the tip gap would be negative somewhere.
    """

    laws: dict[str, _core.Profile]
    covariance: np.ndarray
    places: dict[str, slice]
    residual_mm: np.ndarray
    spare: np.ndarray
    scatter_mm: np.ndarray
    kinds: tuple[Kind, ...]
    held: bool

    def predict(self, depth_mm: float, sums: tuple[dict[str, int], ...]) -> tuple[np.ndarray, np.ndarray]:
        """Sums of laws at a depth, each with +1 or -1 [mm], and their covariance [mm^2]."""
        rows = np.zeros((len(sums), len(self.covariance)))
        for row, each in zip(rows, sums, strict=True):
            for name, sign in each.items():
                # a polynomial below its floor may be above it as well, so it is as unsure
                row[self.places[name]] = sign * depth_mm ** np.arange(len(self.laws[name].coefficients))
        values = [sum(sign * self.laws[name](depth_mm) for name, sign in each.items()) for each in sums]
        return np.array(values), rows @ self.covariance @ rows.T

    def widened(self, other: Together, share: float) -> Together:
        """The same laws with intervals that allow for those of another fit, which are true with this probability."""
        coefficients = [
            np.concatenate([fit.laws[name].coefficients for name in self.places]) for fit in (self, other)
        ]
        off = coefficients[1] - coefficients[0]
        covariance = (1.0 - share) * self.covariance + share * (other.covariance + np.outer(off, off))
        laws = {}
        for name, law in self.laws.items():
            variance = np.diag(covariance)[self.places[name]]
            half = _core.deviations_of_95(law.degrees_of_freedom) * np.sqrt(np.maximum(variance, 0.0))
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
) -> Together:
    """start: each law that is looked for, roughly; its coefficients say of which degree, a 0 in front that it goes
    through 0, its floor that it is never less. absolute: least absolute residuals, else squares."""
    unknowns = _Unknowns(readings, start, range_mm)
    groups = _groups(readings)
    x = unknowns.start
    weights = np.ones(len(unknowns.values))
    whites, kinds = [np.eye(group.at.shape[1]) for group in groups], ()
    for _ in range(MOST_ROUNDS):
        rows = unknowns.rows(x)
        left = unknowns.values - rows @ x
        before, scatters = x, [kind.scatter_mm for kind in kinds]
        spare = _spare(_whitened(groups, whites, rows))
        whites, kinds = _scatters(groups, left, spare, absolute)
        if absolute:
            weights = 1.0 / np.sqrt(np.maximum(np.abs(_whitened(groups, whites, left)), 1e-6))
        a = weights[:, None] * _whitened(groups, whites, rows)
        y = weights * _whitened(groups, whites, unknowns.values)
        x = np.linalg.lstsq(a, y, rcond=None)[0]
        settled = scatters and np.allclose(
            np.concatenate(scatters),
            np.concatenate([kind.scatter_mm for kind in kinds]),
            rtol=1e-6,
            atol=1e-9,
        )
        if settled and np.abs(rows @ (x - before)).max() < 1e-9:
            break
    held = not unknowns.sound(x)
    if held:
        x = unknowns.solve_sound(a, y)
    rows = unknowns.rows(x)
    left = unknowns.values - rows @ x
    white = _whitened(groups, whites, rows)
    spare = _spare(white)
    inverse = np.linalg.pinv(white.T @ white)
    worth = 0.5 * np.pi if absolute else 1.0  # what the median costs against the mean
    covariance = worth * inverse
    parts = [inverse @ (white[at].T @ white[at]) @ inverse for at in (group.rows for group in groups)]
    freedoms = [kind.freedom for kind in kinds]
    scale = unknowns.scale
    laws = {}
    for name, law in start.items():
        at = unknowns.places[name]
        variance = np.diag(covariance)[at]
        # Satterthwaite: of how many values to spare a sum of variances is known that rest on so many each
        known = [
            variance[i] ** 2
            / max(sum((worth * p[k, k]) ** 2 / n for p, n in zip(parts, freedoms, strict=True)), 1e-300)
            for i, k in enumerate(range(at.start, at.stop))
        ]
        freedom = float(np.clip(min(known), 1.0, 1e6))
        zeros = [0.0] * unknowns.first[name]
        depths = [r.depth_mm for r in readings if any(name in each for each in r.sums)]
        half = _core.deviations_of_95(freedom) * np.sqrt(variance) * scale[at]
        laws[name] = _core.Profile(
            [*zeros, *(x * scale)[at]],
            floor=law.floor,
            calibrated_mm=(min(depths), max(depths)),
            half_interval_95=[*zeros, *half],
            degrees_of_freedom=freedom,
        )
    whole, places = _with_zeros(covariance * np.outer(scale, scale), unknowns)
    scatter = np.empty_like(left)
    for group, white in zip(groups, whites, strict=True):
        spread = unknowns.spread_mm[group.at[:, :, None], group.at[:, None, :]] @ np.linalg.inv(white)
        scatter[group.at] = np.sqrt((spread**2).sum(axis=2))
    return Together(laws, whole, places, unknowns.spread_mm @ left, spare, scatter, kinds, held)


class _Unknowns:
    """Coefficients in powers of depth over the deepest, and what each reading is in them."""

    def __init__(self, readings: list[Reading], start: dict[str, _core.Profile], range_mm):
        self.readings, self.range_mm = readings, range_mm
        self.floors = {name: law.floor for name, law in start.items()}
        self.first = {name: int(law.coefficients[0] == 0.0) for name, law in start.items()}
        self.sizes = {name: len(law.coefficients) - self.first[name] for name, law in start.items()}
        ends = np.cumsum([0, *self.sizes.values()]).tolist()
        self.places = {name: slice(a, b) for name, a, b in zip(start, ends[:-1], ends[1:], strict=True)}
        powers = np.concatenate([self.first[name] + np.arange(n) for name, n in self.sizes.items()])
        self.scale = range_mm[1] ** -powers.astype(float)
        self.start = (
            np.concatenate([law.coefficients[self.first[n] :] for n, law in start.items()]) / self.scale
        )
        # values, and rows, are counted in their spread, so that those of one kind scatter alike
        self.spread_mm = block_diag(*[reading.spread_mm() for reading in readings])
        values = [value for reading in readings for value in reading.values_mm]
        self.per_spread = np.linalg.inv(self.spread_mm)
        self.values = self.per_spread @ np.array(values)

    def powers(self, name: str, depth_mm) -> np.ndarray:
        size = self.first[name] + self.sizes[name]
        depth = np.atleast_1d(np.asarray(depth_mm, float)) / self.range_mm[1]
        return np.vander(depth, size, increasing=True)[:, self.first[name] :]

    def rows(self, x: np.ndarray) -> np.ndarray:
        """d value / d unknown, over the spread. Where a polynomial is below its floor it is 0."""
        out = []
        for reading in self.readings:
            for each in reading.sums:
                row = np.zeros(len(x))
                for name, sign in each.items():
                    powers = self.powers(name, reading.depth_mm)[0]
                    if powers @ x[self.places[name]] >= self.floors[name]:
                        row[self.places[name]] = sign * powers
                if reading.from_touch:
                    row[self.places["lag"]] -= self.powers("lag", 0.0)[0]
                out.append(row)
        return self.per_spread @ np.array(out)

    def _shallow_to_deep(self) -> np.ndarray:
        return np.linspace(*self.range_mm, 201)

    def sound(self, x: np.ndarray) -> bool:
        """Lag above 0, tip gap not below, at all depths."""
        least = {"lag": LEAST_MM, "tip_gap": -1e-9}
        return all(
            (self.powers(name, self._shallow_to_deep()) @ x[self.places[name]]).min() >= mm
            for name, mm in least.items()
            if name in self.places
        )

    def solve_sound(self, a: np.ndarray, y: np.ndarray) -> np.ndarray:
        """Solve the same least squares where no control point of lag and tip gap is lower than allowed."""
        from scipy.optimize import lsq_linear

        from_controls = np.eye(a.shape[1])
        least = np.full(a.shape[1], -np.inf)
        for name in ("lag", "tip_gap"):
            if name in self.places:
                at = self.places[name]
                from_controls[at, at] = self._from_controls(name)
                least[at] = LEAST_MM if name == "lag" else 0.0
        found = lsq_linear(a @ from_controls, y, bounds=(least, np.inf), method="bvls")
        return from_controls @ found.x

    def _from_controls(self, name: str) -> np.ndarray:
        """Powers from control points of Bernstein's polynomials over the range (through 0: from depth 0 on)."""
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
    """Measurements of one kind: the places of their values among all, (n, lengths of one); unit_mm: root mean square of
    the spread of each length; of_points: the points of each measurement predict it."""

    name: str
    at: np.ndarray
    unit_mm: np.ndarray
    of_points: bool

    @property
    def rows(self) -> np.ndarray:
        return self.at.ravel()


def _groups(readings: list[Reading]) -> list[_Group]:
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
            np.sqrt(np.mean([(each.spread_mm() ** 2).sum(axis=1) for each in of], axis=0)),
            of[0].own_covariance_mm2 is not None,
        )
        for kind, of in kinds.items()
    ]


def _spare(rows: np.ndarray) -> np.ndarray:
    """1 less its leverage, of each row."""
    q, r = np.linalg.qr(rows)
    kept = np.abs(np.diag(r)) > 1e-12 * max(np.abs(np.diag(r)).max(), 1e-300)
    return np.clip(1.0 - (q[:, kept] ** 2).sum(axis=1), 0.0, 1.0)


def _whitened(groups: list[_Group], whites: list[np.ndarray], rows: np.ndarray) -> np.ndarray:
    out = np.empty_like(rows)
    for group, white in zip(groups, whites, strict=True):
        out[group.at] = np.einsum("ij,nj...->ni...", white, rows[group.at])
    return out


def _scatters(groups, left: np.ndarray, spare: np.ndarray, absolute: bool) -> tuple[list, tuple[Kind, ...]]:
    """For each kind what makes the scatter of its values 1 and lengths of one measurement independent; the kinds."""

    def scatter(part: np.ndarray) -> np.ndarray:
        if not absolute:
            return part.T @ part
        deviation = 1.482602218505602 * np.median(np.abs(part), axis=0)  # of normal noise
        return np.diag(len(part) * deviation**2)

    sums = [scatter(left[group.at]) for group in groups]
    freedoms = [spare[group.at].sum(axis=0) for group in groups]  # of each length
    of_lengths = [k for k, group in enumerate(groups) if not group.of_points]
    mean = sum(np.trace(sums[k]) for k in of_lengths) / max(sum(freedoms[k].sum() for k in of_lengths), 1.0)
    whites, kinds = [], []
    for group, squares, freedom in zip(groups, sums, freedoms, strict=True):
        known = np.sqrt(freedom + BORROWED)
        predicted = 1.0 if group.of_points else mean
        borrowed = (squares + BORROWED * predicted * np.eye(len(known))) / np.outer(known, known)
        borrowed += EXACT_MM**2 * np.eye(len(known))
        if group.of_points:  # never better than its points: nothing makes a line scatter less
            squared, axes = np.linalg.eigh(borrowed)
            borrowed = (axes * np.maximum(squared, 1.0)) @ axes.T
        whites.append(np.linalg.inv(np.linalg.cholesky(borrowed)))
        seen = np.sqrt(np.diag(squares) / np.maximum(freedom, 1e-9)) * (freedom > 1e-6)
        weighted = np.sqrt(np.diag(borrowed))
        few = float(freedom.min()) + BORROWED
        seen_mm = seen * group.unit_mm
        kinds.append(Kind(group.name, len(group.at), tuple(seen_mm.tolist()), tuple(weighted.tolist()), few))
    return whites, tuple(kinds)


def _with_zeros(covariance: np.ndarray, unknowns: _Unknowns) -> tuple[np.ndarray, dict[str, slice]]:
    """The same over all coefficients, those that are 0 by the law's form among them."""
    sizes = [unknowns.first[name] + size for name, size in unknowns.sizes.items()]
    ends = np.cumsum([0, *sizes]).tolist()
    places = {n: slice(a, b) for n, a, b in zip(unknowns.sizes, ends[:-1], ends[1:], strict=True)}
    at = np.concatenate([np.arange(places[n].start + unknowns.first[n], places[n].stop) for n in places])
    whole = np.zeros((ends[-1], ends[-1]))
    whole[np.ix_(at, at)] = covariance
    return whole, places
