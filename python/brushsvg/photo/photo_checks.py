"""Refuse photographs that cannot be read: cropped, unsure, covered, or painted at other places."""

from __future__ import annotations

import numpy as np

from ..errors import Error
from .flatten import Flat
from .markers import View
from .stroke_boxes import MIN_SPLIT_MM2, MIN_SPLIT_SHARE, StrokeBox, box_pixels

MAX_UNSURE_MM = 0.5  # standard deviation of a place on the sheet
# Strokes that one piece of paint may cover. With more, it is a shadow or an object on the page.
MAX_JOINED_STROKES = 2
MAX_TOUCHING_SHARE = 0.25  # of the strokes: if more touch, this is not one painting of this chart
# Of the paint: if the strokes' boxes hold this much more of it when turned, the page was turned by 180 degrees.
MIN_TURNED_EXCESS = 0.1
MIN_SHARE_IN_BOXES = 0.7  # smallest share of the paint inside the strokes' boxes


def refuse_cropped(pixels: np.ndarray, view: View, stroke_boxes: list[StrokeBox]) -> None:
    """Refuse a picture that cuts off the box of a stroke."""
    cropped = []
    for stroke_box in stroke_boxes:
        left, bottom, right, top = stroke_box.box_mm
        corners = view.to_px(np.array([(left, bottom), (right, bottom), (right, top), (left, top)]))
        if (corners < 0).any() or (corners > np.array(pixels.shape[1::-1]) - 1).any():
            cropped.append(stroke_box.stroke)
    if cropped:
        raise Error(
            f"the page is cropped: {len(cropped)} stroke{'s' * (len(cropped) > 1)} extend{'s' * (len(cropped) == 1)} "
            f"beyond the picture ({', '.join(cropped[:4])}{', ...' * (len(cropped) > 4)}): photograph the whole page",
            value=len(cropped),
            code="photo-cropped",
        )


def refuse_unsure(pixels: np.ndarray, view: View, corners_mm: dict[int, np.ndarray]) -> None:
    """Refuse markers that do not determine the whole sheet.

    corners_mm: corners of all markers by their number.
    """
    if view.unsure_mm <= MAX_UNSURE_MM:
        return
    unseen = np.vstack([corners for number, corners in corners_mm.items() if number not in view.seen])
    px = view.to_px(unseen)
    beyond = bool((px < 0).any() or (px > np.array(pixels.shape[1::-1]) - 1).any())
    raise Error(
        f"only {len(view.seen)} markers can be seen ({', '.join(map(str, view.seen))}), "
        + ("others are outside the picture" if beyond else "others are covered")
        + f", so places on the sheet are uncertain by {view.unsure_mm:.2f} mm, more than {MAX_UNSURE_MM:g} mm: "
        "photograph the whole page, with nothing over its markers",
        value=view.unsure_mm,
        code="photo-cropped" if beyond else "photo-markers-missing",
    )


def refuse_displaced(areas_in_boxes, reaching: np.ndarray, stroke_boxes: list[StrokeBox]) -> None:
    """Refuse a sheet with too many marks that touch or are displaced; reaching: parts in several boxes."""
    touching = np.unique(np.argsort(areas_in_boxes[reaching, 1:], axis=1)[:, -2:])
    if len(touching) > MAX_TOUCHING_SHARE * len(stroke_boxes):
        raise Error(
            f"{len(touching)} of {len(stroke_boxes)} marks touch each other or reach the place of another mark, at "
            f"most {int(MAX_TOUCHING_SHARE * len(stroke_boxes))} may. Check that this chart was painted on this page, "
            "and only once, that the page was at its stop, that it was printed at 100 % (measure its bar), and that "
            "the chart is for a brush of this width",
            value=len(touching),
            code="photo-paint-elsewhere",
        )


def refuse_covered(areas_in_boxes, areas, several, stroke_boxes: list[StrokeBox], px_per_mm: float) -> None:
    """Refuse a shadow or object that covers many strokes' boxes; several: parts in several boxes."""
    widest = max(
        (stroke_box.box_mm[2] - stroke_box.box_mm[0]) * (stroke_box.box_mm[3] - stroke_box.box_mm[1])
        for stroke_box in stroke_boxes
    )
    for number in np.flatnonzero(several):
        large = np.flatnonzero(
            areas_in_boxes[number, 1:] > np.maximum(0.5 * MIN_SPLIT_SHARE * areas[number], MIN_SPLIT_MM2 * px_per_mm**2)
        )
        if len(large) > MAX_JOINED_STROKES and areas[number] > widest * px_per_mm**2:
            names = ", ".join(stroke_boxes[k].stroke for k in large)
            raise Error(
                f"a dark area of {areas[number] / px_per_mm**2 / 100:.0f} cm^2 covers the places of {len(large)} "
                f"strokes ({names}). It is a shadow, an object on the page, or smeared paint: remove it, and "
                "photograph the page in even light",
                value=len(large),
                code="photo-covered",
            )


def refuse_elsewhere(painted: np.ndarray, flat: Flat, stroke_boxes: list[StrokeBox]) -> None:
    """Refuse paint outside the strokes' boxes; painted: (rows, columns), pixels that count as paint."""
    is_in_box = np.zeros(painted.shape, bool)
    for stroke_box in stroke_boxes:
        c0, r0, c1, r1 = box_pixels(flat, stroke_box.box_mm, 0.5)
        is_in_box[r0:r1, c0:c1] = True
    total = max(int(painted.sum()), 1)
    inside_share, turned_share = ((painted & mask).sum() / total for mask in (is_in_box, is_in_box[::-1, ::-1]))
    if turned_share > inside_share + MIN_TURNED_EXCESS:
        raise Error(
            f"the page was painted upside down: {100 * turned_share:.0f} % of the paint is at the places of strokes "
            f"on a page turned by 180 degrees, and only {100 * inside_share:.0f} % on this page. Turn the page before "
            "you paint it",
            value=turned_share,
            code="photo-paint-elsewhere",
        )
    if inside_share < MIN_SHARE_IN_BOXES:
        raise Error(
            f"only {100 * inside_share:.0f} % of the paint is where strokes of this chart should be, at least "
            f"{100 * MIN_SHARE_IN_BOXES:.0f} % are needed. Check that this chart was painted on this page, and only "
            "once, that the page was at its stop, and that it was printed at 100 % (measure its bar)",
            value=inside_share,
            code="photo-paint-elsewhere",
        )
