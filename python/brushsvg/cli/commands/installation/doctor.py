"""brushsvg doctor: list what is installed, and what is missing."""

from __future__ import annotations

import os
import platform
import re
import shutil
import subprocess
import sys
from collections.abc import Iterator
from importlib import metadata
from pathlib import Path

from ....errors import Notice, command_to_add
from ...console import RefusedError, print_text
from ...install_plugin import FOLDER, NOTE, SOURCE, extensions_folder, own_program
from ..drawings.text import SINGLE_LINE_FONTS

PURPOSE = {  # the purpose of each extra that a user may want
    "text": "text in TrueType and OpenType fonts",
    "plot": "pictures of brush laws, pages as PDF",
    "arm": "the joints of robot arms",
    "cluster": "batch on several computers",
    "parquet": "the table of batch as Parquet",
    "completion": "commands completed by the shell",
}
_MAX_INKSCAPE_WAIT_S = 20  # seconds to wait for the version of Inkscape: a Snap starts slowly the first time


def list_installation(args) -> None:
    """Print the list of installed and missing parts.

    Raises RefusedError if a library is missing that brushsvg needs.
    """
    needed, extras = _read_requirements()
    problems = {package: _find_version_problem(package, minimum) for package, minimum in needed.items()}
    unusable = {package: problem for package, problem in problems.items() if problem}
    sections = {
        "Program": _list_program(),
        "Libraries": ((package, problems[package] or metadata.version(package)) for package in needed),
        "Extras": _list_extras(extras),
        "Fonts": _list_fonts(),
        "Inkscape": _list_inkscape(),
    }
    for title, rows in sections.items():
        print_text(f"{title}\n" + "".join(f"  {name:<23} {description}\n" for name, description in rows))
    if unusable:
        description = ", ".join(f"{package} {problem}" for package, problem in unusable.items())
        why = Notice("", f"{description}: install with  {command_to_add(*unusable)}", code="package-missing")
        raise RefusedError("", [why])


def _list_program() -> Iterator[tuple[str, str]]:
    yield "brushsvg", f"{metadata.version('brushsvg')}  {own_program() or Path(__file__).parents[3]}"
    yield "Python", f"{platform.python_version()}  {sys.executable}"
    yield "System", f"{platform.platform()}, {os.cpu_count()} processors"


def _read_requirements() -> tuple[dict[str, str], dict[str, dict[str, str]]]:
    """Return packages with their minimum versions: those always needed, and those of each extra in PURPOSE."""
    needed: dict[str, str] = {}
    extras: dict[str, dict[str, str]] = {name: {} for name in PURPOSE}
    for line in metadata.requires("brushsvg") or []:
        match = re.match(r"([\w.-]+)\s*>=([\d.]+)(?:\s*;.*extra == [\"'](\w+)[\"'])?", line)
        if match and match[3] in extras:
            extras[match[3]][match[1]] = match[2]
        elif match and not match[3]:
            needed[match[1]] = match[2]
    return needed, extras


def _find_version_problem(package: str, minimum: str) -> str:
    try:
        installed = metadata.version(package)
    except metadata.PackageNotFoundError:
        return "is missing"
    return f"{installed} is older than {minimum}" if _parse_version(installed) < _parse_version(minimum) else ""


def _parse_version(version: str) -> list[int]:
    return [int(number) for number in re.findall(r"\d+", version.partition("+")[0])[:3]]


def _list_extras(extras: dict[str, dict[str, str]]) -> Iterator[tuple[str, str]]:
    for name, packages in extras.items():
        missing = [package for package, minimum in packages.items() if _find_version_problem(package, minimum)]
        if missing:
            yield name, f"missing, for {PURPOSE[name]}. Add it with  {command_to_add(*missing)}"
        else:
            versions = ", ".join(f"{package} {metadata.version(package)}" for package in packages)
            yield name, f"{versions}  ({PURPOSE[name]})"


def _list_fonts() -> Iterator[tuple[str, str]]:
    font_names = sorted(path.stem for path in SINGLE_LINE_FONTS.glob("*.svg"))
    if font_names:
        yield "single-line fonts", f"{len(font_names)} in {SINGLE_LINE_FONTS}, such as {font_names[0]}"
    else:
        yield (
            "single-line fonts",
            f"none in {SINGLE_LINE_FONTS}: install Inkscape, or give a font file to `text`",
        )


def _list_inkscape() -> Iterator[tuple[str, str]]:
    program = shutil.which("inkscape")
    if program is None:
        yield "program", "not on PATH; only the live preview and *Save as robot program* need it"
    else:
        yield "program", f"{_read_inkscape_version(program)}  {program}"
        if kind := find_sandbox(program):
            yield "sandbox", f"{kind} Inkscape cannot start programs outside: see docs/howto/inkscape.md"
    folder = extensions_folder() / FOLDER
    if not (folder / "brushsvg_program.py").is_file():
        # A wheel does not contain the extension.
        zip_argument = "" if SOURCE.is_dir() else " brushsvg-inkscape.zip"
        yield "extension", f"not installed. Add it with  brushsvg setup inkscape{zip_argument}"
        return
    note = folder / NOTE
    noted_program = os.fsdecode(note.read_bytes()).strip() if note.is_file() else ""
    state = (
        ""
        if not noted_program or shutil.which(noted_program)
        else ", which is no longer there: install the extension again"
    )
    yield "extension", f"{folder}" + (f", runs {noted_program}{state}" if noted_program else "")


def find_sandbox(program: str) -> str:
    """Return "a Snap's" or "a Flatpak's" by the path of the program, otherwise ""."""
    real = os.path.realpath(program)
    if program.startswith("/snap/") or real.startswith("/snap/") or os.path.basename(real) == "snap":
        return "a Snap's"
    return "a Flatpak's" if "/flatpak/" in real else ""


def _read_inkscape_version(program: str) -> str:
    try:
        process = subprocess.run(
            [program, "--version"],
            capture_output=True,
            text=True,
            timeout=_MAX_INKSCAPE_WAIT_S,
            stdin=subprocess.DEVNULL,
        )
    except (OSError, subprocess.TimeoutExpired, UnicodeDecodeError):
        return "does not start"
    match = re.search(r"Inkscape \S+", process.stdout)
    return match[0] if match else "does not say its version"
