"""Strokes of outlines, changed so that a brush of another width can paint them."""

from __future__ import annotations

import numpy as np

from .. import _core
from ..errors import Error, need_one_of, need_truth, require_type
from ..read.design import Notice
from .trial_mark import trial_overlap

WIDE = ("auto", "clamp", "passes", "refuse")
# Passes are tried for shapes that are wider than the brush by this factor. In narrower ones they paint no more than
# strokes at the nearest width do.
_MIN_PASSES_RATIO = 1 / 0.95
MIN_HALF_WIDTH_MM = 1e-3  # least half width of a line: it ends in a point
# A difference of half widths that one does not see: a mark's edge is further from the shape's.
MAX_UNSEEN_MM = 0.1


def within_reach(
    strokes: list[_core.Stroke], brush: _core.Brush, wide: str = "auto", is_searched: bool = True
) -> tuple[list[_core.Stroke], list[_core.Stroke], list[Notice]]:
    """Return the strokes to paint, their targets and notices, stroke by stroke.

    A line that was drawn narrower than the brush is painted at the brush's least width. One that was drawn wider is
    refused when the plan is made. Other widths are changed only where strokes carry an outline. A stroke whose
    shape is less than half of the smallest mark of the brush is left out: its mark would paint more outside of the
    shape than inside.

    wide: "clamp" paints wide shapes at the nearest width. "passes" fills them with passes along the outline, called
    id, id~2, id~3 ..., if these paint the shape better than strokes at the nearest width do. "auto" does the same
    for a brush, and leaves the lines of a pen as they are. "refuse" raises an Error with stroke, width and range.
    is_searched: whether a search paints the sides that strokes at the nearest width leave. Raises Error if nothing
    is left to paint.
    """
    require_type(brush, _core.Brush, "a brush")
    need_one_of(wide, WIDE, "what becomes of wide shapes")
    need_truth(is_searched, "is_searched")
    for stroke in strokes:
        require_type(stroke, _core.Stroke, "a stroke")
    if not brush.width_follows_depth() and wide != "passes":
        return strokes, strokes, []
    least, greatest = brush.half_width_range_mm()
    reach = f"[{2 * least:.3g}, {2 * greatest:.3g}] mm of brush {brush.name}"
    strokes, notices = _without_slivers(strokes, least, brush) if wide != "refuse" else (strokes, [])
    least = max(least, MIN_HALF_WIDTH_MM)
    beyond = {
        k: _find_out_of_reach(stroke, least, greatest) if stroke.target_mm or brush.width_follows_depth() else None
        for k, stroke in enumerate(strokes)
    }
    if wide == "refuse":
        for stroke, (_, worst) in ((strokes[k], found) for k, found in beyond.items() if found):
            whose = "outline" if stroke.target_mm else "line"
            sentence = f"width {2 * worst:.3g} mm of its {whose} is outside the range {reach}"
            bounds = (2 * least, 2 * greatest)
            raise Error(sentence, stroke.id, 2 * worst, bounds, code="width-out-of-reach")
    filled = (
        _fill_in_passes(strokes, _find_wide_strokes(strokes, beyond, greatest), brush)
        if wide in ("auto", "passes")
        else {}
    )
    painted, targets = [], []
    for k, stroke in enumerate(strokes):
        passes, its_targets, how = filled.get(k) or ([stroke], [stroke], "")
        if beyond[k] and k not in filled:
            passes, how = [_clamp_widths(stroke, least, greatest)], "painted at the nearest width"
            if is_searched and wide != "clamp" and stroke.target_mm and beyond[k][1] > greatest:
                how += ", and its sides by strokes of their own"
        if beyond[k] and (k in filled or _is_visible_change(beyond[k][1], least, greatest)):
            what, worst = beyond[k]
            notices.append(
                Notice(
                    stroke.id,
                    f"{what} {2 * worst:.3g} mm wide, outside the range {reach}: {how}",
                    code="width-out-of-reach",
                    about="in passes" if k in filled else "wider" if worst > greatest else "narrower",
                    advice="--wide passes fills it" if wide == "clamp" and worst > greatest else "",
                    excess=2 * max(least - worst, worst - greatest),
                )
            )
        painted += passes
        targets += its_targets
    return painted, targets, notices


def _is_visible_change(half: float, least: float, greatest: float) -> bool:
    """Return whether it is visible that half a width was brought within the range."""
    return not least - MAX_UNSEEN_MM <= half <= greatest + MAX_UNSEEN_MM


def _without_slivers(strokes: list, least: float, brush) -> tuple[list, list[Notice]]:
    """Return strokes without shapes below half the smallest mark, and notices about these."""
    dab_mm2 = np.pi * least**2
    areas = [_core.area(stroke.target_mm) if stroke.target_mm and dab_mm2 else np.inf for stroke in strokes]
    notices = [
        Notice(
            stroke.id,
            f"its shape of {area:.2g} mm2 is less than half of the smallest mark of brush {brush.name}, "
            f"{dab_mm2:.2g} mm2: left out",
            code="width-out-of-reach",
            about="sliver",
        )
        for stroke, area in zip(strokes, areas, strict=True)
        if area < dab_mm2 / 2
    ]
    if notices and len(notices) == len(strokes):
        first = notices[0]
        sentence = f"there is nothing to paint: {first.sentence}; draw it larger, or take a finer brush"
        raise Error(sentence, where=first.where, code="nothing-to-paint")
    return [stroke for stroke, area in zip(strokes, areas, strict=True) if area >= dab_mm2 / 2], notices


def find_wide_lines(lines: list, brush) -> list[tuple[_core.Stroke, float]]:
    """Return the lines that are visibly wider than the brush, and half the greatest width of each."""
    if not brush.width_follows_depth():
        return []
    greatest = brush.half_width_range_mm()[1]
    widest = [(line, max(half for _, half in line.half_width)) for line in lines]
    return [(line, half) for line, half in widest if not _is_within_reach(half, greatest)]


def _is_within_reach(half: float, greatest: float) -> bool:
    """Return whether half a line's width is at most the brush's greatest, or unnoticeably more."""
    return half <= greatest + MAX_UNSEEN_MM


def _find_out_of_reach(stroke, least: float, greatest: float) -> tuple[str, float] | None:
    """Return in words what is out of reach, and half the worst width.

    Returns None if nothing is. Also returns None for a line that was drawn visibly too wide, which is refused
    later.
    """
    halves = np.array([half for _, half in stroke.half_width])
    is_narrow, is_wide = halves < least - 1e-9, halves > greatest + 1e-9
    off = is_narrow | is_wide
    if not off.any() or (not stroke.target_mm and not _is_within_reach(halves.max(), greatest)):
        return None
    worst = halves.max() if is_wide.any() else halves.min()
    what = "its shape is" if stroke.target_mm else "its line is"
    if len(halves) > 1:
        what += " up to" if is_wide.any() else " down to"
    return what, worst


def _find_wide_strokes(strokes: list, beyond: dict, greatest: float) -> list[int]:
    """Return strokes of shapes with a stroke wider than the brush by _MIN_PASSES_RATIO."""
    wider = {
        k: out_of_reach[1]
        for k, out_of_reach in beyond.items()
        if out_of_reach and out_of_reach[1] > greatest and strokes[k].target_mm
    }
    elements = {strokes[k].origin.element for k, half in wider.items() if half > greatest * _MIN_PASSES_RATIO}
    return [k for k in wider if strokes[k].origin.element in elements]


def _fill_in_passes(strokes: list, wider: list[int], brush) -> dict[int, tuple]:
    """Return (passes, targets, how they are painted, in words) of each stroke filled in passes."""
    if not wider:
        return {}
    from .fillings import find_wide_shapes  # with shapely, which is slow to load

    done: dict[int, tuple] = {}
    for shape in find_wide_shapes(strokes, wider, *brush.half_width_range_mm()):
        filling = _choose_passes(shape, strokes, brush)
        for k in shape.wide if filling else ():
            passes = [_make_pass(strokes[k], line, lane) for lane, line in enumerate(filling, start=1)]
            how, filling = ("painted in passes side by side", [])  # the first stroke of the shape has all passes
            if passes:
                its_targets = [
                    passes[0].replaced(target_mm=shape.first_share(passes[:1], passes)),
                    *passes[1:],
                ]
            else:
                its_targets, how = [], "painted in the passes of its shape's first stroke"
            done[k] = (passes, its_targets, how)
    return done


def _choose_passes(shape, strokes: list, brush) -> list:
    """Return the passes along an outline whose mark overlaps most with the shape.

    None are returned where the mark of its strokes at the nearest width overlaps more: these have the direction of
    writing. A pen's edges are those of its outermost ring.
    """
    best, most = [], -1.0
    if brush.width_follows_depth():
        clamped_to_reach = [_clamp_widths(strokes[k], *brush.half_width_range_mm()) for k in shape.wide]
        most = _mark_overlap([*shape.narrow, *clamped_to_reach], shape.rings, brush)
    for lines in shape.along:
        passes = [_make_pass(strokes[shape.wide[0]], line) for line in lines]
        overlap = _mark_overlap([*passes, *shape.narrow], shape.rings, brush)
        if overlap > most:
            best, most = lines, overlap
    return best


def _mark_overlap(strokes: list, rings: list, brush) -> float:
    """Return how much closed-form marks of strokes overlap a shape, 0 where they are refused."""
    try:
        return trial_overlap(strokes, rings, brush)
    except Error:
        return 0.0


def _make_pass(stroke, line, lane: int = 1):
    origin = stroke.origin
    return stroke.replaced(
        id=_core.StrokeId(origin.element, origin.part, origin.repeat, lane),
        middle_mm=line.middle_mm,
        closed=line.closed,
        half_width=line.half_width,
        target_mm=[],
        start_covered=True,  # by other passes
        end_covered=True,
    )


def _clamp_widths(stroke, least: float, greatest: float):
    """Return the stroke with its widths cut to the range, a knot where they leave it."""
    at, half = np.array(stroke.half_width).T
    knots = [(at[0], half[0])]
    for a0, h0, a1, h1 in zip(at[:-1], half[:-1], at[1:], half[1:], strict=True):
        cuts = [(bound - h0) / (h1 - h0) for bound in (least, greatest) if (h0 - bound) * (h1 - bound) < 0]
        knots += [(a0 + cut * (a1 - a0), h0 + cut * (h1 - h0)) for cut in sorted(cuts)]
        knots.append((a1, h1))
    return stroke.replaced(half_width=[(float(a), float(np.clip(h, least, greatest))) for a, h in knots])
