"""Report problems to users: an Error refuses, a Notice warns and stops nothing.

Error is the only exception that a user can cause; any other exception is a bug. Errors and notices have a
code for the kind of problem; docs/reference/diagnostics.md lists the codes. Decisions depend on the code,
never on the words of a sentence.
"""

from __future__ import annotations

import importlib.util
import math
import os
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from numbers import Real


class Error(ValueError):
    """A refusal in one full sentence.

    sentence: the problem, with the number and the allowed range; str(error) is the sentence with the advice.
    where: the element, stroke or key with the problem, "" if there is none.
    value, range: the offending number and its allowed (least, greatest), None if there are none.
    file: the file with the problem, None if only the caller knows the file.
    code: the kind of problem.
    advice: what a user who types commands should do, "" if the sentence is enough. Other programs use
    their own words for the advice.
    notices: warnings about the same drawing that were found before the refusal.
    """

    notices: tuple[Notice, ...] = ()

    def __init__(
        self,
        sentence: str,
        where: str = "",
        value: float | None = None,
        range: tuple[float, float] | None = None,
        file: str | None = None,
        code: str = "",
        advice: str = "",
    ):
        super().__init__(join_advice(sentence, advice))
        self.sentence = sentence
        self.where = where
        self.value = value
        self.range = range
        self.file = file
        self.code = code
        self.advice = advice
        for name in (name for name in (file, where) if isinstance(name, str) and name):
            self.add_note(f"in {name}")  # shown in a traceback

    def notice(self, where: str | None = None) -> Notice:
        """Return a notice with this sentence, which stops nothing.

        where: the element of the notice, None for the element of this error.
        """
        return Notice(self.where if where is None else where, self.sentence, code=self.code, advice=self.advice)


@dataclass(frozen=True)
class Notice:
    """A warning about one element, or the reason why it was left out or must not run.

    where: the element, stroke or key, "" if there is none.
    damaged: the geometry itself is broken and was read up to the error.
    code: the kind of problem.
    about: the subject, for example a CSS property or a kind of element. Notices with one code are alike only
    if they have equal subjects.
    advice: what the user should type, see Error.
    refused: `convert` writes no program because of this notice.
    excess: how far a value exceeds its limit, in the unit of the sentence. Of many alike notices, the one with the
    greatest excess is reported.
    """

    where: str
    sentence: str
    damaged: bool = False
    layer: str | None = None
    code: str = ""
    about: str = ""
    advice: str = ""
    refused: bool = False
    excess: float = field(default=0.0, compare=False, repr=False)

    def __iter__(self):
        """Yield the element and the text, for `where, sentence = notice`."""
        return iter((self.where, self.text))

    @property
    def text(self) -> str:
        """The sentence with its advice."""
        return join_advice(self.sentence, self.advice)

    def as_json(self) -> dict[str, str | bool]:
        """Return the notice for other programs; the sentence ends with the advice."""
        made = {"where": self.where, "sentence": self.text, "code": self.code}
        return made | {"advice": self.advice, "damaged": self.damaged, "refused": self.refused}

    @property
    def kind(self) -> tuple[str, str, bool]:
        """The key that alike notices share, so that they can be reported as one."""
        return (self.code, self.about, self.damaged) if self.code else ("", self.sentence, self.damaged)


@contextmanager
def name_file_in_errors(file: str | os.PathLike[str]) -> Iterator[None]:
    """Let errors inside name this file, unless they name another one."""
    try:
        yield
    except Error as problem:
        problem.file = problem.file or os.fspath(file)
        raise


def join_advice(sentence: str, advice: str) -> str:
    return f"{sentence}; {advice}" if advice else sentence


def list_first(names: Sequence[str], most: int) -> str:
    """Return the first names for a sentence, with the number of the others."""
    more = len(names) - most
    return ", ".join(names[:most]) + (f" and {more} more" if more > 0 else "")


def format_value(number: float) -> str:
    """Format a number from a file for a sentence.

    Whole numbers in TOML may have any number of digits, so only 40 characters are shown.
    """
    return str(number)[:40] if isinstance(number, int) else f"{number:g}"


def require_type(value, kind: type | tuple[type, ...], what: str, name: str = "") -> None:
    """Raise Error if a value does not have the expected Python type.

    what: the expected type in words. True and False count as numbers only if kind contains bool.
    name: the argument or key with the value, "" if there is only one.
    """
    kinds = kind if isinstance(kind, tuple) else (kind,)
    if not isinstance(value, kinds) or (isinstance(value, bool) and bool not in kinds):
        found = f"{type(value).__name__} {str(value)[:40]!r}"
        raise Error(f"{name} must be {what}, not {found}" if name else f"{found} is not {what}", code="wrong-type")


def as_number(value, what: str, name: str = "") -> float:
    """Return a value as a float; raise Error unless it is a number.

    what: the expected number in words. Fractions and numpy's scalars are numbers, too.
    """
    require_type(value, Real, what, name)
    try:
        return float(value)
    except OverflowError:  # an integer of hundreds of digits
        return math.inf if value > 0 else -math.inf


def need_number(value, what: str, least: float, greatest: float) -> float:
    """Return a value as a float; raise Error unless it is a number in the range."""
    number = as_number(value, "a number", what)
    if not least <= number <= greatest:
        sentence = f"{what}, {number:g}, is outside the range [{least:g}, {greatest:g}]"
        raise Error(sentence, range=(least, greatest), code="out-of-range")
    return number


def need_numbers(values, what: str, count: int, least: float, greatest: float) -> tuple[float, ...]:
    """Return a tuple, list or array as floats; raise Error unless it has `count` numbers in the range."""
    values = as_listed(values)
    require_type(values, (tuple, list), f"{count} numbers", what)
    if len(values) != count:
        raise Error(f"{what} has {len(values)} numbers, not {count}", what, code="wrong-type")
    return tuple(need_number(value, f"a number of {what}", least, greatest) for value in values)


def need_truth(value, what: str) -> None:
    """Raise Error if a value is neither True nor False. Without this check, the text "no" would count as True."""
    is_numpy_bool = getattr(getattr(value, "dtype", None), "kind", "") == "b" and value.ndim == 0
    if not (isinstance(value, bool) or is_numpy_bool):
        sentence = f"{what} must be True or False, not {type(value).__name__} {str(value)[:40]!r}"
        raise Error(sentence, code="wrong-type")


def as_listed(value):
    """Return a numpy array as nested lists, and any other value unchanged.

    Callers can pass arrays where lists are expected.
    """
    return value.tolist() if type(value).__module__ == "numpy" and hasattr(value, "tolist") else value


def need_one_of(value, choices: tuple, what: str) -> None:
    """Raise Error if a value is none of the choices."""
    if not any(value is choice or (type(value) is str and value == choice) for choice in choices):
        known = ", ".join(map(str, choices[:-1]))
        raise Error(f"{what} must be {known} or {choices[-1]}, not {str(value)[:40]!r}", code="choice-unknown")


def missing_packages_error(what: str, *packages: str) -> Error:
    """Return an Error for missing packages, with the command that installs them."""
    return Error(f"{what} {' and '.join(packages)}: install with  {command_to_add(*packages)}", code="package-missing")


def command_to_add(*packages: str) -> str:
    """Return the command that adds packages to the running Python.

    The command uses the program that installed brushsvg: pipx, uv or pip.
    """
    names = " ".join(packages)
    if os.path.exists(os.path.join(sys.prefix, "pipx_metadata.json")):
        return f"pipx inject brushsvg {names}"
    if os.path.exists(os.path.join(sys.prefix, "uv-receipt.toml")):
        return f"uv tool install brushsvg {' '.join(f'--with {name}' for name in packages)}"
    if importlib.util.find_spec("pip") is None:  # uv makes environments without pip
        return f"uv pip install --python {sys.executable} {names}"
    return f"{sys.executable} -m pip install {names}"


def describe_unexpected(mistake: Exception) -> Error:
    """Return the Error that a user sees in place of an unexpected exception.

    Either the memory was not enough, or the exception is a bug of brushsvg.
    """
    text = str(mistake)
    is_unloaded = isinstance(mistake, ImportError) and "failed to map segment" in text
    if isinstance(mistake, MemoryError) or is_unloaded or "cannot allocate memory" in text.lower():
        advice = "close other programs, paint a smaller drawing, or raise the limit of `ulimit -v`"
        return Error("there is not enough memory", code="memory-exhausted", advice=advice)
    sentence = f"this should not happen, please report it: {type(mistake).__name__} {text}"
    return Error(sentence, code="unexpected")
