"""brushsvg check: a program read back, simulated, and held against what it should paint."""

from __future__ import annotations

from .. import convert, machine
from ..brushes import brush_names, find_brush
from ..cell import Cell
from ..cell_file import cell_names, find_cell
from ..console import RefusedError, about, stage, tell
from ..errors import Error
from ..files import read_bytes
from ..fold import folded
from ..moves import duration_s
from .choices import brush_of
from .outputs import check_places, suffix_of, write
from .work import prepare


def check_file(args) -> None:
    from .. import checking, comparing
    from ..readback import read_program
    from ..readback.header import made as made_of

    check_places(args.preview)
    with about(args.program):
        text = read_bytes(args.program).decode("latin-1")
        made = made_of(text)
        for kind, name, names in (("cell", made.cell, cell_names()), ("brush", made.brush, brush_names())):
            if getattr(args, kind) is None and name not in names:
                raise Error(
                    f"the program names {kind} {name!r}, which does not come along: give --{kind} FILE"
                )
        cell = find_cell(args.cell if args.cell is not None else made.cell)
        brush = brush_of(args) or find_brush(made.brush)
        z_offset_mm = made.z_offset_mm if args.z_offset is None else args.z_offset
        read = read_program(text, suffix_of(args.program), cell)
    work = _as_made(args, made, cell, brush) if args.input else None
    cell = machine.as_exact_as(cell, made.tolerance_mm or machine.DEFAULT_TOLERANCE_MM)
    with about(args.program):
        sheet_mm = work.plan.sheet_mm if work else args.sheet or made.sheet_mm
        if sheet_mm is None:
            raise Error("its header does not say how large the sheet is: give --sheet or the drawing")
        ran = checking.run(read, brush, cell, sheet_mm, z_offset_mm)
        problems = ran.problems
        again = comparing.again(ran, brush, cell, z_offset_mm)
        changed = again and comparing.differing_line(text, again, cell)
        problems = problems + ([("", changed)] if changed else [])
        strokes, drawn = None, None
        if work:
            loads = convert.in_loads(work, cell).plan
            which, unlike = comparing.with_plan(ran, loads, cell)
            problems = problems + unlike
            if work.strokes is not None:
                whole = convert.whole_strokes(work, loads)
                strokes = None if None in which else [whole[k] for k in which]
                drawn = work.strokes if ran.first_stroke == 1 else None
        shown = convert.Work(made.title, brush, ran.plan, strokes, (), convert.Options(), ())
        if args.preview:
            outlined = convert.outlined(ran.marks, brush, stage)
            write({args.preview: convert.picture(suffix_of(args.preview), shown, outlined)})
        seconds = duration_s(again) if again else 0.0
        suffix = ".json" if args.json else ".txt"
        tell(convert.report_text(suffix, shown, ran.marks, cell, drawn=drawn, seconds=seconds))
    if problems:
        raise RefusedError([(args.program, *problem) for problem in folded(problems)])
    if not args.json:
        known = "" if work else "; without its drawing nobody can say whether it is the right one"
        tell(f"{args.program}: nothing forbids to run it{known}\n")


def _as_made(args, made, cell: Cell, brush) -> convert.Work:
    """The drawing or plan that a program should paint, prepared as its header says."""
    if suffix_of(args.input) != ".json":
        args.compensation, args.tolerance, args.lag = made.compensation, made.tolerance_mm, made.lag_mm
    work = prepare(args, cell, brush)
    return convert.nearest_first(work) if made.nearest_first else work
