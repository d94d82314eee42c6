"""
Equations of the lag: how the contact patch trails the handle.
"""

from __future__ import annotations
import brushsvg._core
import collections.abc
import numpy
import numpy.typing
import typing

__all__: list[str] = ["alpha_after", "drag_arc", "drag_straight", "exponent", "follow", "tip_direction"]

def alpha_after(alpha0_rad: numpy.typing.ArrayLike, exponent: numpy.typing.ArrayLike) -> typing.Any:
    """Return alpha [rad] when the integral of ds / r is `exponent`, article (7)."""

def drag_arc(psi0_rad: float, curvature_per_mm: float, lag_mm: float, length_mm: float) -> float:
    """Return psi [rad] of a taut brush after an arc of the TCP at constant lag."""

def drag_straight(
    contact_mm: tuple[float, float],
    tcp0_mm: tuple[float, float],
    tcp1_mm: tuple[float, float],
    depth0_mm: float,
    depth1_mm: float,
    profile: brushsvg._core.Profile,
) -> tuple[float, float]:
    """
    Return the contact [mm] after a straight move of a taut brush.

    The equations are article (5) to (7). The rule for a loose brush is not applied.
    """

def exponent(
    s_mm: numpy.typing.ArrayLike,
    depth0_mm: numpy.typing.ArrayLike,
    depth1_mm: numpy.typing.ArrayLike,
    profile: brushsvg._core.Profile,
) -> typing.Any:
    """
    Return the integral of ds / r over straight moves, article (7).

    The depth is linear along each move. The summation stops beyond 50.
    """

def follow(
    tcp_mm: numpy.typing.ArrayLike,
    depth_mm: collections.abc.Sequence[float],
    profile: brushsvg._core.Profile,
    contact_mm: tuple[float, float] | None = None,
) -> dict:
    """
    Return contact, heading and tension at each position of the TCP.

    The brush may be taut or loose (article 2.1 and 2.2).

    contact_mm: the contact at the start. None: the brush touches down at the first position.
    """

def tip_direction(
    alpha0_rad: numpy.typing.ArrayLike,
    alpha1_rad: numpy.typing.ArrayLike,
    s_mm: numpy.typing.ArrayLike,
    lag_mm: numpy.typing.ArrayLike,
    tip_gap_mm: numpy.typing.ArrayLike,
) -> typing.Any:
    """Return beta [rad] by article (11) and (12)."""
