"""Read fields of brushsvg's JSON files; each error names the path to the key."""

from __future__ import annotations

import json
import math
from contextlib import suppress

from .errors import Error


def document(data: str | bytes, format_: str, version: int = 1) -> dict:
    """Return the object in a JSON file of a format.

    Raises Error if the file is not JSON, has another format or version, or contains a key twice.
    """
    text = data.decode("utf-8-sig", "replace") if isinstance(data, bytes) else data
    try:
        content = json.loads(text, object_pairs_hook=_once)
    except Error:
        raise
    except ValueError as problem:
        raise Error(f"this is not valid JSON: {problem}", code="not-json") from None
    except RecursionError:
        raise Error("this is not valid JSON: its lists nest too deep", code="not-json") from None
    if not isinstance(content, dict) or content.get("format") != format_:
        says = content.get("format") if isinstance(content, dict) else None
        other = f", but {says!r:.40}" if isinstance(says, str) else ""
        raise Error(f'the file does not say "format": "{format_}"{other}', "format", code="format-unknown")
    found = content.get("version")
    if found != version or isinstance(found, bool):
        sentence = f"version {found!r:.40} of {format_} is not known; known is {version}"
        raise Error(sentence, "version", code="version-unknown")
    return content


def _once(pairs: list[tuple[str, object]]) -> dict:
    """Return an object; raise Error for a key that appears twice. One of the two values would be lost."""
    found = dict(pairs)
    if len(found) < len(pairs):
        names = [name for name, _ in pairs]
        twice = next(name for name in names if names.count(name) > 1)
        raise Error("the key occurs twice: remove one of them", twice, code="key-twice")
    return found


def refuse_unknown(content: dict, known, where: str = "", listed=None) -> None:
    """Raise Error for the first unknown key. listed: the keys that the message lists, None for all known keys."""
    for key in content:
        if key not in known:
            names = ", ".join(listed or known)
            here, path = (" here", f"{where}.{key}") if where else ("", key)
            raise Error(f"this is not known{here}; known are {names}", path, code="key-unknown")


def objects(values, where: str, or_else: str = "") -> list[dict]:
    """Return the values if they are a list of objects, else raise Error.

    or_else: words for the message about another type that the caller accepts.
    """
    if not isinstance(values, list) or not all(isinstance(value, dict) for value in values):
        raise Error(f"this must be a list of objects{or_else}", where, code="wrong-type")
    return values


def number(value, where: str, least: float = -math.inf, greatest: float = math.inf) -> float:
    if not isinstance(value, bool) and isinstance(value, int | float) and abs(value) < math.inf:
        with suppress(OverflowError):  # an integer that is too large for a float
            found = float(value)
            if not least <= found <= greatest:
                sentence = f"{found:g} is outside the range [{least:g}, {greatest:g}]"
                raise Error(sentence, where, found, code="out-of-range")
            return found
    raise Error(f"{value!r:.24} is not a finite number", where, code="not-a-number")


def numbers(values, where: str, count: int | None = None) -> tuple[float, ...]:
    """Return a list of finite numbers as a tuple, else raise Error.

    count: how many numbers there must be, None for any.
    """
    if not isinstance(values, list) or (count is not None and len(values) != count):
        expected = "a list of numbers" if count is None else f"{count} finite numbers"
        raise Error(f"this must be {expected}", where, code="wrong-type")
    return tuple(number(value, f"{where}[{i}]") for i, value in enumerate(values))
