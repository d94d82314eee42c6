"""The finished part of a batch: a line of JSON for each drawing, added when its files are written: a run continues
where the last one ended."""

from __future__ import annotations

import json
import os
from collections.abc import Sequence
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path

from ...errors import Error, Notice
from ...files import read_bytes, reason, write_files
from .items import Item, file_name_key
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
    all that it depends on; path: of the drawing, from the batch's folder, "" where it is no file.
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
    """None for a line that a killed run left half, and for one that is no row."""
    try:
        said = json.loads(line)
        figures = said.pop("figures")
        notices = tuple(Notice(*each.values()) for each in said.pop("notices"))
        row = Row(**said, notices=notices, figures=figures and Figures(**figures))
        texts = [row.name, row.source, row.key, row.path, *row.files, *row.files.values()]
        return row if all(isinstance(each, str) and "\0" not in each for each in texts) else None
    except (ValueError, TypeError, KeyError, AttributeError):
        return None


class Manifest:
    """The manifest of a folder, open and locked while a run writes to it. Error where another one does."""

    def __init__(self, folder: Path):
        self.folder, self.path = folder, folder / NAME
        self._by_name: dict[str, list[Row]] = {}
        self._by_file: dict[str, list[Row]] = {}
        try:
            self._place = os.path.realpath(folder)
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
        for row in filter(None, map(_parse_row, lines)):
            self._refuse_outside(row)
            self._by_name.setdefault(row.name, []).append(row)
            for name in row.files:
                self._by_file.setdefault(file_name_key(name), []).append(row)
        if lines and lines[-1]:
            self._add("\n")  # what was left half stays a line of its own

    def _refuse_outside(self, row: Row) -> None:
        """Error for a file outside of the folder: outdated files are deleted, and a manifest may be anybody's."""
        for name in row.files:
            way = os.path.normpath(os.path.join(self._place, name))
            real = os.path.realpath(os.path.dirname(way))
            if not (self._is_inside(way) and self._is_inside(real)):
                sentence = f"row {row.name}: {name[:200]!r} is outside of the folder"
                advice = "delete the manifest, or give another folder (-o)"
                raise Error(sentence, file=str(self.path), code="path-outside", advice=advice)

    def _is_inside(self, path: str) -> bool:
        return Path(path) == Path(self._place) or Path(self._place) in Path(path).parents

    def _add(self, text: str) -> None:
        self._file.write(text.encode())
        self._file.flush()

    def add(self, row: Row) -> None:
        """After its files were written."""
        self._add(format_row(row))

    def done(self, key: str, item: Item) -> Row | None:
        """Return the row of a drawing whose files are there as they were written. A refused drawing is not finished:
        its cause may be gone, as a missing font or a full disk."""
        for row in self._by_name.get(item.name, []):
            if row.figures and row.key == key and all(map(self._has_file, row.files.items())):
                return replace(row, source=item.source, path=self.way_to(item))
        return None

    def way_to(self, item: Item) -> str:
        """Return the path of the drawing, from this folder: the same from any current folder."""
        try:
            return Path(os.path.relpath(item.path, self._place)).as_posix() if item.path else ""
        except ValueError:  # Windows: another drive
            return item.path

    def refuse_other_drawing(self, item: Item) -> None:
        """Raise Error where files with this name were made of another drawing that still exists."""
        path = self.way_to(item)
        for row in self._by_name.get(item.name, []):
            here = [file for file in row.files.items() if self._has_file(file)]
            if here and row.path not in ("", path) and (self.folder / row.path).exists():
                sentence = (
                    f"{here[0][0]} was made of {row.source}: that of {item.source} would be written over it"
                )
                raise Error(
                    sentence, file=str(self.folder), code="name-taken", advice="give another folder (-o)"
                )

    def other_source(self, item: Item, path: str) -> str:
        """The other drawing, still there, that an earlier run made this file of; "" where there is none."""
        for row in self._by_file.get(file_name_key(path), []):
            is_other = row.name != item.name and row.path not in ("", self.way_to(item))
            if is_other and (self.folder / path).exists() and (self.folder / row.path).exists():
                return row.source
        return ""

    def remove_outdated(self, row: Row) -> list[str]:
        """Files of an earlier program of this drawing, as they were written, are removed: their paths.

        All that were made under the name of what is refused. Of what is done those of the same language that are not
        written now, such as parts of a longer job.
        """
        removed: list[str] = []
        endings = {Path(name).suffix for name in row.files}
        for file in dict.fromkeys(
            file for each in self._by_name.get(row.name, []) for file in each.files.items()
        ):
            is_outdated = file[0] not in row.files and (not row.figures or Path(file[0]).suffix in endings)
            if is_outdated and self._has_file(file):
                try:
                    (self.folder / file[0]).unlink()
                except OSError as problem:
                    sentence = f"an outdated file cannot be removed: {reason(problem)}"
                    raise Error(sentence, file=str(self.folder / file[0]), code="file-unwritable") from None
                removed.append(file[0])
        return removed

    def _has_file(self, file: tuple[str, str]) -> bool:
        try:
            return sha256(read_bytes(self.folder / file[0])) == file[1]
        except Error:
            return False

    def finish(self, rows: Sequence[Row]) -> None:
        """The rows of the whole batch in its order, then the last of each other name whose files or whose drawing still
        exist: another batch into this folder goes on where it ended, and no other drawing takes its names."""
        ours = {row.name for row in rows}
        others = [each[-1] for name, each in self._by_name.items() if name not in ours]
        kept = [row for row in others if self._is_there(row)]
        write_files({self.path: "".join([json.dumps(FORMAT) + "\n", *map(format_row, [*rows, *kept])])})

    def _is_there(self, row: Row) -> bool:
        names = row.files or ([row.path] if row.path else [])
        # not Path.exists, which raises for a name of a damaged file that is longer than names can be
        return any(os.path.exists(self.folder / name) for name in names)

    def close(self) -> None:
        self._file.close()


def make_path_below(folder: Path, name: str) -> str:
    """Return the path of a file, for the writer of files; its folder is made."""
    path = folder / name
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
    except OSError as problem:
        sentence = f"the folder cannot be made: {reason(problem)}"
        raise Error(sentence, file=str(path.parent), code="file-unwritable") from None
    return os.fspath(path)
