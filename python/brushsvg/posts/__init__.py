"""One robot language per file: moves -> text. POSTS names them all."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from ..program import Program


class Post(NamedTuple):
    """title: for people; extension: of its files; write: the whole program as 7-bit text."""

    title: str
    extension: str
    write: Callable[[Program], str]


def _linuxcnc(program: Program) -> str:
    from .gcode import linuxcnc  # loaded for who writes, not for who only asks what can be written

    return linuxcnc(program)


def _grbl(program: Program) -> str:
    from .gcode import grbl

    return grbl(program)


POSTS = {  # by the language a cell names
    "linuxcnc": Post("G-code for LinuxCNC", ".ngc", _linuxcnc),
    "grbl": Post("G-code for grbl", ".ngc", _grbl),
}
