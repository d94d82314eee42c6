"""Lemma 1: a bristle as a beam, clamped at its root and sliding at its tip.

Rigidity and load are arbitrary functions along the bristle.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.polynomial.chebyshev import Chebyshev
from numpy.typing import ArrayLike

from ... import _core
from ...errors import Error, need_one_of
from .numbers import frozen, numbers

ENDS = ("shear_free", "third_derivative")
MAX_TERMS = 513
# Share of the greatest coefficient below which a series is exact to the last digits.
MAX_LAST_COEFFICIENT = 1e-12
# Share of the terms of the determinant below which the last condition adds nothing.
MIN_DETERMINANT = 1e-9


@dataclass(frozen=True, repr=False)
class Bristle:
    """A solved bristle, z = 0 at its root and 1 at its tip.

    Lengths are in units of the bristle's. Called with z, (...) in [0, 1], it gives the deflection w. Of the same
    shape are slope, w'; moment, EI w''; shear, (EI w'')'.
    """

    _deflection: Chebyshev
    _moment: Chebyshev

    def __repr__(self) -> str:
        return f"<Bristle bent by {self._deflection(1.0):.4g} of its length at the tip>"

    def __call__(self, z) -> np.ndarray:
        """Return w(z), (...); Error for z outside of [0, 1]."""
        return self._deflection(_check_z(z))

    def slope(self, z: ArrayLike) -> np.ndarray:
        """Return w'(z), (...); Error for z outside of [0, 1]."""
        return self._deflection.deriv()(_check_z(z))

    def moment(self, z: ArrayLike) -> np.ndarray:
        """Return EI w''(z), (...); Error for z outside of [0, 1]."""
        return self._moment(_check_z(z))

    def shear(self, z: ArrayLike) -> np.ndarray:
        """Return (EI w'')'(z), (...); Error for z outside of [0, 1]."""
        return self._moment.deriv()(_check_z(z))


def bristle(
    rigidity: Callable[[np.ndarray], ArrayLike],
    load: Callable[[np.ndarray], ArrayLike],
    sliding_end: str = "shear_free",
) -> Bristle:
    """Solve Lemma 1, (1), for a bristle of any rigidity and load.

    The equation is (EI w'')'' = q on [0, 1] with w(0) = w'(0) = w'(1) = 0 and one more condition at the tip.

    rigidity, load: EI and q, functions of an array of z, (n,), to arrays of the same shape; EI > 0, both smooth.
    sliding_end: the condition at the tip: "shear_free", (EI w'')'(1) = 0, as in mechanics, or "third_derivative",
    w'''(1) = 0, as the article prints it. Where EI is not constant the two differ.

    With an end free of shear there is exactly one solution, for any EI > 0. With the printed condition this is not
    so: with f = 1 / EI it fails where f(1) int f + f'(1) int (1 - z) f = 0. This requires a bristle that grows
    stiffer to its tip, such as EI = 1 / (1 + sqrt(3) (1 - z)).

    Raises Error for functions of other values, functions that 513 Chebyshev terms do not represent (a jump), and
    where no solution or more than one exists.
    """
    need_one_of(sliding_end, ENDS, "the sliding end")
    for given, what in ((rigidity, "the rigidity"), (load, "the load")):
        if not callable(given):
            raise Error(f"{what} is not a function of z", code="wrong-type")
    pliancy = _fit_series(
        lambda z: 1.0 / _evaluate(rigidity, z, "the rigidity", 1e-12), "the reciprocal of the rigidity"
    )
    q = _fit_series(lambda z: _evaluate(load, z, "the load", -1e12), "the load")
    # The part of the moment that the load makes: M = loaded + M0 + V0 z.
    loaded = q.integ(2, lbnd=0.0)
    line = Chebyshev([0.5, 0.5], domain=[0.0, 1.0])  # z itself
    whole = (
        pliancy.integ(lbnd=0.0)(1.0),
        (line * pliancy).integ(lbnd=0.0)(1.0),
        (loaded * pliancy).integ(lbnd=0.0)(1.0),
    )
    if sliding_end == "shear_free":
        tip = (0.0, 1.0, loaded.deriv()(1.0))
    else:  # w''' = (M / EI)' = M' f + M f'
        f, slope = pliancy(1.0), pliancy.deriv()(1.0)
        tip = (slope, f + slope, loaded.deriv()(1.0) * f + loaded(1.0) * slope)
    products = whole[0] * tip[1], whole[1] * tip[0]
    if abs(products[0] - products[1]) <= MIN_DETERMINANT * (abs(products[0]) + abs(products[1])):
        sentence = "with w'''(1) = 0 this bristle has no solution, or more than one: use sliding_end='shear_free'"
        raise Error(sentence, code="bristle-undetermined")
    root = np.linalg.solve([whole[:2], tip[:2]], [-whole[2], -tip[2]])
    moment = loaded + root[0] + root[1] * line
    return Bristle((moment * pliancy).integ(2, lbnd=0.0), moment)


def bristle_of_article(z: ArrayLike, sliding_end: str = "third_derivative") -> np.ndarray:
    """Return the article's example (2), EI = q = exp(1 - z), solved.

        w = c1 + c2 z + (c3 + c4 z) e^z + z^2 / 2

    z: (...), in [0, 1]. sliding_end: as in bristle. Returns w, (...), in units of the bristle's length. (3) prints
    (cubic in z) e^z + 1, which does not solve (2).

    Raises Error for z outside of [0, 1] and other ends.
    """
    need_one_of(sliding_end, ENDS, "the sliding end")
    return _core.bristle_deflection(_core.bristle_coefficients(sliding_end), _check_z(z))


def _check_z(z) -> np.ndarray:
    return numbers(z, "z", 0.0, 1.0)


def _evaluate(function: Callable, z: np.ndarray, what: str, least: float) -> np.ndarray:
    values = numbers(function(z), f"a value of {what}", least, 1e12)
    if values.shape not in ((), z.shape):
        raise Error(f"{what} gives values of shape {values.shape} for {z.shape}", code="sizes-differ")
    return np.broadcast_to(values, z.shape)


def _fit_series(function: Callable, what: str) -> Chebyshev:
    """Return a function on [0, 1] as a series with as many terms as it needs."""
    terms = 17
    while terms <= MAX_TERMS:
        series = Chebyshev.interpolate(function, terms - 1, domain=[0.0, 1.0])
        size = np.abs(series.coef)
        if size[-4:].max() <= MAX_LAST_COEFFICIENT * size.max() + 1e-300:
            return Chebyshev(
                frozen(
                    np.trim_zeros(np.where(size > 1e-16 * size.max(), series.coef, 0.0), "b")
                    if size.max() > 0
                    else np.zeros(1)
                ),
                domain=[0.0, 1.0],
            )
        terms = 2 * terms - 1
    raise Error(f"{what} is not smooth enough: {MAX_TERMS} Chebyshev terms do not represent it", code="not-smooth")
