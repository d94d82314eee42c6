"""brushsvg check: a program read back, simulated, and held against what it should paint."""

from __future__ import annotations

import json

from ...brush.library import brush_names, find_brush
from ...drawing import settings_in
from ...drawing.gcode import is_ours
from ...errors import Error, Notice
from ...evaluation import report
from ...files import read_bytes
from ...machine import preflight
from ...machine.cell import Cell
from ...machine.cell_file import cell_names
from ...machine.motion import duration_s
from ...machine.paint_reload import in_loads
from ...machine.posts import GCODE
from ...machine.program import out_of_arm
from ...machine.writer import beside
from ...pipeline import outputs, prediction
from ...pipeline.choices import LAYOUT_FLAGS, MADE_FLAGS
from ...pipeline.foreign_program import foreign_program
from ...pipeline.options import DEFAULT_BRUSH, Options
from ...pipeline.work import Work, nearest_first, whole_strokes
from ...text_summary import summarized
from ...units import clock
from ..console import RefusedError, about, stage, tell, warn
from ..steps.options import brush_of, cell_of, exact_cell, typed, warn_of_arm
from ..steps.output_places import check_places, suffix_of, write
from ..steps.prepared import prepare


def check_file(args) -> None:
    from ...verification import against_plan, against_regenerated, simulate_program
    from ...verification.readback import read_program, text_of_file
    from ...verification.readback.fanuc import called
    from ...verification.readback.header import made as made_of
    from ...verification.readback.ros2 import as_table
    from ...verification.time_as_run import time_as_run_s

    check_places(args.preview)
    with about(args.program):
        data = read_bytes(args.program)
        text = text_of_file(b"" if suffix_of(args.program) == ".cdr" else data)
        if suffix_of(args.program) in GCODE and not is_ours(text):
            return _check_foreign(args, text)
        if suffix_of(args.program) == ".robodk":
            raise Error(
                "what a post of RoboDK's kind writes is in a language of its own, which is not read back",
                code="program-format",
            )
        if suffix_of(args.program) == ".cdr":
            raise Error(
                "a serialized message says nothing of brush and paper: check the .csv of the same job",
                code="program-format",
            )
        if suffix_of(args.program) == ".traj":
            text = as_table(text)
        others = called(text) if suffix_of(args.program) == ".ls" else []
        text += "".join(text_of_file(read_bytes(beside(args.program, name))) for name in others)
        made = made_of(text)
        for kind, name, names in (("cell", made.cell, cell_names()), ("brush", made.brush, brush_names())):
            if getattr(args, kind) is None and name not in names:
                raise Error(
                    f"the program names {kind} {name!r}, which does not come along",
                    code=f"{kind}-unknown",
                    advice=f"give --{kind} FILE",
                )
        cell = exact_cell(args.cell if args.cell is not None else made.cell, made.tolerance_mm)
        brush = brush_of(args.brush) or find_brush(made.brush)
        z_offset_mm = made.z_offset_mm if args.z_offset is None else args.z_offset
        read = read_program(text, suffix_of(args.program), cell)
    warn_of_arm(cell)
    if made.border_mm or made.heights_mm or made.first_mm:
        return _check_job(args, text, made, read, cell, brush, z_offset_mm)
    work = _as_made(args, made, cell, brush) if args.input else None
    with about(args.program):
        sheet_mm = work.plan.sheet_mm if work else args.sheet or made.sheet_mm
        if sheet_mm is None:
            raise Error(
                "its header does not say how large the sheet is: give --sheet or the drawing",
                code="sheet-unknown",
            )
        ran = simulate_program.run(read, brush, cell, sheet_mm, z_offset_mm)
        problems = ran.problems + simulate_program.misnumbered(read, made.first_stroke, made.strokes)
        strokes, drawn, speeds = None, None, None
        if work:
            loads = in_loads(work.plan, brush, cell)
            which, unlike = against_plan.with_plan(ran, loads, cell, made.first_stroke)
            problems = problems + unlike
            speeds = None if None in which else [loads.loads[k].speed_mm_s for k in which]
            if work.strokes is not None:
                whole = whole_strokes(work, loads)
                strokes = None if None in which else [whole[k] for k in which]
                drawn = work.strokes if made.first_stroke == 1 else None
        told = against_regenerated.Told(*_told_by(made, work))
        again = against_regenerated.again(ran, brush, cell, z_offset_mm, made.first_stroke, told, speeds)
        least_s = None
        if again and speeds is None:  # feeds may have been lowered since its time was told
            usual_mm_s = min(Options.speed_mm_s, again.touching_mm_s)
            fastest = [max(a_pass.speed_mm_s, usual_mm_s) for a_pass in ran.plan.passes]
            least_s = duration_s(
                against_regenerated.again(ran, brush, cell, z_offset_mm, made.first_stroke, None, fastest)
            )
        changed = again and against_regenerated.differing_line(text, read, again, cell, least_s)
        problems = problems + ([Notice("", changed, code="program-changed")] if changed else [])
        if again and not problems:
            problems = out_of_arm(again, sheet_mm)
        shown = Work(made.title, brush, ran.plan, strokes, (), Options(), ())
        if args.preview:
            outlined = prediction.outlined(ran.marks, brush, stage)
            picture = outputs.picture(suffix_of(args.preview), shown, outlined)
        seconds, as_run_s = duration_s(again) if again else 0.0, time_as_run_s(read, cell)
        if as_run_s > 1.1 * seconds + 1.0:  # feeds were lowered
            seconds = as_run_s
        figures = outputs.reported(shown, ran.marks, cell, drawn=drawn, seconds=seconds, as_run=ran.as_run)
        if args.preview:
            write(args, {args.preview: picture}, len(shown.plan.passes), seconds, figures.total.overlap)
        tell(report.as_text(".json" if args.json else ".txt", figures))
    _refuse_or_allow(args, problems, work is None)


def _check_foreign(args, text: str) -> None:
    """A program that somebody else wrote for a pen: what a brush paints with it, and which limits it breaks."""
    if args.input:
        sentence = "brushsvg did not write it: it paints no drawing that is known; check it alone"
        raise Error(sentence, code="nothing-to-compare")
    dest = {"as": "paths_as", "speed": "paint_speed", "z-offset": "z_offset"}
    for flag in (*LAYOUT_FLAGS, *MADE_FLAGS, "speed", "z-offset", "corrections", "lenient"):
        if flag != "sheet" and getattr(args, dest.get(flag, flag), None):
            sentence = f"brushsvg did not write it: --{flag} would change nothing"
            raise Error(sentence, code="flag-without-effect")
    cell = cell_of(args.cell)
    brush = brush_of(args.brush) or find_brush(DEFAULT_BRUSH)
    found = foreign_program(text, brush, cell, args.sheet)
    warn(args.program, found.warnings)
    shown = Work("", brush, found.plan, None, (), Options(cell=cell), ())
    if args.preview:
        outlined = prediction.outlined(found.marks, brush, stage)
        picture = outputs.picture(suffix_of(args.preview), shown, outlined)
        write(args, {args.preview: picture}, len(found.plan.passes))
    figures = outputs.reported(shown, found.marks, cell)
    tell(report.as_text(".json" if args.json else ".txt", figures))
    if found.problems:
        raise RefusedError(args.program, summarized(list(found.problems)))
    if not args.json:
        tell(
            f"{args.program}: brushsvg did not write it; with brush {brush.name} it keeps the limits asked of it: "
            "depth, speed, rapid moves while the brush touches, the sheet, the workspace\n"
        )


def _told_by(made, work: Work | None) -> tuple[str, tuple[str, ...]]:
    """Title and notes that a program's header should have: its drawing's, or its own where nobody knows better, as of a
    program that was made of a plan."""
    if (
        work is None
        or work.strokes is None
        or not made.notes[:1]
        or not made.notes[0].startswith("compensation")
    ):
        return made.title, made.notes
    order = [note for note in made.notes if note.startswith("order")]
    return work.title or "untitled", (*outputs.notes(work), *order)


def _check_job(args, text: str, made, read, cell: Cell, brush, z_offset_mm: float) -> None:
    """A program before the first stroke: it paints no drawing, and says in its header all that it does."""
    from ...verification import setup_programs

    with about(args.program):
        if args.preview:
            raise Error("it paints no drawing: there is no picture of it", code="nothing-to-show")
        if (made.heights_mm or made.first_mm) and args.input:
            raise Error(
                "it finds the paper's height and paints no drawing: check it alone", code="nothing-to-compare"
            )
        if made.sheet_mm is None:
            raise Error("its header does not say how large the sheet is", code="sheet-unknown")
    work = _as_made(args, made, cell, brush) if args.input else None
    with about(args.program):
        if made.border_mm:
            left, bottom, right, top = made.border_mm
            looked = setup_programs.look_at_border(
                text, read, made, brush, cell, work.plan.sheet_mm if work else made.sheet_mm, z_offset_mm
            )
            problems = looked.problems + (_border_notices(made, work) if work else [])
            does = f"goes round {left:.2f} to {right:.2f} mm, {bottom:.2f} to {top:.2f} mm of the sheet, in the air"
        elif made.first_mm:
            looked = setup_programs.look_at_first_run(text, read, made, brush, cell)
            problems = looked.problems
            does = "goes round the sheet in the air, touches it at four points, strokes at heights from {:g} to {:g} mm"
            does = does.format(*made.first_mm)
        else:
            looked = setup_programs.look_at_heights(text, read, made, brush, cell)
            problems = looked.problems
            highest, lowest, step = made.heights_mm
            does = f"strokes at heights from {highest:g} to {lowest:g} mm, {step:g} mm apart"
    if args.json:
        job = "border" if made.border_mm else "first-run" if made.first_mm else "height"
        told = {"job": job, "time_s": round(looked.time_s, 3)}
        heights_mm = made.first_mm or made.heights_mm
        told |= {"border_mm": made.border_mm} if made.border_mm else {"heights_mm": heights_mm}
        tell(json.dumps(told) + "\n")
    else:
        tell(f"{args.program}: {does}; takes about {clock(looked.time_s)}\n")
    _refuse_or_allow(args, problems, work is None and made.border_mm)


def _border_notices(made, work: Work) -> list[Notice]:
    """A sentence where an air run does not go round what a drawing's paint needs."""
    from ...machine.setup_programs import around

    marks = prediction.predict(work, outlines=False, stage=stage)
    needed, found = around(preflight.bounds_mm(marks, work.brush)), made.border_mm
    if max(abs(ours - theirs) for ours, theirs in zip(found, needed, strict=True)) <= STRAY_MM:
        return []
    place = "{0:.2f} to {2:.2f} mm, {1:.2f} to {3:.2f} mm"
    sentence = (
        f"the program goes round {place.format(*found)}, the drawing is painted within {place.format(*needed)}: it was "
        "changed, or made with other flags or of another drawing"
    )
    return [Notice("", sentence, code="border-elsewhere")]


STRAY_MM = 0.02  # what a plan's rounding makes of where its paint ends


def _refuse_or_allow(args, problems: list[Notice], is_alone: bool) -> None:
    if problems:
        raise RefusedError(args.program, summarized(problems))
    if not args.json:
        known = "; it was not compared with a drawing" if is_alone else ""
        tell(f"{args.program}: nothing forbids to run it{known}\n")


def _as_made(args, made, cell: Cell, brush) -> Work:
    """The drawing or plan that a program should paint, prepared as its header says; what of it is left out, or painted
    otherwise, is told again: this is the last look."""
    if made.is_corrected and args.corrections is None:
        with about(args.program):
            raise Error(
                "its strokes were led elsewhere by corrections, which are not known here",
                code="corrections-missing",
                advice="give --corrections FILE",
            )
    chosen = typed(args)
    if suffix_of(args.input) != ".json":
        with about(args.input):
            wide = args.wide or settings_in(args.input).get("wide")
        chosen = typed(
            args,
            compensation=made.compensation,
            tolerance=made.tolerance_mm,
            lag=made.lag_mm,
            start=made.start,
            end=made.end,
            z_offset=made.z_offset_mm,
            wide=wide,
        )
    work = prepare(chosen, cell, brush)
    warn(args.input, work.notices)
    return nearest_first(work) if made.nearest_first else work
