"""Format the contents of an SVG: rings as path data, and text."""

from __future__ import annotations

from html import escape

import numpy as np


def path_data(ring: np.ndarray, height: float) -> str:
    points = np.round(np.column_stack([ring[:, 0], height - ring[:, 1]]), 3) + 0.0
    return ("M" + "L".join(["%.3f,%.3f"] * len(points)) + "Z") % tuple(points.ravel().tolist())


def printable(text: str) -> str:
    return "".join(letter if letter.isprintable() else " " for letter in text)


def quoted(text: str) -> str:
    return f'"{escape(printable(text))}"'
