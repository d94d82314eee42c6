"""Order of strokes on a page: rows, then letters or characters, then strokes."""

from __future__ import annotations

import numpy as np

from .stroke_order import find_writing_order

# Dots and accents are smaller than this share of their letters, and so are rows of them.
MAX_DOT_SHARE = 0.4
MAX_ACCENT_HEIGHT = 0.5  # accents are lower than this share of their letter, and nearer to it
MIN_STACKED_SHARE = 0.5  # areas that share more of their width are one letter
# Weight of the height against the place in a row: an upper part comes before a lower one that begins on the left.
HEIGHT_WEIGHT = 0.5
# Greatest number of connected areas of a character, and greatest ratio of its sides.
MAX_PARTS, MAX_SIDE_RATIO = 16, 1.5
MAX_CELL_WIDTH = 1.25  # greatest width of a character, in row heights
# Greatest slope of a headline, and its least height as a share of its word's height.
MAX_HEADLINE_SLOPE, MIN_HEADLINE_HEIGHT = 0.2, 0.5


def order_strokes(boxes: np.ndarray, lines: list[list[np.ndarray]], script: str = "auto") -> list[tuple[int, int]]:
    """Return (area, stroke) in the order of writing.

    boxes: x0, y0, x1, y1 of each connected area, y up; lines: middle lines (k, 3) of its strokes, as they run.
    """
    order = []
    for group in group_areas(boxes, script):
        strokes = [(area, k) for area in group for k in range(len(lines[area]))]
        writing_order = find_writing_order([lines[area][k] for area, k in strokes], script)
        if script == "devanagari":
            writing_order = _move_headline_last(writing_order, [lines[area][k] for area, k in strokes])
        order += [strokes[k] for k in writing_order]
    return order


def group_areas(boxes: np.ndarray, script: str = "auto") -> list[list[int]]:
    """Return the areas of each letter or character, in reading order.

    The accents of a Latin letter are a group of their own.
    """
    if script == "cjk" and _is_one_character(boxes):
        return [list(range(len(boxes)))]
    groups = []
    for row in _group_rows(boxes):
        if script == "arabic":
            groups += _group_bodies_and_dots(row, boxes)
        elif script == "cjk" or (script == "auto" and not stand_side_by_side(boxes[row])):
            groups += _group_cells(row, boxes)
        else:
            for letter in _group_letters(row, boxes):
                groups += _split_off_accents(letter, boxes) if script == "latin" else [letter]
    return groups


def _is_one_character(boxes: np.ndarray) -> bool:
    """Return whether areas are one character: few, and as high as wide, unlike a page of text."""
    if not 0 < len(boxes) <= MAX_PARTS:
        return False
    width, height = boxes[:, 2:].max(axis=0) - boxes[:, :2].min(axis=0)
    return bool(max(width, height) < MAX_SIDE_RATIO * min(width, height))


def _group_rows(boxes: np.ndarray) -> list[list[int]]:
    """Return the areas of each row from the top.

    Rows of dots and accents belong to the nearer row, also where they are above each other.
    """
    rows: list[list[int]] = []
    floor = np.inf
    for k in (-boxes[:, 3]).argsort(kind="stable").tolist():
        if boxes[k, 3] <= floor:
            rows.append([])
            floor = boxes[k, 1]
        rows[-1].append(k)
        floor = min(floor, boxes[k, 1])
    while len(merged := _merge_low_rows(rows, boxes)) < len(rows):
        rows = merged
    return rows


def _merge_low_rows(rows: list[list[int]], boxes: np.ndarray) -> list[list[int]]:
    """Merge rows of dots and accents with the nearer row, repeatedly where dots are above each other."""
    sides = [(boxes[row, 2:] - boxes[row, :2]).max(axis=0) for row in rows]  # of the widest and the highest area
    bottoms = np.array([boxes[row, 1].min() for row in rows])
    tops = np.array([boxes[row, 3].max() for row in rows])
    # The gap above each row, and below the last.
    gaps = np.concatenate([[np.inf], bottoms[:-1] - tops[1:], [np.inf]])
    merged: list[list[int]] = []
    joins = False
    for k, row in enumerate(rows):
        nearer = k - 1 if gaps[k] < gaps[k + 1] else min(k + 1, len(rows) - 1)
        accent_mm = MAX_ACCENT_HEIGHT * sides[nearer][1]
        is_narrow = sides[k][0] <= sides[nearer][0]  # unlike a line over a whole word
        is_accent = nearer > k and is_narrow and sides[k][1] < accent_mm and gaps[k + 1] < accent_mm
        is_small = sides[k].max() < MAX_DOT_SHARE * sides[nearer].max() and sides[k][1] < sides[nearer][1]
        is_low = is_accent or is_small
        if joins or (is_low and nearer < k):
            merged[-1] += row
        else:
            merged.append(list(row))
        joins = bool(is_low and nearer > k)
    return merged


def stand_side_by_side(boxes: np.ndarray) -> bool:
    """Return whether areas stand side by side, apart from dots and accents.

    Letters do, parts of characters rarely do.
    """
    sizes = (boxes[:, 2:] - boxes[:, :2]).max(axis=1)
    large = boxes[sizes > MAX_DOT_SHARE * sizes.max()]
    return len(_group_letters(list(range(len(large))), large)) == len(large)


def _group_letters(row: list[int], boxes: np.ndarray) -> list[list[int]]:
    """Return the areas of each letter: areas above each other."""
    letters: list[list[int]] = []
    for k in sorted(row, key=lambda k: boxes[k, 0] - boxes[k, 2]):
        for letter in letters:
            low, high = boxes[letter, 0].min(), boxes[letter, 2].max()
            if min(high, boxes[k, 2]) - max(low, boxes[k, 0]) > MIN_STACKED_SHARE * (boxes[k, 2] - boxes[k, 0]):
                letter.append(k)
                break
        else:
            letters.append([k])

    def place(letter: list[int]) -> float:
        x0, y0 = boxes[letter, :2].min(axis=0)
        x1, y1 = boxes[letter, 2:].max(axis=0)
        return x0 + x1 - HEIGHT_WEIGHT * (y0 + y1)

    return sorted(letters, key=place)


def _split_off_accents(letter: list[int], boxes: np.ndarray) -> list[list[int]]:
    """Return the areas of a letter without its dots and accents, and these: they are written after it.

    A dot or accent is much lower than an area that is above or below it.
    """
    heights = boxes[:, 3] - boxes[:, 1]

    def is_accent(k: int) -> bool:
        apart = [j for j in letter if boxes[j, 3] <= boxes[k, 1] or boxes[k, 3] <= boxes[j, 1]]
        return any(heights[k] < MAX_ACCENT_HEIGHT * heights[j] for j in apart)

    accents = [k for k in letter if is_accent(k)]
    bodies = [k for k in letter if k not in accents]
    return [bodies, accents] if accents else [bodies]


def _group_cells(row: list[int], boxes: np.ndarray) -> list[list[int]]:
    """Return the areas of each character of a row.

    Gaps part characters where both sides together would be too wide for one.
    """
    side = MAX_CELL_WIDTH * np.ptp(boxes[row][:, 1::2])
    cells: list[list[int]] = []
    for k in sorted(row, key=lambda k: boxes[k, 0]):
        left = boxes[cells[-1], 0].min() if cells else -np.inf
        overlaps = bool(cells) and boxes[k, 0] < boxes[cells[-1], 2].max()
        if overlaps or boxes[k, 2] - left < side:
            cells[-1].append(k)
        else:
            cells.append([k])
    return cells


def _group_bodies_and_dots(row: list[int], boxes: np.ndarray) -> list[list[int]]:
    """Return bodies, then dots, both from the right; each is a letter of its own.

    Dots are small and above or below a body, or a letter that is small next to a wide one. A letter of this kind is
    no dot.
    """
    sizes = (boxes[:, 2:] - boxes[:, :2]).max(axis=1)
    max_dot = MAX_DOT_SHARE * sizes[row].max()

    def is_dot(k: int) -> bool:
        letters = [j for j in row if sizes[j] >= max_dot or sizes[k] < MAX_DOT_SHARE * sizes[j]]
        return sizes[k] < max_dot and _is_stacked(boxes[k], boxes[letters])

    return [[k] for k in sorted(row, key=lambda k: (is_dot(k), -boxes[k, 2]))]


def _is_stacked(box: np.ndarray, others: np.ndarray) -> bool:
    """Return whether an area is above or below one of the others."""
    shared = np.minimum(box[2], others[:, 2]) - np.maximum(box[0], others[:, 0])
    narrower = np.minimum(box[2] - box[0], others[:, 2] - others[:, 0])
    return bool((shared > MIN_STACKED_SHARE * narrower).any())


def _move_headline_last(order: list[int], lines: list[np.ndarray]) -> list[int]:
    """Return the order with a word's headline, the flat lines level with the longest one on top, last."""
    points = np.vstack(lines)
    middle = points[:, 1].min() + MIN_HEADLINE_HEIGHT * np.ptp(points[:, 1])
    extents = np.array([np.ptp(line[:, :2], axis=0) for line in lines])
    levels = np.array([line[:, 1].mean() for line in lines])
    flat = (extents[:, 1] < MAX_HEADLINE_SLOPE * extents[:, 0]) & (levels > middle)
    if not flat.any():
        return order
    longest = int(np.argmax(np.where(flat, extents[:, 0], -1)))
    flat &= np.abs(levels - levels[longest]) < 2 * lines[longest][:, 2].max()
    return sorted(order, key=lambda k: bool(flat[k]))
