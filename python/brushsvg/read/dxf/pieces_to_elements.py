"""Convert the pieces of a DXF to elements of a Design.

Lines that meet are joined. Widths are given along the arc length.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from ...geometry.arc_length import knots
from ..design import Element, SubPath
from .entity_curves import Curve, lines_to_cubics, reverse_cubics
from .entity_walk import Piece
from .splines import make_continuous

_MAX_GAP_MM = 1e-4  # ends within this distance meet
_MIN_CUBIC_MM = 1e-6  # size of a cubic below which its direction consists of rounding errors


def join_pieces(pieces: list[Piece]) -> list[Piece]:
    """Join lines that were drawn one after the other and meet.

    The brush is not lifted between the lines of a chain.
    """
    chains: list[list[Piece]] = []
    ends = None  # of the last chain: start and end
    for piece in pieces:
        begin, end = (piece.curves[0].cubics[k, m, :2] for k, m in ((0, 0), (-1, 3)))
        if ends is not None and _are_joinable(chains[-1][-1], piece):
            chain = chains[-1]
            meets = [[_meet(chain_end, piece_end) for piece_end in (begin, end)] for chain_end in ends]
            if len(chain) == 1 and any(meets[0]) and not any(meets[1]):
                chain[0], ends, meets = _reverse_piece(chain[0]), ends[::-1], meets[::-1]
            if any(meets[1]):
                if not meets[1][0]:
                    piece, begin, end = _reverse_piece(piece), end, begin
                chain.append(piece)
                ends = None if _meet(ends[0], end) else (ends[0], end)
                continue
        chains.append([piece])
        ends = (begin, end) if piece.joinable and not _meet(begin, end) else None
    return [_merge_chain(chain) for chain in chains]


def _are_joinable(a: Piece, b: Piece) -> bool:
    return b.joinable and a.block == b.block and a.pen == b.pen


def _meet(a: np.ndarray, b: np.ndarray) -> bool:
    return math.dist(a, b) <= _MAX_GAP_MM


def _reverse_piece(piece: Piece) -> Piece:
    (curve,) = piece.curves
    return replace(piece, curves=(replace(curve, cubics=reverse_cubics(curve.cubics)),))


def _merge_chain(chain: list[Piece]) -> Piece:
    if len(chain) == 1:
        return chain[0]
    cubics = np.concatenate([piece.curves[0].cubics for piece in chain])
    return replace(chain[0], curves=(Curve(cubics),))


def piece_to_element(piece: Piece) -> Element:
    default_mm = 0.0 if piece.fill_rule else piece.pen.width_mm
    subpaths = tuple(_subpath(curve, default_mm) for curve in piece.curves)
    drawn = [subpath.widths[:, 1] for subpath in subpaths if subpath.widths is not None]
    width_mm = float(np.concatenate(drawn).max()) if drawn else default_mm
    if len(subpaths) == len(drawn) == 1 and np.ptp(drawn[0]) == 0:
        subpaths = (replace(subpaths[0], widths=None),)
    return Element(piece.id, subpaths, width_mm, piece.pen.colour, piece.pen.layer, fill_rule=piece.fill_rule)


def find_pattern_restarts(piece: Piece) -> list[np.ndarray]:
    """Find the cubics at which the pattern of a line type restarts.

    Returns an array of indices for each sub-path of the piece's element, without the first cubic.
    """
    restarts_by_subpath = []
    for curve in piece.curves:
        cubics, _ = _closed_cubics(curve)
        restarts = np.zeros(len(cubics), dtype=bool)
        if curve.pattern_restarts is not None:
            restarts = np.append(curve.pattern_restarts, [True] * (len(cubics) - len(curve.pattern_restarts)))
        restarts_by_subpath.append(np.flatnonzero(restarts[_has_extent(cubics)][1:]) + 1)
    return restarts_by_subpath


def _closed_cubics(curve: Curve) -> tuple[np.ndarray, float]:
    """Return cubics (n, 4, 2), with a last one that closes a closed curve, and the gap as drawn."""
    cubics = curve.cubics[..., :2]
    gap = math.dist(cubics[0, 0], cubics[-1, 3])
    if curve.closed and gap > _MAX_GAP_MM:
        cubics = np.concatenate((cubics, lines_to_cubics([cubics[-1, 3], cubics[0, 0]])))
    return cubics, gap


def _has_extent(cubics: np.ndarray) -> np.ndarray:
    return np.abs(cubics - cubics[:, :1]).max(axis=(1, 2)) >= _MIN_CUBIC_MM


def _subpath(curve: Curve, default_mm: float) -> SubPath:
    (cubics, gap), widths = _closed_cubics(curve), curve.widths
    if widths is not None:
        widths = np.where((widths == 0).all(axis=1, keepdims=True), default_mm, widths)
        if len(widths) < len(cubics):
            widths = np.concatenate((widths, widths[-1:, 1:].repeat(2, axis=1)))
    has_extent = _has_extent(cubics)
    if not has_extent.any():
        point = np.repeat(cubics[:1, :1], 4, axis=1)
        return SubPath(point, widths=None if widths is None else np.array([[0.0, widths.max()]]))
    cubics, widths = make_continuous(cubics[has_extent]), None if widths is None else widths[has_extent]
    # A line with widths is closed only if drawn so: a line that tapers off where it began is not a ring.
    closed = curve.closed or (gap <= _MAX_GAP_MM and widths is None)
    if closed:
        cubics[-1, 3] = cubics[0, 0]
    return SubPath(cubics, closed, None if widths is None else _widths_along_length(cubics, widths))


def _widths_along_length(cubics: np.ndarray, widths: np.ndarray) -> np.ndarray:
    """Return rows (k, 2) of length fraction and width; two rows share the fraction at a jump."""
    fractions = np.cumsum([0.0, *knots(cubics)[:, -1]])
    fractions = fractions / fractions[-1]
    rows = np.column_stack((np.column_stack((fractions[:-1], fractions[1:])).ravel(), widths.ravel()))
    is_new = np.append(True, (np.diff(rows, axis=0) != 0).any(axis=1))
    return rows[is_new]
