"""Strokes found in outlines, made such that a brush can paint them: wider or narrower than it, they are not."""

from __future__ import annotations

import numpy as np

from .. import _core
from ..drawing.design import Notice
from ..errors import Error, need, need_one_of
from .offset_passes import clamped
from .trial_mark import trial_overlap

WIDE = ("auto", "clamp", "passes", "refuse")
# At the nearest width the mark overlaps with a shape by so much, or passes are taken for it.
ENOUGH = 0.8
BETTER = 0.01  # and passes by so much more
# Or they are where all wide shapes of the drawing together gain so much of overlap. At 0.06 letters look alike both
# ways, and passes take twice the poses; at 0.12 stems are a fifth too thin.
CLEARLY = 0.1
# Hardly wider than the brush, passes paint no more than the nearest width does: so much wider, they are tried.
_WORTH_PASSES = 1 / 0.95
_ALIKE = 0.003  # of overlap: less is not worth the direction of writing, or more passes
POINT_MM = 1e-3  # half the width of a line where it ends in a point
UNSEEN_MM = 0.1  # of half a width out of reach: a mark's edge lies beside the shape's by more


def within_reach(
    strokes: list[_core.Stroke], brush: _core.Brush, wide: str = "auto"
) -> tuple[list[_core.Stroke], list[_core.Stroke], list[Notice]]:
    """What to paint, stroke by stroke, and what each should become: (strokes to paint, strokes wanted, notices).

    A line that was drawn narrower than the brush is painted at the brush's least width; one drawn wider is refused when
    the plan is made. Other widths are changed only where strokes carry an outline. A stroke whose shape is less than
    half of the smallest mark of the brush is left out: its mark would paint more outside of the shape than inside.
    wide: "clamp", the nearest width; "passes", several passes, called id, id~2, id~3 ..., which fill the shape that is
    wider than the brush and stay in it; "auto", passes for all wider shapes that they paint better, if at the nearest
    widths the mark of one of them overlaps with it by less than 0.8, or marks of all of them by 0.1 less than passes;
    "refuse", Error naming stroke, width and range. Error if nothing is left to paint.
    """
    need(brush, _core.Brush, "a brush")
    need_one_of(wide, ("auto", "clamp", "passes", "refuse"), "what becomes of wide shapes")
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
    filled, fillable = _filled(strokes, _wide(strokes, beyond, greatest), brush, wide)
    painted, wanted = [], []
    for k, stroke in enumerate(strokes):
        made, meant, how = filled.get(k) or ([stroke], [stroke], "")
        if beyond[k] and k not in filled:
            made, how = [_clamped(stroke, least, greatest)], "painted at the nearest width"
        if beyond[k] and (k in filled or _shows(beyond[k][1], least, greatest)):
            what, worst = beyond[k]
            notices.append(
                Notice(
                    stroke.id,
                    f"{what} {2 * worst:.3g} mm wide, outside the range {reach}: {how}",
                    code="width-out-of-reach",
                    about="in passes" if k in filled else "wider" if worst > greatest else "narrower",
                    advice="--wide passes paints more of it" if k in fillable else "",
                )
            )
        painted += made
        wanted += meant
    return painted, wanted, notices


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


def _filled(strokes: list, wider: list[int], brush, wide: str) -> tuple[dict[int, tuple], set[int]]:
    """For each stroke to paint in passes (these, what they should become, how in words); and the strokes of which
    passes would paint more, if they were asked for."""
    if not wider:
        return {}, set()
    from .fillings import fillings  # with shapely, which is slow to load

    done: dict[int, tuple] = {}
    found = fillings(strokes, wider, *brush.half_width_range_mm())
    best = [_best(ways, strokes, brush) for ways in found]
    chosen, fillable = ({}, set()) if wide == "passes" else _chosen(best, strokes, brush, wide)
    for number, (filling, _) in enumerate(best):
        if wide != "passes" and number not in chosen:
            continue
        for k in filling.passes:
            passes = [_like(strokes[k], line, lane) for lane, line in enumerate(filling.passes[k], start=1)]
            meant = []
            if passes:
                line, rings = filling.meant[k]
                meant = [_like(strokes[k], line), *passes[1:]]
                meant[0].wanted_mm = rings
            done[k] = (passes, meant, _how(passes) + chosen.get(number, ""))
    return done, fillable


def _best(ways: list, strokes: list, brush) -> tuple:
    """Of the ways to fill a shape the one whose mark overlaps with it most, and how much: passes beside its middle
    lines, which have the direction of writing, unless others are fewer or plainly better."""
    beside, *along = [(each, _filled_overlap(each, strokes, brush)) for each in ways]
    if not along:
        return beside
    best = max(along, key=lambda each: each[1])
    if not brush.width_follows_depth():
        return best  # a pen's edges are those of its outermost ring
    worth = _ALIKE if best[0].count > beside[0].count else -_ALIKE if best[0].count < beside[0].count else 0
    return best if best[1] > beside[1] + worth else beside


def _filled_overlap(filling, strokes: list, brush) -> float:
    passes = [_like(strokes[k], line) for k, lines in filling.passes.items() for line in lines]
    return _mark_overlap([*passes, *filling.narrow], filling.rings, brush)


def _chosen(best: list[tuple], strokes: list, brush, wide: str) -> tuple[dict[int, str], set[int]]:
    """The fillings that are taken where nobody says which, by their numbers, and why in words: all that paint better,
    if one of their shapes would be painted too badly without, or all of them clearly worse, for the stems of a word
    are of one weight. And of the others, the strokes of shapes that passes paint better; none where all of them
    together hardly win by it."""
    found, filled = zip(*best, strict=True)
    nearest = [_at_nearest(filling, strokes, brush) for filling in found]
    better = [k for k in range(len(found)) if filled[k] > nearest[k] + BETTER]
    areas = [_core.area(each.rings) for each in found]

    def gained(some: list[int]) -> float:
        won = sum(areas[k] * (filled[k] - nearest[k]) for k in some)
        return won / sum(areas[k] for k in some) if some else 0.0

    taken: dict[int, str] = {}
    if wide == "auto":
        words = ", since at the nearest width its mark would overlap with the shape by {:.2f}"
        bad = [k for k in better if nearest[k] < ENOUGH]
        if bad or gained(list(range(len(found)))) >= CLEARLY:
            others = ", as others of the drawing" if bad else words + ", in passes by {:.2f}"
            taken = {k: (words if k in bad else others).format(nearest[k], filled[k]) for k in better}
    left = [k for k in range(len(found)) if k not in taken]
    if gained(left) <= BETTER:
        return taken, set()
    return taken, {stroke for k in better if k in left for stroke in found[k].passes}


def _at_nearest(filling, strokes: list, brush) -> float:
    """How much the mark overlaps with a shape, its strokes painted at the nearest width."""
    clamped = [_clamped(strokes[k], *brush.half_width_range_mm()) for k in filling.passes]
    return _mark_overlap([*filling.narrow, *clamped], filling.rings, brush)


def _mark_overlap(strokes: list, rings: list, brush) -> float:
    """How much the marks of strokes, compensated in closed form, overlap with a shape; 0 where they are refused."""
    try:
        return trial_overlap(strokes, rings, brush)
    except Error:
        return 0.0


def _how(passes: list) -> str:
    if not passes:
        return "painted in the passes of its shape's first stroke"
    return "painted in passes side by side"


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
    """The stroke with its widths cut to the range."""
    return stroke.replaced(half_width=clamped(stroke, least, greatest).half_width)
