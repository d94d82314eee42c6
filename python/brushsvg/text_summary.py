"""Many sentences of one kind as one: a person reads the first of them and how many there are."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

from .errors import Notice

MOST_ALIKE = 3  # of a kind, each on a line of its own
MOST_NAMED = 4  # whose sentence is the very same: a brush has as many laws


def summarize_notices(notices: Iterable[Notice]) -> list[Notice]:
    """The notices in the order in which each kind comes first; the rest of a kind is counted."""
    kinds: dict[tuple, list[Notice]] = {}
    for notice in notices:
        kinds.setdefault(notice.kind, []).append(notice)
    result = []
    for alike in kinds.values():
        if len(alike) <= MOST_ALIKE:
            result += alike
        elif _is_one(alike):
            *names, last = (notice.where for notice in alike)
            result.append(replace(alike[0], where=f"{', '.join(names)} and {last}"))
        else:
            first = alike[0]
            more = f"and {len(alike) - 1} like it"
            if first.where:
                result.append(replace(first, where=f"{first.where} {more}"))
            else:
                result.append(replace(first, sentence=f"{first.sentence}, {more}"))
    return result


def _is_one(alike: list[Notice]) -> bool:
    """Whether few elements have the very same said of them."""
    same = len({notice.sentence for notice in alike}) == 1 and all(notice.where for notice in alike)
    return same and len(alike) <= MOST_NAMED
