"""Parts of programs that are longer than a controller takes, and the names of programs on controllers."""

from __future__ import annotations

import hashlib
import itertools
import re
from collections.abc import Container, Iterator

import numpy as np

from ..cells.language_limits import MAX_PROGRAM_LINES
from ..moves import Program
from .script import LanguageWords, write_section


def split_into_parts(program: Program, words: LanguageWords, lines_around: int, rises_again: bool) -> Iterator[str]:
    """Split the sections into parts that each fit in one program.

    The language limits the lines of one program. A section with more lines is a part by itself.

    lines_around: number of lines that each program has in addition to its part.
    rises_again: whether the tool goes straight up in each part, or only in the first one.
    """
    max_lines = MAX_PROGRAM_LINES[program.cell.language] - lines_around
    part_text, line_count, risen = "", 0, False
    for section in program.sections():
        section_text = "\n" + "".join(write_section(section, words, risen))
        if part_text and line_count + section_text.count("\n") > max_lines:
            yield part_text
            part_text, line_count = "", 0
            if rises_again:
                risen = False
                section_text = "\n" + "".join(write_section(section, words, risen))
        part_text += section_text
        line_count += section_text.count("\n")
        risen = risen or bool(section.moves)
    yield part_text


def name_on_controller(name: str, max_letters: int, reserved: Container[str] = ()) -> str:
    """Return the name of a program on its controller, in capitals.

    Controllers take names that begin with a letter and have letters, digits and underscores. A name that must change
    ends with four letters that depend on all of it, so that the names of two jobs differ.

    reserved: words in capitals that cannot be names.
    """
    capitals = name.upper()
    if re.fullmatch(rf"[A-Z][A-Z0-9_]{{0,{max_letters - 1}}}", capitals) and capitals not in reserved:
        return capitals
    kept = re.sub(r"[^A-Z0-9_]", "_", capitals)
    kept = kept if kept[:1].isalpha() else f"P{kept}"
    return kept[: max_letters - 4] + _four_letters(hashlib.sha256(name.encode("utf-8", "surrogateescape")).digest())


def name_parts(program: Program, setup: str) -> Iterator[str]:
    """Yield names of programs that the main program calls, without end.

    They depend on the main program's text and on all moves, so that the names of two jobs differ. Controllers take
    names of 8 letters.

    setup: the main program's text before its calls.
    """
    digest = hashlib.sha256(setup.encode())
    for section in program.sections():
        for move in section.moves:
            for values in (move.points_mm, move.speed_mm_s, move.axes, move.blends_mm):
                if values is not None:  # + 0.0: -0 becomes 0
                    digest.update((np.round(np.asarray(values, float), program.cell.decimals) + 0.0).tobytes())
    of_job = _four_letters(digest.digest())
    return (f"B{of_job}{number:03d}" for number in itertools.count(1))


def _four_letters(digest: bytes) -> str:
    return np.base_repr(int.from_bytes(digest[:8], "big") % 36**4, 36).zfill(4)
