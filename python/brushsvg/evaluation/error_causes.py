"""Why paint differs from what was drawn at a place: what the stroke asks for there that a brush cannot."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .._core import footprint_at

CORNER_DEG = 25.0  # a polyline of a smooth line turns by less from piece to piece
STEEP = 0.25  # mm of half width per mm: a footprint is about three times as long as half of its width
SLIGHT = 1e-6
SEEN = 0.05  # of the one width that a brush has: less is not what one sees first
GRAVE = 0.25  # of half the width: a middle that is so far off the line is what one sees first
EXPLAINS = 0.3  # of what is missing at a place: a width out of reach that leaves less is not why
POINTED = 0.3  # of its greatest width, a tenth of the way there from its tip: a disc has 0.44, a drop 0.1


@dataclass(frozen=True)
class Cause:
    """In words, and as a code of docs/diagnostics.md."""

    words: str
    code: str


def cause(
    stroke,
    line: np.ndarray,
    brush,
    place,
    size_mm: float,
    where: str,
    miss,
    tolerance_mm: float,
    compensation: str = "closed",
) -> Cause:
    """The first of the causes that holds near a place, the gravest first.

    stroke: as it was wanted; line: its middle, flattened, (n, 4) rows x, y, arc length, half width; place: of the
    stroke's verdict, size_mm: side of its square; where: "bare" where no stroke reaches, "rim" where one that is wider
    than the brush would, "corner" where discs of this one's widths do not, else ""; miss: of the pass.
    """
    is_missing = place.is_missing
    at = int(np.hypot(line[:, 0] - place.at_mm[0], line[:, 1] - place.at_mm[1]).argmin())
    s, half, length = line[at, 2], line[at, 3], line[-1, 2]
    halves = np.array([half for _, half in stroke.half_width])
    off = f"tracking error up to {miss.largest_mm:.2g} mm"
    depth = _depth(brush, half)
    footprint = _length_of(brush, depth)
    if brush.width_follows_depth():
        least, greatest = brush.half_width_range_mm()
        finest = max(least, _finest_measured(brush))
        beside_mm2 = (half - greatest) * size_mm  # what a mark too narrow leaves in the square
        if (
            is_missing
            and half > greatest + SLIGHT
            and (where == "rim" or beside_mm2 > EXPLAINS * place.area_mm2)
        ):
            words = f"{2 * half:.3g} mm wide there, wider than the brush paints, {2 * greatest:.3g} mm"
            return Cause(words, code="wider-than-brush")
        if where == "bare":
            return Cause("no stroke reaches there", code="unreached")
        if where == "corner":
            return Cause("a corner of the shape, which round marks leave", code="shape-corner")
        if not is_missing and half < least - SLIGHT:
            words = (
                f"{2 * half:.3g} mm wide there, thinner than the finest line of the brush, {2 * least:.3g} mm"
            )
            return Cause(words, code="thinner-than-brush")
        if halves.max() < finest - SLIGHT:
            words = f"thinner than the finest line that was measured of the brush, {2 * finest:.3g} mm"
            return Cause(words, code="thinner-than-measured")
    else:
        own = brush.half_width(depth)
        widths = f"{2 * half:.3g} mm wide there, the one width of the brush is {2 * own:.3g} mm"
        if (half - own if is_missing else own - half) > SEEN * own:
            return Cause(widths, code="one-width")
    if compensation in ("none", "constant") and miss.largest_mm > max(tolerance_mm, GRAVE * half):
        how = (
            "the lag is not compensated"
            if compensation == "none"
            else "one lag does not fit all of the stroke"
        )
        return Cause(f"{how}: {off}", code="lag-not-compensated")
    if min(tolerance_mm, miss.largest_mm) > GRAVE * half:
        return Cause(f"the tolerance is {tolerance_mm:g} mm: {off}", code="coarse-tolerance")
    if length + 2 * half <= footprint:
        words = f"too short for the brush: a dab, whose footprint is {footprint:.2g} mm long"
        return Cause(words, code="shorter-than-footprint")
    turn_deg = _corner_deg(line, s, max(footprint, 2 * half), stroke.closed)
    if turn_deg > CORNER_DEG:
        return Cause(f"a corner of {turn_deg:.0f} degrees, sharper than the footprint", code="sharp-corner")
    if not stroke.closed and s < max(brush.tip_to_widest(depth), half):
        how = (
            "the footprint is pointed behind"
            if _is_pointed(brush, depth)
            else "the footprint's back, not a round cap"
        )
        return Cause(f"start of the stroke: {how}", code="stroke-start")
    if not stroke.closed and length - s < max(footprint, half):
        return Cause("end of the stroke: the footprint's front, not a round cap", code="stroke-end")
    lag_mm = brush.lag(depth)
    radius_mm = _radius(line, s, lag_mm)
    if radius_mm < lag_mm:
        words = f"turns tighter than the lag: radius {radius_mm:.2g} mm, lag {lag_mm:.2g} mm"
        return Cause(words, code="tighter-than-lag")
    if radius_mm < half:
        return Cause(
            f"turns tighter than half its width: radius {radius_mm:.2g} mm", code="tighter-than-width"
        )
    rise = np.gradient(line[:, 3], np.maximum.accumulate(line[:, 2] + 1e-9 * np.arange(len(line))))
    if abs(rise[at]) > STEEP:
        return Cause("its width changes faster than the footprint can follow", code="steep-width")
    if is_missing and compensation == "refined" and miss.largest_mm > tolerance_mm:
        return Cause(
            "refined: less paint here, and the rest of the outline fits better", code="traded-by-refinement"
        )
    if is_missing:  # what a footprint covers on a bend is never less than across its middle
        return Cause(off, code="off-middle-line")
    return Cause("the footprint is wider on bends than across its middle", code="wider-on-bends")


def _depth(brush, half_width_mm: float) -> float:
    if not brush.width_follows_depth():
        return brush.paint_depth_mm
    least, greatest = brush.half_width_range_mm()
    return brush.depth_for_half_width(float(np.clip(half_width_mm, least, greatest)), "")


def _length_of(brush, depth_mm: float) -> float:
    """Of the footprint, from its tip to its front."""
    return float(footprint_at(brush.footprints, depth_mm, 1.0)[:, 0].max())


def _is_pointed(brush, depth_mm: float) -> bool:
    outline = np.abs(footprint_at(brush.footprints, depth_mm, 1.0))
    widest, half = outline[outline[:, 1].argmax()]
    edge = outline[outline[:, 0] <= widest]
    edge = edge[edge[:, 0].argsort()]
    return bool(np.interp(0.1 * widest, edge[:, 0], edge[:, 1]) < POINTED * half)


def _finest_measured(brush) -> float:
    laws = (brush.lag, brush.tip_gap, brush.tip_to_widest, brush.half_width)
    return brush.half_width(max((law.calibrated_mm[0] for law in laws if law.calibrated_mm), default=0.0))


def _corner_deg(line: np.ndarray, s: float, reach_mm: float, closed: bool) -> float:
    """The sharpest corner near a place of the line; of a closed one, also that at its seam."""
    steps = np.diff(line[:, :2], axis=0)
    steps = steps[np.hypot(*steps.T) > 0]
    if len(steps) < 2:
        return 0.0
    turns, length = np.abs(_turns(steps)), line[-1, 2]
    at = np.unique(line[:, 2])[1:-1][: len(turns)]
    away = np.abs(at - s)
    near = turns[: len(at)][(np.minimum(away, length - away) if closed else away) <= reach_mm]
    if closed and min(s, length - s) <= reach_mm:
        near = np.append(near, np.abs(_turns(steps[[-1, 0]])))
    return float(np.degrees(near.max(initial=0.0)))


def _turns(steps: np.ndarray) -> np.ndarray:
    a, b = steps[:-1], steps[1:]
    return np.arctan2(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0], (a * b).sum(axis=1))


def _radius(line: np.ndarray, s: float, window_mm: float) -> float:
    """Of the line near a place, from how far it turns within a window."""
    length = line[-1, 2]
    window_mm = min(max(window_mm, 1.0), length)
    first = min(max(s - window_mm / 2, 0.0), length - window_mm)
    at = np.linspace(first, first + window_mm, 9)
    points = np.column_stack([np.interp(at, line[:, 2], line[:, k]) for k in (0, 1)])
    turned = abs(float(_turns(np.diff(points, axis=0)).sum()))
    return 0.875 * window_mm / turned if turned > 1e-9 else np.inf
