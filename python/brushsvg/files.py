"""Writing files so that nobody ever finds half of one."""

import os
import tempfile
from pathlib import Path

from .errors import Error


def write_atomically(path: str | os.PathLike, data: bytes | str) -> None:
    """Put data (text as UTF-8) at path: written beside it, flushed, then renamed over it.

    Either the whole file is there or path is as it was before. Raises Error when the place cannot be written.
    """
    path = Path(path)
    if isinstance(data, str):
        data = data.encode("utf-8")
    target = Path(os.path.realpath(path))  # a link stays a link
    beside = None
    try:
        if os.path.exists(target) and not os.path.isfile(target):
            target.write_bytes(data)  # a device or pipe must not be renamed over; a folder refuses
            return
        if os.path.exists(target) and not os.access(target, os.W_OK):
            raise PermissionError(13, "permission denied")
        handle, beside = tempfile.mkstemp(prefix=f".{target.name[:80]}.", suffix=".part", dir=target.parent)
        with os.fdopen(handle, "wb") as file:
            file.write(data)
            file.flush()
            os.fsync(file.fileno())
        os.chmod(beside, target.stat().st_mode & 0o777 if target.exists() else 0o666 & ~_umask())
        os.replace(beside, target)
        beside = None
    except OSError as problem:
        reason = (problem.strerror or str(problem)).lower()
        raise Error(f"the file {path} cannot be written: {reason}") from None
    finally:
        if beside is not None:
            Path(beside).unlink(missing_ok=True)


def _umask() -> int:
    mask = os.umask(0)  # there is no way to read it without setting it
    os.umask(mask)
    return mask
