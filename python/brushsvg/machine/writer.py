"""A plan to the text that a machine runs: paint fetched, header written, file encoded."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Iterator
from dataclasses import replace
from pathlib import Path

from .. import _core
from ..errors import Error, need
from ..files import write_files
from .cells.cell import Cell
from .cells.cell_file import cell_names, find_cell, parse_cell, write_cell
from .header_lines import header_of
from .motion import Program, duration_s, program_in_robot_frame
from .paint_reload import PlanInLoads, in_loads, visits
from .posts import POSTS, Post
from .preflight import DEFAULT_TOLERANCE_MM, as_exact_as, look
from .program import WHOLE_JOB, Job, Walked, check_job, out_of_arm, unchecked_program
from .realised.backlash import undone


def post_for(suffix: str, cell: Cell) -> Post:
    """How the cell's language is written. Error when it cannot be, or not in a file of that extension."""
    post = POSTS.get(cell.language)
    if post is None:
        raise Error(
            f"no program can be written in {cell.language!r}, the language of cell {cell.name}; "
            f"known: {', '.join(POSTS)}",
            where="language",
            code="language-unknown",
        )
    if suffix not in post.extensions:
        other = cells_for(suffix)
        raise Error(
            f"the extension {suffix!r} is neither .json, for a plan, nor {' or '.join(post.extensions)}, for "
            f"{post.title}, which cell {cell.name} speaks"
            + (f"; {suffix} is for cell {' or '.join(other)}" if other else ""),
            code="program-format",
            advice="give --cell" if other else "",
        )
    return post


def cells_for(suffix: str) -> list[str]:
    """Names of the cells that come along whose programs have this extension."""
    languages = {name for name, post in POSTS.items() if suffix in post.extensions}
    return [name for name in cell_names() if find_cell(name).language in languages]


def encode(
    suffix: str,
    plan: _core.Plan,
    brush: _core.Brush,
    title: str,
    notes: Iterable[str] = (),
    cell: Cell | None = None,
    job: Job = WHOLE_JOB,
) -> bytes | Iterator[str]:
    """The plan as the bytes of a plan.json or a program in the cell's language, in pieces, by the file's extension.

    Error for any other extension, and for a program where a limit of brush or cell is broken.
    """
    cell = cell or find_cell()
    if suffix == ".json":
        return _core.write_plan(plan).encode()
    post_for(suffix, cell)
    walk = check_job(in_loads(plan, brush, cell), brush, cell, job)
    if not walk.problems:
        walk = replace(walk, problems=out_of_arm(walk.made, plan.sheet_mm))
    return encoded(suffix, plan, walk, brush, title, notes)


def encoded(
    suffix: str, plan: _core.Plan, walk: Walked, brush: _core.Brush, title: str, notes: Iterable[str] = ()
) -> bytes | Iterator[str]:
    """The same for who has gone through the plan's loads before. Error where something forbids to run them."""
    made = walk.allowed()
    if suffix == ".json":
        return _core.write_plan(plan).encode()
    header = header_of(title or "untitled", brush.name, walk.loads, notes, made, walk.job)
    return text_of(post_for(suffix, made.cell), replace(made, header=header), suffix)


def in_parts(suffix: str, pieces: bytes | Iterator[str]) -> dict[str, bytes | str | Iterator[str]]:
    """The same in the files of a language where one program cannot hold a long job: {"": the first, name: another}.

    A name that begins with "-" is appended to the first file's, as `beside` does.
    """
    post = parted_post(suffix)
    if post is None:
        return {"": pieces}
    texts = post.programs("".join(pieces))
    return {"": texts.pop("")} | texts


def in_files(path: str | os.PathLike[str], pieces: bytes | Iterator[str]) -> dict:
    """The same by the paths of those files."""
    parts = in_parts(Path(path).suffix.lower(), pieces)
    return {path_next_to(path, name): text for name, text in parts.items()}


def parted_post(suffix: str) -> Post | None:
    """The language of an extension, where long jobs of it are several files."""
    return next((post for post in POSTS.values() if post.parted and suffix in post.extensions), None)


def path_next_to(path: str | os.PathLike[str], name: str) -> str:
    """The path of another program of the same job. name: "" for the one at the path."""
    if not name:
        return os.fspath(path)
    path = Path(path)
    return str(path.with_name((path.stem if name.startswith("-") else "") + name + path.suffix))


def called_programs(path: str | os.PathLike[str], text: str, read: Callable[[str], str]) -> dict[str, str]:
    """The files that a program's text calls, and those that they call, with their texts: in the order of the calls.

    path: of the program, which need not exist yet; read: the text of a file.
    """
    post, texts, found = parted_post(Path(path).suffix.lower()), [text], {}
    for one in texts if post else []:
        for file in (path_next_to(path, name) for name in post.called(one)):
            if file not in found:
                found[file] = read(file)
                texts.append(found[file])
    return found


def text_of(post: Post, made: Program, suffix: str = "") -> Iterator[str]:
    """The program in a robot's language, in pieces, as files of an extension have it."""
    made = undone(program_in_robot_frame(made)) if post.in_robot_frame else made
    pieces = post.others.get(suffix, post.write)(made)
    return pieces if post.line_end == "\n" else (piece.replace("\n", post.line_end) for piece in pieces)


def whole_program(loads: PlanInLoads, brush: _core.Brush, cell: Cell, job: Job = WHOLE_JOB) -> Program:
    """Return all that the machine does, paint included, for a picture: limits are not checked."""
    job = replace(job, visits=visits(loads, cell, job.first_stroke))
    return unchecked_program(loads, brush, cell, job)


def time_s(loads: PlanInLoads, brush: _core.Brush, cell: Cell, job: Job = WHOLE_JOB) -> float:
    """Estimated time, paint included; limits are not looked at."""
    return duration_s(whole_program(loads, brush, cell, job))


def write_program(
    path: str | os.PathLike[str],
    plan: _core.Plan,
    brush: _core.Brush,
    title: str = "",
    cell: Cell | None = None,
) -> None:
    """Write a plan as plan.json or a program in the cell's language, by the extension of path.

    Error, and nothing written, when paint leaves the sheet or a limit of brush or cell is broken.
    """
    if not isinstance(cell, Cell | None):
        raise TypeError(f"cell must be a brushsvg.Cell or None, not {type(cell).__name__}")
    need(plan, _core.Plan, "a plan")
    need(brush, _core.Brush, "a brush")
    need(title, str, "a title")
    # a cell made by hand must be one that a file may hold: each key within its range
    cell = parse_cell(write_cell(cell)) if cell else find_cell()
    suffix = Path(path).suffix.lower()
    cell = as_exact_as(cell, DEFAULT_TOLERANCE_MM)
    marks, loads = _core.simulate(plan, brush), in_loads(plan, brush, cell)
    walk = look(loads, brush, marks, cell, DEFAULT_TOLERANCE_MM)
    write_files(in_files(path, encoded(suffix, plan, walk, brush, title)))
