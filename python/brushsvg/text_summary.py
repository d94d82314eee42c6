"""Many sentences of one kind as one: a person reads the first of them and how many there are."""

from __future__ import annotations

import re
from collections.abc import Iterable

MOST_ALIKE = 3  # of a kind, told one by one
MOST_NAMED = 4  # whose sentence is the very same: a brush has as many laws
_OWN = re.compile(r"'[^']*'|[-+]?[0-9][0-9.]*(?:e[-+]?[0-9]+)?")  # what differs within a kind: names, numbers


def folded(told: Iterable[tuple[str, str]]) -> list[tuple[str, str]]:
    """(element, sentence) pairs in the order in which each kind comes first; the rest of a kind is counted."""
    kinds: dict[str, list[tuple[str, str]]] = {}
    for where, sentence in told:
        kinds.setdefault(kind(sentence), []).append((where, sentence))
    result = []
    for alike in kinds.values():
        if len(alike) <= MOST_ALIKE:
            result += alike
        elif len(alike) <= MOST_NAMED and len({sentence for _, sentence in alike}) == 1 and all(dict(alike)):
            *names, last = (where for where, _ in alike)
            result.append((f"{', '.join(names)} and {last}", alike[0][1]))
        else:
            where, sentence = alike[0]
            result.append((f"{where} and {len(alike) - 1} like it", sentence))
    return result


def kind(sentence: str) -> str:
    """What sentences have in common that differ in names and numbers only."""
    return _OWN.sub("", sentence)
