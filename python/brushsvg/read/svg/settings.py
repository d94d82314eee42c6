"""Settings for brushsvg in a drawing: the attributes data-brushsvg-*.

They are on paths, groups and layers, which inherit them, and on the root element.
"""

from __future__ import annotations

import math
import re

from ...errors import Error
from ...units import length_mm, number
from .. import SCRIPTS

PREFIX = "data-brushsvg-"


def own_settings(attributes: dict[str, str], is_root: bool = False) -> tuple[dict, list[str]]:
    """Return the settings of an element, and sentences about invalid settings.

    docs/reference/drawings.md lists the settings.
    """
    settings, problems = _read_settings(
        attributes, _STROKE_SETTINGS | _DOCUMENT_SETTINGS if is_root else _STROKE_SETTINGS
    )
    job_settings = _DOCUMENT_SETTINGS.keys() | (_ROOT_JOB_SETTINGS if is_root else set())
    return {key: value for key, value in settings.items() if key not in job_settings}, problems


def document_settings(attributes: dict[str, str]) -> dict:
    """Return the valid settings of the root element that concern the whole job.

    These are the brush, the start and end of strokes, and the settings of the document.
    """
    settings, _ = _read_settings(
        attributes,
        _DOCUMENT_SETTINGS | {name: _STROKE_SETTINGS[name] for name in ("brush", *_ROOT_JOB_SETTINGS)},
    )
    return settings


def _read_settings(attributes: dict[str, str], known: dict) -> tuple[dict, list[str]]:
    settings, problems = {}, []
    for attribute, text in attributes.items():
        if not attribute.startswith(PREFIX):
            continue
        name = attribute.removeprefix(PREFIX)
        if name not in known:
            is_for_document = name in _DOCUMENT_SETTINGS
            why = "holds for the whole drawing: write it on its svg element" if is_for_document else "is not known"
            problems.append(f"{attribute} {why}; known here: {', '.join(known)}")
            continue
        key, read = known[name]
        try:
            settings[key] = read(text.strip())
        except (Error, ValueError) as problem:
            problems.append(f"{attribute}: {problem}")
    if terminals := settings.pop("terminals", None):
        settings = {"start": terminals, "end": terminals} | settings
    return settings, problems


def _width_mm(text: str) -> float:
    return _in_range(length_mm(text), 0.001, 1000, "mm")


def _speed_mm_s(text: str) -> float:
    try:
        value = number(text)
    except Error:
        raise Error(f"{text[:24]!r} is not a speed in mm/s", code="setting-invalid") from None
    return _in_range(value, 0.001, 10000, "mm/s")


def _whole_number(least: int, greatest: int):
    def read(text: str) -> int:
        if not re.fullmatch("[+-]?[0-9]{1,18}", text):  # int() also accepts digits of other alphabets
            raise Error(f"{text[:24]!r} is not a whole number", code="setting-invalid")
        return _in_range(int(text), least, greatest)

    return read


def _yes_or_no(text: str) -> bool:
    if text.lower() not in ("yes", "no", "true", "false", "1", "0"):
        raise Error(f"{text[:24]!r} is neither yes nor no", code="setting-invalid")
    return text.lower() in ("yes", "true", "1")


def _name(text: str) -> str:
    if not text:
        raise Error("it is empty", code="setting-invalid")
    return text


def _one_of(*known: str):
    def read(text: str) -> str:
        if text not in known:
            raise Error(f"{text[:24]!r} is none of {', '.join(known)}", code="setting-invalid")
        return text

    return read


def _tolerance_mm(text: str) -> float:
    return _in_range(length_mm(text), 1e-5, 10, "mm")


def _in_range(value, least, greatest, unit: str = ""):
    if not (math.isfinite(value) and least <= value <= greatest):
        unit = unit and f" {unit}"
        raise Error(f"{value:g}{unit} is outside the range [{least:g}, {greatest:g}]{unit}", code="out-of-range")
    return value


_TERMINAL = _one_of("auto", "round", "butt", "pointed")
_STROKE_SETTINGS = {
    "width": ("width_mm", _width_mm),
    "speed": ("speed_mm_s", _speed_mm_s),
    "order": ("order", _whole_number(-1_000_000, 1_000_000)),
    "passes": ("passes", _whole_number(1, 20)),
    "reload": ("reload", _yes_or_no),
    "skip": ("skip", _yes_or_no),
    "brush": ("brush", _name),
    "terminals": ("terminals", _TERMINAL),
    "start": ("start", _TERMINAL),
    "end": ("end", _TERMINAL),
    "script": ("script", _one_of(*SCRIPTS)),
}
_DOCUMENT_SETTINGS = {  # keys have the names of the attributes and of the flags
    "cell": ("cell", _name),
    "compensation": ("compensation", _one_of("none", "constant", "closed", "refined")),
    "tolerance": ("tolerance", _tolerance_mm),
    "wide": ("wide", _one_of("auto", "clamp", "passes", "refuse")),
}
# Settings of a stroke that concern the whole job if they are on the root. There a flag takes precedence.
_ROOT_JOB_SETTINGS = {"terminals", "start", "end"}
