"""Split a line of text into runs of one script and one direction.

The directions follow the Unicode bidirectional algorithm (UAX #9), without its explicit marks (X1 to X8).
"""

from __future__ import annotations

import unicodedata
from dataclasses import dataclass
from itertools import groupby, pairwise

_STRONG = ("L", "R", "AL")
_NOT_NEUTRAL = ("L", "R", "EN", "AN")
_REMOVED = ("BN", "LRE", "RLE", "LRO", "RLO", "PDF", "LRI", "RLI", "FSI", "PDI")
_COMMON_SCRIPTS = ("Zyyy", "Zinh", "Zzzz")  # digits, punctuation, accents, unassigned characters
_SEPARATORS = (("ES", "EN"), ("CS", "EN"), ("CS", "AN"))  # (separator, numbers that it may join)
LEFT_TO_RIGHT_MARK = "\u200e"
_MIRRORED = str.maketrans("()[]{}<>«»", ")(][}{><»«")
_MAX_OPEN_BRACKETS = 63  # UAX #9 (BD16) reads no brackets after this number
# How much higher the level of a character is than the level of its line, for lines from the left and from the right.
_LEVEL_STEPS = ({"L": 0, "R": 1, "EN": 2, "AN": 2}, {"L": 1, "R": 0, "EN": 1, "AN": 1})


@dataclass(frozen=True)
class TextRun:
    """Characters that are shaped together.

    start, end: the indices of the characters in their line.
    script: tag of ISO 15924, "Zyyy" if no character has a script.
    level: the level of UAX #9; runs with odd levels are written from right to left.
    """

    start: int
    end: int
    script: str
    level: int

    @property
    def is_right_to_left(self) -> bool:
        return self.level % 2 == 1


def starts_at_the_right(line: str) -> bool:
    """Whether the first character with a direction is written from right to left."""
    kinds = map(unicodedata.bidirectional, line)
    return next((kind for kind in kinds if kind in _STRONG), "L") != "L"


def split_runs(line: str) -> list[TextRun]:
    """Return the runs of a line, in the order of reading."""
    keys = list(zip(_find_scripts(line), _find_levels(line), strict=True))
    runs = []
    for (script, level), group in groupby(range(len(line)), key=keys.__getitem__):
        indices = list(group)
        runs.append(TextRun(indices[0], indices[-1] + 1, script, level))
    return runs


def sort_from_the_left(runs: list[TextRun]) -> list[TextRun]:
    """Return the runs of a line in their order on paper, from left to right (rule L2)."""
    ordered = list(runs)
    for level in range(max((run.level for run in runs), default=0), 0, -1):
        groups = groupby(ordered, key=lambda run: run.level >= level)
        ordered = [run for is_turned, group in groups for run in (reversed(list(group)) if is_turned else group)]
    return ordered


def sort_letters_from_the_left(line: str) -> str:
    """Return a line with its letters in their order on paper, for a library that does not know directions.

    The line itself runs from the left, as a text in SVG does. Brackets between letters from right to left are mirrored.
    Marks that separate directions are left out.
    """
    keys = _find_levels(f"{LEFT_TO_RIGHT_MARK}{line}")[1:]
    groups = (list(group) for _, group in groupby(range(len(line)), key=keys.__getitem__))
    runs = [TextRun(group[0], group[-1] + 1, "Zyyy", keys[group[0]]) for group in groups]
    parts = ((line[run.start : run.end], run.is_right_to_left) for run in sort_from_the_left(runs))
    ordered = "".join(part[::-1].translate(_MIRRORED) if is_turned else part for part, is_turned in parts)
    return ordered.replace(LEFT_TO_RIGHT_MARK, "")


def _find_scripts(line: str) -> list[str]:
    """Return each character's script, that of the character before it if it has none."""
    from fontTools.unicodedata import script as find_script_tag  # pictures need directions only

    tags = list(map(find_script_tag, line))
    current = next((tag for tag in tags if tag not in _COMMON_SCRIPTS), "Zyyy")
    scripts = []
    for tag in tags:
        current = current if tag in _COMMON_SCRIPTS else tag
        scripts.append(current)
    return scripts


def _find_levels(line: str) -> list[int]:
    """Return the level of each character."""
    base = int(starts_at_the_right(line))
    edge = "LR"[base]
    kinds = [unicodedata.bidirectional(character) or "L" for character in line]
    kept = [k for k, kind in enumerate(kinds) if kind not in _REMOVED]
    resolved = _resolve([line[k] for k in kept], [kinds[k] for k in kept], edge)
    levels = {k: base + _LEVEL_STEPS[base][kind] for k, kind in zip(kept, resolved, strict=True)}
    filled, current = [], base
    for k in range(len(line)):
        current = levels.get(k, current)
        filled.append(current)
    return filled


def _resolve(characters: list[str], kinds: list[str], edge: str) -> list[str]:
    """Return "L", "R", "EN" or "AN" by bidirectional class (W1 to W7, N0 to N2); edge: "L" or "R" of the line."""
    previous = strong = edge
    for k, kind in enumerate(kinds):
        kind = previous if kind == "NSM" else kind
        strong = kind if kind in _STRONG else strong
        previous = kinds[k] = "AN" if kind == "EN" and strong == "AL" else kind
    for k in range(1, len(kinds) - 1):
        if kinds[k - 1] == kinds[k + 1] and (kinds[k], kinds[k + 1]) in _SEPARATORS:
            kinds[k] = kinds[k + 1]
    for step in (1, -1):
        order = range(len(kinds))[::step]
        for before, k in pairwise(order):
            if kinds[k] == "ET" and kinds[before] == "EN":
                kinds[k] = "EN"
    strong = edge
    for k, kind in enumerate(kinds):
        kinds[k] = "R" if kind == "AL" else "L" if kind == "EN" and strong == "L" else kind
        strong = kinds[k] if kinds[k] in _STRONG else strong
    _resolve_brackets(characters, kinds, edge)
    for is_neutral, group in groupby(range(len(kinds)), key=lambda k: kinds[k] not in _NOT_NEUTRAL):
        if is_neutral:
            indices = list(group)
            outside = [kinds[k] if 0 <= k < len(kinds) else edge for k in (indices[0] - 1, indices[-1] + 1)]
            before, after = map(_find_side, outside)
            kinds[indices[0] : indices[-1] + 1] = [before if before == after else edge] * len(indices)
    return kinds


def _resolve_brackets(characters: list[str], kinds: list[str], edge: str) -> None:
    """Give both brackets of a pair one direction (rule N0).

    They have the direction of the line if a letter or number between them has it. Otherwise they have the other
    direction if it is that of the text between them and of the text before them.
    """
    for opening, closing in _find_bracket_pairs(characters, kinds):
        inside = {_find_side(kind) for kind in kinds[opening + 1 : closing] if kind in _NOT_NEUTRAL}
        if not inside:
            continue
        kinds_before = (kinds[k] for k in range(opening - 1, -1, -1))
        before = next((_find_side(kind) for kind in kinds_before if kind in _NOT_NEUTRAL), edge)
        kinds[opening] = kinds[closing] = edge if edge in inside else before


def _find_bracket_pairs(characters: list[str], kinds: list[str]) -> list[tuple[int, int]]:
    """Return the indices of the brackets of each pair, in the order of the opening brackets."""
    waiting: list[tuple[int, str]] = []  # index of an opening bracket, and the closing one
    pairs = []
    for k, (character, kind) in enumerate(zip(characters, kinds, strict=True)):
        if kind in _NOT_NEUTRAL or not unicodedata.mirrored(character):
            continue
        if unicodedata.category(character) == "Ps":
            if len(waiting) == _MAX_OPEN_BRACKETS:
                break
            following = (chr(ord(character) + step) for step in (1, 2))
            waiting.append((k, next((each for each in following if unicodedata.category(each) == "Pe"), "")))
        for depth in reversed(range(len(waiting))):
            if waiting[depth][1] == character:
                pairs.append((waiting[depth][0], k))
                del waiting[depth:]
                break
    return sorted(pairs)


def _find_side(kind: str) -> str:
    """Return the direction that a resolved letter or number has for the neutral characters next to it."""
    return "L" if kind == "L" else "R"
