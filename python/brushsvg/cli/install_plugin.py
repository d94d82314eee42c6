"""Install the extension where Inkscape looks for it, and remove it.

The extension is a separate program under the GPL, so this package does not contain it. It comes from the source
tree that this package runs from, or from the zip that `make plugins` makes.
"""

from __future__ import annotations

import os
import shutil
import sys
import sysconfig
import zipfile
import zlib
from pathlib import Path

from ..errors import Error

FOLDER = "brushsvg"
NOTE = "brushsvg-executable.txt"  # read by the extension
_SUFFIXES = (".py", ".inx")
_MAX_UNZIPPED_BYTES = 10_000_000  # bytes; the extension has about a hundredth of this
SOURCE = Path(__file__).parents[3] / "plugins" / "inkscape"


def install_inkscape(zipped: str | None = None, source: Path = SOURCE) -> Path:
    """Replace the extension, note where this brushsvg is, and return its folder.

    Raises Error if there is nothing to copy, or if the folder cannot be written.
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
        sentence = f"cannot be written: {(problem.strerror or str(problem)).lower()}"
        raise Error(sentence, file=str(folder), code="file-unwritable") from None
    return folder


def remove_inkscape() -> Path:
    """Delete the extension and its note on brushsvg, and return its folder.

    Raises Error if it is not there, or if it cannot be deleted. Other files in the folder stay.
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
        sentence = f"cannot be deleted: {(problem.strerror or str(problem)).lower()}"
        raise Error(sentence, file=str(folder), code="file-unwritable") from None
    return folder


def own_program() -> str:
    """Return the path of the running brushsvg, or "".

    If another program is running, the brushsvg next to the running Python is returned, if there is one.
    """
    scripts = sysconfig.get_path("scripts")
    for candidate in (shutil.which(sys.argv[0]), shutil.which("brushsvg", path=scripts)):
        if candidate and Path(candidate).stem == "brushsvg":
            return os.path.abspath(candidate)
    return ""


def extensions_folder() -> Path:
    """Return the folder of the user's Inkscape extensions on this system."""
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
    paths = sorted(path for path in source.glob("*") if path.suffix in _SUFFIXES or path.name == "LICENSE")
    if not paths:
        raise Error(
            "the extension has another licence and is not part of this package: give its zip, "
            "brushsvg-inkscape.zip, which `make plugins` builds from the source",
            code="plugin-missing",
        )
    return {path.name: path.read_bytes() for path in paths}


def _read_zip(path: str) -> dict[str, bytes]:
    try:
        with zipfile.ZipFile(path) as file:
            members = [each for each in file.infolist() if not each.is_dir()]
            names = {each.filename: each.filename.rpartition("/")[2] for each in members}
            are_known = all(name.endswith(_SUFFIXES) or name == "LICENSE" for name in names.values())
            if not are_known or "brushsvg_program.py" not in names.values():
                raise Error("this is not the extension's zip", file=path, code="plugin-zip")
            if sum(each.file_size for each in members) > _MAX_UNZIPPED_BYTES:
                raise Error(f"it holds more than {_MAX_UNZIPPED_BYTES} bytes", file=path, code="file-too-large")
            return {names[each.filename]: file.read(each) for each in members}
    except OSError as problem:
        sentence = f"the file cannot be read: {(problem.strerror or str(problem)).lower()}"
        raise Error(sentence, file=path, code="file-unreadable") from None
    except (zipfile.BadZipFile, zlib.error, EOFError, NotImplementedError, RuntimeError):
        raise Error("this is not a zip that can be read", file=path, code="plugin-zip") from None
