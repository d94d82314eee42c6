"""Read values of a project file as the command line reads its options."""

from __future__ import annotations

import os
from collections.abc import Callable

from ...errors import Error, need_number, require_type
from ...files import is_file
from ...suggestions import did_you_mean
from ...units import length_mm, number, paper_mm, size_mm


def read_value(choice: str, value: object, key: str) -> object:
    """Read a value as the option of the command line does.

    Raises Error with the key.
    """
    from ..choices.choices import CHOICE_VALUES

    try:
        if choice == "join":
            require_type(value, bool, "true or false")
            return value
        if choice in ("layer", "skip_region", "skip_comment"):
            require_type(value, list, "a list of texts")
            return [_read_typed(choice, _format_as_typed(each)) for each in value]
        text = _format_as_typed(value)
        if choice in CHOICE_VALUES and text not in CHOICE_VALUES[choice]:
            allowed = CHOICE_VALUES[choice]
            sentence = f"{text[:40]!r} is not known{did_you_mean(text, allowed)} Known are {', '.join(allowed)}"
            raise Error(sentence, code="choice-unknown")
        return _read_typed(choice, text)
    except Error as refusal:
        raise Error(
            refusal.sentence, key, refusal.value, refusal.range, code=refusal.code, advice=refusal.advice
        ) from None


def _format_as_typed(value: object) -> str:
    """Return the text that a user would type for a value of TOML."""
    if isinstance(value, int | float) and not isinstance(value, bool):
        return str(value)[:400]
    require_type(value, str, "a text or a number")
    return str(value)


def _read_typed(choice: str, text: str) -> object:
    from ..choices.choice_checks import read_colour
    from ..choices.choices import CHOICE_RANGES

    readers: dict[str, Callable[[str], object]] = {
        "sheet": paper_mm,
        "fit": size_mm,
        "origin": lambda text: _read_lengths(text, 2, "a point, as 20,15"),
        "skip_region": _read_region,
        "colour": read_colour,
        "scale": _read_factor,
        "paint_speed": number,
    } | dict.fromkeys(("width", "lag", "tolerance", "z_offset", "paper_z"), length_mm)
    value = readers.get(choice, _read_words)(text)
    if choice in CHOICE_RANGES:
        return need_number(value, "the value", *CHOICE_RANGES[choice])
    return value


def _read_words(text: str) -> str:
    if not text.strip():
        raise Error("the text is empty", code="not-text")
    return text


def _read_factor(text: str) -> float:
    return number(text.removesuffix("%")) / (100 if text.endswith("%") else 1)


def _read_lengths(text: str, count: int, shape: str) -> tuple[float, ...]:
    parts = text.split(",")
    if len(parts) != count:
        raise Error(f"{text[:24]!r} is not {shape}", code="wrong-type")
    return tuple(need_number(length_mm(part), "a number of it", -1e6, 1e6) for part in parts)


def _read_region(text: str) -> tuple[float, ...]:
    x0, y0, x1, y1 = _read_lengths(text, 4, "a region, as 0,0,30,20")
    return min(x0, x1), min(y0, y1), max(x0, x1), max(y0, y1)


def name_or_path(kind: str, text: str, folder: str) -> str:
    """Return a shipped name as it is, and a file joined to the folder of the project.

    Raises Error if there is neither.
    """
    from ...machine.cells.cell_file import cell_names
    from ...model.library import brush_names

    names, suffix = (brush_names(), ".json") if kind == "brush" else (cell_names(), ".toml")
    if text in names:
        return text
    if text.endswith(suffix) or "/" in text or os.sep in text:
        path = os.path.join(folder, os.path.expanduser(text))
        if is_file(path):
            return path
        raise Error(
            f"{kind} {text[:80]!r} is a file that does not exist; looked for {path}",
            where=kind,
            code="file-unreadable",
            advice="correct the path, which counts from the folder of the project file",
        )
    file_name = f"{text}{suffix}"
    advice = (
        f"{file_name} is in this folder: write it with its ending" if is_file(os.path.join(folder, file_name)) else ""
    )
    sentence = (
        f"{kind} {text[:80]!r} is not known{did_you_mean(text, names)} Known are {', '.join(names)}, and any file that "
        f"ends in {suffix}"
    )
    raise Error(sentence, where=kind, code=f"{kind}-unknown", advice=advice)
