"""Order of strokes on a page: rows, letters or characters of a row, strokes of each (stroke_order)."""

from __future__ import annotations

import numpy as np

from .stroke_order import find_writing_order

SMALL_SHARE = 0.4  # dots and accents, and rows of them, are smaller than this share of their letters
STACKED_SHARE = 0.5  # areas that share more of their width are one letter
HIGHER_FIRST = (
    0.5  # weight of height against place in a row: an upper part comes before a lower one that begins left
)
MOST_PARTS, SQUARE_RATIO = 16, 1.5  # connected areas of a character, and its sides
CELL_SIDE = 1.25  # a character is at most so many row heights wide
HEADLINE_SLOPE, HEADLINE_TOP = 0.2, 0.5  # a headline is flatter, and higher in its word than this share


def order_strokes(
    boxes: np.ndarray, lines: list[list[np.ndarray]], script: str = "auto"
) -> list[tuple[int, int]]:
    """Return (area, stroke) in the order of writing.

    boxes: x0, y0, x1, y1 of each connected area, y up; lines: middle lines (k, 3) of its strokes, as they run.
    """
    order = []
    for group in group_areas(boxes, script):
        strokes = [(area, k) for area in group for k in range(len(lines[area]))]
        found = find_writing_order([lines[area][k] for area, k in strokes], script)
        if script == "devanagari":
            found = _headline_last(found, [lines[area][k] for area, k in strokes])
        order += [strokes[k] for k in found]
    return order


def group_areas(boxes: np.ndarray, script: str = "auto") -> list[list[int]]:
    """Return the areas of each letter or character, in reading order."""
    if script == "cjk" and _is_one_character(boxes):
        return [list(range(len(boxes)))]
    groups = []
    for row in _rows(boxes):
        if script == "arabic":
            groups += _bodies_and_dots(row, boxes)
        elif script == "cjk" or (script == "auto" and not stand_side_by_side(boxes[row])):
            groups += _cells(row, boxes)
        else:
            groups += _letters(row, boxes)
    return groups


def _is_one_character(boxes: np.ndarray) -> bool:
    """Return whether areas are as high as wide, more or less, and few enough: not a page of text."""
    if not 0 < len(boxes) <= MOST_PARTS:
        return False
    width, height = boxes[:, 2:].max(axis=0) - boxes[:, :2].min(axis=0)
    return bool(max(width, height) < SQUARE_RATIO * min(width, height))


def _rows(boxes: np.ndarray) -> list[list[int]]:
    """Return the areas of each row from the top; rows of dots and accents belong to the nearer row."""
    rows: list[list[int]] = []
    floor = np.inf
    for k in (-boxes[:, 3]).argsort(kind="stable").tolist():
        if boxes[k, 3] <= floor:
            rows.append([])
            floor = boxes[k, 1]
        rows[-1].append(k)
        floor = min(floor, boxes[k, 1])
    sizes = [(boxes[row, 2:] - boxes[row, :2]).max() for row in rows]
    bottoms = np.array([boxes[row, 1].min() for row in rows])
    tops = np.array([boxes[row, 3].max() for row in rows])
    gaps = np.concatenate([[np.inf], bottoms[:-1] - tops[1:], [np.inf]])  # above each row, and below the last
    merged: list[list[int]] = []
    joins = False
    for k, row in enumerate(rows):
        nearer = k - 1 if gaps[k] < gaps[k + 1] else min(k + 1, len(rows) - 1)
        is_low = sizes[k] < SMALL_SHARE * sizes[nearer]
        if joins or (is_low and nearer < k):
            merged[-1] += row
        else:
            merged.append(list(row))
        joins = bool(is_low and nearer > k)
    return merged


def stand_side_by_side(boxes: np.ndarray) -> bool:
    """Return whether areas stand side by side but for dots and accents: letters do, parts of characters rarely."""
    sizes = (boxes[:, 2:] - boxes[:, :2]).max(axis=1)
    large = boxes[sizes > SMALL_SHARE * sizes.max()]
    return len(_letters(list(range(len(large))), large)) == len(large)


def _letters(row: list[int], boxes: np.ndarray) -> list[list[int]]:
    """Return the areas of each letter: those above each other."""
    letters: list[list[int]] = []
    for k in sorted(row, key=lambda k: boxes[k, 0] - boxes[k, 2]):
        for letter in letters:
            low, high = boxes[letter, 0].min(), boxes[letter, 2].max()
            if min(high, boxes[k, 2]) - max(low, boxes[k, 0]) > STACKED_SHARE * (boxes[k, 2] - boxes[k, 0]):
                letter.append(k)
                break
        else:
            letters.append([k])

    def place(letter: list[int]) -> float:
        x0, y0 = boxes[letter, :2].min(axis=0)
        x1, y1 = boxes[letter, 2:].max(axis=0)
        return x0 + x1 - HIGHER_FIRST * (y0 + y1)

    return sorted(letters, key=place)


def _cells(row: list[int], boxes: np.ndarray) -> list[list[int]]:
    """Return the areas of each character of a row: gaps part them where both sides would be too wide for one."""
    side = CELL_SIDE * np.ptp(boxes[row][:, 1::2])
    cells: list[list[int]] = []
    for k in sorted(row, key=lambda k: boxes[k, 0]):
        left = boxes[cells[-1], 0].min() if cells else -np.inf
        overlaps = bool(cells) and boxes[k, 0] < boxes[cells[-1], 2].max()
        if overlaps or boxes[k, 2] - left < side:
            cells[-1].append(k)
        else:
            cells.append([k])
    return cells


def _bodies_and_dots(row: list[int], boxes: np.ndarray) -> list[list[int]]:
    """Return bodies, then dots, both from the right; each is a letter of its own."""
    sizes = (boxes[:, 2:] - boxes[:, :2]).max(axis=1)
    is_dot = sizes < SMALL_SHARE * sizes[row].max()
    return [[k] for k in sorted(row, key=lambda k: (is_dot[k], -boxes[k, 2]))]


def _headline_last(order: list[int], lines: list[np.ndarray]) -> list[int]:
    """Return the order with the headline of a word last: flat lines on the level of the longest flat one on top."""
    every = np.vstack(lines)
    middle = every[:, 1].min() + HEADLINE_TOP * np.ptp(every[:, 1])
    extents = np.array([np.ptp(line[:, :2], axis=0) for line in lines])
    levels = np.array([line[:, 1].mean() for line in lines])
    flat = (extents[:, 1] < HEADLINE_SLOPE * extents[:, 0]) & (levels > middle)
    if not flat.any():
        return order
    longest = int(np.argmax(np.where(flat, extents[:, 0], -1)))
    flat &= np.abs(levels - levels[longest]) < 2 * lines[longest][:, 2].max()
    return sorted(order, key=lambda k: bool(flat[k]))
