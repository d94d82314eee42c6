"""Cut lines of a DXF into the dashes of their line type."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from ...errors import Error
from ...geometry.arc_length import knots
from ..dashes import cut_into_dashes, find_smallest_gap_mm
from ..design import Element, Notice, SubPath
from .pens import Pen

_MAX_DASHES = 100_000
_MAX_JOINT_GAP_MM = 1e-6  # rounding error between the end of a line and the end of its last dash


class DashCutter:
    """A cutter of elements into dashes, with a common limit for a drawing.

    notices: about the elements that were cut, and about line types that are not read.
    """

    def __init__(self):
        self.notices: list[Notice] = []
        self._dashes_left = _MAX_DASHES

    def cut(self, element: Element, pen: Pen, pattern_restarts: list[np.ndarray]) -> Element:
        """Return the element with each dash as a sub-path.

        pattern_restarts: for each sub-path, the indices of the cubics at which the pattern restarts, without the first
        cubic. Raises Error if there are too many dashes.
        """
        if pen.line_type is None or element.fill_rule:
            return element
        pattern = [length * pen.line_scale for length in pen.line_type.pattern_mm]
        lengths = [knots(subpath.cubics)[:, -1] for subpath in element.subpaths]
        if not any(length.any() for length in lengths):
            return element
        if not 0 < sum(pattern) < math.inf:
            unread = Notice(
                pen.line_type.name,
                "the line type is not read: its lines count as unbroken",
                code="dashes-unread",
            )
            if unread not in self.notices:
                self.notices.append(unread)
            return element
        if any(subpath.widths is not None for subpath in element.subpaths):
            self.notices.append(
                Notice(
                    element.id,
                    "its dashes are not read: its width varies",
                    layer=element.layer,
                    code="dashes-unread",
                )
            )
            return element
        pieces: list[SubPath] = []
        for subpath, restarts, length in zip(element.subpaths, pattern_restarts, lengths, strict=True):
            runs = np.split(np.arange(len(length)), restarts)
            # CAD programs draw lines unbroken that are shorter than the pattern.
            if all(length[run].sum() < sum(pattern) for run in runs):
                pieces.append(subpath)
                continue
            try:
                pieces += self._cut_runs(subpath, runs, length, pattern, self._dashes_left - len(pieces))
            except Error as error:
                raise Error(str(error), where=element.id, code=error.code) from None
        self._dashes_left -= len(pieces)
        if len(pieces) > len(element.subpaths):
            sentence = f"it is dashed: {len(pieces)} dashes, each a stroke"
            self.notices.append(Notice(element.id, sentence, layer=element.layer, code="dashed"))
            element = replace(element, dash_gap_mm=find_smallest_gap_mm(pattern))
        return replace(element, subpaths=tuple(pieces))

    def _cut_runs(self, subpath: SubPath, runs, length: np.ndarray, pattern, limit: int) -> list[SubPath]:
        """Cut each run of cubics into dashes, and join dashes that meet at a corner."""
        if len(runs) == 1:
            return cut_into_dashes(subpath, pattern, 0.0, limit)
        dashes_so_far: list[np.ndarray] = []
        for run in runs:
            part = SubPath(subpath.cubics[run])
            dashes = (
                [part]
                if length[run].sum() < sum(pattern)
                else cut_into_dashes(part, pattern, 0.0, limit - len(dashes_so_far))
            )
            pieces = [dash.cubics for dash in dashes]
            if dashes_so_far and pieces and _continues(dashes_so_far[-1], pieces[0]):
                pieces[0] = np.concatenate((dashes_so_far.pop(), pieces[0]))
            dashes_so_far += pieces
        if subpath.closed and len(dashes_so_far) > 1 and _continues(dashes_so_far[-1], dashes_so_far[0]):
            dashes_so_far[0] = np.concatenate((dashes_so_far.pop(), dashes_so_far[0]))
        return [SubPath(cubics) for cubics in dashes_so_far]


def _continues(first: np.ndarray, second: np.ndarray) -> bool:
    """Whether a dash continues in another dash. A dot does not continue."""
    is_long = all(np.abs(cubics - cubics[:1, :1]).max() > _MAX_JOINT_GAP_MM for cubics in (first, second))
    return is_long and math.dist(first[-1, 3], second[0, 0]) <= _MAX_JOINT_GAP_MM
