"""The manifest of a batch: a line of JSON for each finished drawing.

A line is added once the files of the drawing are written, so a run continues where the last run ended.
"""

from __future__ import annotations

import json
import os
from collections.abc import Sequence
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path

from ...errors import Error, Notice
from ...files import read_bytes, system_reason, write_files
from .items import Item, file_name_key
from .one import Figures, sha256

try:
    import fcntl
except ImportError:  # on Windows, two runs that write to one folder are not detected
    fcntl = None

NAME = "manifest.jsonl"
FORMAT = {"format": "brushsvg/batch", "version": 1}


@dataclass(frozen=True)
class Row:
    """The result for one drawing of a batch.

    name: the name of its files.
    source: the name that a person gave to the drawing, such as a path.
    key: sha256 of everything that the result depends on.
    figures: None for a refused drawing; code, where (the element) and sentence are the reason.
    notices: warnings.
    files: sha256 of each file, by its path below the folder of the batch.
    path: the path of the drawing from the folder of the batch, "" if the drawing is no file.
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
    path: str = ""

    @property
    def text(self) -> str:
        return ": ".join(filter(None, (self.where, self.sentence)))


def format_row(row: Row) -> str:
    return json.dumps(asdict(row), ensure_ascii=False) + "\n"


def _parse_row(line: bytes) -> Row | None:
    """Return the row in a line, or None if a killed run left it incomplete or it is no row."""
    try:
        values = json.loads(line)
        figures = values.pop("figures")
        notices = tuple(Notice(*each.values()) for each in values.pop("notices"))
        row = Row(**values, notices=notices, figures=figures and Figures(**figures))
        texts = [row.name, row.source, row.key, row.path, *row.files, *row.files.values()]
        return row if all(isinstance(each, str) and "\0" not in each for each in texts) else None
    except (ValueError, TypeError, KeyError, AttributeError):
        return None


class Manifest:
    """The manifest of a folder, open and locked while a run writes to it.

    Raises Error if another run is writing to the folder.
    """

    def __init__(self, folder: Path):
        self.folder, self.path = folder, folder / NAME
        self._by_name: dict[str, list[Row]] = {}
        self._by_file: dict[str, list[Row]] = {}
        try:
            self._place = os.path.realpath(folder)
            folder.mkdir(parents=True, exist_ok=True)
            self._file = open(self.path, "ab")  # noqa: SIM115
        except (OSError, ValueError) as problem:
            sentence = f"the folder cannot be written to: {system_reason(problem)}"
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
            header = json.loads(first)
        except ValueError:
            header = None
        if header != FORMAT:
            sentence = f"this is not a manifest of {FORMAT['format']}, version {FORMAT['version']}"
            advice = "delete or rename the file, or give another folder (-o)"
            raise Error(sentence, file=str(self.path), code="format-unknown", advice=advice)
        for row in filter(None, map(_parse_row, lines)):
            self._refuse_outside(row)
            self._by_name.setdefault(row.name, []).append(row)
            for name in row.files:
                self._by_file.setdefault(file_name_key(name), []).append(row)
        if lines and lines[-1]:
            self._add("\n")  # an incomplete line stays a line of its own

    def _refuse_outside(self, row: Row) -> None:
        """Raise Error for a file outside of the folder: a manifest may be another person's, and files get deleted."""
        for name in row.files:
            path = os.path.normpath(os.path.join(self._place, name))
            real_folder = os.path.realpath(os.path.dirname(path))
            if not (self._is_inside(path) and self._is_inside(real_folder)):
                sentence = f"row {row.name}: {name[:200]!r} is outside of the folder"
                advice = "delete the manifest, or give another folder (-o)"
                raise Error(sentence, file=str(self.path), code="path-outside", advice=advice)

    def _is_inside(self, path: str) -> bool:
        return Path(path) == Path(self._place) or Path(self._place) in Path(path).parents

    def _add(self, text: str) -> None:
        self._file.write(text.encode())
        self._file.flush()

    def add(self, row: Row) -> None:
        """Add the row of a drawing whose files are written."""
        self._add(format_row(row))

    def find_finished(self, key: str, item: Item) -> Row | None:
        """Return the row of a finished drawing, or None.

        A drawing is finished if its files are unchanged since they were written. A refused drawing is not finished,
        because the cause may be gone by now, such as a missing font or a full disk.
        """
        for row in self._by_name.get(item.name, []):
            if row.figures and row.key == key and all(map(self._has_file, row.files.items())):
                return replace(row, source=item.source, path=self.make_relative_path(item))
        return None

    def make_relative_path(self, item: Item) -> str:
        """Return the path of a drawing from this folder. The path does not depend on the current folder."""
        try:
            return Path(os.path.relpath(item.path, self._place)).as_posix() if item.path else ""
        except ValueError:  # on Windows, the drawing is on another drive
            return item.path

    def refuse_other_drawing(self, item: Item) -> None:
        """Raise Error where files with this name belong to another drawing. Only drawings that still exist count."""
        path = self.make_relative_path(item)
        for row in self._by_name.get(item.name, []):
            unchanged = [file for file in row.files.items() if self._has_file(file)]
            if unchanged and row.path not in ("", path) and (self.folder / row.path).exists():
                sentence = f"{unchanged[0][0]} was made from {row.source}: {item.source} would replace it"
                raise Error(sentence, file=str(self.folder), code="name-taken", advice="give another folder (-o)")

    def find_other_source(self, item: Item, path: str) -> str:
        """Return the other drawing that an earlier run made this file from.

        Returns "" if there is none, or if that drawing no longer exists.
        """
        for row in self._by_file.get(file_name_key(path), []):
            is_other = row.name != item.name and row.path not in ("", self.make_relative_path(item))
            if is_other and (self.folder / path).exists() and (self.folder / row.path).exists():
                return row.source
        return ""

    def remove_outdated(self, row: Row) -> list[str]:
        """Remove unchanged files of an earlier program of this drawing.

        All files under the name of a refused drawing are removed. For a converted drawing, files of the same
        language that were not written now are removed, such as parts of a longer job.

        Returns the paths of the removed files.
        """
        removed: list[str] = []
        endings = {Path(name).suffix for name in row.files}
        for file in dict.fromkeys(file for each in self._by_name.get(row.name, []) for file in each.files.items()):
            is_outdated = file[0] not in row.files and (not row.figures or Path(file[0]).suffix in endings)
            if is_outdated and self._has_file(file):
                try:
                    (self.folder / file[0]).unlink()
                except OSError as problem:
                    sentence = f"an outdated file cannot be removed: {system_reason(problem)}"
                    raise Error(sentence, file=str(self.folder / file[0]), code="file-unwritable") from None
                removed.append(file[0])
        return removed

    def _has_file(self, file: tuple[str, str]) -> bool:
        try:
            return sha256(read_bytes(self.folder / file[0])) == file[1]
        except Error:
            return False

    def finish(self, rows: Sequence[Row]) -> None:
        """Rewrite the manifest: the rows of this batch, then rows of other drawings.

        The rows of this batch are in the order of the batch. The last row of each other name is kept if its files
        or its drawing still exist. Another batch into this folder can then continue, and no other drawing takes its
        names.
        """
        own_names = {row.name for row in rows}
        others = [rows_of_name[-1] for name, rows_of_name in self._by_name.items() if name not in own_names]
        kept = [row for row in others if self._still_exists(row)]
        write_files({self.path: "".join([json.dumps(FORMAT) + "\n", *map(format_row, [*rows, *kept])])})

    def _still_exists(self, row: Row) -> bool:
        names = row.files or ([row.path] if row.path else [])
        # Path.exists would raise for a name in a damaged manifest that is too long for a file.
        return any(os.path.exists(self.folder / name) for name in names)

    def close(self) -> None:
        self._file.close()


def make_path_below(folder: Path, name: str) -> str:
    """Return the path of a file below a folder, and make the folder of the file."""
    path = folder / name
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
    except OSError as problem:
        sentence = f"the folder cannot be made: {system_reason(problem)}"
        raise Error(sentence, file=str(path.parent), code="file-unwritable") from None
    return os.fspath(path)
