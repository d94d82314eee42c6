"""Report the programs of an earlier run that stay next to a new program."""

from __future__ import annotations

import re
from collections.abc import Collection
from pathlib import Path

from ..errors import Notice
from .writer import called_programs


def report_leftover_programs(output: str, files: Collection[str]) -> list[Notice]:
    """Report programs that an earlier run left at the output path, before it is written.

    These are programs for a colour, or parts of a program, that this run does not write. Nobody should run them.

    files: the paths that this run writes.
    """
    path = Path(output)
    name = re.compile(rf"{re.escape(path.stem)}([-_]\d+[-_][0-9a-f]{{6}}|_c\d+)?(-part\d+)?{re.escape(path.suffix)}")
    existing = [each.name for each in path.parent.glob("*") if name.fullmatch(each.name)]
    for program in {path, *map(path.with_name, existing)}:
        existing += [each for each in _list_called_before(str(program)) if path.with_name(each).exists()]
    written = set(map(Path, files))  # a path may be spelled ./out.ngc
    leftover = sorted({each for each in existing if path.with_name(each) not in written}, key=_make_sort_key)
    if not leftover:
        return []
    sentence = f"programs of an earlier run are still here and belong to another version: {', '.join(leftover)}"
    return [Notice("", sentence, code="programs-of-before", advice="delete them")]


def _list_called_before(program: str) -> list[str]:
    """List the files that the program now at a path calls.

    A program in several files calls its other files.
    """
    return [Path(file).name for file in called_programs(program, read_if_possible(program), read_if_possible)]


def read_if_possible(path: str) -> str:
    """Read a program next to another one as far as possible.

    Names in it are ASCII. Devices and pipes hold no program.
    """
    try:
        return Path(path).read_bytes().decode("ascii", "replace") if Path(path).is_file() else ""
    except OSError:
        return ""


def _make_sort_key(name: str) -> list:
    """Return a key that sorts part2 before part10."""
    return [int(part) if part.isdigit() else part for part in re.split(r"(\d+)", name)]
