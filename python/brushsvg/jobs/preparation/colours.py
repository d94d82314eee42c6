"""The colours of a job, the lightest first, and the part of a job that one colour paints."""

from __future__ import annotations

from ...errors import Error
from ..prepared_drawing import PreparedDrawing, select_passes


def list_colours(work: PreparedDrawing) -> list[str]:
    """Return the colours of the strokes as "#rrggbb" in lower case, the lightest first.

    Dark paint covers light paint, and rests of dark paint in the brush spoil light paint.
    """

    def lightness(colour: str) -> float:  # luma of ITU-R BT.601
        red, green, blue = (int(colour[k : k + 2], 16) for k in (1, 3, 5))
        return 0.299 * red + 0.587 * green + 0.114 * blue

    distinct = dict.fromkeys(each.colour.lower() for each in work.plan.passes if each.colour)
    return sorted(distinct, key=lightness, reverse=True)


def select_colour(work: PreparedDrawing, colour: str) -> PreparedDrawing:
    """Return the work with the strokes of one colour.

    Strokes without a colour are painted with the first colour. Error if no stroke has the colour.
    """
    all_colours = list_colours(work)
    if colour not in all_colours:
        known_colours = ", ".join(all_colours) or "none"
        sentence = f"nothing is painted in {colour}; colours of this drawing: {known_colours}"
        raise Error(sentence, "colour", code="nothing-to-paint")
    painted_colours = {"", colour} if colour == all_colours[0] else {colour}
    return select_passes(work, [k for k, each in enumerate(work.plan.passes) if each.colour.lower() in painted_colours])
