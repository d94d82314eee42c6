"""Why paint differs from what was drawn at a place: what the stroke asks for there that a brush cannot."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..._core import footprint_at

CORNER_DEG = 25.0  # a polyline of a smooth line turns by less from piece to piece
STEEP = 0.25  # mm of half width per mm: a footprint is about three times as long as half of its width
SLIGHT = 1e-6
SEEN = 0.05  # of the one width that a brush has: less is not what one sees first
GRAVE = 0.25  # of half the width: a middle that is so far off the line is what one sees first
EXPLAINS = 0.3  # of what is missing at a place: a width out of reach that leaves less is not why
POINTED = 0.3  # of its greatest width, a tenth of the way there from its tip: a disc has 0.44, a drop 0.1

LARGER = "use a finer brush, or scale the drawing up"
REMEDIES = {  # by code, where something helps
    "wider-than-brush": "use a wider brush, or --wide passes",
    "thinner-than-brush": "use a finer brush, or draw it wider",
    "thinner-than-measured": "draw it wider, or calibrate the brush with thinner lines",
    "one-width": "use another pen, or draw it as wide as this one",
    "unreached": LARGER,
    "shape-corner": LARGER,
    "lag-not-compensated": "leave out --compensation",
    "coarse-tolerance": "use a smaller --tolerance",
    "shorter-than-footprint": LARGER,
    "sharp-corner": LARGER,
    "stroke-start": "try another --start",
    "stroke-end": "try another --end",
    "tighter-than-lag": "try --compensation refined, or scale the drawing up",
    "tighter-than-width": "draw it thinner there, or bend it less",
    "steep-width": "let its width change more slowly",
    "off-middle-line": "use a smaller --tolerance",
    "wider-on-bends": "try --compensation refined",
}


OF_LINES = ("stroke-start", "stroke-end", "off-middle-line")  # in a shape nobody drew the strokes


def remedy(code: str, stroke) -> str:
    """What helps against a cause, "" where nothing does."""
    return LARGER if code in OF_LINES and stroke.wanted_mm else REMEDIES.get(code, "")


@dataclass(frozen=True)
class Cause:
    """In words, and as a code of docs/reference/diagnostics.md."""

    words: str
    code: str


def cause(
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

    stroke: as it was drawn; line: its middle, flattened, (n, 4) rows x, y, arc length, half width; place: of the
    stroke's verdict, size_mm: side of its square; where: "bare" where no stroke reaches, "rim" where one that is wider
    than the brush would, "corner" where discs of this one's widths do not, else ""; tracking_error: of the pass.
    """
    at = int(np.hypot(line[:, 0] - place.at_mm[0], line[:, 1] - place.at_mm[1]).argmin())
    here = _Here(stroke, line, brush, at, place.is_missing)
    off = f"tracking error up to {tracking_error.largest_mm:.2g} mm"
    return (
        (
            _of_width(here, place.area_mm2, size_mm, where)
            if brush.width_follows_depth()
            else _of_one_width(here)
        )
        or _of_compensation(here, tracking_error.largest_mm, tolerance_mm, compensation, off)
        or _of_length(here)
        or _of_way(here)
        or _of_rest(here, tracking_error.largest_mm > tolerance_mm, compensation, off)
    )


class _Here:
    """A place of a stroke's middle line: at, its row; s_mm, its arc length; half_mm, the half width there."""

    def __init__(self, stroke, line: np.ndarray, brush, at: int, is_missing: bool):
        self.stroke, self.line, self.brush, self.at, self.is_missing = stroke, line, brush, at, is_missing
        self.s_mm, self.half_mm, self.length_mm = line[at, 2], line[at, 3], line[-1, 2]
        self.depth_mm = _depth(brush, self.half_mm)
        self.footprint_mm = _length_of(brush, self.depth_mm)


def _of_width(here: _Here, area_mm2: float, size_mm: float, where: str) -> Cause | None:
    """What the brush is too wide or too narrow for, or no stroke reaches."""
    half, (least, greatest) = here.half_mm, here.brush.half_width_range_mm()
    finest = max(least, _finest_measured(here.brush))
    unpainted_mm2 = (half - greatest) * size_mm  # what a mark too narrow leaves in the square
    is_wide = here.is_missing and half > greatest + SLIGHT
    if is_wide and (where == "rim" or unpainted_mm2 > EXPLAINS * area_mm2):
        words = f"{2 * half:.3g} mm wide there, wider than the brush paints, {2 * greatest:.3g} mm"
        return Cause(words, code="wider-than-brush")
    if where == "bare":
        return Cause("no stroke reaches there", code="unreached")
    if where == "corner":
        return Cause("a corner of the shape, which round marks leave", code="shape-corner")
    if not here.is_missing and half < least - SLIGHT:
        words = f"{2 * half:.3g} mm wide there, thinner than the finest line of the brush, {2 * least:.3g} mm"
        return Cause(words, code="thinner-than-brush")
    if max(half for _, half in here.stroke.half_width) < finest - SLIGHT:
        words = f"thinner than the finest line that was measured of the brush, {2 * finest:.3g} mm"
        return Cause(words, code="thinner-than-measured")
    return None


def _of_one_width(here: _Here) -> Cause | None:
    own = here.brush.half_width(here.depth_mm)
    less = here.half_mm - own if here.is_missing else own - here.half_mm
    if less <= SEEN * own:
        return None
    words = f"{2 * here.half_mm:.3g} mm wide there, the one width of the brush is {2 * own:.3g} mm"
    return Cause(words, code="one-width")


def _of_compensation(
    here: _Here, off_mm: float, tolerance_mm: float, compensation: str, off: str
) -> Cause | None:
    """Return the cause if the chosen compensation or tolerance displaces the paint."""
    if compensation in ("none", "constant") and off_mm > max(tolerance_mm, GRAVE * here.half_mm):
        is_none = compensation == "none"
        how = "the lag is not compensated" if is_none else "one lag does not fit all of the stroke"
        return Cause(f"{how}: {off}", code="lag-not-compensated")
    if min(tolerance_mm, off_mm) > GRAVE * here.half_mm:
        return Cause(f"the tolerance is {tolerance_mm:g} mm: {off}", code="coarse-tolerance")
    return None


def _of_length(here: _Here) -> Cause | None:
    if here.length_mm + 2 * here.half_mm > here.footprint_mm:
        return None
    words = f"too short for the brush: a dab, whose footprint is {here.footprint_mm:.2g} mm long"
    return Cause(words, code="shorter-than-footprint")


def _of_way(here: _Here) -> Cause | None:
    """Corners, ends and bends that a footprint cannot follow."""
    line, brush, half, s_mm, is_open = here.line, here.brush, here.half_mm, here.s_mm, not here.stroke.closed
    turn_deg = _corner_deg(line, s_mm, max(here.footprint_mm, 2 * half), here.stroke.closed)
    if turn_deg > CORNER_DEG:
        return Cause(f"a corner of {turn_deg:.0f} degrees, sharper than the footprint", code="sharp-corner")
    if is_open and s_mm < max(brush.tip_to_widest(here.depth_mm), half):
        pointed = _is_pointed(brush, here.depth_mm)
        how = "the footprint is pointed behind" if pointed else "the footprint's back, not a round cap"
        return Cause(f"start of the stroke: {how}", code="stroke-start")
    if is_open and here.length_mm - s_mm < max(here.footprint_mm, half):
        return Cause("end of the stroke: the footprint's front, not a round cap", code="stroke-end")
    lag_mm = brush.lag(here.depth_mm)
    radius_mm = _radius(line, s_mm, lag_mm)
    if radius_mm < lag_mm:
        words = f"turns tighter than the lag: radius {radius_mm:.2g} mm, lag {lag_mm:.2g} mm"
        return Cause(words, code="tighter-than-lag")
    if radius_mm < half:
        words = f"turns tighter than half its width: radius {radius_mm:.2g} mm"
        return Cause(words, code="tighter-than-width")
    rise = np.gradient(line[:, 3], np.maximum.accumulate(line[:, 2] + 1e-9 * np.arange(len(line))))
    if abs(rise[here.at]) > STEEP:
        return Cause("its width changes faster than the footprint can follow", code="steep-width")
    return None


def _of_rest(here: _Here, is_off: bool, compensation: str, off: str) -> Cause:
    if here.is_missing and compensation == "refined" and is_off:
        words = "refined: less paint here, and the rest of the outline fits better"
        return Cause(words, code="traded-by-refinement")
    if here.is_missing:  # what a footprint covers on a bend is never less than across its middle
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
