"""Check that the whole page and its markers are in the picture."""

from __future__ import annotations

import numpy as np

from ..errors import Error
from .edges import StrokeBox
from .markers import View

MAX_UNSURE_MM = 0.5  # standard deviation of a place on the sheet


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
