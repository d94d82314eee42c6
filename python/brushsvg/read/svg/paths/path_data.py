"""Parse SVG path data to commands.

The parser follows the grammar exactly. A path ends at the first text that the grammar does not allow, and the
position of this text is returned.
"""

from __future__ import annotations

import re

from ....units import NUMBER as _NUMBER

_SPACE = r"[ \t\n\r\f]*+"
_GAP = rf"{_SPACE}(?:,{_SPACE})?"
NUMBER, SPACE, GAP, FLAG = (re.compile(text) for text in (_NUMBER, _SPACE, _GAP, "[01]"))
# The empty alternative matches at the end of a list, so finditer does not search further.
_NEXT_NUMBER = re.compile(f"{_GAP}({_NUMBER})|")
_ARC_ARGUMENTS = (NUMBER, NUMBER, NUMBER, FLAG, FLAG, NUMBER, NUMBER)

# Commands of one path. No lettering has a hundredth of this number, and each command needs 600 bytes.
MOST_COMMANDS = 1_000_000
_ARGUMENT_COUNT = {"M": 2, "L": 2, "H": 1, "V": 1, "C": 6, "S": 4, "Q": 4, "T": 2}

# The position of the command or its arguments in the text, its letter, and its numbers.
Command = tuple[int, str, tuple[float, ...]]


def parse_numbers(text: str) -> list[float] | None:
    """Parse a list of numbers separated as SVG allows.

    The result is [] for an empty text, and None if the text is not a list of numbers.
    """
    if not text:
        return []
    _, values, end = _read_numbers(text, 0)
    return values if end == len(text) else None


def snippet(text: str, position: int, length: int = 16) -> str:
    """Return the text at a position, quoted and shortened, for use in a sentence."""
    found = text[position : position + length].strip()
    return repr(found + ("..." if position + length < len(text) else "")) if found else "the end"


def parse_path(d: str) -> tuple[list[Command], int | None]:
    """Return the commands up to the first error, and its position.

    The position is None if there is no error. More than MOST_COMMANDS commands are an error, too.
    """
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
            at, error = _read_arcs(d, begin, at, letter, commands)
        else:
            at, error = _read_sets(d, begin, at, letter, commands)
        if error is not None:
            return commands, error
        at = SPACE.match(d, at).end()
    return commands, None


def parse_points(text: str) -> tuple[list[Command], int | None]:
    """Return a list of points as moveto and lineto commands up to the first error.

    Also returns the position of the error, None if there is none.
    """
    at = SPACE.match(text).end()
    commands: list[Command] = []
    at, error = _read_sets(text, at, at, "M", commands)
    if error is None and (end := SPACE.match(text, at).end()) < len(text):
        error = end
    return commands, error


def _read_numbers(text: str, at: int) -> tuple[list[int], list[float], int]:
    """Read numbers from a position on; return their positions, values and the end of the last one."""
    first = NUMBER.match(text, at)
    if not first:
        return [], [], at
    places, values, end = [at], [float(first[0])], first.end()
    for found in _NEXT_NUMBER.finditer(text, end):
        if found[1] is None or len(values) > 6 * MOST_COMMANDS:  # C has the most numbers: six
            break
        places.append(found.start(1))
        values.append(float(found[1]))
        end = found.end()
    return places, values, end


def _read_sets(d: str, begin: int, at: int, letter: str, commands: list[Command]) -> tuple[int, int | None]:
    places, values, end = _read_numbers(d, at)
    if not values:
        return at, at
    count = _ARGUMENT_COUNT[letter.upper()]
    for first in range(0, len(values) - count + 1, count):
        place = places[first] if first else begin
        if len(commands) >= MOST_COMMANDS:
            return place, place
        commands.append((place, letter, tuple(values[first : first + count])))
        if letter in "Mm":
            letter = "L" if letter == "M" else "l"
    return end, GAP.match(d, end).end() if len(values) % count else None


def _read_arcs(d: str, begin: int, at: int, letter: str, commands: list[Command]) -> tuple[int, int | None]:
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
