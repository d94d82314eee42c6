"""The known name that a mistyped one is most like."""

from __future__ import annotations

import difflib
from collections.abc import Iterable

NEAR = 0.6  # the ratio of difflib, its default: roun-6 and round-6 have 0.92, author and about 0.55


def nearest_name(name: str, known: Iterable[str]) -> str:
    """The most alike of the known names; "" where none is alike."""
    near = difflib.get_close_matches(name, list(known), 1, NEAR)
    return near[0] if near else ""


def did_you_mean(name: str, known: Iterable[str]) -> str:
    """What ends a sentence on a name that is not known: a question, or a full stop where no name is alike."""
    near = nearest_name(name, known)
    return f"; did you mean {near}?" if near else "."
