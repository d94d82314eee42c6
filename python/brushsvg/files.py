"""Files: read with a refusal in one sentence, written so that nobody finds half of one or some of several."""

from __future__ import annotations

import os
import stat
import tempfile
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path

from .errors import Error

LARGEST_BYTES = 500 * 2**20  # no drawing is; a device may have no end


def read_bytes(path: str | os.PathLike) -> bytes:
    """What a file holds. Error, with the path in `file`, when it cannot be read."""
    try:
        with open(path, "rb") as file:
            data = file.read(LARGEST_BYTES + 1)
        if len(data) > LARGEST_BYTES:
            raise Error(
                f"the file is larger than {LARGEST_BYTES // 2**20} MB, the range is [0, {LARGEST_BYTES // 2**20}] MB",
                file=os.fspath(path),
            )
        return data
    except FileNotFoundError:
        sentence = "there is no such file"
    except IsADirectoryError:
        sentence = "this is a directory, not a file"
    except (OSError, ValueError) as problem:  # ValueError: a name that no file can have
        sentence = f"the file cannot be read: {reason(problem)}"
    raise Error(sentence, file=os.fspath(path))


def find_file(kind: str, shipped: Path, suffix: str, name_or_path: str | os.PathLike) -> Path:
    """Where a brush or cell lies: that of a name among the shipped ones, or a user's own file.

    Error, naming the kind and the shipped ones, for a name that is neither.
    """
    if isinstance(name_or_path, os.PathLike):
        return Path(name_or_path)
    names = names_in(shipped, suffix)
    if name_or_path in names:
        return shipped / f"{name_or_path}{suffix}"
    if name_or_path.endswith(suffix) or "/" in name_or_path or os.sep in name_or_path:
        return Path(name_or_path)
    known = ", ".join(names)
    raise Error(
        f"{kind} {name_or_path!r} is not known; known are {known}, and any file that ends in {suffix}"
    )


def names_in(folder: Path, suffix: str) -> list[str]:
    """Names of the files of a kind in a folder, without their suffix, in alphabetical order."""
    return sorted(path.stem for path in folder.glob(f"*{suffix}"))


def write_files(files: Mapping[str | os.PathLike, bytes | str | Iterable[str]]) -> None:
    """Put data at each path, at all of them or at none: written beside them, then renamed. Text, whole or in
    pieces, becomes UTF-8.

    Error, with the path in `file`, when a place cannot be written; every path is then as it was before. The
    one gap: a rename that fails after others were made, as where a file is a mount point of its own.
    Devices and pipes are written through, once all the rest lies ready.
    """
    path: str | os.PathLike = ""
    targets = {path: os.path.realpath(path) for path in files}  # a link stays a link
    beside: dict[str | os.PathLike, str] = {}
    through = []
    try:
        for path, target in targets.items():
            mode = _mode(target)
            if mode is not None and not stat.S_ISREG(mode):
                through.append(path)
                continue
            if mode is not None and not os.access(target, os.W_OK):
                raise PermissionError(13, "permission denied")
            folder, name = os.path.split(target)
            handle, beside[path] = tempfile.mkstemp(prefix=f".{name[:80]}.", suffix=".part", dir=folder)
            with os.fdopen(handle, "wb") as file:
                file.writelines(_pieces(files[path]))
                file.flush()
                os.fsync(file.fileno())
            os.chmod(beside[path], 0o666 & ~_umask() if mode is None else mode & 0o777)
        for path in through:  # must not be renamed over; a folder refuses
            with open(targets[path], "wb") as file:
                file.writelines(_pieces(files[path]))
        for path in list(beside):
            os.replace(beside[path], targets[path])
            del beside[path]
    except OSError as problem:
        raise Error(f"the file cannot be written: {reason(problem)}", file=os.fspath(path)) from None
    finally:
        for left in beside.values():
            Path(left).unlink(missing_ok=True)


def reason(problem: Exception) -> str:
    """What the system says of a file, as the end of a sentence."""
    return (getattr(problem, "strerror", None) or str(problem)).lower()


def _mode(path: str) -> int | None:
    try:
        return os.stat(path).st_mode
    except FileNotFoundError:
        return None


def _pieces(data: bytes | str | Iterable[str]) -> Iterator[bytes]:
    for piece in [data] if isinstance(data, bytes | str) else data:
        yield piece.encode("utf-8") if isinstance(piece, str) else piece


def _umask() -> int:
    mask = os.umask(0)  # there is no way to read it without setting it
    os.umask(mask)
    return mask
