"""Make the prior of a fit to further marks from a brush file.

The prior has the laws of the file and their uncertainty.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ... import _core
from ...errors import Error
from ...model.confidence import LAWS, places
from ..marks.from_marks import GAP_TERMS, HALF_TERMS, LAG_TERMS, laws_of

# Relative standard deviations of an assumed law, and of the error of a polynomial of low degree with exact
# coefficients. With 0 for the latter, a brush of few depths could never learn that its law bends.
ASSUMED_SIGMA, FORM_SIGMA = 0.2, 0.002
# Standard deviation of the ratio of the widest section to the half width, if the file has no uncertainty.
RATIO_SIGMA = 0.5
# Least width of a round tail half way to the widest section, relative to the greatest width. A drop has 0.5, an egg
# 0.87.
MIN_ROUND_TAIL_WIDTH = 0.68
DEPTH_COUNT = 41  # depths at which laws are compared
TERMS = {"lag": LAG_TERMS, "tip_gap": GAP_TERMS, "half_width": HALF_TERMS}


@dataclass(frozen=True)
class KnownLaws:
    """The laws of a brush as a prior.

    laws: in the form of a fit of marks. covariance (n, n): of lag, tip_gap and half_width without their constant 0, and
    of widest_per_half. how: for each law, a description of its uncertainty in the file. off_mm: for each law, its
    largest distance from the law of the brush.
    """

    laws: _core.MarkLaws
    covariance: np.ndarray
    how: dict[str, str]
    off_mm: dict[str, float]
    deepest_mm: float

    def prior(self, wider: dict[str, float]) -> _core.LawPrior:
        """Return the prior for a fit. wider: for each law, the factor of its intervals."""
        rows = root_of_inverse(self.widened(wider))
        return _core.LawPrior(self.laws, rows.tolist())

    def loosened(self, share: float) -> dict[str, float]:
        """Return the factor of each law for a relative error of `share`.

        The error is a standard deviation, rms over depths.
        """
        own = self.laws
        values = {"lag": own.lag, "tip_gap": own.tip_gap[1:], "half_width": own.half_width[1:]}
        out, depths = {}, np.arange(1, 5) / 4 * self.deepest_mm
        for law, place in numbers_of().items():
            if law == "tip_to_widest":
                sd, size = np.sqrt(self.covariance[place, place][0]), np.array([own.widest_per_half])
            else:
                powers = np.vander(depths, len(values[law]) + (law != "lag"), increasing=True)[:, law != "lag" :]
                sd = np.sqrt(np.einsum("ij,jk,ik->i", powers, self.covariance[place, place], powers))
                size = powers @ values[law]
            out[law] = max(1.0, share * float(np.sqrt(np.mean(size**2) / max(np.mean(sd**2), 1e-18))))
        return out

    def unfollowed(self, share: float, deepest_mm: float) -> np.ndarray:
        """Return the covariance of laws with a relative error of `share`. The laws are measured down to deepest_mm."""
        at, own, depths = numbers_of(), self.laws, np.linspace(0.0, deepest_mm, DEPTH_COUNT)[1:]
        out = np.diag(np.full(len(self.covariance), (share * own.widest_per_half) ** 2))
        for law in TERMS:
            values = np.polynomial.polynomial.polyval(depths, getattr(own, law))
            size = np.maximum(values, values[DEPTH_COUNT // 4])
            out[at[law], at[law]] = covariance_as_measured(law, depths, share * size)
        return out

    def widened(self, wider: dict[str, float]) -> np.ndarray:
        times = np.ones(len(self.covariance))
        for law, place in numbers_of().items():
            times[place] = wider.get(law, 1.0)
        return self.covariance * np.outer(times, times)


def numbers_of() -> dict[str, slice]:
    """Return the slice of each law in the numbers of a fit. tip_to_widest is its ratio to the half width."""
    lag, gap, half = LAG_TERMS, LAG_TERMS + GAP_TERMS, LAG_TERMS + GAP_TERMS + HALF_TERMS
    return {
        "lag": slice(0, lag),
        "tip_gap": slice(lag, gap),
        "half_width": slice(gap, half),
        "tip_to_widest": slice(half, half + 1),
    }


def root_of_inverse(covariance: np.ndarray) -> np.ndarray:
    """Return the matrix (n, n) from numbers to standard normal numbers. covariance (n, n): of the numbers."""
    unit = np.sqrt(np.diag(covariance))
    values, vectors = np.linalg.eigh(covariance / np.outer(unit, unit))
    return (vectors / np.sqrt(np.maximum(values, 1e-12))).T / unit


def known_laws(brush: _core.Brush) -> KnownLaws:
    """Return the laws of a brush as a prior.

    Raises Error for a brush that does not trail.
    """
    depths = _sample_depths(brush)
    if max(brush.lag(d) for d in depths) <= 0:
        sentence = f"brush {brush.name} does not trail, so marks cannot update it"
        raise Error(sentence, "lag", code="pen-without-lag")
    fitted_laws = laws_of(brush)
    laws = _core.MarkLaws(
        fitted_laws.lag,
        fitted_laws.tip_gap,
        fitted_laws.half_width,
        fitted_laws.widest_per_half,
        fitted_laws.front_per_half,
        _has_round_tail(brush),
    )
    to_numbers = _to_numbers(brush, depths, laws.widest_per_half)
    file_covariance = _covariance_in_file(brush)
    covariance, how = to_numbers @ file_covariance @ to_numbers.T, {}
    for law, place in numbers_of().items():
        coefficients = places(brush)[law]
        if np.any(file_covariance[coefficients, coefficients]):
            how[law] = "covariance in the brush file"
            block = _form_covariance(brush, law, depths, laws.widest_per_half)
        elif law == "tip_to_widest":
            half = _core.interval_factor_95() * RATIO_SIGMA
            how[law] = (
                f"not in the brush file; assumed: {laws.widest_per_half:.2f} +- {half:.2f} half widths from the tip "
                "(95 %)"
            )
            block = RATIO_SIGMA**2
        else:
            block, how[law] = _covariance_without_file(
                getattr(brush, law), law, depths, to_numbers[place, coefficients]
            )
        covariance[place, place] += block
    return KnownLaws(laws, covariance, how, _largest_distances(brush, laws, depths), float(depths[-1]))


def _sample_depths(brush) -> np.ndarray:
    return np.linspace(*brush.depth_range_mm, DEPTH_COUNT)[1:]


def covariance_as_measured(law: str, depths: np.ndarray, sd_mm: np.ndarray) -> np.ndarray:
    """Return the covariance of the coefficients of a measured law.

    The law is measured at as many depths as it has coefficients, with errors sd_mm.
    """
    terms, first = TERMS[law], 0 if law == "lag" else 1
    at = np.linspace(0.0, depths[-1], terms + first)[first:]
    inverse = np.linalg.inv(np.vander(at, terms + first, increasing=True)[:, first:])
    sd = np.interp(at, depths, sd_mm)
    return (inverse * sd**2) @ inverse.T


def _form_covariance(brush, law: str, depths: np.ndarray, ratio: float):
    """Return the part of the covariance of a law that comes from its low degree."""
    if law == "tip_to_widest":
        return (FORM_SIGMA * ratio) ** 2
    return covariance_as_measured(law, depths, FORM_SIGMA * _size_of_law(getattr(brush, law), depths))


def _size_of_law(law, depths: np.ndarray) -> np.ndarray:
    """Return the size of a law at depths, at least its value at a quarter of the greatest depth.

    Near first touch the law may be 0.
    """
    return np.maximum([law(d) for d in depths], law(depths[-1] / 4))


def _covariance_in_file(brush) -> np.ndarray:
    """Return the covariance of the coefficients of a brush. It is 0 if the file has none."""
    size = places(brush)[LAWS[-1]].stop
    return np.array(brush.covariance) if len(brush.covariance) else np.zeros((size, size))


def _covariance_without_file(law, name: str, depths: np.ndarray, to_numbers: np.ndarray) -> tuple[np.ndarray, str]:
    """Return the covariance of a law without one, and a description of its origin.

    It comes from the RMSE of the law, from its half intervals, or from the assumption for unmeasured laws. The RMSE
    comes first, because the intervals of single coefficients make no band and the RMSE is wider.
    """
    half = np.array(law.half_interval_95)
    if law.rmse_mm is not None:
        error = np.full_like(depths, law.rmse_mm)
        return covariance_as_measured(
            name, depths, error
        ), f"RMSE of the law, {law.rmse_mm:g} mm at each of {TERMS[name]} depths"
    if not half.any():
        error = ASSUMED_SIGMA * _size_of_law(law, depths)
        return covariance_as_measured(
            name, depths, error
        ), f"not in the brush file; assumed: {100 * ASSUMED_SIGMA:g} % (standard deviation)"
    has_interval = half > 0
    powers = np.vander(depths, len(half), increasing=True)[:, has_interval]
    unit_covariance = np.linalg.pinv(powers.T @ powers)
    sd = half[has_interval] / _core.interval_factor_95() / np.sqrt(np.diag(unit_covariance))
    selected = to_numbers[:, has_interval]
    form = covariance_as_measured(name, depths, FORM_SIGMA * _size_of_law(law, depths))
    return selected @ (
        unit_covariance * np.outer(sd, sd)
    ) @ selected.T + form, "intervals of the coefficients in the brush file, as if fitted to evenly spaced depths"


def _to_numbers(brush, depths: np.ndarray, ratio: float) -> np.ndarray:
    """Return the matrix from a brush's coefficients to a fit's, whose laws are nearest over the depths."""
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
    """Return whether the footprint's tail is round, by the width half way from tip to widest section."""
    shares = []
    for shape in brush.footprints.dragged:
        x, y = np.array(shape.outline_mm).T
        widest = float(x[np.argmax(np.abs(y))])
        tail = x <= widest
        order = np.argsort(x[tail])
        shares.append(np.interp(widest / 2, x[tail][order], np.abs(y[tail][order])) / max(np.abs(y).max(), 1e-9))
    return float(np.median(shares)) > MIN_ROUND_TAIL_WIDTH


def _largest_distances(brush, laws, depths: np.ndarray) -> dict[str, float]:
    half = np.polynomial.polynomial.polyval(depths, laws.half_width)
    fitted_values = {
        "lag": np.polynomial.polynomial.polyval(depths, laws.lag),
        "tip_gap": np.polynomial.polynomial.polyval(depths, laws.tip_gap),
        "tip_to_widest": laws.widest_per_half * half,
        "half_width": half,
    }
    return {
        law: float(max(abs(getattr(brush, law)(d) - v) for d, v in zip(depths, fitted_values[law], strict=True)))
        for law in LAWS
    }
