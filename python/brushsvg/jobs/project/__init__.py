"""The project file, brushsvg.toml: settings for all drawings in a folder.

It has a brush, a cell, the paper, layers and options.
"""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Any

from ...errors import Error, require_type
from ...files import decode_text, read_bytes, toml_document
from ...suggestions import did_you_mean
from .values import name_or_path, read_value

NAME = "brushsvg.toml"
FORMAT, VERSION = "brushsvg/project", 1
MAX_BYTES = 1_000_000  # TOML of this size is read within seconds; a project file needs some hundred bytes
# The choice that each top-level key makes.
CHOICE_BY_TOP_KEY = {"brush": "brush", "cell": "cell", "paper": "sheet", "layers": "layer"}
OF_ONE_DRAWING = ("input", "corrections")  # choices that a project file cannot make


@dataclass(frozen=True)
class Project:
    """Settings that the drawings of a folder share, as in a project file.

    path: the path of the file.
    settings: values by the names of the keywords of `convert`; lengths in mm. A brush or cell is a shipped name or
        a path, and relative paths are joined to the folder of the file.
    """

    path: str
    settings: Mapping[str, object] = field(default_factory=dict)

    def __post_init__(self):
        object.__setattr__(self, "settings", MappingProxyType(dict(self.settings)))

    def __reduce__(self):
        return Project, (self.path, dict(self.settings))

    @property
    def choices(self) -> dict[str, Any]:
        """Keywords for `convert`, `check`, `compare` and `batch`.

        Settings in a drawing take precedence over them.
        """
        return {**self.settings, "from_project": tuple(self.settings)}


def find_project(drawing: str | os.PathLike[str]) -> Project | None:
    """Find and read the project file of a drawing, or return None if there is none.

    drawing: the path of the drawing, which need not exist, or of a folder.

    The file is `brushsvg.toml` in the folder of the drawing, or in the nearest folder above it. The search ends
    after your home folder, and after a folder that contains `.git`.

    Raises Error, as read_project does, for a file that is not valid.
    """
    path = find_project_file(drawing)
    return None if path is None else read_project(path)


def find_project_file(drawing: str | os.PathLike[str]) -> str | None:
    """Find the path of the project file of a drawing, or None; see find_project."""
    require_type(drawing, (str, os.PathLike), "a path", "the drawing of a project")
    try:
        folder = os.path.abspath(drawing)
    except OSError:  # the current folder was removed
        return None
    if not os.path.isdir(folder):
        folder = os.path.dirname(folder)
    home = os.path.abspath(os.path.expanduser("~"))
    while True:
        path = os.path.join(folder, NAME)
        if os.path.isfile(path) or os.path.islink(path):  # a broken link is refused when it is read
            return path
        above = os.path.dirname(folder)
        if folder in (home, above) or os.path.exists(os.path.join(folder, ".git")):
            return None
        folder = above


def read_project(path: str | os.PathLike[str]) -> Project:
    """Read a project file.

    Raises Error, with the path in `file` and the key in `where`, if the file cannot be read or a key is unknown. A
    value that the same option of the command line refuses, and a brush or cell that does not exist, also raise
    Error.
    """
    require_type(path, (str, os.PathLike), "the path of a project file")
    path = os.fspath(path)
    data = read_bytes(path)
    try:
        if len(data) > MAX_BYTES:
            sentence = f"a project file has at most {MAX_BYTES} bytes, this one has {len(data)}"
            raise Error(sentence, value=len(data), range=(0, MAX_BYTES), code="file-too-large")
        document = toml_document(decode_text(data, "a project", "not-toml"), "project", VERSION, "it lacks the line {}")
        settings = _read_settings(document, os.path.dirname(path))
    except Error as refusal:
        refusal.file = path
        raise
    return Project(path, settings)


def list_default_keys() -> dict[str, str]:
    """Return the keys of [defaults], each with the name of its choice."""
    from ..choices.choices import CHOICE_BY_FLAG, CHOICES

    flags = {choice: flag for flag, choice in CHOICE_BY_FLAG.items()}
    top = {*CHOICE_BY_TOP_KEY.values(), *OF_ONE_DRAWING}
    return {flags.get(name, name.replace("_", "-")): name for name in CHOICES if name not in top}


def write_project(
    brush: str | None = None, cell: str | None = None, paper: str | None = None, speed: float | None = None
) -> str:
    """Write a project file with a comment on each key.

    A key without a value is written as a comment.

    brush, cell: a shipped name, or a path relative to the file.
    paper: as `--sheet`.
    speed: mm/s.
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


def _read_settings(document: dict, folder: str) -> dict[str, object]:
    from ..choices.choice_checks import check_choices
    from ..choices.choices import Choices

    defaults = document.pop("defaults", {})
    if not isinstance(defaults, dict):
        advice = "write [defaults] on a line by itself, and the options below it"
        raise Error("this is not a table", where="defaults", code="wrong-type", advice=advice)
    choice_by_key = list_default_keys()
    for key in document:
        _refuse_unknown(key, CHOICE_BY_TOP_KEY, choice_by_key, "write it below [defaults]")
    settings = {
        CHOICE_BY_TOP_KEY[key]: read_value(CHOICE_BY_TOP_KEY[key], value, key) for key, value in document.items()
    }
    for key, value in defaults.items():
        _refuse_unknown(key, choice_by_key, CHOICE_BY_TOP_KEY, "write it above [defaults]", "defaults.")
        settings[choice_by_key[key]] = read_value(choice_by_key[key], value, f"defaults.{key}")
    for kind in {"brush", "cell"} & {*settings}:
        settings[kind] = name_or_path(kind, settings[kind], folder)
    check_choices(Choices(**settings))
    return settings


def _refuse_unknown(key: str, known: Mapping, elsewhere: Mapping, advice: str, prefix: str = "") -> None:
    if key in known:
        return
    renamed = {"sheet": "paper", "layer": "layers"}.get(key)
    advice = f"call it {renamed}, above [defaults]" if renamed else advice if key in elsewhere else ""
    nearest = ";" if advice else did_you_mean(key, [*known, *elsewhere])
    listed = "" if advice else f" Known here are {', '.join(known)}"
    sentence = f"a project has no key {prefix}{key[:40]}{nearest}{listed}".removesuffix(";")
    raise Error(sentence, where=prefix + key[:40], code="key-unknown", advice=advice)
