"""Write a plan as a machine program: paint, header and files."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Iterator
from dataclasses import replace
from pathlib import Path

from .. import _core
from ..errors import Error, Notice, missing_packages_error, require_type
from ..files import write_files
from .arm.inverse_kinematics import is_installed
from .cells.cell import Cell
from .cells.cell_check import OF_EXAMPLE
from .cells.cell_file import cell_names, find_cell, parse_cell, write_cell
from .dry_brush import report_dry_brush, report_long_strokes, report_missing_paint
from .header_lines import header_of
from .job_program import (
    WHOLE_JOB,
    CheckedProgram,
    Job,
    find_moves_out_of_arm,
    make_checked_program,
    report_strokes_beyond_part,
    unchecked_program,
)
from .moves import Program, duration_s, program_in_robot_frame
from .paint_reload import PlanInLoads, list_station_visits, split_into_loads
from .pen_changes import report_single_pen
from .posts import POSTS, Post
from .preflight import DEFAULT_TOLERANCE_MM, as_exact_as, check_job, report_other_brush
from .realised.backlash import compensate_backlash
from .realised.displacement_field import beyond_field


def post_for(suffix: str, cell: Cell) -> Post:
    """Return the post for a cell's language.

    Raises Error if the language cannot be written, or not in a file with this extension.
    """
    post = POSTS.get(cell.language)
    if post is None:
        raise Error(
            f"no program can be written in {cell.language!r}, the language of cell {cell.name}; "
            f"known: {', '.join(POSTS)}",
            where="language",
            code="language-unknown",
        )
    if suffix not in post.extensions:
        other = cells_for_extension(suffix)
        raise Error(
            f"the extension {suffix!r} is neither .json, for a plan, nor {' or '.join(post.extensions)}, for "
            f"{post.title}, which cell {cell.name} speaks"
            + (f"; {suffix} is for cell {' or '.join(other)}" if other else ""),
            code="program-format",
            advice="give --cell" if other else "",
        )
    return post


def cells_for_extension(suffix: str) -> list[str]:
    """Return the names of the shipped cells whose programs have this extension."""
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
    """Encode a plan as a plan.json or as a program.

    The program is in the cell's language. The extension decides between the two.

    suffix: extension of the file, with its dot.

    Returns the bytes of a plan.json, or the pieces of a program.

    Raises Error for any other extension, and if a program breaks a limit of the brush or the cell.
    """
    cell = cell or find_cell()
    if suffix == ".json":
        return _core.write_plan(plan).encode()
    post_for(suffix, cell)
    walk = make_checked_program(split_into_loads(plan, brush, cell), brush, cell, job)
    if not walk.problems:
        walk = replace(walk, problems=find_moves_out_of_arm(walk.made, plan.sheet_mm))
    return encode_checked(suffix, plan, walk, brush, title, notes)


def encode_checked(
    suffix: str,
    plan: _core.Plan,
    walk: CheckedProgram,
    brush: _core.Brush,
    title: str,
    notes: Iterable[str] = (),
    name: str = "",
) -> bytes | Iterator[str]:
    """Encode a plan whose loads have been checked already, like encode.

    name: stem of the file, after which some languages name the program.

    Raises Error if the check found a problem.
    """
    program = walk.allowed()
    if suffix == ".json":
        return _core.write_plan(plan).encode()
    header = header_of(title or "untitled", brush.name, walk.loads, notes, program, walk.job)
    named = replace(program, header=header, name=name or program.name)
    return text_of(post_for(suffix, program.cell), named, suffix)


def join_pieces(pieces: bytes | Iterator[str] | Iterator[bytes]) -> str | bytes:
    """Return a whole program: its text, or the bytes of a plan or of a binary format."""
    if isinstance(pieces, bytes):
        return pieces
    joined = list(pieces)
    return b"".join(joined) if isinstance(joined[0], bytes) else "".join(joined)


def in_parts(suffix: str, pieces: bytes | Iterator[str]) -> dict[str, bytes | str | Iterator[str]]:
    """Split an encoded program into files.

    Some languages cannot hold a long job in one program. Returns {"": first file, name: another file}. A name that
    begins with "-" is appended to the first file's name, see path_next_to.
    """
    post = parted_post(suffix)
    if post is None:
        return {"": pieces}
    texts = post.programs(join_pieces(pieces))
    return {"": texts.pop("")} | texts


def in_files(path: str | os.PathLike[str], pieces: bytes | str | Iterator[str]) -> dict:
    """Return the files of an encoded program by their paths."""
    parts = in_parts(Path(path).suffix.lower(), pieces)
    return {path_next_to(path, name): text for name, text in parts.items()}


def parted_post(suffix: str) -> Post | None:
    """Return the post of an extension if its long jobs are several files, else None."""
    return next((post for post in POSTS.values() if post.parted and suffix in post.extensions), None)


def path_next_to(path: str | os.PathLike[str], name: str) -> str:
    """Return the path of another program of the same job.

    name: "" for the program at the path itself. A name that begins with "-" is appended to the stem.
    """
    if not name:
        return os.fspath(path)
    path = Path(path)
    return str(path.with_name((path.stem if name.startswith("-") else "") + name + path.suffix))


def report_renamed(name: str, suffix: str, cell: Cell, known_name: str = "") -> list[Notice]:
    """Return a notice if the controller knows a program by another name than that of its file.

    name: the stem of the file; "" for none.
    suffix: the extension of the file, with its dot.
    known_name: the name in the program; by default the name that the post gives it.
    """
    post = POSTS.get(cell.language)
    if not name or post is None or suffix not in post.extensions:
        return []
    possible_name = post.controller_name(name)
    known_name = known_name or possible_name
    if known_name.lower() == name.lower():
        return []
    is_possible = possible_name.lower() == name.lower()
    reason = f"but its file {name!r}" if is_possible else f"which cannot have {name!r} as a name"
    sentence = f"the program is called {known_name} on the controller, {reason}"
    return [Notice("", sentence, code="program-renamed", advice=f"name the file {known_name}{suffix}")]


def called_programs(path: str | os.PathLike[str], text: str, read: Callable[[str], str]) -> dict[str, str]:
    """Return the texts of the files that a program calls.

    Indirect calls are included. The files are in the order of the calls.

    path: path of the program, which need not exist yet.
    read: returns the text of a file.
    """
    post, unread_texts, called_texts = parted_post(Path(path).suffix.lower()), [text], {}
    for program_text in unread_texts if post else []:
        for file in (path_next_to(path, name) for name in post.called(program_text)):
            if file not in called_texts:
                called_texts[file] = read(file)
                unread_texts.append(called_texts[file])
    return called_texts


def text_of(post: Post, program: Program, suffix: str = "") -> Iterator[str]:
    """Return the pieces of a program in a robot's language. suffix: extension of the file."""
    program = compensate_backlash(program_in_robot_frame(program)) if post.in_robot_frame else program
    pieces = post.write(program, suffix)
    return pieces if post.line_end == "\n" else (piece.replace("\n", post.line_end) for piece in pieces)


def whole_program(loads: PlanInLoads, brush: _core.Brush, cell: Cell, job: Job = WHOLE_JOB) -> Program:
    """Make the whole program, including paint, for a picture. Limits are not checked."""
    job = replace(job, visits=list_station_visits(loads, cell, job.first_stroke))
    return unchecked_program(loads, brush, cell, job)


def time_s(loads: PlanInLoads, brush: _core.Brush, cell: Cell) -> float:
    """Estimate the duration [s] of a plan, including paint. Limits are not checked."""
    return duration_s(whole_program(loads, brush, cell))


def report_program(
    suffix: str, loads: PlanInLoads, brush: _core.Brush, cell: Cell, name: str, first_stroke: int = 1
) -> list[Notice]:
    """Return notices on the paint, the pens and the name of a job that may be run.

    suffix: the extension of the program, or ".json" for a plan, which no machine paints yet.
    name: the stem of the file; "" for none.
    """
    notices = [*report_missing_paint(brush, cell), *report_long_strokes(loads, brush, cell)]
    if suffix != ".json":
        notices += report_dry_brush(loads, brush, cell, first_stroke)
        notices += report_single_pen(loads.loads, cell, first_stroke)
        notices += beyond_field(loads.loads, cell)
        notices += report_strokes_beyond_part(loads, cell)
    return [*notices, *report_renamed(name, suffix, cell)]


def list_cell_notices(cell: Cell) -> list[Notice]:
    """Return notices on what makes a program less certain than it looks.

    These are a paper position that nobody taught, and an arm whose joints were not checked.
    """
    return [*([OF_EXAMPLE] if cell.paper.example else []), *list_arm_notices(cell)]


def list_arm_notices(cell: Cell) -> list[Notice]:
    if not cell.arm or is_installed():
        return []
    sentence = f"brushsvg did not check whether arm {cell.arm.name} reaches everything that is painted"
    advice = missing_packages_error("this check needs", "ssik").sentence
    return [Notice("arm", sentence, code="arm-not-followed", advice=advice)]


def write_program(
    path: str | os.PathLike[str],
    plan: _core.Plan,
    brush: _core.Brush,
    title: str = "",
    cell: Cell | None = None,
) -> list[Notice]:
    """Write a plan as a plan.json or as a program, and return notices.

    The program is in the cell's language. The extension of path decides between the two.

    There is a notice if the plan was made for another brush, or with another file of this brush. The program paints
    with the given brush, and its header counts these notices. The other notices are those of `convert` on the paint,
    the pens, the name of the program and the cell.

    Raises Error, and writes nothing, for a brush that is not valid, and if paint leaves the sheet or a limit of the
    brush or the cell is broken.
    """
    if not isinstance(cell, Cell | None):
        raise TypeError(f"cell must be a brushsvg.Cell or None, not {type(cell).__name__}")
    require_type(plan, _core.Plan, "a plan")
    require_type(brush, _core.Brush, "a brush")
    require_type(title, str, "a title")
    _core.check(brush)
    # a cell that was made in Python must be valid as a file: each key within its range
    cell = parse_cell(write_cell(cell)) if cell else find_cell()
    suffix = Path(path).suffix.lower()
    cell = as_exact_as(cell, DEFAULT_TOLERANCE_MM)
    marks, loads = _core.simulate(plan, brush), split_into_loads(plan, brush, cell)
    walk = check_job(loads, brush, marks, cell, DEFAULT_TOLERANCE_MM, of_drawing=False)
    notices = report_other_brush(plan, brush)
    notes = [f"warnings: {len(notices)}"] if notices else []
    name = Path(path).stem
    write_files(in_files(path, encode_checked(suffix, plan, walk, brush, title, notes, name)))
    cell_notices = list_cell_notices(cell) if suffix != ".json" else []
    return [*notices, *report_program(suffix, loads, brush, cell, name), *cell_notices]
