"""Laws of motion: Theorem 1 for a taut brush, section 2.2 for a loose one.

They say how a taut brush turns, where its patch and tip are, and what a loose brush does.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from ... import _core
from ...array_values import ArrayValue
from ...errors import Error
from .numbers import DEEPEST_MM, FARTHEST_MM, frozen, numbers, together

MAX_ANGLE_RAD = 2 * np.pi


def alpha_after(alpha0_rad: ArrayLike, s_mm: ArrayLike, lag_mm: ArrayLike) -> np.ndarray:
    """Return the angle of a taut brush after a straight move at one depth.

    This is (7) with r constant:

        tan(alpha / 2) = tan(alpha0 / 2) exp(-s / r)

    alpha0_rad, s_mm, lag_mm: (...), from the direction of motion to the vector from the patch to the handle, in [-2
    pi, 2 pi]; the way, in [0, 1e6]; the lag, in [0, 1e6], 0 for a rigid pen. Returns alpha [rad], (...), in [-pi,
    pi]. The loose rule is not applied; alpha_after_turn applies it. Theorem 1 prints alpha as the angle to the
    vector to the patch's centre of forces. A settled brush would then have 180 degrees, where (5) and (7) have 0.

    Raises Error for numbers outside of these ranges and shapes that do not broadcast.
    """
    alpha0, s, lag = _check_start(alpha0_rad, s_mm, lag_mm)
    exponent = np.divide(s, lag, out=np.where(s > 0.0, np.inf, 0.0), where=lag > 0.0)
    return _core.lag.alpha_after(alpha0, exponent)


def alpha_on_ramp(
    alpha0_rad: ArrayLike,
    s_mm: ArrayLike,
    law: _core.Profile | float,
    depth0_mm: ArrayLike,
    depth1_mm: ArrayLike,
) -> np.ndarray:
    """Return the angle of a taut brush after a move along which depth changes.

    This is (7) for a straight move along which the depth changes linearly:

        tan(alpha / 2) = tan(alpha0 / 2) exp(-integral of ds / r(d(s)) over the way)

    alpha0_rad, s_mm: (...), as in alpha_after. law: the lag, a Profile (brush.lag) or a number [mm]. depth0_mm,
    depth1_mm: (...), press depth at both ends, in [0, 1000]. Returns alpha [rad], (...). Exponents beyond 50 count
    as 50 or more: the heading is the direction of motion to 1e-21. The loose rule is not applied; follow applies
    it.

    Raises Error for numbers outside of these ranges, depths that the brush cannot have, shapes that do not
    broadcast, and a lag that is negative, or 0 in part, between the depths.
    """
    alpha0 = numbers(alpha0_rad, "alpha0 [rad]", -MAX_ANGLE_RAD, MAX_ANGLE_RAD)
    s = numbers(s_mm, "the way s [mm]", 0.0, FARTHEST_MM)
    depths = [numbers(depth, "the depth [mm]", 0.0, DEEPEST_MM) for depth in (depth0_mm, depth1_mm)]
    alpha0, s, *depths = together(alpha0, s, *depths)
    return _core.lag.alpha_after(alpha0, _core.lag.exponent(s, *depths, _as_profile(law, depths)))


def alpha_after_turn(alpha0_rad: ArrayLike, s_mm: ArrayLike, lag_mm: ArrayLike) -> np.ndarray:
    """Return the angle after a straight move at one depth, for any turn.

    Where the turn is beyond 90 degrees, section 2.2 applies, then (7). A brush that is pushed rather than pulled
    goes loose. The patch rests for s* = -2 r cos(alpha0) while the handle passes it, and is dragged from there on.
    Then alpha is 180 degrees - alpha0 on the same side.

    alpha0_rad, s_mm, lag_mm: (...), as in alpha_after. Returns alpha [rad], (...), in [-pi, pi]. The print counts
    (7) from the segment's start after a rest; it errs by millimetres there.

    Raises Error for numbers outside of the ranges and shapes that do not broadcast.
    """
    alpha0, s, lag = _check_start(alpha0_rad, s_mm, lag_mm)
    cos, sin = np.cos(alpha0), np.sin(alpha0)
    rest = np.maximum(0.0, -2.0 * lag * cos)
    resting = np.arctan2(lag * sin, lag * cos + np.minimum(s, rest))
    from_there = np.where(rest > 0.0, np.arctan2(sin, -cos), alpha0)
    return np.where((s < rest), resting, alpha_after(from_there, np.maximum(s - rest, 0.0), lag))


def contact_offset(alpha_rad: ArrayLike, lag_mm: ArrayLike) -> np.ndarray:
    """Return the patch's centre of friction as seen from the handle, (5) and (6).

        (Delta x, Delta y) = (-r cos(alpha), -r sin(alpha))

    The frame is that of the motion, with x along it. alpha_rad, lag_mm: (...). Returns mm, (..., 2). The article's
    (9) uses the same symbols for the distance that the patch has moved. After (10) it prints p1 = p0 + Delta p
    where q1 + Delta p holds.

    Raises Error for numbers outside of the ranges of alpha_after and shapes that do not broadcast.
    """
    alpha, lag = together(_check_angle(alpha_rad, "alpha [rad]"), numbers(lag_mm, "the lag [mm]", 0.0, FARTHEST_MM))
    return np.stack([-lag * np.cos(alpha), -lag * np.sin(alpha)], axis=-1)


def tip_offset(alpha_rad: ArrayLike, lag_mm: ArrayLike, tip_gap_mm: ArrayLike) -> np.ndarray:
    """Return the brush's tip as seen from the handle, (15) and (16).

    It is contact_offset with r + b in place of r. alpha_rad, lag_mm, tip_gap_mm: (...). Returns mm, (..., 2).

    Raises Error for numbers outside of the ranges of alpha_after and shapes that do not broadcast.
    """
    lag, gap = together(
        numbers(lag_mm, "the lag [mm]", 0.0, FARTHEST_MM / 2),
        numbers(tip_gap_mm, "the tip gap [mm]", 0.0, FARTHEST_MM / 2),
    )
    return contact_offset(alpha_rad, lag + gap)


@dataclass(frozen=True, eq=False, repr=False)
class Followed(ArrayValue):
    """The motion of the brush at each place of the handle; the arrays are read-only.

    contact_mm: (n, 2), the patch's centre of friction p. heading_rad: (n,), of the vector from p to the handle;
    before the first motion it is the first known heading. taut: (n,) of bool, whether the handle is as far from p
    as the lag.
    """

    contact_mm: np.ndarray
    heading_rad: np.ndarray
    taut: np.ndarray


def follow(
    tcp_mm: ArrayLike, depth_mm: ArrayLike, law: _core.Profile | float, contact_mm: ArrayLike | None = None
) -> Followed:
    """Follow the patch along straight moves of the handle, taut and loose.

    Theorem 1 and section 2.2 are applied event by event.

    tcp_mm: (n, 2), n >= 1, places of the handle in the frame of the paper. depth_mm: (n,) or one for all, linear
    between them, in [0, 1000]. law: the lag, a Profile (brush.lag) or a number [mm]. contact_mm: (2,), where the
    patch is at first, no further than the lag; None: the brush is set down there. The print separates loose from
    taut by an epsilon of 0.01 mm, which fine steps never reach; here the moments are roots.

    Raises Error for other shapes and numbers, depths that the brush cannot have, and a lag that is negative, or 0 in
    part, at the depths passed.
    """
    tcp = numbers(tcp_mm, "a place of the TCP [mm]", -FARTHEST_MM, FARTHEST_MM)
    depth = numbers(depth_mm, "the depth [mm]", 0.0, DEEPEST_MM)
    if tcp.ndim != 2 or tcp.shape[1] != 2 or depth.ndim > 1:
        sentence = f"places of shape {tcp.shape} and depths of shape {depth.shape} are not (n, 2) and (n,)"
        raise Error(sentence, code="sizes-differ")
    depth = np.full(len(tcp), depth) if depth.ndim == 0 else depth
    contact = None
    if contact_mm is not None:
        contact = numbers(contact_mm, "the contact [mm]", -FARTHEST_MM, FARTHEST_MM)
        if contact.shape != (2,):
            raise Error(f"a contact of shape {contact.shape} is not (2,)", code="sizes-differ")
    rows = _core.lag.follow(tcp, depth, _as_profile(law, depth), contact)
    return Followed(*(frozen(rows[name]) for name in ("contact_mm", "heading_rad", "taut")))


def _as_profile(law, depths_mm) -> _core.Profile:
    if isinstance(law, _core.Profile):
        law(np.asarray(depths_mm))  # refuses depths that the brush cannot have
        return law
    lag = numbers(law, "the lag [mm]", 0.0, FARTHEST_MM)
    if lag.ndim > 0:
        raise Error("the lag must be one number or a Profile, not an array", code="wrong-type")
    return _core.Profile([float(lag)])


def _check_angle(given, what: str) -> np.ndarray:
    return numbers(given, what, -MAX_ANGLE_RAD, MAX_ANGLE_RAD)


def _check_start(alpha0_rad, s_mm, lag_mm) -> list[np.ndarray]:
    return together(
        _check_angle(alpha0_rad, "alpha0 [rad]"),
        numbers(s_mm, "the way s [mm]", 0.0, FARTHEST_MM),
        numbers(lag_mm, "the lag [mm]", 0.0, FARTHEST_MM),
    )
