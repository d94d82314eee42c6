"""Find why paint differs from the drawing at a place: what the stroke needs there that the brush cannot do."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..._core import area, footprint_at, intersect, target_outline

RING_TOLERANCE_MM = 0.01
_MIN_SQUARE_MM = 0.5  # smallest side of the square in which paint and drawing differ most, see stroke_score
_MIN_BARE_SHARE = 0.1  # of this square: a smaller area that no stroke reaches does not explain the difference
MIN_CORNER_DEG = 25.0  # the polyline of a smooth line turns by less from piece to piece
# Half width in mm per mm of length. A footprint is about three times as long as half of its width.
MAX_WIDTH_SLOPE = 0.25
WIDTH_TOLERANCE_MM = 1e-6
MIN_WIDTH_ERROR = 0.05  # of the width of a brush with one width: a smaller error is not the most visible one
MIN_MIDDLE_OFFSET = 0.25  # of half the width: a middle that is further off is the most visible error
MIN_EXPLAINED_SHARE = 0.3  # of the missing area: a width out of reach that leaves less is not the cause
# A footprint is pointed if it is narrower than this share of its greatest width, a tenth of the way there from its
# tip. A disc has 0.44, a drop 0.1.
MAX_TIP_WIDTH = 0.3

SCALE_UP = "use a finer brush, or scale the drawing up"
REMEDIES = {  # by code of the cause, where a remedy exists
    "wider-than-brush": "use a wider brush, or --wide passes",
    "thinner-than-brush": "use a finer brush, or draw it wider",
    "thinner-than-measured": "draw it wider, or calibrate the brush with thinner lines",
    "one-width": "use another pen, or draw it as wide as this one",
    "unreached": SCALE_UP,
    "shape-corner": SCALE_UP,
    "lag-not-compensated": "leave out --compensation",
    "coarse-tolerance": "use a smaller --tolerance",
    "shorter-than-footprint": SCALE_UP,
    "sharp-corner": SCALE_UP,
    "stroke-start": "try another --start",
    "stroke-end": "try another --end",
    "tighter-than-lag": "try --compensation refined, or scale the drawing up",
    "tighter-than-width": "draw it thinner there, or bend it less",
    "steep-width": "let its width change more slowly",
    "off-middle-line": "use a smaller --tolerance",
    "wider-on-bends": "try --compensation refined",
}
REFINABLE_CODES = ("tighter-than-lag", "wider-on-bends")  # refinement helps, and more than it only SCALE_UP


# Causes whose remedy is SCALE_UP in a filled shape, because nobody drew the strokes there.
LINE_CODES = ("stroke-start", "stroke-end", "off-middle-line")


def find_remedy(code: str, stroke, compensation: str) -> str:
    """Return the remedy for a cause, "" where there is none. A refined job is not refined again."""
    is_refined = code in REFINABLE_CODES and compensation == "refined"
    return SCALE_UP if is_refined or (code in LINE_CODES and stroke.target_mm) else REMEDIES.get(code, "")


@dataclass(frozen=True)
class Cause:
    """The cause of a difference.

    words: the cause in words; code: a code of docs/reference/diagnostics.md.
    """

    words: str
    code: str


def square_side_mm(line: np.ndarray) -> float:
    return max(_MIN_SQUARE_MM, float(np.median(line[:, 3])))


def find_cause(painted, stroke, line, place, size_mm, tracking_error) -> Cause:
    """Find why paint differs at a place.

    painted: a figures.PaintedPlan; size_mm: side of the square around the place that is examined.
    """
    pieces_here = [
        piece
        for piece in painted.unreached
        if piece.element == stroke.origin.element and _is_near_rings(place.at_mm, piece.rings, size_mm / 2)
    ]
    is_bare = place.is_missing and any(not piece.is_rim for piece in pieces_here)
    is_rim = place.is_missing and bool(pieces_here)
    is_corner = place.is_missing and _outside_discs_mm2(stroke, place.at_mm, size_mm) > place.area_mm2 / 2
    where = "bare" if is_bare else "rim" if is_rim else "corner" if is_corner else ""
    return find_gravest_cause(
        stroke,
        line,
        painted.brush,
        place,
        size_mm,
        where,
        tracking_error,
        painted.tolerance_mm,
        painted.compensation,
    )


def _is_near_rings(place_mm, rings, reach_mm: float) -> bool:
    """Return whether rings enclose enough of a square around a place. The limit is _MIN_BARE_SHARE of the square."""
    return area(intersect([_square_ring(place_mm, reach_mm)], rings)) > _MIN_BARE_SHARE * (2 * reach_mm) ** 2


def _outside_discs_mm2(stroke, place_mm, size_mm: float) -> float:
    """Return the area of a shape, in a square at place_mm, that no disc of the stroke covers."""
    if not stroke.target_mm:
        return 0.0
    within = intersect([_square_ring(place_mm, size_mm / 2)], stroke.target_mm)
    discs = target_outline(stroke.replaced(target_mm=[]), RING_TOLERANCE_MM)
    return area(within) - area(intersect(within, discs))


def _square_ring(place_mm, reach_mm: float) -> np.ndarray:
    x, y = place_mm
    sides = ((-1, -1), (1, -1), (1, 1), (-1, 1))
    return np.array([(x + reach_mm * right, y + reach_mm * up) for right, up in sides])


def find_gravest_cause(
    stroke,
    line: np.ndarray,
    brush,
    place,
    size_mm: float,
    where: str,
    tracking_error,
    tolerance_mm: float,
    compensation: str = "closed",
) -> Cause:
    """Return the gravest cause that holds near a place.

    stroke: the stroke as it was drawn; line: its flattened middle line, (n, 4) rows x, y, arc length, half width;
    place: the place of its verdict; size_mm: side of the square around the place; where: "bare" where no stroke
    reaches, "rim" where only a stroke wider than the brush would reach, "corner" where discs of the stroke's widths do
    not reach, else ""; tracking_error: of the pass.
    """
    at = int(np.hypot(line[:, 0] - place.at_mm[0], line[:, 1] - place.at_mm[1]).argmin())
    stroke_place = _StrokePlace(stroke, line, brush, at, place.is_missing)
    error_words = f"tracking error up to {tracking_error.largest_mm:.2g} mm"
    return (
        (
            _width_cause(stroke_place, place.area_mm2, size_mm, where)
            if brush.width_follows_depth()
            else _one_width_cause(stroke_place)
        )
        or _compensation_cause(stroke_place, tracking_error.largest_mm, tolerance_mm, compensation, error_words)
        or _length_cause(stroke_place)
        or _path_cause(stroke_place)
        or _remaining_cause(stroke_place, tracking_error.largest_mm > tolerance_mm, compensation, error_words)
    )


class _StrokePlace:
    """A place on a stroke's middle line.

    at: its row in line; s_mm: its arc length; half_mm: the half width there; length_mm: length of the line; depth_mm,
    footprint_mm: depth of the brush and length of its footprint for this half width.
    """

    def __init__(self, stroke, line: np.ndarray, brush, at: int, is_missing: bool):
        self.stroke, self.line, self.brush, self.at, self.is_missing = stroke, line, brush, at, is_missing
        self.s_mm, self.half_mm, self.length_mm = line[at, 2], line[at, 3], line[-1, 2]
        self.depth_mm = _depth_for_half_width(brush, self.half_mm)
        self.footprint_mm = _footprint_length_mm(brush, self.depth_mm)


def _width_cause(place: _StrokePlace, area_mm2: float, size_mm: float, where: str) -> Cause | None:
    """Return the cause if the width is out of reach, or no stroke reaches the place."""
    half, (least, greatest) = place.half_mm, place.brush.half_width_range_mm()
    finest = max(least, _min_measured_half_width(place.brush))
    unpainted_mm2 = (half - greatest) * size_mm  # area that a mark of the greatest width leaves in the square
    is_wide = place.is_missing and half > greatest + WIDTH_TOLERANCE_MM
    if is_wide and (where == "rim" or unpainted_mm2 > MIN_EXPLAINED_SHARE * area_mm2):
        words = f"{2 * half:.3g} mm wide there, wider than the brush paints, {2 * greatest:.3g} mm"
        return Cause(words, code="wider-than-brush")
    if where == "bare":
        return Cause("no stroke reaches there", code="unreached")
    if where == "corner":
        return Cause("a corner of the shape, which round marks leave", code="shape-corner")
    if not place.is_missing and half < least - WIDTH_TOLERANCE_MM:
        words = f"{2 * half:.3g} mm wide there, thinner than the finest line of the brush, {2 * least:.3g} mm"
        return Cause(words, code="thinner-than-brush")
    if max(half for _, half in place.stroke.half_width) < finest - WIDTH_TOLERANCE_MM:
        words = f"thinner than the finest line that was measured of the brush, {2 * finest:.3g} mm"
        return Cause(words, code="thinner-than-measured")
    return None


def _one_width_cause(place: _StrokePlace) -> Cause | None:
    brush_half_mm = place.brush.half_width(place.depth_mm)
    error_mm = place.half_mm - brush_half_mm if place.is_missing else brush_half_mm - place.half_mm
    if error_mm <= MIN_WIDTH_ERROR * brush_half_mm:
        return None
    words = f"{2 * place.half_mm:.3g} mm wide there, the one width of the brush is {2 * brush_half_mm:.3g} mm"
    return Cause(words, code="one-width")


def _compensation_cause(
    place: _StrokePlace, error_mm: float, tolerance_mm: float, compensation: str, error_words: str
) -> Cause | None:
    """Return the cause if the chosen compensation or tolerance displaces the paint."""
    if compensation in ("none", "constant") and error_mm > max(tolerance_mm, MIN_MIDDLE_OFFSET * place.half_mm):
        is_none = compensation == "none"
        how = "the lag is not compensated" if is_none else "one lag does not fit all of the stroke"
        return Cause(f"{how}: {error_words}", code="lag-not-compensated")
    if min(tolerance_mm, error_mm) > MIN_MIDDLE_OFFSET * place.half_mm:
        return Cause(f"the tolerance is {tolerance_mm:g} mm: {error_words}", code="coarse-tolerance")
    return None


def _length_cause(place: _StrokePlace) -> Cause | None:
    if place.length_mm + 2 * place.half_mm > place.footprint_mm:
        return None
    words = f"too short for the brush: a dab, whose footprint is {place.footprint_mm:.2g} mm long"
    return Cause(words, code="shorter-than-footprint")


def _path_cause(place: _StrokePlace) -> Cause | None:
    """Return the cause if the footprint cannot follow a corner, end or bend."""
    line = place.line
    brush = place.brush
    half = place.half_mm
    s_mm = place.s_mm
    is_open = not place.stroke.closed
    turn_deg = _sharpest_corner_deg(line, s_mm, max(place.footprint_mm, 2 * half), place.stroke.closed)
    if turn_deg > MIN_CORNER_DEG:
        return Cause(f"a corner of {turn_deg:.0f} degrees, sharper than the footprint", code="sharp-corner")
    if is_open and s_mm < max(brush.tip_to_widest(place.depth_mm), half):
        pointed = _is_pointed(brush, place.depth_mm)
        how = "the footprint is pointed behind" if pointed else "the footprint's back, not a round cap"
        return Cause(f"start of the stroke: {how}", code="stroke-start")
    if is_open and place.length_mm - s_mm < max(place.footprint_mm, half):
        return Cause("end of the stroke: the footprint's front, not a round cap", code="stroke-end")
    lag_mm = brush.lag(place.depth_mm)
    radius_mm = _turning_radius_mm(line, s_mm, lag_mm)
    if radius_mm < lag_mm:
        words = f"turns tighter than the lag: radius {radius_mm:.2g} mm, lag {lag_mm:.2g} mm"
        return Cause(words, code="tighter-than-lag")
    if radius_mm < half:
        words = f"turns tighter than half its width: radius {radius_mm:.2g} mm"
        return Cause(words, code="tighter-than-width")
    slopes = np.abs(np.diff(line[:, 3]) / np.diff(np.maximum.accumulate(line[:, 2] + 1e-9 * np.arange(len(line)))))
    if slopes[max(place.at - 1, 0) : place.at + 1].max(initial=0.0) > MAX_WIDTH_SLOPE:  # on either side
        return Cause("its width changes faster than the footprint can follow", code="steep-width")
    return None


def _remaining_cause(place: _StrokePlace, is_off: bool, compensation: str, error_words: str) -> Cause:
    if place.is_missing and compensation == "refined" and is_off:
        words = "refined: less paint here, and the rest of the outline fits better"
        return Cause(words, code="traded-by-refinement")
    if place.is_missing:  # on a bend, a footprint never covers less than across its middle
        return Cause(error_words, code="off-middle-line")
    return Cause("the footprint is wider on bends than across its middle", code="wider-on-bends")


def _depth_for_half_width(brush, half_width_mm: float) -> float:
    if not brush.width_follows_depth():
        return brush.paint_depth_mm
    least, greatest = brush.half_width_range_mm()
    return brush.depth_for_half_width(float(np.clip(half_width_mm, least, greatest)), "")


def _footprint_length_mm(brush, depth_mm: float) -> float:
    """Return the length of the footprint from its tip to its front."""
    return float(footprint_at(brush.footprints, depth_mm, 1.0)[:, 0].max())


def _is_pointed(brush, depth_mm: float) -> bool:
    outline = np.abs(footprint_at(brush.footprints, depth_mm, 1.0))
    widest, half = outline[outline[:, 1].argmax()]
    edge = outline[outline[:, 0] <= widest]
    edge = edge[edge[:, 0].argsort()]
    return bool(np.interp(0.1 * widest, edge[:, 0], edge[:, 1]) < MAX_TIP_WIDTH * half)


def _min_measured_half_width(brush) -> float:
    laws = (brush.lag, brush.tip_gap, brush.tip_to_widest, brush.half_width)
    return brush.half_width(max((law.calibrated_mm[0] for law in laws if law.calibrated_mm), default=0.0))


def _sharpest_corner_deg(line: np.ndarray, s: float, reach_mm: float, closed: bool) -> float:
    """Return the sharpest corner within reach of arc length s.

    The corner at the seam of a closed line counts as well.
    """
    steps = np.diff(line[:, :2], axis=0)
    steps = steps[np.hypot(*steps.T) > 0]
    if len(steps) < 2:
        return 0.0
    turns, length = np.abs(_turning_angles(steps)), line[-1, 2]
    at = np.unique(line[:, 2])[1:-1][: len(turns)]
    distance = np.abs(at - s)
    near = turns[: len(at)][(np.minimum(distance, length - distance) if closed else distance) <= reach_mm]
    if closed and min(s, length - s) <= reach_mm:
        near = np.append(near, np.abs(_turning_angles(steps[[-1, 0]])))
    return float(np.degrees(near.max(initial=0.0)))


def _turning_angles(steps: np.ndarray) -> np.ndarray:
    a, b = steps[:-1], steps[1:]
    return np.arctan2(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0], (a * b).sum(axis=1))


def _turning_radius_mm(line: np.ndarray, s: float, window_mm: float) -> float:
    """Return the line's radius near arc length s, from its turn within window_mm."""
    length = line[-1, 2]
    window_mm = min(max(window_mm, 1.0), length)
    first = min(max(s - window_mm / 2, 0.0), length - window_mm)
    at = np.linspace(first, first + window_mm, 9)
    points = np.column_stack([np.interp(at, line[:, 2], line[:, k]) for k in (0, 1)])
    turned = abs(float(_turning_angles(np.diff(points, axis=0)).sum()))
    return 0.875 * window_mm / turned if turned > 1e-9 else np.inf
