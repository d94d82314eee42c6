"""brushsvg init: ask four questions, and write the project file."""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Callable

from ....errors import Error, Notice
from ....jobs.options import DEFAULT_BRUSH
from ....jobs.project import NAME, write_project
from ....jobs.project.values import name_or_path
from ....machine.cells.cell_file import DEFAULT_CELL, cell_names, find_cell
from ....machine.posts import POSTS
from ....model.library import brush_names, find_brush
from ....units import PAPERS_MM
from ...arguments import values
from ...console import RefusedError, print_text, refuse_errors, say
from ...steps.ask_measurements import can_answer
from ...steps.output_places import check_outputs, write_outputs

NOT_MEASURED = "none"
AS_DRAWN = "as each drawing says"


def init_project(args) -> None:
    """Ask for settings without a flag, and write the project file.

    Without a terminal, settings without a flag have their defaults.
    """
    check_outputs(args, args.output, sources=[args.output])
    folder = os.path.dirname(os.path.abspath(args.output))
    with refuse_errors(""):  # errors name the brush or cell themselves
        cell = None if args.cell is None else _read_cell(args.cell, folder)
        brush = None if args.brush is None else _read_brush(args.brush, folder)
    paper, speed = args.sheet, args.paint_speed

    def read_speed(text: str, folder: str) -> float | None:
        speed_mm_s = values.paint_speed(text.replace(",", ".")) if text else None
        return _check_speed(speed_mm_s, brush, cell, folder)

    if can_answer(args):
        if cell is None:
            for line in _list_machines():
                say(line)
            cell = _ask(f"Machine, a name or a cell.toml [{DEFAULT_CELL}]: ", DEFAULT_CELL, folder, _read_cell)
        if args.brush is None:
            say(f"Brushes: {', '.join(brush_names())}, or your own brush.json")
            brush = _ask(
                f"Brush, a name, a file, or {NOT_MEASURED} if it is not measured yet [{NOT_MEASURED}]: ",
                NOT_MEASURED,
                folder,
                _read_brush,
            )
        if paper is None:
            say(f"Papers: {', '.join(PAPERS_MM)}, or a size such as 300x200mm")
            paper = _ask(f"Paper [{AS_DRAWN}]: ", AS_DRAWN, folder, _read_paper)
        if speed is None:
            speed = _ask("Painting speed in mm/s [as each drawing says, or 20]: ", "", folder, read_speed)
    with refuse_errors("--speed"):
        _check_speed(speed, brush, cell, folder)
    text = write_project(brush or None, cell, paper, speed)
    write_outputs(args, {args.output: text}, sources=[args.output])
    print_text("".join(f"{line}\n" for line in _list_next_steps(brush)))


def _list_machines() -> list[str]:
    """Return a line with the shipped cells of each robot language."""
    by_title: dict[str, list[str]] = {}
    for name in cell_names():
        by_title.setdefault(POSTS[find_cell(name).language].title, []).append(name)
    return [f"{title}: {', '.join(names)}" for title, names in by_title.items()]


def _ask(question: str, default: str, folder: str, read: Callable[[str, str], object]):
    """Ask until the answer, or the default, can be read; raise RefusedError if the answers end too early."""
    while True:
        sys.stderr.write(question)
        sys.stderr.flush()
        answer = sys.stdin.readline()
        if not answer:
            sentence = "the answers ended. Answer all questions, or give --cell, --brush, --sheet and --speed"
            raise RefusedError("init", [Notice("", sentence, code="answer-missing")])
        try:
            return read(answer.strip() or default, folder)
        except (Error, argparse.ArgumentTypeError) as problem:
            say(str(problem))


def _read_cell(text: str, folder: str) -> str:
    find_cell(text)
    return text if text in cell_names() else _make_relative_path(folder, text)


def _read_brush(text: str, folder: str) -> str:
    """Return the brush as in a project file, or "" if it is not measured yet."""
    if text == NOT_MEASURED:
        return ""
    find_brush(text)
    return text if text in brush_names() else _make_relative_path(folder, text)


def _read_paper(text: str, _folder: str) -> str | None:
    """Return the paper, or None for the page of each drawing."""
    if text == AS_DRAWN:
        return None
    values.sheet(text)
    return text


def _check_speed(speed_mm_s: float | None, brush: str | None, cell: str | None, folder: str) -> float | None:
    """Return the speed; raise Error beyond the limits of brush or cell, which are as in the project file."""
    if speed_mm_s is not None:
        from ....machine.limits.speeds import check_painting_speed

        for notice in check_painting_speed(
            speed_mm_s,
            find_brush(name_or_path("brush", brush or DEFAULT_BRUSH, folder)),
            find_cell(name_or_path("cell", cell or DEFAULT_CELL, folder)),
        ):
            raise Error(notice.sentence, code=notice.code)
    return speed_mm_s


def _make_relative_path(folder: str, path: str) -> str:
    """Return a path as a file in this folder has to write it."""
    try:
        relative = os.path.relpath(os.path.abspath(path), folder)
    except ValueError:  # on Windows, the file is on another drive
        return os.path.abspath(path)
    return relative.replace(os.sep, "/")


def _list_next_steps(brush: str | None) -> list[str]:
    """Return lines on what to do next."""
    lines = [f"Commands use {NAME} for every drawing in this folder; edit it as you like."]
    if not brush:
        lines += [
            f"The brush is not set: commands use {DEFAULT_BRUSH}. Measure yours with "
            "`brushsvg brush new -o mine.json`,",
            f'then write brush = "mine.json" into {NAME}.',
        ]
    return [
        *lines,
        "Next: convert a drawing of this folder. Add --explain to see where each setting comes from.",
    ]
