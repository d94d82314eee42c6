"""What of a batch is done: a line of JSON for each drawing, added when its files lie there, so that a run goes on where
the last one ended."""

from __future__ import annotations

import json
import os
from collections.abc import Iterable
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path

from ..errors import Error, Notice
from ..files import read_bytes, reason, write_files
from .one import Figures, sha256

try:
    import fcntl
except ImportError:  # Windows: there nobody sees that two runs write to one folder
    fcntl = None

NAME = "manifest.jsonl"
FORMAT = {"format": "brushsvg/batch", "version": 1}


@dataclass(frozen=True)
class Row:
    """One drawing of a batch.

    name: of its files; source: what a person calls it; figures: None where it was refused, for the reason in code,
    where (the element) and sentence; notices: warnings; files: path below the batch's folder to sha256; key: sha256 of
    all that it depends on.
    """

    name: str
    source: str
    key: str
    figures: Figures | None = None
    code: str = ""
    where: str = ""
    sentence: str = ""
    notices: tuple[Notice, ...] = ()
    files: dict[str, str] = field(default_factory=dict)

    @property
    def told(self) -> str:
        return ": ".join(filter(None, (self.where, self.sentence)))


def as_line(row: Row) -> str:
    return json.dumps(asdict(row), ensure_ascii=False) + "\n"


def _row(line: bytes) -> Row | None:
    """None for a line that a killed run left half."""
    try:
        said = json.loads(line)
        figures = said.pop("figures")
        notices = tuple(Notice(*each.values()) for each in said.pop("notices"))
        return Row(**said, notices=notices, figures=figures and Figures(**figures))
    except (ValueError, TypeError, KeyError, AttributeError):
        return None


class Manifest:
    """The manifest of a folder, open and locked while a run writes to it. Error where another one does."""

    def __init__(self, folder: Path):
        self.folder, self.path = folder, folder / NAME
        self.rows: dict[str, Row] = {}
        try:
            folder.mkdir(parents=True, exist_ok=True)
            self._file = open(self.path, "ab")  # noqa: SIM115
        except (OSError, ValueError) as problem:
            sentence = f"the folder cannot be written to: {reason(problem)}"
            raise Error(sentence, file=str(folder), code="file-unwritable") from None
        if fcntl:
            try:
                fcntl.flock(self._file, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except OSError:
                self._file.close()
                sentence = "another run is writing to this folder"
                raise Error(sentence, file=str(folder), code="file-unwritable") from None
        try:
            self._read()
        except BaseException:
            self._file.close()
            raise

    def _read(self) -> None:
        first, *lines = read_bytes(self.path).split(b"\n")
        if not first:
            self._add(json.dumps(FORMAT) + "\n")
            return
        try:
            said = json.loads(first)
        except ValueError:
            said = None
        if said != FORMAT:
            sentence = f"this is not a manifest of {FORMAT['format']}, version {FORMAT['version']}"
            raise Error(sentence, file=str(self.path), code="format-unknown")
        self.rows = {row.key: row for row in map(_row, lines) if row}
        if lines and lines[-1]:
            self._add("\n")  # what was left half stays a line of its own

    def _add(self, text: str) -> None:
        self._file.write(text.encode())
        self._file.flush()

    def add(self, row: Row) -> None:
        """After its files were written."""
        self._add(as_line(row))

    def done(self, key: str, name: str, source: str) -> Row | None:
        """The row of what is done already and lies there as it was written."""
        row = self.rows.get(key)
        if row is None or row.name != name or not all(map(self._lies_there, row.files.items())):
            return None
        return replace(row, source=source)

    def _lies_there(self, file: tuple[str, str]) -> bool:
        try:
            return sha256(read_bytes(self.folder / file[0])) == file[1]
        except Error:
            return False

    def finish(self, rows: Iterable[Row]) -> None:
        """The rows of the whole batch in its order, and no others."""
        write_files({self.path: "".join([json.dumps(FORMAT) + "\n", *map(as_line, rows)])})

    def close(self) -> None:
        self._file.close()


def below(folder: Path, name: str) -> str:
    """Where a file lies, for the writer of files; its folder is made."""
    path = folder / name
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
    except OSError as problem:
        sentence = f"the folder cannot be made: {reason(problem)}"
        raise Error(sentence, file=str(path.parent), code="file-unwritable") from None
    return os.fspath(path)
