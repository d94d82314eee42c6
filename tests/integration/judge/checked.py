"""Run `brushsvg check` and `convert` in this process.

Both run the commands' own code. A drawing is prepared only once.
"""

from __future__ import annotations

import copy
import types
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

from brushsvg import _core
from brushsvg.cli.arguments.parser import parse
from brushsvg.cli.commands import convert_file
from brushsvg.cli.commands.drawings import check as command
from brushsvg.cli.console import RefusedError
from brushsvg.jobs import checking, outputs
from brushsvg.jobs.options import load_cell
from brushsvg.jobs.preparation import preparation
from brushsvg.jobs.prepared_drawing import PreparedDrawing

CRASHED = "this should not happen"


def converted(source, program, *words) -> list[str]:
    """Return the refusals of `brushsvg convert`; empty if it wrote a program."""
    try:
        convert_file(parse(["convert", str(source), "-o", str(program), *map(str, words)]))
    except RefusedError as refused:
        return [f"{notice.where}: {notice.text}" for notice in refused.why]
    return []


@contextmanager
def quick_check():
    """Yield a function that runs `brushsvg check` and returns its refusals.

    The result holds CRASHED after any other error. The function keeps prepared drawings and writes no
    figures. Neither changes what check refuses.
    """
    known: dict[tuple, PreparedDrawing] = {}
    cells: dict[str, object] = {}
    requested: dict[tuple, object] = {}
    before = {
        checking: {name: getattr(checking, name) for name in ("preparation", "load_cell", "outputs")},
        command: {name: getattr(command, name) for name in ("print_text", "report")},
    }

    def prepare(source, options, stage):
        key = (
            str(source),
            repr(replace(options, cell=None, brush=None)),
            options.cell.name,
            options.brush.name,
        )
        if key not in known:
            known[key] = preparation.prepare(source, options, stage)
        work, plan = known[key], known[key].plan
        work = copy.copy(work)  # check may reorder a plan
        object.__setattr__(
            work, "plan", _core.Plan(plan.brush, plan.brush_sha256, plan.sheet_mm, plan.passes, plan.extra)
        )
        return work

    def cell_of(name):
        if name not in cells:
            cells[name] = load_cell(name)
        return cells[name]

    def refusals(*words) -> list[str]:
        if words not in requested:
            requested[words] = parse(["check", *map(str, words)])
        try:
            command.check_file(copy.copy(requested[words]))
        except RefusedError as refused:
            return [f"{notice.where}: {notice.text}" for notice in refused.why]
        except Exception as mistake:
            return [f"{CRASHED}: {type(mistake).__name__} {mistake}"]
        return []

    checking.preparation, checking.load_cell = types.SimpleNamespace(prepare=prepare), cell_of
    checking.outputs = types.SimpleNamespace(header_lines=outputs.header_lines, make_report=lambda *_, **__: None)
    command.print_text, command.report = lambda text: None, types.SimpleNamespace(as_text=lambda *_: "")
    try:
        yield refusals
    finally:
        for module, names in before.items():
            for name, value in names.items():
                setattr(module, name, value)


def put(path: Path, text: str) -> Path:
    path.write_bytes(text.encode("latin-1"))
    return path
