"""Strokes found in outlines, made such that a brush can paint them: wider or narrower than it, they are not."""

from __future__ import annotations

import numpy as np

from .. import _core
from ..errors import Error, need, need_one_of
from ..read.design import Notice
from .trial_mark import trial_overlap

WIDE = ("auto", "clamp", "passes", "refuse")
# Hardly wider than the brush, passes paint no more than the nearest width does: so much wider, they are tried.
_WORTH_PASSES = 1 / 0.95
POINT_MM = 1e-3  # half the width of a line where it ends in a point
UNSEEN_MM = 0.1  # of half a width out of reach: a mark's edge is further from the shape's


def within_reach(
    strokes: list[_core.Stroke], brush: _core.Brush, wide: str = "auto", is_searched: bool = True
) -> tuple[list[_core.Stroke], list[_core.Stroke], list[Notice]]:
    """Return what to paint, stroke by stroke, and what each should become: (strokes to paint, targets, notices).

    A line that was drawn narrower than the brush is painted at the brush's least width; one drawn wider is refused when
    the plan is made. Other widths are changed only where strokes carry an outline. A stroke whose shape is less than
    half of the smallest mark of the brush is left out: its mark would paint more outside of the shape than inside.
    wide: "clamp", the nearest width; "passes", passes along the outline, called id, id~2, id~3 ..., for each wider
    shape that they paint better than strokes at the nearest width do; "auto", the same for a brush, and the lines of a
    pen as they are; "refuse", Error naming stroke, width and range. is_searched: whether a search paints the sides
    that strokes at the nearest width leave. Error if nothing is left to paint.
    """
    need(brush, _core.Brush, "a brush")
    need_one_of(wide, WIDE, "what becomes of wide shapes")
    for stroke in strokes:
        need(stroke, _core.Stroke, "a stroke")
    if not brush.width_follows_depth() and wide != "passes":
        return strokes, strokes, []
    least, greatest = brush.half_width_range_mm()
    reach = f"[{2 * least:.3g}, {2 * greatest:.3g}] mm of brush {brush.name}"
    strokes, notices = _without_slivers(strokes, least, brush) if wide != "refuse" else (strokes, [])
    least = max(least, POINT_MM)
    beyond = {
        k: _beyond(stroke, least, greatest) if stroke.wanted_mm or brush.width_follows_depth() else None
        for k, stroke in enumerate(strokes)
    }
    if wide == "refuse":
        for stroke, (_, worst) in ((strokes[k], found) for k, found in beyond.items() if found):
            whose = "outline" if stroke.wanted_mm else "line"
            sentence = f"width {2 * worst:.3g} mm of its {whose} is outside the range {reach}"
            bounds = (2 * least, 2 * greatest)
            raise Error(sentence, stroke.id, 2 * worst, bounds, code="width-out-of-reach")
    filled = _filled(strokes, _wide(strokes, beyond, greatest), brush) if wide in ("auto", "passes") else {}
    painted, targets = [], []
    for k, stroke in enumerate(strokes):
        made, its_targets, how = filled.get(k) or ([stroke], [stroke], "")
        if beyond[k] and k not in filled:
            made, how = [_clamped(stroke, least, greatest)], "painted at the nearest width"
            if is_searched and wide != "clamp" and stroke.wanted_mm and beyond[k][1] > greatest:
                how += ", and its sides by strokes of their own"
        if beyond[k] and (k in filled or _shows(beyond[k][1], least, greatest)):
            what, worst = beyond[k]
            notices.append(
                Notice(
                    stroke.id,
                    f"{what} {2 * worst:.3g} mm wide, outside the range {reach}: {how}",
                    code="width-out-of-reach",
                    about="in passes" if k in filled else "wider" if worst > greatest else "narrower",
                    advice="--wide passes fills it" if wide == "clamp" and worst > greatest else "",
                )
            )
        painted += made
        targets += its_targets
    return painted, targets, notices


def _shows(half: float, least: float, greatest: float) -> bool:
    """Whether one sees that half a width was brought within the range."""
    return not least - UNSEEN_MM <= half <= greatest + UNSEEN_MM


def _without_slivers(strokes: list, least: float, brush) -> tuple[list, list[Notice]]:
    """The strokes but those of shapes that are less than half of the smallest mark of the brush."""
    dab_mm2 = np.pi * least**2
    areas = [_core.area(stroke.wanted_mm) if stroke.wanted_mm and dab_mm2 else np.inf for stroke in strokes]
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


def is_within_reach(half: float, greatest: float) -> bool:
    """Whether half the width of a line is at most the brush's greatest, or exceeds it by less than one sees."""
    return half <= greatest + UNSEEN_MM


def _beyond(stroke, least: float, greatest: float) -> tuple[str, float] | None:
    """What is out of reach, in words, and half the worst width; None for a line that was drawn visibly too wide, which
    is refused."""
    halves = np.array([half for _, half in stroke.half_width])
    is_narrow, is_wide = halves < least - 1e-9, halves > greatest + 1e-9
    off = is_narrow | is_wide
    if not off.any() or (not stroke.wanted_mm and not is_within_reach(halves.max(), greatest)):
        return None
    worst = halves.max() if is_wide.any() else halves.min()
    what = "its shape is" if stroke.wanted_mm else "its line is"
    if len(halves) > 1:
        what += " up to" if is_wide.any() else " down to"
    return what, worst


def _wide(strokes: list, beyond: dict, greatest: float) -> list[int]:
    """The strokes of shapes that are wider than the brush, of elements where one of them is so by more than hardly."""
    wider = {
        k: found[1] for k, found in beyond.items() if found and found[1] > greatest and strokes[k].wanted_mm
    }
    elements = {strokes[k].origin.element for k, half in wider.items() if half > greatest * _WORTH_PASSES}
    return [k for k in wider if strokes[k].origin.element in elements]


def _filled(strokes: list, wider: list[int], brush) -> dict[int, tuple]:
    """For each stroke of a shape that is filled in passes: these, what they should become, how in words."""
    if not wider:
        return {}
    from .fillings import fillings  # with shapely, which is slow to load

    done: dict[int, tuple] = {}
    for shape in fillings(strokes, wider, *brush.half_width_range_mm()):
        filling = _best(shape, strokes, brush)
        for k in shape.wide if filling else ():
            passes = [_like(strokes[k], line, lane) for lane, line in enumerate(filling, start=1)]
            how, filling = (
                "painted in passes side by side",
                [],
            )  # the first stroke of the shape has all of them
            if passes:
                its_targets = [
                    passes[0].replaced(wanted_mm=shape.first_share(passes[:1], passes)),
                    *passes[1:],
                ]
            else:
                its_targets, how = [], "painted in the passes of its shape's first stroke"
            done[k] = (passes, its_targets, how)
    return done


def _best(shape, strokes: list, brush) -> list:
    """The passes along an outline whose mark overlaps most with it; none where that of its strokes at the nearest
    width does, which have the direction of writing. A pen's edges are those of its outermost ring."""
    best, most = [], -1.0
    if brush.width_follows_depth():
        clamped_to_reach = [_clamped(strokes[k], *brush.half_width_range_mm()) for k in shape.wide]
        most = _mark_overlap([*shape.narrow, *clamped_to_reach], shape.rings, brush)
    for lines in shape.along:
        passes = [_like(strokes[shape.wide[0]], line) for line in lines]
        overlap = _mark_overlap([*passes, *shape.narrow], shape.rings, brush)
        if overlap > most:
            best, most = lines, overlap
    return best


def _mark_overlap(strokes: list, rings: list, brush) -> float:
    """How much the marks of strokes, compensated in closed form, overlap with a shape; 0 where they are refused."""
    try:
        return trial_overlap(strokes, rings, brush)
    except Error:
        return 0.0


def _like(stroke, line, lane: int = 1):
    of = stroke.origin
    return stroke.replaced(
        id=_core.StrokeId(of.element, of.part, of.repeat, lane),
        middle_mm=line.middle_mm,
        closed=line.closed,
        half_width=line.half_width,
        wanted_mm=[],
        start_covered=True,  # by other passes
        end_covered=True,
    )


def _clamped(stroke, least: float, greatest: float):
    """The stroke with its widths cut to the range, a knot where they leave it."""
    at, half = np.array(stroke.half_width).T
    knots = [(at[0], half[0])]
    for a0, h0, a1, h1 in zip(at[:-1], half[:-1], at[1:], half[1:], strict=True):
        cuts = [(bound - h0) / (h1 - h0) for bound in (least, greatest) if (h0 - bound) * (h1 - bound) < 0]
        knots += [(a0 + cut * (a1 - a0), h0 + cut * (h1 - h0)) for cut in sorted(cuts)]
        knots.append((a1, h1))
    return stroke.replaced(half_width=[(float(a), float(np.clip(h, least, greatest))) for a, h in knots])
