"""Files: read with a refusal in one sentence, written so that nobody finds half of one or some of several."""

from __future__ import annotations

import os
import re
import secrets
import stat
import tomllib
from collections.abc import Iterable, Iterator, Mapping
from contextlib import ExitStack, suppress
from pathlib import Path

from .errors import Error, require_type
from .suggestions import did_you_mean

try:
    import fcntl
except ImportError:  # Windows: there what a killed run left stays
    fcntl = None

MOST_PARTS = 20  # of a TOML key, a.b.c; many of them take minutes to read
LARGEST_BYTES = 500 * 2**20  # no drawing is; a device may have no end
READ_AT_ONCE = 4 * 2**20  # memory is allocated as it is needed


def read_bytes(path: str | os.PathLike[str]) -> bytes:
    """What a file holds. Error, with the path in `file`, when it cannot be read."""
    path = os.fspath(path)  # a number would be taken for an open file, and closed
    try:
        with open(path, "rb") as file:
            size, parts = os.fstat(file.fileno()).st_size, []  # 0 of a pipe or a device
            while size <= LARGEST_BYTES and (part := file.read(READ_AT_ONCE)):
                parts.append(part)
                size = max(size, sum(map(len, parts)))
        if size > LARGEST_BYTES:
            raise Error(
                f"the file is larger than {LARGEST_BYTES // 2**20} MB, the range is [0, {LARGEST_BYTES // 2**20}] MB",
                file=os.fspath(path),
                code="file-too-large",
            )
        return b"".join(parts)
    except FileNotFoundError:
        is_address = "://" in path
        sentence = "addresses are not read: save the file first" if is_address else "there is no such file"
    except IsADirectoryError:
        sentence = "this is a directory, not a file"
    except (OSError, ValueError) as problem:  # ValueError: a name that no file can have
        sentence = f"the file cannot be read: {system_reason(problem)}"
    raise Error(sentence, file=os.fspath(path), code="file-unreadable")


def toml_document(text: str, kind: str) -> dict:
    """What the text of a TOML file says. Error for what is none, kind: as a sentence calls the file."""
    # possessive, and only from the beginning of a word: a long word is read once, not once from each of its letters
    if found := re.search(rf"(?<![\w-])(?:[\w-]++\s*+\.\s*+){{{MOST_PARTS}}}", text):
        sentence = f"a key of more than {MOST_PARTS} parts: {found[0][:20]!r} ..."
        raise Error(f"the {kind} file is not TOML of ours: {sentence}", code="not-toml")
    try:
        return tomllib.loads(text)
    except ValueError as problem:  # also a whole number of thousands of digits
        raise Error(f"the {kind} file is not TOML: {str(problem)[:200]}", code="not-toml") from None
    except RecursionError:
        raise Error(f"the {kind} file is not TOML: its lists nest too deep", code="not-toml") from None


def find_file(kind: str, shipped: Path, suffix: str, name_or_path: str | os.PathLike[str]) -> Path:
    """Return the path of a brush or cell: a shipped one with this name, or a user's own file.

    Error, naming the kind and the shipped ones, for a name that is neither.
    """
    if isinstance(name_or_path, os.PathLike):
        return Path(name_or_path)
    require_type(name_or_path, str, f"the name or the path of a {kind}")
    names = names_in(shipped, suffix)
    if name_or_path in names:
        return shipped / f"{name_or_path}{suffix}"
    if name_or_path.endswith(suffix) or "/" in name_or_path or os.sep in name_or_path:
        return Path(name_or_path)
    known, own = ", ".join(names), f"{name_or_path}{suffix}"
    raise Error(
        f"{kind} {name_or_path!r} is not known{did_you_mean(name_or_path, names)} Known are {known}, and any file "
        f"that ends in {suffix}",
        code=f"{kind}-unknown",
        advice=f"{own} is in this folder: give its name with the ending" if _is_file(own) else "",
    )


def _is_file(path: str) -> bool:
    try:
        return os.path.isfile(path)
    except ValueError:  # a name that no file can have
        return False


def names_in(folder: Path, suffix: str) -> list[str]:
    """Names of the files of a kind in a folder, without their suffix, in alphabetical order."""
    return sorted(path.stem for path in folder.glob(f"*{suffix}"))


def write_files(files: Mapping[str | os.PathLike[str], bytes | str | Iterable[str]]) -> None:
    """Put data at each path, at all of them or at none: written next to them, then renamed. Text, whole or in
    pieces, becomes UTF-8.

    Error, with the path in `file`, when a place cannot be written; every path is then as it was before. The
    one gap: a rename that fails after others were made, as where a file is a mount point of its own.
    Devices and pipes are written through, once all other files are ready. Files that a killed run left next to a path
    are cleared by the next one that writes there.
    """
    path: str | os.PathLike[str] = ""
    targets: dict[str | os.PathLike[str], str] = {}
    staged: dict[str | os.PathLike[str], str] = {}
    through = []
    held = ExitStack()
    try:
        for path in files:
            targets[path] = os.path.realpath(path)  # a link stays a link
        for path, target in targets.items():
            mode = _mode(target)
            if mode is not None and not stat.S_ISREG(mode):
                through.append(path)
                continue
            if mode is not None and not os.access(target, os.W_OK):
                raise PermissionError(13, "permission denied")
            folder, name = os.path.split(target)
            prefix = f".{name.encode('utf-8', 'surrogateescape')[:80].decode('utf-8', 'ignore')}."
            _clear_left(folder, prefix)
            handle, staged[path] = _new_part(folder, prefix, 0o666 if mode is None else mode & 0o777)
            held.callback(os.close, os.dup(handle))  # keeps the lock until the file has its name
            with os.fdopen(handle, "wb") as file:
                file.writelines(_pieces(files[path]))
                file.flush()
                os.fsync(file.fileno())
            if mode is not None:
                os.chmod(staged[path], mode & 0o777)
        for path in through:  # must not be renamed over; a folder refuses
            with open(targets[path], "wb") as file:
                file.writelines(_pieces(files[path]))
        for path in list(staged):
            os.replace(staged[path], targets[path])
            del staged[path]
    except Error:  # of what is written, made while it is written
        raise
    except (OSError, ValueError) as problem:  # ValueError: a name that no file can have
        raise Error(
            f"the file cannot be written: {system_reason(problem)}",
            file=os.fspath(path),
            code="file-unwritable",
        ) from None
    finally:
        for left in staged.values():
            Path(left).unlink(missing_ok=True)
        held.close()


def system_reason(problem: Exception) -> str:
    """What the system says of a file, as the end of a sentence."""
    return (getattr(problem, "strerror", None) or str(problem)).lower()


def _new_part(folder: str, prefix: str, mode: int) -> tuple[int, str]:
    """A new file, open and locked as long as its handle or a copy of it is open: the sign that somebody writes it.

    The system takes the umask from its mode. Python can only read the umask by setting it, which changes the files
    that other threads make at that moment.
    """
    flags = os.O_RDWR | os.O_CREAT | os.O_EXCL | getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_BINARY", 0)
    while True:
        path = os.path.join(folder, f"{prefix}{secrets.token_hex(4)}.part")
        try:
            handle = os.open(path, flags, mode)
        except FileExistsError:
            continue
        if fcntl:
            with suppress(OSError):  # a file system without locks: nothing is cleared there
                fcntl.flock(handle, fcntl.LOCK_EX)
        if os.path.exists(path):
            return handle, path
        os.close(handle)  # another run took it for left before it was locked


def _clear_left(folder: str, prefix: str) -> None:
    """Remove what killed runs left of files with this prefix: nobody holds its lock any more."""
    ours = re.compile(re.escape(prefix) + r"[a-z0-9_]{8}\.part")  # as _new_part names them
    names = []
    with suppress(OSError):  # a folder that may be written and not listed
        names = os.listdir(folder) if fcntl else []
    for path in (os.path.join(folder, name) for name in names if ours.fullmatch(name)):
        with suppress(OSError), open(path, "r+b") as left:
            fcntl.flock(left, fcntl.LOCK_EX | fcntl.LOCK_NB)
            os.unlink(path)


def _mode(path: str) -> int | None:
    try:
        return os.stat(path).st_mode
    except FileNotFoundError:
        return None


def _pieces(data: bytes | str | Iterable[str]) -> Iterator[bytes]:
    for piece in [data] if isinstance(data, bytes | str) else data:
        yield piece.encode("utf-8") if isinstance(piece, str) else piece
