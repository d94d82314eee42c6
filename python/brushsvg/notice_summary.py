"""Combine many notices of one kind: people read the first one and their number."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

from .errors import Notice

MOST_ALIKE = 3  # notices of a kind that are all kept; if there are more, they are combined
MOST_NAMED = 4  # elements with one sentence that are all named: a brush has four laws


def summarize_notices(notices: Iterable[Notice]) -> list[Notice]:
    """Keep a few notices of each kind and count the others.

    The kinds stay in the order in which they first appear. The notice that stands for its kind has the greatest excess,
    so that its remedy is enough for all. Equal notices, as on the copies of an element, count once.
    """
    kinds: dict[tuple, list[Notice]] = {}
    for notice in dict.fromkeys(notices):
        kinds.setdefault(notice.kind, []).append(notice)
    result = []
    for alike in kinds.values():
        if len(alike) <= MOST_ALIKE:
            result += alike
        elif _is_one(alike):
            *names, last = (notice.where for notice in alike)
            result.append(replace(alike[0], where=f"{', '.join(names)} and {last}"))
        else:
            first = max(alike, key=lambda notice: notice.excess)
            more = f"and {len(alike) - 1} like it"
            if first.where:
                result.append(replace(first, where=f"{first.where} {more}"))
            else:
                result.append(replace(first, sentence=f"{first.sentence}, {more}"))
    return result


def _is_one(alike: list[Notice]) -> bool:
    """Return whether the notices have one sentence and few elements."""
    same = len({notice.sentence for notice in alike}) == 1 and all(notice.where for notice in alike)
    return same and len(alike) <= MOST_NAMED
