"""Ends of lines that run out into one corner of a straight cut: the medial axis of a slanted end hooks into the corner
that stands out, where the stroke itself runs straight on to the cut."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ... import _core
from ...geometry.polylines import length
from ...geometry.rotation import rotation
from .graph import Piece

# What is looked at back from the end, in half widths there: the axis of a cut at 45 degrees hooks for 3.7 of them.
LOOKED_AT = 4.5
# Where a line has its width: over the next half width back it grows by less than this share. Lower, and no stroke that
# swells has one; higher, and the second leg of a hook counts as the line.
LEVEL = 0.06
# How far to both sides the cut is looked at, how far cut and sides may stray from straight, and how steep the cut may
# be, in half widths. A brush squares what is no steeper (drawn_cut.cpp).
OFF_MIDDLE, STRAIGHT, BENT, STEEPEST = 0.92, 0.12, 0.5, 1.3
ACROSS = OFF_MIDDLE * np.linspace(-1.0, 1.0, 7)
ALONG = 0.9 * np.linspace(0.0, 1.0, 4)  # where sides are looked at, in shares of the way to the cut
FLICK = 0.25  # in half widths: a last piece that is no longer is but how the axis ends
# The axis of an arm whose sides bend as they end, as in an r, points past the middle of its cut by this angle.
TURNS_RAD = np.radians([0, -8, 8, -16, 16])
UNSEEN_RAD = np.radians(6)  # a last step that turns by less is no hook


def run_to_cuts(chain: list[Piece], rings: list[np.ndarray]) -> list[Piece]:
    """The pieces of one stroke, hooks at its free ends replaced; see `run_to_cut`. A last piece that is all hook goes
    to the one before it."""
    chain = _at_last(chain, rings)
    back = _at_last([_reversed(piece) for piece in reversed(chain)], rings)
    return [_reversed(piece) for piece in reversed(back)]


def _at_last(chain: list[Piece], rings: list[np.ndarray]) -> list[Piece]:
    last = chain[-1]
    if last.ends[1] is not None or last.closed:
        return chain
    line = run_to_cut(last.line, rings)
    if line is not last.line or len(chain) == 1:
        return [*chain[:-1], replace(last, line=line)]
    before = chain[-2]
    is_shared = np.allclose(before.line[-1, :2], last.line[0, :2])
    both = np.vstack([before.line, last.line[1:] if is_shared else last.line])
    line = run_to_cut(both, rings)
    is_flick = length(last.line[:, :2]) < FLICK * last.line[-1, 2]
    if line is both or (
        len(line) > len(before.line) + 1 and not is_flick
    ):  # a corner is left of the last piece
        return chain
    whole = replace(
        before,
        line=line,
        ends=(before.ends[0], None),
        branches=[*before.branches, *last.branches],
        inside=[*before.inside, *last.inside],
        through=[*before.through, *last.through],
    )
    return [*chain[:-2], whole]


def _reversed(piece: Piece) -> Piece:
    return replace(piece, line=piece.line[::-1], ends=piece.ends[::-1])


def run_to_cut(line: np.ndarray, rings: list[np.ndarray]) -> np.ndarray:
    """The line (k, 3) of x, y, half width [mm], whose last point is a free end, its hook replaced by a straight run up
    to where its disc touches the cut; the same object where the end is no straight cut. rings: of the shape."""
    back = line[::-1]
    along = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(back[:, :2], axis=0).T))])
    befores = np.column_stack([np.interp(along + back[:, 2], along, column) for column in back.T])
    halves = back[:, 2]
    is_over = (along > LOOKED_AT * np.maximum(halves, halves[0])) | (along[-1] < along + halves)
    ways_mm = back[:, :2] - befores[:, :2]
    is_level = (
        (halves > 0) & ways_mm.any(axis=1) & (befores[:, 2] <= (1 + LEVEL) * halves)
    )  # no way where the line is back there
    is_level[is_over.argmax() if is_over.any() else len(back) :] = False
    (level,) = is_level.nonzero()
    axes = ways_mm[level] / np.hypot(*ways_mm[level].T)[:, None]
    if is_level[0]:
        if _turn(back[0, :2] - back[1, :2], axes[0]) < UNSEEN_RAD:
            return line
        level, axes = level[1:], axes[1:]
    ways = np.stack([axes @ rotation(turn_rad) for turn_rad in TURNS_RAD], axis=1)
    cuts_mm, slopes = straight_cuts(back[level, None, :2], ways, halves[level, None], rings)
    is_cut = np.abs(np.arctan(slopes) - TURNS_RAD) < np.arctan(STEEPEST)  # False for nan
    for row, turn in np.argwhere(is_cut):  # the first place back with straight sides up to a cut
        k, ahead, to_cut_mm, slope = level[row], ways[row, turn], cuts_mm[row, turn], slopes[row, turn]
        here, half = back[k, :2], back[k, 2]
        if _has_straight_sides(here, ahead, half, to_cut_mm, slope, rings):
            on_mm = to_cut_mm - half * np.hypot(1, slope)
            if on_mm <= 0:
                return line[: len(line) - k]
            return np.vstack([line[: len(line) - k], [*(here + on_mm * ahead), half]])
    return line


def straight_cuts(
    here: np.ndarray, ways: np.ndarray, half, rings: list[np.ndarray]
) -> tuple[np.ndarray, np.ndarray]:
    """How far ahead of places (..., 2), in mm, the outline of rings is cut straight across, over the width of lines of
    these half widths (...), and its slope; nan where there is no such cut. ways: (..., 2), unit vectors."""
    offsets = np.asarray(half)[..., None] * ACROSS
    left = np.stack([-ways[..., 1], ways[..., 0]], axis=-1)
    at = here[..., None, :] + offsets[..., None] * left[..., None, :]
    along = np.broadcast_to(ways[..., None, :], at.shape)
    found = _core.first_crossings(rings, at.reshape(-1, 2), along.reshape(-1, 2))
    reached = np.array(found).reshape(at.shape[:-1])
    reached[~np.isfinite(reached).all(axis=-1)] = np.nan
    slope = (reached[..., -1] - reached[..., 0]) / (offsets[..., -1] - offsets[..., 0])
    middle = (reached[..., 0] + reached[..., -1]) / 2
    bent = np.abs(middle[..., None] + slope[..., None] * offsets - reached).max(axis=-1)
    is_cut = (np.abs(slope) <= STEEPEST) & (bent <= STRAIGHT * np.asarray(half))
    return np.where(is_cut, middle, np.nan), np.where(is_cut, slope, np.nan)


def _has_straight_sides(
    here: np.ndarray, ahead: np.ndarray, half: float, to_cut_mm: float, slope: float, rings: list[np.ndarray]
) -> bool:
    """Whether a line has straight sides from a place on to the cut ahead of it."""
    left = _left_of(ahead)
    for side in (-1, 1):
        on_mm = (to_cut_mm + slope * side * OFF_MIDDLE * half) * ALONG
        at = (
            here + on_mm[:, None] * ahead + 0.7 * half * side * left
        )  # inside, on either side of a slanted cut
        side_mm = np.array(_core.first_crossings(rings, at, np.tile(side * left, (len(at), 1))))
        if (np.abs(side_mm - 0.3 * half) > BENT * half).any():
            return False
    return True


def _turn(one: np.ndarray, other: np.ndarray) -> float:
    return abs(float(np.arctan2(one[0] * other[1] - one[1] * other[0], one @ other)))


def _left_of(way: np.ndarray) -> np.ndarray:
    return np.array([-way[1], way[0]])
