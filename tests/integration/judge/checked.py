"""`brushsvg check` and `convert`, run in this process: the commands' own code, a drawing prepared once."""

from __future__ import annotations

import copy
import types
from contextlib import contextmanager
from pathlib import Path

from brushsvg import _core
from brushsvg.cli.arguments.parser import parse
from brushsvg.cli.commands import check as command
from brushsvg.cli.commands import convert_file
from brushsvg.cli.console import RefusedError
from brushsvg.pipeline import outputs
from brushsvg.pipeline.work import Work

CRASHED = "this should not happen"


def converted(*words) -> list[str]:
    """The sentences with which `brushsvg convert` refuses; empty when it has written."""
    try:
        convert_file(parse(["convert", *map(str, words)]))
    except RefusedError as refused:
        return [f"{notice.where}: {notice.told}" for notice in refused.why]
    return []


@contextmanager
def quick_check():
    """A function: words of `brushsvg check` -> the sentences with which it refuses; CRASHED for anything else.

    What it prepares of a drawing is kept, the figures that it tells are not made: neither decides what it refuses.
    """
    known: dict[tuple, Work] = {}
    cells: dict[tuple, object] = {}
    asked: dict[tuple, object] = {}
    names = "prepare", "exact_cell", "tell", "outputs", "report"
    whole = {name: getattr(command, name) for name in names}

    def prepare(chosen, cell, brush):
        key = (repr(chosen), cell.name, brush.name)
        if key not in known:
            known[key] = whole["prepare"](chosen, cell, brush)
        work, plan = known[key], known[key].plan
        work = copy.copy(work)  # a plan may be put in another order
        object.__setattr__(
            work, "plan", _core.Plan(plan.brush, plan.brush_sha256, plan.sheet_mm, plan.passes, plan.extra)
        )
        return work

    def exact_cell(name, tolerance_mm):
        if (name, tolerance_mm) not in cells:
            cells[name, tolerance_mm] = whole["exact_cell"](name, tolerance_mm)
        return cells[name, tolerance_mm]

    def refusals(*words) -> list[str]:
        if words not in asked:
            asked[words] = parse(["check", *map(str, words)])
        try:
            command.check_file(copy.copy(asked[words]))
        except RefusedError as refused:
            return [f"{notice.where}: {notice.told}" for notice in refused.why]
        except Exception as mistake:
            return [f"{CRASHED}: {type(mistake).__name__} {mistake}"]
        return []

    command.prepare, command.exact_cell, command.tell = prepare, exact_cell, lambda text: None
    command.outputs = types.SimpleNamespace(notes=outputs.notes, reported=lambda *_, **__: None)
    command.report = types.SimpleNamespace(as_text=lambda *_: "")
    try:
        yield refusals
    finally:
        for name, before in whole.items():
            setattr(command, name, before)


def put(path: Path, text: str) -> Path:
    path.write_bytes(text.encode("latin-1"))
    return path
