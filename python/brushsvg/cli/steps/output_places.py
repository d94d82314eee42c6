"""Check where a command writes before any work, then write all files or none."""

from __future__ import annotations

import os
from collections.abc import Collection

from ...errors import Notice
from ...files import find_file_used_twice, write_files
from ...reporting.report_text import format_overlap
from ...units import clock
from ..console import RefusedError, clear_stage, print_text, refuse_errors, say, stage
from .replacing import record_written, refuse_replacing


def suffix_of(path: str | None) -> str:
    return os.path.splitext(path or "")[1].lower()


def check_outputs(args, *paths: str | None, sources: Collection[str | None] = ()) -> None:
    """Refuse outputs that cannot be written, as far as that is known before any work.

    sources: the outputs that are brushes, cells, corrections or drawings, see refuse_replacing.
    """
    for path in filter(None, paths):
        folder = os.path.dirname(os.path.realpath(path))
        reason = None
        if os.path.isdir(path):
            reason = "it is a directory"
        elif not os.path.isdir(folder):
            reason = "its directory does not exist"
        elif not os.access(folder, os.W_OK | os.X_OK):
            reason = "its directory is not writable"
        if reason:
            why = Notice("", f"the file cannot be written: {reason}", code="file-unwritable")
            raise RefusedError(path, [why])
    _refuse_project_brush(args, paths)
    refuse_replacing(filter(None, paths), sources, args.force)


def _refuse_project_brush(args, paths: Collection[str | None]) -> None:
    """Refuse to replace the brush of the project file, as a typed brush is refused, also with --force."""
    brushes = args.brush if "brush" in getattr(args, "from_project", ()) else []
    if twice := find_file_used_twice([brushes] if isinstance(brushes, str) else brushes, paths):
        sentence = "brushsvg.toml names this file as the brush, so it cannot be written as well"
        raise RefusedError(twice, [Notice("", sentence, code="options-contradict", advice="give another name")])


def write_outputs(
    args,
    files,
    strokes: int | None = None,
    seconds: float | None = None,
    overlap=None,
    more: str = "",
    sources: Collection[str | None] = (),
) -> None:
    """Write all files, and report them with their figures unless --quiet.

    sources: as for check_outputs.
    """
    stage("writing")
    refuse_replacing(files, sources, args.force)
    with refuse_errors(""):  # the error names the file itself
        write_files(files)
    record_written(path for path in files if path not in sources)
    clear_stage()
    if args.quiet:
        return
    facts = [] if strokes is None else [f"{strokes} stroke{'s' * (strokes != 1)}"]
    facts += [] if seconds is None else [f"takes about {clock(seconds)}"]
    facts += [] if overlap is None else [f"overlap {format_overlap(overlap)}"]
    facts += [more] if more else []
    say(", ".join(map(str, files)), "; ".join(["written", *filter(None, [", ".join(facts)])]))


def print_list(names: list[str], describe) -> None:
    width = max(map(len, names))
    for name in names:
        with refuse_errors(name):
            print_text(f"{name.ljust(width)}  {describe(name)}\n")
