"""Text as a font sets it, before it has a place on a sheet."""

from __future__ import annotations

from dataclasses import dataclass

from ..design import Notice, SubPath


@dataclass(frozen=True)
class Placed:
    """One glyph with ink. x_mm, y_mm: its origin from where its line of text begins, y down.

    label: the characters it stands for; subpaths: from its origin, in mm, y down.
    """

    label: str
    subpaths: tuple[SubPath, ...]
    x_mm: float
    y_mm: float = 0.0


@dataclass(frozen=True)
class Setting:
    """A text: the glyphs of each line; filled: they are shapes, not lines to follow.

    missing: characters without a glyph, each once, in the order met.
    """

    lines: tuple[tuple[Placed, ...], ...]
    filled: bool
    missing: tuple[str, ...] = ()
    notices: tuple[Notice, ...] = ()
