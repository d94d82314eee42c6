"""Read and write files.

Reading refuses in one sentence. Writing never leaves half of a file, or only some of several files.
"""

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
except ImportError:  # on Windows, the files that a killed run left behind are not removed
    fcntl = None

MOST_PARTS = 20  # parts of a TOML key such as a.b.c; a key with many parts takes minutes to read
LARGEST_BYTES = 500 * 2**20  # no drawing is larger, and a device may be endless
READ_AT_ONCE = 4 * 2**20  # bytes of one read, so that memory is allocated only as needed


def read_bytes(path: str | os.PathLike[str]) -> bytes:
    """Return the content of a file.

    Raises Error, with the path in `file`, if the file cannot be read.
    """
    path = os.fspath(path)  # refuses a number, which open() would use as an open file and close
    try:
        with open(path, "rb") as file:
            size, parts = os.fstat(file.fileno()).st_size, []  # a pipe or a device has size 0
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


def decode_text(data: bytes, what: str, code: str, file: str | None = None) -> str:
    """Decode the content of a file; raise Error if it is not UTF-8.

    A byte order mark, which editors on Windows write, is left out.

    what: the expected content in words.
    """
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError:
        raise Error(f"the file is not {what}: it is not text in UTF-8", file=file, code=code) from None


def toml_document(text: str, kind: str, version: int, format_is_missing: str = "{} is missing") -> dict:
    """Parse the text of a TOML file, and return its content without the keys format and version.

    kind: the word before "file" in messages, and the second word of the format. format_is_missing: what the message
    says of the missing line. Raises Error if the file is invalid or of another format or version. A key of more than
    MOST_PARTS parts is refused as well.
    """
    # The quantifiers are possessive and a match begins only at the beginning of a word. So a long word is
    # read once, and not again from each of its letters.
    if found := re.search(rf"(?<![\w-])(?:[\w-]++\s*+\.\s*+){{{MOST_PARTS}}}", text):
        sentence = f"a key of more than {MOST_PARTS} parts: {found[0][:20]!r} ..."
        raise Error(f"the {kind} file is not TOML of ours: {sentence}", code="not-toml")
    try:
        content = tomllib.loads(text)
        repr(content)  # a number with thousands of digits is refused here if it is hexadecimal, otherwise above
    except ValueError as problem:
        raise Error(f"the {kind} file is not TOML: {str(problem)[:200]}", code="not-toml") from None
    except RecursionError:
        raise Error(f"the {kind} file is not TOML: its lists nest too deep", code="not-toml") from None
    format_ = f"brushsvg/{kind}"
    if content.pop("format", None) != format_:
        says = format_is_missing.format(f'format = "{format_}"')
        raise Error(f"the file is not a {kind}: {says}", "format", code="format-unknown")
    if (found_version := content.pop("version", None)) != version or isinstance(found_version, bool):
        sentence = f"version {repr(found_version)[:40]} of the {kind} file is not known; known: {version}"
        if found_version is None:
            sentence = f"the {kind} file needs the line version = {version}"
        raise Error(sentence, "version", code="version-unknown")
    return content


def find_file(kind: str, shipped: Path, suffix: str, name_or_path: str | os.PathLike[str]) -> Path:
    """Return the path of a shipped brush or cell, or of a user's own file.

    Raises Error, with the kind and the shipped names, if the name is neither.
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
        advice=f"{own} is in this folder: give its name with the ending" if is_file(own) else "",
    )


def is_file(path: str) -> bool:
    """Return whether a path is a file; False for a name that no file can have."""
    try:
        return os.path.isfile(path)
    except ValueError:
        return False


def names_in(folder: Path, suffix: str) -> list[str]:
    """Return the sorted names of the files with a suffix, without the suffix."""
    return sorted(path.stem for path in folder.glob(f"*{suffix}"))


def find_file_used_twice(read: Iterable[object], written: Iterable[object]) -> str:
    """Return the first written path that is also read, or written before; "" if there is none.

    read, written: paths, in any spelling. Everything else, such as None or a Brush, is no path.
    """
    used_paths = {_real_path(path) for path in read if isinstance(path, str | os.PathLike)}
    for path in (path for path in written if isinstance(path, str | os.PathLike)):
        if _real_path(path) in used_paths:
            return os.fspath(path)
        used_paths.add(_real_path(path))
    return ""


def _real_path(path: str | os.PathLike[str]) -> str:
    try:
        return os.path.realpath(path)
    except ValueError:  # no file can have this name, such as one with a NUL
        return os.fspath(path)


def write_files(files: Mapping[str | os.PathLike[str], bytes | str | Iterable[str]]) -> None:
    """Write data to all of the paths or to none of them.

    Each file is written next to its path and then renamed. Text, whole or in pieces, is encoded as UTF-8.

    Raises Error, with the path in `file`, if a path cannot be written; every path is then as it was before.
    There is one exception: a rename can fail after other renames succeeded, for example if a file is a mount
    point. Devices and pipes are written directly, after all other files are ready. The next run that writes
    to a path removes the files that a killed run left next to it.
    """
    path: str | os.PathLike[str] = ""
    targets: dict[str | os.PathLike[str], str] = {}
    staged: dict[str | os.PathLike[str], str] = {}
    through = []
    held = ExitStack()
    try:
        for path in files:
            targets[path] = os.path.realpath(path)  # writes to the target of a link, so that the link stays
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
        for path in through:  # a rename would replace a device or pipe; a folder raises OSError
            with open(targets[path], "wb") as file:
                file.writelines(_pieces(files[path]))
        for path in list(staged):
            os.replace(staged[path], targets[path])
            del staged[path]
    except Error:  # from the data, which may be produced while it is written
        raise
    except (OSError, ValueError) as problem:  # ValueError: a name that no file can have
        sentence = f"the file cannot be written: {system_reason(problem)}"
        raise Error(sentence, file=os.fspath(path), code="file-unwritable") from None
    finally:
        for left in staged.values():
            Path(left).unlink(missing_ok=True)
        held.close()


def system_reason(problem: Exception) -> str:
    """Return the system's reason for a failure, as the end of a sentence."""
    return (getattr(problem, "strerror", None) or str(problem)).lower()


def _new_part(folder: str, prefix: str, mode: int) -> tuple[int, str]:
    """Create a new file that is locked while its handle or a copy of it is open.

    The lock shows that a run is still writing the file. The system applies the umask to the mode. Python can
    read the umask only by setting it, which would affect files that other threads create at that moment.
    """
    flags = os.O_RDWR | os.O_CREAT | os.O_EXCL | getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_BINARY", 0)
    while True:
        path = os.path.join(folder, f"{prefix}{secrets.token_hex(4)}.part")
        try:
            handle = os.open(path, flags, mode)
        except FileExistsError:
            continue
        if fcntl:
            with suppress(OSError):  # a file system without locks: _clear_left removes nothing there
                fcntl.flock(handle, fcntl.LOCK_EX)
        if os.path.exists(path):
            return handle, path
        os.close(handle)  # another run removed it as a leftover before it was locked


def _clear_left(folder: str, prefix: str) -> None:
    """Remove unlocked files with this prefix, which killed runs left behind."""
    ours = re.compile(re.escape(prefix) + r"[a-z0-9_]{8}\.part")  # as _new_part names them
    names = []
    with suppress(OSError):  # some folders can be written to but not listed
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
