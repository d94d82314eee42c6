"""
The law by which the contact patch trails the handle.
"""

from __future__ import annotations
import brushsvg._core
import collections.abc
import numpy
import numpy.typing
import typing

__all__: list[str] = [
    "alpha_after",
    "drag_arc",
    "drag_straight",
    "exponent",
    "follow",
    "tip_direction",
]

def alpha_after(
    alpha0_rad: numpy.typing.ArrayLike, exponent: numpy.typing.ArrayLike
) -> typing.Any:
    """
    alpha [rad] once the integral of ds / r is `exponent`, article (7).
    """

def drag_arc(
    psi0_rad: float, curvature_per_mm: float, lag_mm: float, length_mm: float
) -> float:
    """
    psi [rad] after an arc of the TCP at constant lag, taut.
    """

def drag_straight(
    contact_mm: tuple[float, float],
    tcp0_mm: tuple[float, float],
    tcp1_mm: tuple[float, float],
    depth0_mm: float,
    depth1_mm: float,
    profile: brushsvg._core.Profile,
) -> tuple[float, float]:
    """
    Contact [mm] after a straight move of a taut brush, article (5) to (7); the loose rule is not applied.
    """

def exponent(
    s_mm: numpy.typing.ArrayLike,
    depth0_mm: numpy.typing.ArrayLike,
    depth1_mm: numpy.typing.ArrayLike,
    profile: brushsvg._core.Profile,
) -> typing.Any:
    """
    Integral of ds / r over straight moves with depth linear along them, article (7); beyond 50 it stops counting.
    """

def follow(
    tcp_mm: numpy.typing.ArrayLike,
    depth_mm: collections.abc.Sequence[float],
    profile: brushsvg._core.Profile,
    contact_mm: tuple[float, float] | None = None,
) -> dict:
    """
    Contact, heading and tension at each place of the TCP, taut and loose (article 2.1, 2.2).
    """

def tip_direction(
    alpha0_rad: numpy.typing.ArrayLike,
    alpha1_rad: numpy.typing.ArrayLike,
    s_mm: numpy.typing.ArrayLike,
    lag_mm: numpy.typing.ArrayLike,
    tip_gap_mm: numpy.typing.ArrayLike,
) -> typing.Any:
    """
    beta [rad], article (11), (12).
    """
