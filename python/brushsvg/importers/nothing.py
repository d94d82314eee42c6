"""The refusal of a drawing of which nothing is left, with the reasons."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from ..design import Notice
from ..errors import Error

_REASONS = 3


def nothing_to_paint(notices: Iterable[Notice], left_out: Mapping[str, int] | None = None) -> Error:
    """Names damage first, then what was met most often. left_out: how often something was, without a notice, by why."""
    places: dict[tuple[bool, str], list[str]] = {}
    for notice in notices:
        places.setdefault((notice.damaged, notice.sentence), []).append(notice.where)
    reasons = [(damaged, len(found), _at(found, said)) for (damaged, said), found in places.items()]
    for why, count in (left_out or {}).items():
        reasons.append((False, count, f"{count} {'element is' if count == 1 else 'elements are'} {why}"))
    reasons.sort(key=lambda reason: (not reason[0], -reason[1]))
    sentence = "the drawing holds nothing to paint"
    if reasons:
        sentence += ": " + "; ".join(said for *_, said in reasons[:_REASONS])
    if more := len(reasons[_REASONS:]):
        sentence += f"; and {more} more reason{'s' * (more > 1)}"
    return Error(sentence)


def _at(places: list[str], sentence: str) -> str:
    return f"{places[0]}: {sentence}" if len(places) == 1 else f"{len(places)} times: {sentence}"
