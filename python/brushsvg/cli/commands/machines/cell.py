"""brushsvg cell: list, show, check, new, place."""

from __future__ import annotations

import math
import os
from dataclasses import replace

from ....errors import Error, Notice
from ....jobs.choices.ineffective_flags import LAYOUT_FLAGS, report_flags_without_effect
from ....jobs.options import DEFAULT_BRUSH
from ....machine.arm.inverse_kinematics import is_installed, joints_of
from ....machine.cells import cell_check as cell_checks
from ....machine.cells.cell import robot_from_paper
from ....machine.cells.cell_file import DEFAULT_CELL, cell_names, find_cell, own_name, parse_cell, write_cell
from ....machine.cells.describe_cell import cell_page
from ....machine.job_program import find_stations_out_of_limits
from ....machine.paint_reload import split_into_loads
from ....machine.posts import POSTS
from ....machine.posts.robodk import find_post
from ....machine.preflight import DEFAULT_TOLERANCE_MM, check_rounding
from ....machine.writer import whole_program
from ....model.library import find_brush
from ...console import RefusedError, print_text, refuse_errors, stage, warn
from ...steps.options import apply_drawing_settings, load_brush, load_exact_cell, make_choices
from ...steps.output_places import check_outputs, print_list, suffix_of, write_outputs
from ...steps.prepared import prepare


def cell_list(_args) -> None:
    print_list(cell_names(), lambda name: find_cell(name).description)


def cell_show(args) -> None:
    with refuse_errors(args.input):
        print_text(cell_page(find_cell(args.input)) + "\n")


def cell_check(args) -> None:
    with refuse_errors(args.input):
        cell = find_cell(args.input)
        if cell.language in POSTS:
            check_rounding(cell, DEFAULT_TOLERANCE_MM)
        if cell.arm and is_installed():
            joints_of(cell.arm)
        if cell.robodk:
            find_post(cell.robodk.post)
    if cell.language not in POSTS:
        known_languages = ", ".join(POSTS)
        sentence = f"no program can be written in {cell.language!r} yet, only plans; known: {known_languages}"
        warn(args.input, [Notice("language", sentence, code="language-unknown")])
    frame = robot_from_paper(cell)
    if problems := cell_checks.report_workspace_out_of_reach(cell) or find_stations_out_of_limits(
        find_brush(DEFAULT_BRUSH), cell, frame
    ):
        raise RefusedError(args.input, problems)
    warn(args.input, cell_checks.report_unusual_values(cell))
    print_text(f"{args.input}: cell {cell.name} can be used\n")


def cell_place(args) -> None:
    from ....machine.arm import place
    from ....machine.arm.follow_joints import follow
    from ....machine.job_program import find_moves_out_of_limits
    from ....machine.setup_programs import make_sheet_program
    from ....show.table_picture import table_picture

    check_outputs(args, args.output)
    cell = load_exact_cell(args.input)
    with refuse_errors(args.input):
        if cell.arm is None:
            sentence = f"cell {cell.name} has no [arm] table: brushsvg does not know what its machine reaches"
            raise Error(sentence, code="arm-missing")
        joints = joints_of(cell.arm)
    if args.drawing:
        chosen = apply_drawing_settings(make_choices(args, input=args.drawing, cell=args.input), args.drawing)
        work = prepare(chosen, cell)
        sheet_mm = work.plan.sheet_mm
        program = whole_program(split_into_loads(work.plan, work.brush, cell), work.brush, cell)
    else:
        flags = (flag for flag in (*LAYOUT_FLAGS, "wide") if flag != "sheet")
        warn(args.input, report_flags_without_effect(make_choices(args, input=None), flags, "the whole sheet"))
        sheet_mm = args.sheet or DEFAULT_SHEET_MM
        program = make_sheet_program(load_brush(args.brush) or find_brush(DEFAULT_BRUSH), cell, sheet_mm)
    stage("following the joints")
    followed = follow(program, joints)
    problems = [*followed.problems, *find_moves_out_of_limits(program, sheet_mm)]
    nearest_place = (
        place.find_nearest_place(program, joints, lambda moved: not find_moves_out_of_limits(moved, sheet_mm))
        if problems
        else None
    )
    followed_there = (
        followed if nearest_place is None else follow(place.move_paper(program, nearest_place.frame), joints)
    )
    if args.output:
        stage("checking places for the paper")
        table = place.rate_table(cell, program.robot_from_frame, joints)
        drawn = table_picture(
            suffix_of(args.output),
            table,
            cell,
            sheet_mm,
            program.robot_from_frame,
            nearest_place and nearest_place.frame,
        )
        write_outputs(args, {args.output: drawn})
    if not problems:
        print_text(f"{args.input}: arm {cell.arm.name} reaches all of it with the paper where it is\n")
    elif nearest_place:
        pose = place.move_paper_of_cell(cell, nearest_place.frame).paper
        print_text(
            f"{args.input}: the arm reaches all of it with the sheet {nearest_place.text}: {_format_pose(pose)}\n"
        )
    if followed_there.start_rad is not None:
        angles = ", ".join(str(round(math.degrees(angle))) for angle in followed_there.start_rad)
        print_text(f"{args.input}: it begins with its joints at {angles} degrees, or turned by whole turns\n")
    if problems:
        if not nearest_place:
            problems[0] = replace(problems[0], advice=place.NO_PLACE_FOUND)
        raise RefusedError(args.drawing or args.input, problems)


DEFAULT_SHEET_MM = (200.0, 100.0)


def _format_pose(paper) -> str:
    origin, turned = (", ".join(f"{v:g}" for v in each) for each in (paper.origin_mm, paper.rotation_deg))
    return f"origin_mm = [{origin}], rotation_deg = [{turned}]"


def cell_new(args) -> None:
    check_outputs(args, args.output, sources=[args.output])
    with refuse_errors(args.like or DEFAULT_CELL):
        cell = find_cell(args.like or DEFAULT_CELL)
    name = os.path.splitext(os.path.basename(args.output))[0]
    with refuse_errors(args.output):
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
        text = write_cell(replace(cell, name=own_name(name), paper=paper))
        new_cell = parse_cell(text)
    warn(
        args.output, cell_checks.report_workspace_out_of_reach(new_cell) or cell_checks.report_unusual_values(new_cell)
    )
    write_outputs(args, {args.output: text}, sources=[args.output])
