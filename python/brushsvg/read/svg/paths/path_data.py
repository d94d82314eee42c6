"""SVG path data: text to commands.

The grammar is walked by hand and to the letter: what it does not allow ends the path there, with the place.
"""

from __future__ import annotations

import re

from ....units import NUMBER as _NUMBER

_SPACE = r"[ \t\n\r\f]*+"
_GAP = rf"{_SPACE}(?:,{_SPACE})?"
NUMBER, SPACE, GAP, FLAG = (re.compile(text) for text in (_NUMBER, _SPACE, _GAP, "[01]"))
_NEXT_NUMBER = re.compile(f"{_GAP}({_NUMBER})|")  # or nothing, where a list ends: no search beyond
_ARC_ARGUMENTS = (NUMBER, NUMBER, NUMBER, FLAG, FLAG, NUMBER, NUMBER)

MOST_COMMANDS = 1_000_000  # of one path: no lettering has a hundredth of it, and each takes 600 bytes
_COUNT = {"M": 2, "L": 2, "H": 1, "V": 1, "C": 6, "S": 4, "Q": 4, "T": 2}

# Where the command's arguments begin in the text, its letter, its numbers.
Command = tuple[int, str, tuple[float, ...]]


def numbers(text: str) -> list[float] | None:
    """A list of numbers separated as SVG allows, [] for no text; None if it is anything else."""
    if not text:
        return []
    _, values, end = _run(text, 0)
    return values if end == len(text) else None


def snippet(text: str, position: int, length: int = 16) -> str:
    """What stands at a position, quoted and shortened, for a sentence."""
    found = text[position : position + length].strip()
    return repr(found + ("..." if position + length < len(text) else "")) if found else "the end"


def parse_path(d: str) -> tuple[list[Command], int | None]:
    """Commands up to the first error, and where that is (None if there is none). One more than MOST_COMMANDS is an
    error, too."""
    commands: list[Command] = []
    at = SPACE.match(d).end()
    while at < len(d):
        if len(commands) >= MOST_COMMANDS:
            return commands, at
        begin, letter = at, d[at]
        if letter not in "MmLlHhVvCcSsQqTtAaZz" or not (commands or letter in "Mm"):
            return commands, at
        at = SPACE.match(d, at + 1).end()
        if letter in "Zz":
            commands.append((begin, letter, ()))
            continue
        if letter in "Aa":
            at, error = _arcs(d, begin, at, letter, commands)
        else:
            at, error = _sets(d, begin, at, letter, commands)
        if error is not None:
            return commands, error
        at = SPACE.match(d, at).end()
    return commands, None


def parse_points(text: str) -> tuple[list[Command], int | None]:
    """A list of points as moveto and linetos up to the first error, and where that is."""
    at = SPACE.match(text).end()
    commands: list[Command] = []
    at, error = _sets(text, at, at, "M", commands)
    if error is None and (end := SPACE.match(text, at).end()) < len(text):
        error = end
    return commands, error


def _run(text: str, at: int) -> tuple[list[int], list[float], int]:
    """Where the numbers that follow begin, what they are, and where the last one ends."""
    first = NUMBER.match(text, at)
    if not first:
        return [], [], at
    places, values, end = [at], [float(first[0])], first.end()
    for found in _NEXT_NUMBER.finditer(text, end):
        if found[1] is None or len(values) > 6 * MOST_COMMANDS:  # six numbers make a C
            break
        places.append(found.start(1))
        values.append(float(found[1]))
        end = found.end()
    return places, values, end


def _sets(d: str, begin: int, at: int, letter: str, commands: list[Command]) -> tuple[int, int | None]:
    places, values, end = _run(d, at)
    if not values:
        return at, at
    count = _COUNT[letter.upper()]
    for first in range(0, len(values) - count + 1, count):
        place = places[first] if first else begin
        if len(commands) >= MOST_COMMANDS:
            return place, place
        commands.append((place, letter, tuple(values[first : first + count])))
        if letter in "Mm":
            letter = "L" if letter == "M" else "l"
    return end, GAP.match(d, end).end() if len(values) % count else None


def _arcs(d: str, begin: int, at: int, letter: str, commands: list[Command]) -> tuple[int, int | None]:
    while True:
        values = []
        for pattern in _ARC_ARGUMENTS:
            found = pattern.match(d, at)
            if not found:
                return at, at
            values.append(float(found[0]))
            end = found.end()
            at = GAP.match(d, end).end()
        commands.append((begin, letter, tuple(values)))
        if not NUMBER.match(d, at):
            return end, None
        if len(commands) >= MOST_COMMANDS:
            return at, at
        begin = at
