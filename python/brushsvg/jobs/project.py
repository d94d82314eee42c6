"""The project file, brushsvg.toml: brush, cell, paper, layers and options of all drawings in a folder."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Any

from ..errors import Error, need, need_number
from ..files import read_bytes, toml_document
from ..suggestions import did_you_mean
from ..units import length_mm, number, paper_mm, size_mm

NAME = "brushsvg.toml"
FORMAT, VERSION = "brushsvg/project", 1
MAX_BYTES = 1_000_000  # TOML of this size is read within seconds; a project needs some hundred bytes
TOP_KEYS = {"brush": "brush", "cell": "cell", "paper": "sheet", "layers": "layer"}  # key: choice
OF_ONE_DRAWING = ("input", "corrections")  # choices that no project can make


@dataclass(frozen=True)
class Project:
    """Settings that the drawings of a folder share, as a project file has them.

    path: of the file. settings: values by the names of the keywords of `convert`; lengths in mm. A brush or cell is a
    shipped name or a path, relative paths joined to the folder of the file.
    """

    path: str
    settings: Mapping[str, object] = field(default_factory=dict)

    def __post_init__(self):
        object.__setattr__(self, "settings", MappingProxyType(dict(self.settings)))

    def __reduce__(self):
        return Project, (self.path, dict(self.settings))

    @property
    def choices(self) -> dict[str, Any]:
        """Keywords for `convert`, `check`, `compare` and `batch`; settings in a drawing take precedence over them."""
        return {**self.settings, "from_project": tuple(self.settings)}


def find_project(drawing: str | os.PathLike[str]) -> Project | None:
    """Find and read the project file of a drawing, or return None if there is none.

    drawing: its path, which need not exist, or a folder. The file is `brushsvg.toml` in the folder of the drawing, or
    in the nearest folder above it. The search ends after your home folder, and after a folder that contains `.git`.

    Raises Error, as read_project does, for a file that is not valid.
    """
    path = find_project_file(drawing)
    return None if path is None else read_project(path)


def find_project_file(drawing: str | os.PathLike[str]) -> str | None:
    """Find the path of the project file of a drawing, see find_project."""
    need(drawing, (str, os.PathLike), "a path, which the drawing of a project is")
    try:
        folder = os.path.abspath(drawing)
    except OSError:  # the current folder was removed
        return None
    if not os.path.isdir(folder):
        folder = os.path.dirname(folder)
    home = os.path.abspath(os.path.expanduser("~"))
    while True:
        path = os.path.join(folder, NAME)
        if os.path.isfile(path):
            return path
        above = os.path.dirname(folder)
        if folder in (home, above) or os.path.exists(os.path.join(folder, ".git")):
            return None
        folder = above


def read_project(path: str | os.PathLike[str]) -> Project:
    """Read a project file.

    Raises Error, with the path in `file` and the key in `where`, for a file that cannot be read, a key that is not
    known, a value that the same option of the command line does not accept, and a brush or cell that does not exist.
    """
    need(path, (str, os.PathLike), "the path of a project file")
    path = os.fspath(path)
    data = read_bytes(path)
    try:
        if len(data) > MAX_BYTES:
            sentence = f"a project file has at most {MAX_BYTES} bytes, this one has {len(data)}"
            raise Error(sentence, value=len(data), range=(0, MAX_BYTES), code="file-too-large")
        settings = _settings(toml_document(_text(data), "project"), os.path.dirname(path))
    except Error as refusal:
        refusal.file = path
        raise
    except ValueError:  # of a hexadecimal number, which Python reads but does not print
        raise Error("a number has thousands of digits", file=path, code="not-toml") from None
    return Project(path, settings)


def options() -> dict[str, str]:
    """Return the keys of [defaults], each with the name of its choice."""
    from .choices import CHOICES, NAMED_OTHERWISE

    flags = {choice: flag for flag, choice in NAMED_OTHERWISE.items()}
    top = {*TOP_KEYS.values(), *OF_ONE_DRAWING}
    return {flags.get(name, name.replace("_", "-")): name for name in CHOICES if name not in top}


def write_project(
    brush: str | None = None, cell: str | None = None, paper: str | None = None, speed: float | None = None
) -> str:
    """Write a project file with a comment on each key. A key without a value is written as a comment.

    brush, cell: a shipped name, or a path relative to the file; paper: as `--sheet`; speed: mm/s.
    """

    def line(key: str, value, example) -> str:
        text = f"{value:g}" if isinstance(value, float) else json.dumps(example if value is None else value)
        return f"# {key} = {text}" if value is None else f"{key} = {text}"

    lines = [
        "# Settings of brushsvg for all drawings in this folder and below it.",
        "# The command line and settings in a drawing take precedence. --explain shows where each setting came from.",
        f"format = {json.dumps(FORMAT)}",
        f"version = {VERSION}",
        "",
        "# The brush: a name (see `brushsvg brush list`) or a file, relative to this file.",
        line("brush", brush, "mine.json"),
        "# The machine: a name (see `brushsvg cell list`) or a file, relative to this file.",
        line("cell", cell, "machine.toml"),
        "# The paper: a2, a3, a4, a5, letter, or width x height. It replaces the page size of each drawing.",
        line("paper", paper, "a4"),
        "# The layers to paint, in each drawing that has layers.",
        line("layers", None, ["Ink"]),
        "",
        "# Options of the command line without their dashes; `brushsvg convert --help-all` explains them.",
        "[defaults]",
        f"{line('speed', speed, 20)}  # of painting, in mm/s",
        line("detail", None, "fine"),
    ]
    return "\n".join([*lines, ""])


def _text(data: bytes) -> str:
    try:
        return data.decode("utf-8")
    except UnicodeDecodeError:
        sentence = "the file is not a project: it is not text in UTF-8"
        raise Error(sentence, code="not-toml") from None


def _settings(document: dict, folder: str) -> dict[str, object]:
    from .choices import Choices, checked

    if document.pop("format", None) != FORMAT:
        sentence = f'the file is not a project: it lacks the line format = "{FORMAT}"'
        raise Error(sentence, where="format", code="format-unknown")
    version = document.pop("version", None)
    if version != VERSION or isinstance(version, bool):
        sentence = f"version {str(version)[:40]} of the project file is not known; known: {VERSION}"
        raise Error(sentence, where="version", code="version-unknown")
    defaults = document.pop("defaults", {})
    if not isinstance(defaults, dict):
        raise Error("defaults is written as a table, [defaults]", where="defaults", code="wrong-type")
    known = options()
    for key in document:
        _refuse_unknown(key, TOP_KEYS, known, "write it below [defaults]")
    settings = {TOP_KEYS[key]: _value(TOP_KEYS[key], value, key) for key, value in document.items()}
    for key, value in defaults.items():
        _refuse_unknown(key, known, TOP_KEYS, "write it above [defaults]", "defaults.")
        settings[known[key]] = _value(known[key], value, f"defaults.{key}")
    for kind in {"brush", "cell"} & {*settings}:
        settings[kind] = _name_or_path(kind, settings[kind], folder)
    checked(Choices(**settings))
    return settings


def _refuse_unknown(key: str, known: Mapping, elsewhere: Mapping, advice: str, prefix: str = "") -> None:
    if key in known:
        return
    renamed = {"sheet": "paper", "layer": "layers"}.get(key)
    advice = f"call it {renamed}, above [defaults]" if renamed else advice if key in elsewhere else ""
    meant = ";" if advice else did_you_mean(key, [*known, *elsewhere])
    listed = "" if advice else f" Known here are {', '.join(known)}"
    sentence = f"a project has no key {prefix}{key[:40]}{meant}{listed}".removesuffix(";")
    raise Error(sentence, where=prefix + key[:40], code="key-unknown", advice=advice)


def _value(choice: str, value: object, key: str) -> object:
    """Read a value as the option of the command line does. Error with the key."""
    from .choices import ONE_OF

    try:
        if choice == "join":
            need(value, bool, f"true or false, which {key} is")
            return value
        if choice in ("layer", "skip_region", "skip_comment"):
            need(value, list, f"a list of texts, which {key} is")
            return [_read(choice, _as_typed(each, key), key) for each in value]
        text = _as_typed(value, key)
        if choice in ONE_OF and text not in ONE_OF[choice]:
            known = ONE_OF[choice]
            sentence = (
                f"{key} {text[:40]!r} is not known{did_you_mean(text, known)} Known are {', '.join(known)}"
            )
            raise Error(sentence, code="choice-unknown")
        return _read(choice, text, key)
    except Error as refusal:
        sentence = refusal.sentence if key in refusal.sentence else f"{key}: {refusal.sentence}"
        raise Error(
            sentence, key, refusal.value, refusal.range, code=refusal.code, advice=refusal.advice
        ) from None


def _as_typed(value: object, key: str) -> str:
    """Return the text that a user would type for a value of TOML."""
    if isinstance(value, int | float) and not isinstance(value, bool):
        return str(value)[:400]
    need(value, str, f"a text or a number, which {key} is")
    return str(value)


def _read(choice: str, text: str, key: str) -> object:
    from .choices import RANGES, colour_of

    readers: dict[str, Callable[[str], object]] = {
        "sheet": paper_mm,
        "fit": size_mm,
        "origin": lambda text: _lengths(text, 2, "a point, as 20,15"),
        "skip_region": _region,
        "colour": colour_of,
        "scale": _factor,
        "paint_speed": number,
    } | dict.fromkeys(("width", "lag", "tolerance", "z_offset", "paper_z"), length_mm)
    found = readers.get(choice, _words)(text)
    if choice in RANGES:
        return need_number(found, key, *RANGES[choice])
    return found


def _words(text: str) -> str:
    if not text.strip():
        raise Error("the text is empty", code="not-text")
    return text


def _factor(text: str) -> float:
    return number(text.removesuffix("%")) / (100 if text.endswith("%") else 1)


def _lengths(text: str, count: int, shape: str) -> tuple[float, ...]:
    parts = text.split(",")
    if len(parts) != count:
        raise Error(f"{text[:24]!r} is not {shape}", code="wrong-type")
    return tuple(need_number(length_mm(part), "a number of it", -1e6, 1e6) for part in parts)


def _region(text: str) -> tuple[float, ...]:
    x0, y0, x1, y1 = _lengths(text, 4, "a region, as 0,0,30,20")
    return min(x0, x1), min(y0, y1), max(x0, x1), max(y0, y1)


def _name_or_path(kind: str, text: str, folder: str) -> str:
    """Return a shipped name as it is, and a file with the folder of the project. Error if there is neither."""
    from ..machine.cells.cell_file import cell_names
    from ..model.library import brush_names

    names, suffix = (brush_names(), ".json") if kind == "brush" else (cell_names(), ".toml")
    if text in names:
        return text
    if text.endswith(suffix) or "/" in text or os.sep in text:
        path = os.path.join(folder, os.path.expanduser(text))
        if _is_file(path):
            return path
        raise Error(
            f"{kind} {text[:80]!r} is a file that does not exist; looked for {path}",
            where=kind,
            code="file-unreadable",
            advice=f"correct the path, which counts from the folder of {NAME}",
        )
    own = f"{text}{suffix}"
    advice = (
        f"{own} is in this folder: write it with its ending" if _is_file(os.path.join(folder, own)) else ""
    )
    raise Error(
        f"{kind} {text[:80]!r} is not known{did_you_mean(text, names)} Known are {', '.join(names)}, and any file that "
        f"ends in {suffix}",
        where=kind,
        code=f"{kind}-unknown",
        advice=advice,
    )


def _is_file(path: str) -> bool:
    try:
        return os.path.isfile(path)
    except ValueError:  # a name that no file can have
        return False
