"""Puts the extension for Inkscape where Inkscape looks, and removes it.

The extension is a program of its own under the GPL, so the package does not carry it: it is taken from the source tree
that this package is run from, or from the zip that `make plugins` makes.
"""

from __future__ import annotations

import os
import shutil
import sys
import sysconfig
import zipfile
from pathlib import Path

from ..errors import Error

FOLDER = "brushsvg"
NOTE = "brushsvg-executable.txt"  # read by the extension
_SUFFIXES = (".py", ".inx")
_MAX_UNZIPPED_BYTES = 10_000_000  # bytes; ours has a hundredth of it
SOURCE = Path(__file__).parents[3] / "plugins" / "inkscape"


def install_inkscape(zipped: str | None = None, source: Path = SOURCE) -> Path:
    """Replace the extension, note where this brushsvg is, and return the extension's folder.

    Error when there is nothing to copy, or the folder cannot be written.
    """
    files = _read_zip(zipped) if zipped else _read_tree(source)
    folder = extensions_folder() / FOLDER
    note = own_program()
    try:
        folder.mkdir(parents=True, exist_ok=True)
        for old in folder.iterdir():
            if old.suffix in _SUFFIXES:
                old.unlink()
        for name, data in files.items():
            (folder / name).write_bytes(data)
        (folder / NOTE).write_bytes(os.fsencode(f"{note}\n") if note else b"")
    except OSError as problem:
        raise Error(
            f"cannot be written: {(problem.strerror or str(problem)).lower()}",
            file=str(folder),
            code="file-unwritable",
        ) from None
    return folder


def remove_inkscape() -> Path:
    """Delete the extension, with the note of where brushsvg is; the folder that it was in.

    Error when it is not there, or cannot be deleted. Files of other names stay.
    """
    folder = extensions_folder() / FOLDER
    if not (folder / "brushsvg_program.py").is_file():
        raise Error("the extension is not there", file=str(folder), code="plugin-missing")
    try:
        for path in folder.iterdir():
            if path.suffix in _SUFFIXES or path.name in ("LICENSE", NOTE):
                path.unlink()
        shutil.rmtree(folder / "__pycache__", ignore_errors=True)
        if not any(folder.iterdir()):
            folder.rmdir()
    except OSError as problem:
        raise Error(
            f"cannot be deleted: {(problem.strerror or str(problem)).lower()}",
            file=str(folder),
            code="file-unwritable",
        ) from None
    return folder


def own_program() -> str:
    """Return the running brushsvg executable, or the one next to the running Python, or an empty text."""
    scripts = sysconfig.get_path("scripts")
    for found in (shutil.which(sys.argv[0]), shutil.which("brushsvg", path=scripts)):
        if found and Path(found).stem == "brushsvg":
            return os.path.abspath(found)
    return ""


def extensions_folder() -> Path:
    """Where Inkscape looks for a person's extensions, on this system."""
    if profile := os.environ.get("INKSCAPE_PROFILE_DIR"):
        return Path(profile) / "extensions"
    home = Path.home()
    if sys.platform == "win32":
        data = Path(os.environ.get("APPDATA") or home / "AppData" / "Roaming")
    elif sys.platform == "darwin":
        data = home / "Library" / "Application Support" / "org.inkscape.Inkscape" / "config"
    else:
        data = Path(os.environ.get("XDG_CONFIG_HOME") or home / ".config")
    return data / "inkscape" / "extensions"


def _read_tree(source: Path) -> dict[str, bytes]:
    found = sorted(path for path in source.glob("*") if path.suffix in _SUFFIXES or path.name == "LICENSE")
    if not found:
        raise Error(
            "the extension is not part of this package, its licence being another: give its zip, "
            "brushsvg-inkscape.zip, which `make plugins` makes of the source",
            code="plugin-missing",
        )
    return {path.name: path.read_bytes() for path in found}


def _read_zip(path: str) -> dict[str, bytes]:
    try:
        with zipfile.ZipFile(path) as file:
            inside = [each for each in file.infolist() if not each.is_dir()]
            names = {each.filename: each.filename.rpartition("/")[2] for each in inside}
            known = all(name.endswith(_SUFFIXES) or name == "LICENSE" for name in names.values())
            if not known or "brushsvg_program.py" not in names.values():
                raise Error("this is not the extension's zip", file=path, code="plugin-zip")
            if sum(each.file_size for each in inside) > _MAX_UNZIPPED_BYTES:
                raise Error(
                    f"it holds more than {_MAX_UNZIPPED_BYTES} bytes", file=path, code="file-too-large"
                )
            return {names[each.filename]: file.read(each) for each in inside}
    except OSError as problem:
        raise Error(
            f"the file cannot be read: {(problem.strerror or str(problem)).lower()}",
            file=path,
            code="file-unreadable",
        ) from None
    except (zipfile.BadZipFile, NotImplementedError, RuntimeError):
        raise Error("this is not a zip that can be read", file=path, code="plugin-zip") from None
