"""What a brush file says of its laws, and how sure it is: the prior of a fit to further marks."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ... import _core
from ...errors import Error
from ...model.confidence import LAWS, places
from ..marks.from_marks import GAP_TERMS, HALF_TERMS, LAG_TERMS, laws_of

# Of a law, as standard deviation: what an assumed one may be off, and what a polynomial of low degree is off even where
# its numbers are sure. With 0 in place of the latter a brush of few depths could never learn that its law bends.
ASSUMED, FORM = 0.2, 0.002
RATIO = 0.5  # of the widest section's place over the half width, where the file does not say how sure it is
ROUND_TAIL = 0.68  # half way down the tail a drop has 0.5 of its half width, an egg 0.87
DEPTHS = 41
TERMS = {"lag": LAG_TERMS, "tip_gap": GAP_TERMS, "half_width": HALF_TERMS}


@dataclass(frozen=True)
class KnownLaws:
    """laws: of the brush, in the numbers that marks are fitted with; covariance (n, n) of those: lag, tip_gap and
    half_width without their constant 0, widest_per_half. how: by law, in words, how sure the file is. off_mm: by law,
    the greatest distance of the laws from the brush's own."""

    laws: _core.MarkLaws
    covariance: np.ndarray
    how: dict[str, str]
    off_mm: dict[str, float]
    deepest_mm: float

    def prior(self, wider: dict[str, float]) -> _core.LawPrior:
        """wider: by law, how many times as wide the intervals are taken."""
        rows = root_of_inverse(self.widened(wider))
        return _core.LawPrior(self.laws, rows.tolist())

    def loosened(self, share: float) -> dict[str, float]:
        """By law, how many times as wide it must be taken to be unsure by this share of it (rms over depths)."""
        own = self.laws
        values = {"lag": own.lag, "tip_gap": own.tip_gap[1:], "half_width": own.half_width[1:]}
        out, depths = {}, np.arange(1, 5) / 4 * self.deepest_mm
        for law, place in numbers_of().items():
            if law == "tip_to_widest":
                sd, size = np.sqrt(self.covariance[place, place][0]), np.array([own.widest_per_half])
            else:
                powers = np.vander(depths, len(values[law]) + (law != "lag"), increasing=True)[
                    :, law != "lag" :
                ]
                sd = np.sqrt(np.einsum("ij,jk,ik->i", powers, self.covariance[place, place], powers))
                size = powers @ values[law]
            out[law] = max(1.0, share * float(np.sqrt(np.mean(size**2) / max(np.mean(sd**2), 1e-18))))
        return out

    def unfollowed(self, share: float, deepest_mm: float) -> np.ndarray:
        """Covariance of numbers whose laws were measured down to this depth, each time off by a share of them."""
        at, own, depths = numbers_of(), self.laws, np.linspace(0.0, deepest_mm, DEPTHS)[1:]
        out = np.diag(np.full(len(self.covariance), (share * own.widest_per_half) ** 2))
        for law in TERMS:
            values = np.polynomial.polynomial.polyval(depths, getattr(own, law))
            size = np.maximum(values, values[DEPTHS // 4])
            out[at[law], at[law]] = as_measured(law, depths, share * size)
        return out

    def widened(self, wider: dict[str, float]) -> np.ndarray:
        times = np.ones(len(self.covariance))
        for law, place in numbers_of().items():
            times[place] = wider.get(law, 1.0)
        return self.covariance * np.outer(times, times)


def numbers_of() -> dict[str, slice]:
    """Return where each law's numbers are among those of a fit; tip_to_widest: its ratio to the half width."""
    lag, gap, half = LAG_TERMS, LAG_TERMS + GAP_TERMS, LAG_TERMS + GAP_TERMS + HALF_TERMS
    return {
        "lag": slice(0, lag),
        "tip_gap": slice(lag, gap),
        "half_width": slice(gap, half),
        "tip_to_widest": slice(half, half + 1),
    }


def root_of_inverse(covariance: np.ndarray) -> np.ndarray:
    """Rows (n, n) that make standard normal numbers of what has this covariance."""
    unit = np.sqrt(np.diag(covariance))
    values, vectors = np.linalg.eigh(covariance / np.outer(unit, unit))
    return (vectors / np.sqrt(np.maximum(values, 1e-12))).T / unit


def known_laws(brush: _core.Brush) -> KnownLaws:
    """Error for a brush that does not trail."""
    depths = _depths(brush)
    if max(brush.lag(d) for d in depths) <= 0:
        raise Error(
            f"brush {brush.name} does not trail: nothing of it is learnt from marks",
            "lag",
            code="pen-without-lag",
        )
    near = laws_of(brush)
    laws = _core.MarkLaws(
        near.lag,
        near.tip_gap,
        near.half_width,
        near.widest_per_half,
        near.front_per_half,
        _has_round_tail(brush),
    )
    to = _to_numbers(brush, depths, laws.widest_per_half)
    whole = _of_the_file(brush)
    covariance, how = to @ whole @ to.T, {}
    for law, place in numbers_of().items():
        own = places(brush)[law]
        if np.any(whole[own, own]):
            how[law], block = "the covariance in its file", _of_form(brush, law, depths, laws.widest_per_half)
        elif law == "tip_to_widest":
            half = _core.deviations_of_95() * RATIO
            how[law] = (
                f"nothing it says: {laws.widest_per_half:.2f} +- {half:.2f} half widths from the tip (95 %)"
            )
            block = RATIO**2
        else:
            block, how[law] = _said(getattr(brush, law), law, depths, to[place, own])
        covariance[place, place] += block
    return KnownLaws(laws, covariance, how, _off(brush, laws, depths), float(depths[-1]))


def _depths(brush) -> np.ndarray:
    return np.linspace(*brush.depth_range_mm, DEPTHS)[1:]


def as_measured(law: str, depths: np.ndarray, sd_mm: np.ndarray) -> np.ndarray:
    """Covariance of a law's numbers, measured at as many depths as there are of them, each with its error."""
    terms, first = TERMS[law], 0 if law == "lag" else 1
    at = np.linspace(0.0, depths[-1], terms + first)[first:]
    inverse = np.linalg.inv(np.vander(at, terms + first, increasing=True)[:, first:])
    sd = np.interp(at, depths, sd_mm)
    return (inverse * sd**2) @ inverse.T


def _of_form(brush, law: str, depths: np.ndarray, ratio: float):
    """What a law that is sure may still be off for being of low degree."""
    if law == "tip_to_widest":
        return (FORM * ratio) ** 2
    return as_measured(law, depths, FORM * _size(getattr(brush, law), depths))


def _size(law, depths: np.ndarray) -> np.ndarray:
    """Of a law at depths, and near the touch, where it may be 0, what it is at a quarter of the greatest one."""
    return np.maximum([law(d) for d in depths], law(depths[-1] / 4))


def _of_the_file(brush) -> np.ndarray:
    """Covariance over a brush's coefficients, 0 where it has none."""
    size = places(brush)[LAWS[-1]].stop
    return np.array(brush.covariance) if len(brush.covariance) else np.zeros((size, size))


def _said(law, name: str, depths: np.ndarray, to_numbers: np.ndarray) -> tuple[np.ndarray, str]:
    """Of a law without covariance: by its RMSE, its half-intervals, or as an assumed one. The intervals of single
    coefficients make no band, and where they have an RMSE it is the wider."""
    half = np.array(law.half_interval_95)
    if law.rmse_mm is not None:
        error = np.full_like(depths, law.rmse_mm)
        return as_measured(
            name, depths, error
        ), f"its RMSE, {law.rmse_mm:g} mm at each of {TERMS[name]} depths"
    if not half.any():
        error = ASSUMED * _size(law, depths)
        return as_measured(name, depths, error), f"nothing it says: {100 * ASSUMED:g} % (standard deviation)"
    some = half > 0
    powers = np.vander(depths, len(half), increasing=True)[:, some]
    alike = np.linalg.pinv(powers.T @ powers)
    sd = half[some] / _core.deviations_of_95() / np.sqrt(np.diag(alike))
    to = to_numbers[:, some]
    form = as_measured(name, depths, FORM * _size(law, depths))
    return to @ (
        alike * np.outer(sd, sd)
    ) @ to.T + form, "its half-intervals, as for numbers fitted to even depths"


def _to_numbers(brush, depths: np.ndarray, ratio: float) -> np.ndarray:
    """From a brush's coefficients to the fit's numbers, nearest over its depths."""
    at, to = places(brush), numbers_of()
    out = np.zeros((to["tip_to_widest"].stop, at[LAWS[-1]].stop))
    for law, terms in TERMS.items():
        first = 0 if law == "lag" else 1
        columns = np.vander(depths, terms + first, increasing=True)[:, first:]
        values = np.vander(depths, len(getattr(brush, law).coefficients), increasing=True)
        out[to[law], at[law]] = np.linalg.pinv(columns) @ values
    half = np.array([brush.half_width(d) for d in depths])
    widest = np.array([brush.tip_to_widest(d) for d in depths])
    of_widest = np.vander(depths, len(brush.tip_to_widest.coefficients), increasing=True)
    of_half = np.vander(depths, len(brush.half_width.coefficients), increasing=True)
    out[to["tip_to_widest"], at["tip_to_widest"]] = half @ of_widest / (half @ half)
    out[to["tip_to_widest"], at["half_width"]] = (widest - 2 * ratio * half) @ of_half / (half @ half)
    return out


def _has_round_tail(brush) -> bool:
    """By how wide the footprint is half way from its tip to its widest section."""
    shares = []
    for shape in brush.footprints.dragged:
        x, y = np.array(shape.outline_mm).T
        widest = float(x[np.argmax(np.abs(y))])
        tail = x <= widest
        order = np.argsort(x[tail])
        shares.append(
            np.interp(widest / 2, x[tail][order], np.abs(y[tail][order])) / max(np.abs(y).max(), 1e-9)
        )
    return float(np.median(shares)) > ROUND_TAIL


def _off(brush, laws, depths: np.ndarray) -> dict[str, float]:
    half = np.polynomial.polynomial.polyval(depths, laws.half_width)
    near = {
        "lag": np.polynomial.polynomial.polyval(depths, laws.lag),
        "tip_gap": np.polynomial.polynomial.polyval(depths, laws.tip_gap),
        "tip_to_widest": laws.widest_per_half * half,
        "half_width": half,
    }
    return {
        law: float(max(abs(getattr(brush, law)(d) - v) for d, v in zip(depths, near[law], strict=True)))
        for law in LAWS
    }
