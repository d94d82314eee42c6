"""Report wrong argument types of the C++ module in one sentence.

The sentence is in Python's words. True and False are not accepted as numbers.
"""

from __future__ import annotations

import functools
import re
from collections.abc import Callable, Iterator
from types import ModuleType

# pybind11's names of argument types, and the words for people
_IN_WORDS = (
    (r"typing\.SupportsFloat \| typing\.SupportsIndex", "number"),
    (r"typing\.SupportsInt \| typing\.SupportsIndex", "whole number"),
    (r"typing\.Annotated\[numpy\.typing\.ArrayLike, numpy\.\w+, \"\[([^\"]*)\]\"\]", r"array (\1)"),
    (r"typing\.Annotated\[collections\.abc\.Sequence\[([^\[\]]*)\], \"FixedSize\((\d+)\)\"\]", r"\2 \1s"),
    (r"collections\.abc\.Sequence\[", "list["),
    (r"numpy\.typing\.ArrayLike", "array"),
    (r"brushsvg\._core\.", ""),
    (r"\| None\b", "or None"),
)
_MARK = "incompatible"  # a word in pybind11's messages about types
SHOWN = 40  # characters of a value that a message shows


def in_words(function: Callable) -> Callable:
    """Wrap a function of the C++ module so that it reports wrong types in words."""
    called = _in_words(function, function.__name__)
    called.__module__, called.__qualname__ = "brushsvg", function.__name__  # for pickle
    return called


@functools.cache
def with_classes_in_words(module: ModuleType) -> None:
    """Make the classes of the C++ module report wrong types in words from now on."""
    for kind in [each for each in vars(module).values() if isinstance(each, type)]:
        for name, member in list(vars(kind).items()):
            words = kind.__name__ if name.startswith("__") else f"{kind.__name__}.{name}"
            if isinstance(member, property):
                if member.fset:
                    fset = _in_words(member.fset, words, is_method=True)
                    setattr(kind, name, property(member.fget, fset, doc=member.__doc__))
            elif isinstance(member, staticmethod):
                setattr(kind, name, staticmethod(_in_words(member.__func__, words)))
            elif callable(member) and (name in ("__init__", "__call__") or not name.startswith("_")):
                setattr(kind, name, _in_words(member, words, is_method=True))


def _in_words(function: Callable, words: str, is_method: bool = False) -> Callable:
    @functools.cache
    def ways() -> list[dict[str, str]]:
        return list(_signatures(function.__doc__ or "", is_method))

    @functools.wraps(function, updated=())
    def called(*given, **named):
        own = given[is_method:]
        found = [_truth(way, own, named) for way in ways() if len(way) >= len(own)]
        if found and all(found):
            raise TypeError(f"{words}{found[0]}")
        try:
            return function(*given, **named)
        except TypeError as wrong:
            if _MARK not in str(wrong):
                raise
            raise TypeError(_explain(words, ways(), own, named)) from None

    return called


def _explain(words: str, ways: list[dict[str, str]], given: tuple, named: dict) -> str:
    shown = ", ".join([*map(_short, given), *(f"{name}={_short(value)}" for name, value in named.items())])
    if len(ways) == 1 and all(re.fullmatch(r"arg\d", name) for name in ways[0]) and len(ways[0]) == len(given) == 1:
        kind = next(iter(ways[0].values()))
        return f"{words} is {kind if kind[0].isdigit() else f'a {kind}'}, not {shown}"
    taken = " or ".join(f"({', '.join(f'{name}: {kind}' for name, kind in way.items())})" for way in ways)
    return f"{words} takes {taken}, not ({shown})"


def _truth(way: dict[str, str], given: tuple, named: dict) -> str:
    """Return the words about True or False in place of a number, "" if there is none."""
    for name, value in [*zip(way, given, strict=False), *named.items()]:
        if _takes_numbers(way.get(name, "")) and _has_truth(value):
            return f"{'' if re.fullmatch('arg[0-9]', name) else f': {name}'} takes numbers, not {_short(value)}"
    return ""


@functools.cache  # every wrapped function calls it
def _takes_numbers(kind: str) -> bool:
    return bool(re.search("number|array|float", kind)) and "bool" not in kind


def _has_truth(value: object) -> bool:
    if isinstance(value, list | tuple):
        return any(map(_has_truth, value))
    return isinstance(value, bool) or getattr(getattr(value, "dtype", None), "kind", "") == "b"


def _short(value: object) -> str:
    text = " ".join(repr(value).split())
    return text if len(text) <= SHOWN else f"{text[: SHOWN - 3]}..."


def _signatures(doc: str, is_method: bool) -> Iterator[dict[str, str]]:
    """Yield arguments with their types in words, for each signature of pybind11."""
    for line in doc.splitlines():
        found = re.match(r"(?:\d+\. )?[\w.]*\((.*)\)(?: -> .*)?$", line.strip())
        if found and found[1] != "*args, **kwargs":
            some = [each.partition(" = ")[0].partition(": ") for each in _parted(found[1])]
            yield {name: _kind_in_words(kind) for name, _, kind in some[is_method:] if kind}
            if not re.match(r"\d+\. ", line.strip()) and "Overloaded function." not in doc:
                return


def _parted(text: str) -> list[str]:
    """Split a text at the commas outside of brackets and quotes."""
    bare = re.sub(r"'[^']*'|\"[^\"]*\"", lambda quoted: "_" * len(quoted[0]), text)
    depth, ends = 0, [-1]
    for place, letter in enumerate(bare):
        depth += (letter in "([{") - (letter in ")]}")
        if letter == "," and depth == 0:
            ends.append(place)
    return [text[a + 1 : b].strip() for a, b in zip(ends, [*ends[1:], len(text)], strict=True)]


def _kind_in_words(kind: str) -> str:
    for pattern, instead in _IN_WORDS:
        kind = re.sub(pattern, instead, kind)
    return kind
