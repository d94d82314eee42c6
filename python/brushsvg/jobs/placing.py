"""Find where an arm reaches the paper, as `brushsvg cell place` does."""

from __future__ import annotations

import math
import os
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Unpack

from ..errors import Error, Notice, name_file_in_errors
from ..files import write_files
from ..machine.arm.inverse_kinematics import joints_of
from ..machine.cells.cell import Cell
from ..machine.job_program import find_moves_out_of_limits
from ..machine.moves import Program
from ..machine.paint_reload import split_into_loads
from ..machine.preflight import DEFAULT_TOLERANCE_MM, as_exact_as
from ..machine.setup_programs import make_sheet_program
from ..machine.writer import whole_program
from ..model.library import find_brush
from .choices.choice_checks import refuse_file_used_twice
from .choices.choices import ChoiceKeywords, Choices, path_of, suffix_of
from .choices.drawing_settings import fill_from_drawing
from .choices.ineffective_flags import (
    LAYOUT_FLAGS,
    PLANNING_FLAGS,
    report_flags_without_effect,
    report_ineffective_flags,
)
from .conversion import check_output_path, make_choices
from .options import DEFAULT_BRUSH, load_brush, load_cell, make_options
from .preparation import preparation
from .setting_up import DEFAULT_SHEET_MM, Warn

if TYPE_CHECKING:
    from .preparation.preparation import Source

Stage = Callable[[str], object]


@dataclass(frozen=True)
class PaperPlacement:
    """Where an arm reaches the paper.

    problems: what the arm cannot do, or which limits are broken, with the paper where it is; () if it reaches all.
    cell: the cell as given, with the paper at the nearest place where the arm reaches all; None if no such place was
        found.
    move_text: how the paper is moved or turned to get there; "" if it stays.
    start_deg: angles of the joints (6,) in which to begin there [deg], or turned by whole turns; None without a place.
    picture: a map of the table or wall with the paper, the text of an SVG or the bytes of a PNG; None without a path.
    notices: warnings.
    """

    problems: tuple[Notice, ...]
    cell: Cell | None = field(repr=False)
    move_text: str
    start_deg: tuple[float, ...] | None
    picture: str | bytes | None = field(default=None, repr=False)
    notices: tuple[Notice, ...] = ()


def place_paper(
    cell: str | os.PathLike[str] | Cell,
    drawing: Source | None = None,
    picture: str | os.PathLike[str] | None = None,
    **choices: Unpack[ChoiceKeywords],
) -> PaperPlacement:
    """Find the nearest place of the paper at which an arm can paint a drawing, as `brushsvg cell place` does.

    cell: a cell with a table [arm].
    drawing: what will be painted, as `convert` takes it; without one, the whole sheet is tried.
    picture: the path of a map of the table or wall (.png .svg), if it is to be written.
    choices: as for `convert`. Without a drawing, only `sheet` (200 x 100 mm by default) and `brush` have an effect.

    Raises Error for a cell without an arm, a drawing that cannot be painted, and if ssik is not installed.
    """
    chosen = make_choices(drawing, {**choices, "cell": cell})
    path = check_output_path("picture", picture)
    refuse_file_used_twice(chosen, [path])
    notices: list[Notice] = []
    placement = find_placement(chosen, path, warn=lambda _, some: notices.extend(some))
    if path is not None:
        write_files({path: placement.picture})
    return replace(placement, notices=tuple(notices))


def find_placement(
    chosen: Choices,
    path: str | None,
    stage: Stage = lambda text: None,
    warn: Warn = lambda file, notices: None,
) -> PaperPlacement:
    """Find the nearest place of the paper, and report warnings with their file as soon as they are known.

    chosen: the cell, and a drawing or None as the input.
    path: the path of the map, which gives its format; None for no map.
    """
    from ..machine.arm import place
    from ..machine.arm.follow_joints import follow

    cell = load_cell(chosen.cell)
    with name_file_in_errors(path_of(chosen.cell)):
        if cell.arm is None:
            sentence = f"cell {cell.name} has no [arm] table: brushsvg does not know what its machine reaches"
            raise Error(sentence, code="arm-missing", advice="describe its links and joints in a table [arm]")
        joints = joints_of(cell.arm)
    program, sheet_mm = _program_to_place(chosen, cell, stage, warn)
    stage("following the joints")
    followed = follow(program, joints)
    problems = (*followed.problems, *find_moves_out_of_limits(program, sheet_mm))
    found = None
    if problems:
        found = place.find_nearest_place(program, joints, lambda moved: not find_moves_out_of_limits(moved, sheet_mm))
        if found:
            followed = follow(place.move_paper(program, found.frame), joints)
        else:
            problems = (replace(problems[0], advice=place.NO_PLACE_FOUND), *problems[1:])
    picture = None
    if path is not None:
        from ..show.table_picture import table_picture

        stage("checking places for the paper")
        table = place.rate_table(cell, program.robot_from_frame, joints)
        frames = program.robot_from_frame, found and found.frame
        picture = table_picture(suffix_of(path), table, cell, sheet_mm, *frames)
    if problems and not found:
        return PaperPlacement(problems, None, "", None, picture)
    return PaperPlacement(
        problems,
        place.move_paper_of_cell(cell, found.frame) if found else cell,
        found.text if found else "",
        tuple(map(math.degrees, followed.start_rad)),
        picture,
    )


def _program_to_place(chosen: Choices, cell: Cell, stage: Stage, warn: Warn) -> tuple[Program, tuple[float, float]]:
    """Return a drawing's program, or one that goes round the whole sheet, and the size of the sheet."""
    warn(path_of(chosen.cell), report_flags_without_effect(chosen, ["z-offset"], "the place of the paper"))
    if chosen.input is None:
        flags = (flag for flag in ("colour", "speed", *LAYOUT_FLAGS, *PLANNING_FLAGS) if flag != "sheet")
        warn(path_of(chosen.cell), report_flags_without_effect(chosen, flags, "the whole sheet"))
        sheet_mm = chosen.sheet or DEFAULT_SHEET_MM
        brush = load_brush(chosen.brush) or find_brush(DEFAULT_BRUSH)
        return make_sheet_program(brush, as_exact_as(cell, DEFAULT_TOLERANCE_MM), sheet_mm), sheet_mm
    drawing = path_of(chosen.input)
    with name_file_in_errors(drawing):
        chosen = fill_from_drawing(chosen, chosen.input)
        warn(drawing, report_ineffective_flags(chosen))
        work = preparation.prepare(chosen.input, make_options(chosen, cell), stage)
        warn(drawing, work.notices)
        loads = split_into_loads(work.plan, work.brush, work.options.cell)
    return whole_program(loads, work.brush, work.options.cell), work.plan.sheet_mm
