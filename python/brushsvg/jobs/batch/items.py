"""The drawings of a batch, from files, folders, lists and texts.

Each drawing has a name of its own.
"""

from __future__ import annotations

import glob
import hashlib
import json
import os
import unicodedata
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path

from ...errors import Error, require_type
from ...files import read_bytes, system_reason
from ...read import READERS, InMemory
from ...read.text import text_svg

# G-code is read only by its path, because folders hold programs as well.
FOLDER_SUFFIXES = (".svg", ".svgz", ".dxf")
LIST_SUFFIX = ".txt"
MAX_NAME_LETTERS = 60  # letters of a word that are used in the names of its files


@dataclass(frozen=True)
class Item:
    """One drawing.

    name: the name of its files, without extension, below the folder of the batch.
    source: the name that a person gave to the drawing, such as a path.
    digest: hash of everything that the drawing depends on; "" if it cannot be read, in which case `read` raises the
        error.
    read: reads the drawing when it is converted.
    path: the absolute path, "" if the drawing is no file.
    """

    name: str
    source: str
    digest: str
    read: Callable[[], InMemory]
    path: str = ""


def list_drawings(operands: Iterable[str | os.PathLike[str]], open_lists: tuple[str, ...] = ()) -> list[Item]:
    """List the drawings of files, folders, patterns and lists, in that order.

    A folder stands for all SVG and DXF files below it, also in linked folders. A pattern has * ? or []. A list
    (.txt) has a path on each line, from the folder of the list. Error if an operand matches nothing.

    open_lists: the lists that these operands are read from, which must not be read again.
    """
    items = []
    for operand in map(os.fspath, operands):
        if os.path.isdir(operand):
            items += [
                _make_drawing_item(path, path.relative_to(operand)) for path in _find_drawings_below(Path(operand))
            ]
        elif Path(operand).suffix.lower() == LIST_SUFFIX:
            real_path = os.path.realpath(operand)
            if real_path in open_lists:
                sentence = "this list contains itself, directly or in another list"
                raise Error(sentence, file=operand, code="file-unreadable", advice="remove its name from the list")
            items += list_drawings(_read_list(operand), (*open_lists, real_path))
        elif os.path.exists(operand) or not glob.has_magic(operand):
            items.append(_make_drawing_item(Path(operand), Path(Path(operand).name)))
        else:
            matches = [Path(path) for path in sorted(glob.glob(operand, recursive=True)) if os.path.isfile(path)]
            matching_drawings = [path for path in matches if path.suffix.lower() in READERS]
            items += [_make_drawing_item(path, Path(path.name)) for path in matching_drawings]
            if not matching_drawings:
                raise Error("no drawing matches this pattern", file=operand, code="file-unreadable")
    return items


def _find_drawings_below(folder: Path) -> list[Path]:
    """Find the drawings of a folder, its subfolders and linked folders, each folder once."""
    paths, folders, visited = [], [folder], set()
    while folders:
        current_folder = folders.pop()
        if os.path.realpath(current_folder) in visited:
            continue
        visited.add(os.path.realpath(current_folder))
        try:
            entries = sorted(current_folder.iterdir())
        except OSError as problem:
            sentence = f"the folder cannot be read: {system_reason(problem)}"
            raise Error(sentence, file=str(current_folder), code="file-unreadable") from None
        for path in entries:
            if path.is_dir():  # links come last, so that a folder has its own name rather than that of a link
                folders.insert(0 if path.is_symlink() else len(folders), path)
            elif path.suffix.lower() in FOLDER_SUFFIXES and (path.is_file() or path.is_symlink()):
                paths.append(path)  # a link to a file that does not exist becomes a refused row
    if not paths:
        sentence = f"no drawing is in this folder; looked for {', '.join(FOLDER_SUFFIXES)}"
        raise Error(sentence, file=str(folder), code="file-unreadable")
    return sorted(paths)


def _read_list(path: str) -> list[str]:
    lines = _read_lines(path)
    return [os.path.join(os.path.dirname(path), line) for line in lines]


def _read_lines(path: str | os.PathLike[str]) -> list[str]:
    """Read the lines of a text file that are not blank, without surrounding blanks."""
    try:
        lines = [line.strip() for line in read_bytes(path).decode("utf-8-sig").splitlines()]
    except UnicodeDecodeError:
        raise Error("the list is not text in UTF-8", file=os.fspath(path), code="not-text") from None
    if not any(lines):
        raise Error("the list is empty", file=os.fspath(path), code="file-empty")
    return [line for line in lines if line]


def _make_drawing_item(path: Path, name: Path) -> Item:
    stem = name.with_suffix("").as_posix() if name.name else ""
    if not stem.isprintable():
        return _make_refused_item(_escape_unprintable(stem), _escape_unprintable(str(path)))

    def read() -> InMemory:
        extension = path.suffix.lower()
        if extension not in READERS and (extension or path.exists()):
            known_formats = ", ".join(READERS)
            sentence = f"{extension or 'no extension'} is not a drawing format that is read; known: {known_formats}"
            raise Error(sentence, file=str(path), code="drawing-format")
        return InMemory(extension, read_bytes(path))

    try:
        digest = hashlib.sha256(f"{path.suffix.lower()}\n".encode() + read_bytes(path)).hexdigest()
    except Error:
        digest = ""
    return Item(stem, str(path), digest, read, os.path.realpath(path))


def _make_refused_item(name: str, source: str) -> Item:
    """Make an item that is refused when it is read, as no file can have its name."""

    def read() -> InMemory:
        sentence = f"{name[:60]} cannot be the name of a file: it has characters that cannot be printed"
        raise Error(sentence, code="name-invalid", advice="rename the drawing")

    return Item(name, source, "", read)


def _escape_unprintable(text: str) -> str:
    """Escape characters that cannot be printed, such as line ends, as Python does."""
    return "".join(
        each if each.isprintable() else each.encode("unicode_escape", "surrogatepass").decode() for each in text
    )


def list_words(
    path: str | os.PathLike[str],
    font: bytes,
    size_mm: float = 20.0,
    sheet_mm: tuple[float, float] | None = None,
) -> list[Item]:
    """Make a drawing of each line of a text file, as `brushsvg text` does.

    Each drawing is named after its letters. In a line, \\n starts a new line of text.
    """
    lines = _read_lines(path)
    _check_font(lines[0], font, size_mm, sheet_mm)
    settings = [hashlib.sha256(font).hexdigest(), size_mm, sheet_mm]

    def item(line: str, name: str) -> Item:
        text = line.replace("\\n", "\n")

        def read() -> InMemory:
            document, notices = text_svg(text, font, size_mm=size_mm, sheet_mm=sheet_mm)
            for notice in notices:  # nobody inspects each word, so a word with a missing letter is refused
                if notice.where == "font":  # only says what kind of font it is
                    continue
                raise Error(notice.sentence, notice.where, code=notice.code)
            return InMemory(".svg", document.encode())

        content = json.dumps([text, *settings]).encode()
        return Item(name, line, hashlib.sha256(content).hexdigest(), read)

    names: dict[str, int] = {}
    items = []
    for line in lines:
        name = "".join(each if _is_name_letter(each) else "_" for each in line)[:MAX_NAME_LETTERS]
        count = names[file_name_key(name)] = names.get(file_name_key(name), 0) + 1
        items.append(item(line, name if count == 1 else f"{name}~{count}"))
    return items


def _check_font(line: str, font: bytes, size_mm: float, sheet_mm) -> None:
    """Raise Error for a problem that concerns all words, not only this line."""
    try:
        text_svg(line, font, size_mm=size_mm, sheet_mm=sheet_mm)
    except Error as refusal:
        if refusal.where != "text":
            raise


def _is_name_letter(letter: str) -> bool:
    return letter in "-" or unicodedata.category(letter)[0] in "LMN"


def make_items(items: Iterable) -> list[Item]:
    """Make items of paths, of pairs of a name and an SVG document, and of Items.

    The document is text or bytes. An Item is returned as it is.
    """
    result = []
    for each in items:
        if isinstance(each, Item):
            result.append(each)
        elif isinstance(each, str | os.PathLike):
            result += list_drawings([each])
        else:
            require_type(each, tuple, "a path, or a pair of a name and an SVG document")
            if len(each) != 2 or not isinstance(each[0], str) or not isinstance(each[1], str | bytes):
                raise Error("a pair is a name and an SVG document as text or bytes", code="wrong-type")
            result.append(_make_memory_item(*each))
    _check_names(result)
    return result


def _make_memory_item(name: str, document: str | bytes) -> Item:
    data = document.encode() if isinstance(document, str) else document
    return Item(name, name, hashlib.sha256(b".svg\n" + data).hexdigest(), lambda: InMemory(".svg", data))


def _check_names(items: list[Item]) -> None:
    """Raise Error if two items have one place, or one is outside of the folder."""
    by_name: dict[str, Item] = {}
    for item in items:
        parts = Path(item.name).parts
        if not parts or Path(item.name).is_absolute() or ".." in parts or not item.name.isprintable():
            raise Error(f"{item.name[:60]!r} cannot be the name of a file", code="name-invalid")
        other = by_name.setdefault(file_name_key(item.name), item)
        if other is not item:
            sentence = f"{other.source} and {item.source} would both be written as {item.name}"
            raise Error(sentence, code="name-taken", advice=_suggest_remedy(other, item, items))


def file_name_key(name: str) -> str:
    """Return a key that is equal for names of the same file on Windows or macOS.

    These systems ignore case, and how accents are composed.
    """
    return unicodedata.normalize("NFC", unicodedata.normalize("NFC", name).casefold())


def _suggest_remedy(first: Item, second: Item, items: list[Item]) -> str:
    """Return advice for two drawings that have one name."""
    if first.path and first.path == second.path:
        return "both names are the same drawing: give it once"
    for drawing in (second, first):
        names = [item.name for item in items if drawing.path and item.path == drawing.path]
        if len(names) > 1:
            return f"{drawing.source} is given twice, as {' and '.join(names)}: leave its folder out"
    if first.path and os.path.dirname(first.path) == os.path.dirname(second.path):
        return "rename one of them"
    return "give one of them to a batch of its own, with another folder (-o)"
