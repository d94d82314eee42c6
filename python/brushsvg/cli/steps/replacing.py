"""Which files a command may replace: programs and pictures that brushsvg wrote and nobody changed since.

What it wrote is remembered in a file of the user's own, a line of two hashes for each path. A mark inside the outputs
would change the bytes of programs, which must be the same for the same input, and most formats of pictures have no
place for one; a file next to each output would litter folders. Where nothing is remembered, for example about
files copied from another machine, a file counts as somebody's own.
"""

from __future__ import annotations

import hashlib
import os
import sys
from collections.abc import Collection, Iterable
from contextlib import suppress
from pathlib import Path

from ...errors import Error, Notice
from ...files import read_bytes, write_files
from ..console import RefusedError

MAX_RECORD_BYTES = 4_000_000  # of what is remembered: some 30,000 files; of more, the older half is forgotten


def refuse_replacing(paths: Iterable[str], sources: Collection[str] = (), force: bool = False) -> None:
    """Refuse to replace a file that may be somebody's own. sources: paths of brushes, cells, corrections and drawings,
    which are never replaced without force; others may be, as they were written."""
    if force:
        return
    known: dict[str, str] | None = None
    for path in paths:
        if not os.path.isfile(path):
            continue
        known = _read_record() if known is None else known
        if path in sources:
            sentence = "the file is there already, and might be somebody's own"
        elif _hash_path(path) not in known:
            sentence = f"the file is there already, and brushsvg does not know that it wrote it{_explain_unwritable()}"
        elif known[_hash_path(path)] != _hash_content(path):
            sentence = "the file is there already, and was changed since brushsvg wrote it"
        else:
            continue
        advice = "give another name, or --force to replace it"
        raise RefusedError(path, [Notice("", sentence, code="file-exists", advice=advice)])


def record_written(paths: Iterable[str]) -> None:
    """That these files are as brushsvg wrote them. Where that cannot be written, they count as somebody's own later."""
    lines = [f"{_hash_path(path)} {_hash_content(path)}\n" for path in paths if os.path.isfile(path)]
    with suppress(OSError, Error, RuntimeError):  # RuntimeError: nobody's home
        place = _find_record_path()
        place.parent.mkdir(parents=True, exist_ok=True)
        with open(place, "a", encoding="ascii") as file:
            file.write("".join(lines))  # short: whole also where others write at the same time
        if place.stat().st_size > MAX_RECORD_BYTES:
            kept = place.read_text("ascii").splitlines(keepends=True)
            write_files({place: "".join(kept[len(kept) // 2 :])})


def _find_record_path() -> Path:
    if os.environ.get("XDG_STATE_HOME"):
        return Path(os.environ["XDG_STATE_HOME"], "brushsvg", "written.txt")
    if sys.platform == "win32" and os.environ.get("LOCALAPPDATA"):
        return Path(os.environ["LOCALAPPDATA"], "brushsvg", "written.txt")
    return Path.home() / ".local" / "state" / "brushsvg" / "written.txt"


def _explain_unwritable() -> str:
    """Why nothing is remembered, if nothing can be: in a container, for example, whose home cannot be written."""
    with suppress(RuntimeError):
        place = _find_record_path()
        there = next(folder for folder in place.parents if folder.exists())
        if not os.access(there, os.W_OK) or (place.exists() and not os.access(place, os.W_OK)):
            return f": {place}, where brushsvg keeps this, cannot be written"
    return ""


def _read_record() -> dict[str, str]:
    """The hash of its content by that of its path, the last one of each."""
    with suppress(OSError, ValueError, RuntimeError):
        lines = [line.split() for line in _find_record_path().read_text("ascii").splitlines()]
        return dict(line for line in lines if len(line) == 2)
    return {}


def _hash_path(path: str) -> str:
    return hashlib.sha256(os.fsencode(os.path.realpath(path))).hexdigest()


def _hash_content(path: str) -> str:
    """Of a file's content; "" of one that cannot be read."""
    try:
        return hashlib.sha256(read_bytes(path)).hexdigest()
    except Error:
        return ""
