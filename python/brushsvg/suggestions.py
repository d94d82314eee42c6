"""Suggest the known name that is most similar to a mistyped one."""

from __future__ import annotations

import difflib
from collections.abc import Iterable

# Least ratio of difflib for a similar name; 0.6 is its default. "roun-6" and "round-6" have 0.92, "author"
# and "about" have 0.55.
NEAR = 0.6


def nearest_name(name: str, known: Iterable[str]) -> str:
    """Return the most similar known name, "" if no name is similar."""
    near = difflib.get_close_matches(name, list(known), 1, NEAR)
    return near[0] if near else ""


def did_you_mean(name: str, known: Iterable[str]) -> str:
    """Return the end of a sentence about an unknown name.

    It asks for the most similar known name, or is a full stop if no name is similar.
    """
    near = nearest_name(name, known)
    return f"; did you mean {near}?" if near else "."
