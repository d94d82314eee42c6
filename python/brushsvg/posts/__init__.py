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
    from .gcode import gcode  # loaded for who writes, not for who only asks what can be written

    return gcode(program)


POSTS = {"linuxcnc": Post("G-code for LinuxCNC", ".ngc", _linuxcnc)}  # by the language a cell names
