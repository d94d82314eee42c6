"""Order the strokes of a chart for painting."""

from __future__ import annotations

from itertools import groupby

# In a round, each depth is painted by the next kind. After four rounds every depth was painted by all kinds.
KINDS = ("straight", "angular", "arc", "reversal")


def shallow_to_deep(strokes: list[tuple[str, float]]) -> list[int]:
    """Return the indices of strokes with references first, then by depth.

    strokes: (kind, depth [mm]), ordered from shallow to deep.

    If paint runs out, it then does so where most of it is used.
    """
    return sorted(range(len(strokes)), key=lambda k: (strokes[k][0] != "reference", strokes[k][1]))


def early_and_late(strokes: list[tuple[str, float]]) -> list[int]:
    """Return the indices in rounds, each with one stroke of every depth.

    Rounds go from shallow to deep and back in turn, between the first reference and the others. The path painted before
    a stroke then has the same mean length at every depth.
    """
    in_order = shallow_to_deep(strokes)
    references = [k for k in in_order if strokes[k][0] == "reference"]
    by_depth = [
        _by_kind(strokes, list(alike), number)
        for number, (_, alike) in enumerate(
            groupby((k for k in in_order if k not in references), key=lambda k: strokes[k][1])
        )
    ]
    rounds = max(map(len, by_depth), default=0)
    turns = (by_depth[:: 1 if round_number % 2 == 0 else -1] for round_number in range(rounds))
    dealt = [left[round_number] for round_number, turn in enumerate(turns) for left in turn if round_number < len(left)]
    return [*references[:1], *dealt, *references[1:]]


def _by_kind(strokes: list[tuple[str, float]], alike: list[int], first: int) -> list[int]:
    """Order the strokes of one depth: one of each kind, from the kind with number `first` on, then the repeats."""
    of_kind = {kind: [k for k in alike if strokes[k][0] == kind] for kind in KINDS}
    kinds = KINDS[first % len(KINDS) :] + KINDS[: first % len(KINDS)]
    repeats = max(map(len, of_kind.values()))
    return [of_kind[kind][repeat] for repeat in range(repeats) for kind in kinds if repeat < len(of_kind[kind])]
