"""Decide which files a command may replace.

Programs and pictures may be replaced if brushsvg wrote them and nobody changed them since.

Written files are recorded in a file of the user, with a line of two hashes for each path. A mark inside the outputs
would change the bytes of programs, which must be the same for the same input. Most picture formats have no place
for a mark, and a file next to each output would litter folders. A file without a record, such as one copied from
another machine, counts as a file of somebody else.
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

# The largest size of the record: some 30,000 files. If it is larger, the older half is dropped.
MAX_RECORD_BYTES = 4_000_000


def refuse_replacing(paths: Iterable[str], sources: Collection[str] = (), force: bool = False) -> None:
    """Refuse to replace a file that brushsvg did not write.

    sources: paths of brushes, cells, corrections and drawings. They are never replaced without force; other files
        may be replaced if they are unchanged.
    """
    if force:
        return
    recorded: dict[str, str] | None = None
    for path in paths:
        if not os.path.isfile(path):
            continue
        recorded = _read_record() if recorded is None else recorded
        if path in sources:
            sentence = "the file already exists, and may not be from brushsvg"
        elif _hash_path(path) not in recorded:
            sentence = f"the file already exists, and brushsvg has no record of writing it{_explain_unwritable()}"
        elif recorded[_hash_path(path)] != _hash_content(path):
            sentence = "the file already exists, and was changed after brushsvg wrote it"
        else:
            continue
        advice = "give another name, or --force to replace it"
        raise RefusedError(path, [Notice("", sentence, code="file-exists", advice=advice)])


def record_written(paths: Iterable[str]) -> None:
    """Record that these files are as brushsvg wrote them.

    If the record cannot be written, the files later count as files of somebody else.
    """
    lines = [f"{_hash_path(path)} {_hash_content(path)}\n" for path in paths if os.path.isfile(path)]
    with suppress(OSError, Error, RuntimeError):  # RuntimeError: there is no home folder
        record_path = _find_record_path()
        record_path.parent.mkdir(parents=True, exist_ok=True)
        with open(record_path, "a", encoding="ascii") as file:
            # The text is short, so it stays whole if other processes write at the same time.
            file.write("".join(lines))
        if record_path.stat().st_size > MAX_RECORD_BYTES:
            kept_lines = record_path.read_text("ascii").splitlines(keepends=True)
            write_files({record_path: "".join(kept_lines[len(kept_lines) // 2 :])})


def _find_record_path() -> Path:
    if os.environ.get("XDG_STATE_HOME"):
        return Path(os.environ["XDG_STATE_HOME"], "brushsvg", "written.txt")
    if sys.platform == "win32" and os.environ.get("LOCALAPPDATA"):
        return Path(os.environ["LOCALAPPDATA"], "brushsvg", "written.txt")
    return Path.home() / ".local" / "state" / "brushsvg" / "written.txt"


def _explain_unwritable() -> str:
    """Return why nothing can be recorded, or ""; a container's home folder may not be writable."""
    with suppress(RuntimeError):
        record_path = _find_record_path()
        existing_folder = next(folder for folder in record_path.parents if folder.exists())
        if not os.access(existing_folder, os.W_OK) or (record_path.exists() and not os.access(record_path, os.W_OK)):
            return f": {record_path}, where brushsvg keeps this, cannot be written"
    return ""


def _read_record() -> dict[str, str]:
    """Return the last recorded content hash of each file, by the hash of its path."""
    with suppress(OSError, ValueError, RuntimeError):
        lines = [line.split() for line in _find_record_path().read_text("ascii").splitlines()]
        return dict(line for line in lines if len(line) == 2)
    return {}


def _hash_path(path: str) -> str:
    return hashlib.sha256(os.fsencode(os.path.realpath(path))).hexdigest()


def _hash_content(path: str) -> str:
    """Return the sha256 of a file, or "" if the file cannot be read."""
    try:
        return hashlib.sha256(read_bytes(path)).hexdigest()
    except Error:
        return ""
