"""Report problems: Error, the one exception that a user can cause (all others are bugs), and Notice, which stops
nothing.

Both have a code for their kind, listed in docs/reference/diagnostics.md. Decisions ask for the code, never for words
of a sentence.
"""

from __future__ import annotations

import importlib.util
import math
import os
import sys
from dataclasses import dataclass
from numbers import Real


class Error(ValueError):
    """A refusal in one full sentence.

    sentence: what is wrong, with the number and the admissible range; str(error) is this sentence with the advice.
    where: the element, stroke or key it concerns, "" if none.
    value, range: the offending number and (least, greatest), None where there are none.
    file: the file it is about, None where only the caller knows.
    code: of what kind it is.
    advice: what helps who types commands, "" where the sentence says it all: other programs word it their own way.
    notices: warnings of the same drawing that were found before it was refused.
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
        """The same as something that stops nothing; where: its element, where that is known better."""
        return Notice(
            self.where if where is None else where, self.sentence, code=self.code, advice=self.advice
        )


@dataclass(frozen=True)
class Notice:
    """A warning about one element, or the reason why it was left out or may not be run.

    where: the element, stroke or key, "" if none. damaged: the geometry itself is broken and was read up to the error;
    code: its kind. about: a CSS property or a kind of element; notices of one kind are alike only if this is the same.
    advice: what to type, see Error. refused: `convert`
    writes no program because of it.
    """

    where: str
    sentence: str
    damaged: bool = False
    layer: str | None = None
    code: str = ""
    about: str = ""
    advice: str = ""
    refused: bool = False

    def __iter__(self):
        """For `where, sentence = notice`."""
        return iter((self.where, self.text))

    @property
    def text(self) -> str:
        """The sentence with its advice."""
        return join_advice(self.sentence, self.advice)

    def as_json(self) -> dict[str, str | bool]:
        """For programs that read us: the sentence ends in the advice."""
        made = {"where": self.where, "sentence": self.text, "code": self.code}
        return made | {"advice": self.advice, "damaged": self.damaged, "refused": self.refused}

    @property
    def kind(self) -> tuple[str, str, bool]:
        """The part that alike notices share: they are reported as one."""
        return (self.code, self.about, self.damaged) if self.code else ("", self.sentence, self.damaged)


def join_advice(sentence: str, advice: str) -> str:
    return f"{sentence}; {advice}" if advice else sentence


def format_value(number: float) -> str:
    """A number of a file in a sentence: whole numbers of TOML have no end."""
    return str(number)[:40] if isinstance(number, int) else f"{number:g}"


def require_type(value, kind: type | tuple[type, ...], what: str) -> None:
    """Error for a value of another Python type than what it should be, in words. True is no number."""
    kinds = kind if isinstance(kind, tuple) else (kind,)
    if not isinstance(value, kinds) or (isinstance(value, bool) and bool not in kinds):
        raise Error(f"{type(value).__name__} {str(value)[:40]!r} is not {what}", code="wrong-type")


def need_number(value, what: str, least: float, greatest: float) -> float:
    """The number itself. Error for what is none, and outside of [least, greatest]."""
    require_type(value, Real, f"a number, which {what} is")
    try:
        number = float(value)
    except OverflowError:  # an integer of hundreds of digits
        number = math.inf if value > 0 else -math.inf
    if not least <= number <= greatest:
        raise Error(
            f"{what}, {number:g}, is outside the range [{least:g}, {greatest:g}]",
            range=(least, greatest),
            code="out-of-range",
        )
    return number


def need_truth(value, what: str) -> None:
    """Error for what is neither True nor False: the text "no" would count as yes."""
    if not isinstance(value, bool) and getattr(getattr(value, "dtype", None), "kind", "") != "b":
        raise Error(
            f"{type(value).__name__} {str(value)[:40]!r} is not True or False, which {what} is",
            code="wrong-type",
        )


def as_listed(value):
    """An array of numpy as nested lists, all else as it is: arrays may stand for lists."""
    return value.tolist() if type(value).__module__ == "numpy" and hasattr(value, "tolist") else value


def need_one_of(value, choices: tuple, what: str) -> None:
    """Error for what is none of the choices there are."""
    if not any(value is choice or (type(value) is str and value == choice) for choice in choices):
        known = ", ".join(map(str, choices[:-1]))
        raise Error(f"{what} is {known} or {choices[-1]}, not {str(value)[:40]!r}", code="choice-unknown")


def missing_packages_error(what: str, *packages: str) -> Error:
    """Return a refusal because packages of an extra are missing, with the command that installs them."""
    return Error(
        f"{what} {' and '.join(packages)}: install with  {command_to_add(*packages)}", code="package-missing"
    )


def command_to_add(*packages: str) -> str:
    """The command that adds packages to the Python that runs this, by the program that installed it."""
    names = " ".join(packages)
    if os.path.exists(os.path.join(sys.prefix, "pipx_metadata.json")):
        return f"pipx inject brushsvg {names}"
    if os.path.exists(os.path.join(sys.prefix, "uv-receipt.toml")):
        return f"uv tool install brushsvg {' '.join(f'--with {name}' for name in packages)}"
    if importlib.util.find_spec("pip") is None:  # as in the environments of uv
        return f"uv pip install --python {sys.executable} {names}"
    return f"{sys.executable} -m pip install {names}"


def describe_unexpected(mistake: Exception) -> Error:
    """What a user is shown of an exception that is no refusal: there was no memory, or the mistake is ours."""
    text = str(mistake)
    is_unloaded = isinstance(mistake, ImportError) and "failed to map segment" in text
    if isinstance(mistake, MemoryError) or is_unloaded or "cannot allocate memory" in text.lower():
        advice = "close other programs, paint a smaller drawing, or raise the limit of `ulimit -v`"
        return Error("there is not enough memory", code="memory-exhausted", advice=advice)
    sentence = f"this should not happen, please report it: {type(mistake).__name__} {text}"
    return Error(sentence, code="unexpected")
