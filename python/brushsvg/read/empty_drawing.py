"""The refusal of a drawing of which nothing is left, with the reasons."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from ..errors import Error
from .design import Notice

_REASONS = 3


def nothing_to_paint(notices: Iterable[Notice], left_out: Mapping[str, int] | None = None) -> Error:
    """Names damage first, then what was met most often. left_out: how often something was, without a notice, by why."""
    alike: dict[tuple, list[Notice]] = {}
    for notice in notices:
        alike.setdefault(notice.kind, []).append(notice)
    reasons = [(found[0].damaged, len(found), _said(found)) for found in alike.values()]
    for why, count in (left_out or {}).items():
        reasons.append((False, count, f"{count} {'element is' if count == 1 else 'elements are'} {why}"))
    reasons.sort(key=lambda reason: (not reason[0], -reason[1]))
    sentence = "the drawing holds nothing to paint"
    if reasons:
        sentence += ": " + "; ".join(said for *_, said in reasons[:_REASONS])
    if more := len(reasons[_REASONS:]):
        sentence += f"; and {more} more reason{'s' * (more > 1)}"
    return Error(sentence, code="nothing-to-paint")


def _said(alike: list[Notice]) -> str:
    first = alike[0]
    return f"{first.where}: {first.text}" if len(alike) == 1 else f"{len(alike)} times: {first.text}"
