"""brushsvg cell: list, show, check, new."""

from __future__ import annotations

import os
from dataclasses import replace

from ...errors import Notice
from ...machine import cell_check as cell_checks
from ...machine.cell_file import DEFAULT_CELL, cell_names, find_cell, parse_cell, write_cell
from ...machine.describe_cell import cell_page
from ...machine.posts import POSTS
from ..console import RefusedError, about, tell, warn
from ..steps.output_places import check_places, tell_list, write


def cell_list(_args) -> None:
    tell_list(cell_names(), lambda name: find_cell(name).description)


def cell_show(args) -> None:
    with about(args.input):
        tell(cell_page(find_cell(args.input)) + "\n")


def cell_check(args) -> None:
    with about(args.input):
        cell = find_cell(args.input)
    if cell.language not in POSTS:
        known = ", ".join(POSTS)
        sentence = f"no program can be written in {cell.language!r} yet, only plans; known: {known}"
        warn(args.input, [Notice("language", sentence, code="language-unknown")])
    if problems := cell_checks.out_of_reach(cell):
        raise RefusedError(args.input, problems)
    warn(args.input, cell_checks.remarks(cell))
    tell(f"{args.input}: cell {cell.name} can be used\n")


def cell_new(args) -> None:
    check_places(args.output)
    if os.path.exists(args.output):
        why = Notice("", "the file is there already: it might be somebody's machine", code="file-exists")
        raise RefusedError(args.output, [why])
    with about(args.like or DEFAULT_CELL):
        cell = find_cell(args.like or DEFAULT_CELL)
    name = os.path.splitext(os.path.basename(args.output))[0]
    with about(args.output):
        paper = (
            replace(
                cell.paper,
                taught_mm=tuple(args.taught),
                origin_mm=(0.0, 0.0, 0.0),
                rotation_deg=(0.0, 0.0, 0.0),
                example=False,
            )
            if args.taught
            else cell.paper
        )
        text = write_cell(replace(cell, name=name, paper=paper))
        made = parse_cell(text)
    warn(args.output, cell_checks.out_of_reach(made) or cell_checks.remarks(made))
    write(args, {args.output: text})
