"""In which order a chart's strokes are painted."""

from __future__ import annotations

from itertools import groupby

# Of a round's depths each is painted by the next kind: over four rounds every depth is painted by all of them
KINDS = ("straight", "angular", "arc", "reversal")


def shallow_to_deep(strokes: list[tuple[str, float]]) -> list[int]:
    """Numbers of (kind, depth mm): references first, then from shallow to deep: paint that runs out does so where most
    of it is used."""
    return sorted(range(len(strokes)), key=lambda k: (strokes[k][0] != "reference", strokes[k][1]))


def early_and_late(strokes: list[tuple[str, float]]) -> list[int]:
    """The same in rounds, each with one stroke of every depth, from shallow to deep and back in turn, between the first
    reference and the others: the way painted before a stroke is on average as long at every depth."""
    in_order = shallow_to_deep(strokes)
    references = [k for k in in_order if strokes[k][0] == "reference"]
    by_depth = [
        _by_kind(strokes, list(alike), number)
        for number, (_, alike) in enumerate(
            groupby((k for k in in_order if k not in references), key=lambda k: strokes[k][1])
        )
    ]
    rounds = max(map(len, by_depth), default=0)
    turns = (by_depth[:: 1 if one % 2 == 0 else -1] for one in range(rounds))
    dealt = [left[one] for one, turn in enumerate(turns) for left in turn if one < len(left)]
    return [*references[:1], *dealt, *references[1:]]


def _by_kind(strokes: list[tuple[str, float]], alike: list[int], first: int) -> list[int]:
    """Strokes of one depth: one of each kind after the other, from a first one on, then those that repeat them."""
    of_kind = {kind: [k for k in alike if strokes[k][0] == kind] for kind in KINDS}
    kinds = KINDS[first % len(KINDS) :] + KINDS[: first % len(KINDS)]
    repeats = max(map(len, of_kind.values()))
    return [of_kind[kind][one] for one in range(repeats) for kind in kinds if one < len(of_kind[kind])]
