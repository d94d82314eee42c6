"""The error for a drawing with nothing to paint, with the reasons."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from ..errors import Error
from .design import Notice

_MAX_NAMED_REASONS = 3  # reasons that the error names


def empty_drawing_error(notices: Iterable[Notice], left_out: Mapping[str, int] | None = None) -> Error:
    """Return the error for a drawing with nothing to paint.

    Its sentence names damage first, then the most frequent reasons.

    left_out: the number of elements that were left out without a notice, by reason.
    """
    notices_by_kind: dict[tuple, list[Notice]] = {}
    for notice in notices:
        notices_by_kind.setdefault(notice.kind, []).append(notice)
    reasons = [(group[0].damaged, len(group), _summarize_notices(group)) for group in notices_by_kind.values()]
    for why, count in (left_out or {}).items():
        reasons.append((False, count, f"{count} {'element is' if count == 1 else 'elements are'} {why}"))
    reasons.sort(key=lambda reason: (not reason[0], -reason[1]))
    sentence = "the drawing holds nothing to paint"
    if reasons:
        sentence += ": " + "; ".join(reason_text for *_, reason_text in reasons[:_MAX_NAMED_REASONS])
    if more := len(reasons[_MAX_NAMED_REASONS:]):
        sentence += f"; and {more} more reason{'s' * (more > 1)}"
    return Error(sentence, code="nothing-to-paint")


def _summarize_notices(group: list[Notice]) -> str:
    first, more = group[0], len(group) - 1
    if not first.where:
        return f"{len(group)} times: {first.text}" if more else first.text
    return f"{first.where}{f' and {more} like it' if more else ''}: {first.text}"
