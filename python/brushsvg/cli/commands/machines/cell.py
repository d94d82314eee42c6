"""brushsvg cell: list, show, check, new, place."""

from __future__ import annotations

import os
from dataclasses import replace

from ....errors import Notice
from ....jobs.options import DEFAULT_BRUSH
from ....jobs.placing import find_placement
from ....machine.arm.inverse_kinematics import is_installed, joints_of
from ....machine.cells import cell_check as cell_checks
from ....machine.cells.cell import robot_from_paper
from ....machine.cells.cell_file import DEFAULT_CELL, cell_names, find_cell, own_name, parse_cell, write_cell
from ....machine.cells.describe_cell import cell_page
from ....machine.job_program import find_stations_out_of_limits
from ....machine.posts import POSTS
from ....machine.posts.robodk import find_post
from ....machine.preflight import DEFAULT_TOLERANCE_MM, check_rounding
from ....model.library import find_brush
from ...console import RefusedError, print_text, refuse_errors, stage, warn
from ...steps.options import make_choices
from ...steps.output_places import check_outputs, print_list, write_outputs


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
    check_outputs(args, args.output)
    with refuse_errors(""):  # errors name their file themselves
        found = find_placement(make_choices(args, input=args.drawing, cell=args.input), args.output, stage, warn)
    if args.output:
        write_outputs(args, {args.output: found.picture})
    if not found.problems:
        print_text(f"{args.input}: arm {found.cell.arm.name} reaches all of it with the paper where it is\n")
    elif found.cell:
        pose = _format_pose(found.cell.paper)
        print_text(f"{args.input}: the arm reaches all of it with the sheet {found.move_text}: {pose}\n")
    if found.start_deg is not None:
        angles = ", ".join(str(round(angle)) for angle in found.start_deg)
        print_text(f"{args.input}: it begins with its joints at {angles} degrees, or turned by whole turns\n")
    if found.problems:
        raise RefusedError(args.drawing or args.input, list(found.problems))


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
