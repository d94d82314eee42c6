"""brushsvg check: a program read back, simulated, and held against what it should paint."""

from __future__ import annotations

import json

from ....errors import Error
from ....jobs import outputs, prediction
from ....jobs.checking import Check, check_program
from ....reporting.report_text import AGAINST
from ....show.evaluation import report
from ....text_summary import summarized
from ....units import clock
from ...console import RefusedError, print_text, refuse_errors, stage, warn
from ...steps.options import make_choices
from ...steps.output_places import check_outputs, suffix_of, write_outputs

RUNNABLE = "OK to run: no problem found"


def check_file(args) -> None:
    check_outputs(args, args.picture)
    with refuse_errors(""):  # errors name their file
        done = check_program(args.program, make_choices(args), stage, warn)
    with refuse_errors(args.program):
        if done.is_foreign and args.lenient:
            sentence = "brushsvg did not write it: --lenient would change nothing"
            raise Error(sentence, code="flag-without-effect")
        if done.work is None and args.picture:
            raise Error("it paints no drawing: there is no picture of it", code="nothing-to-show")
        if args.picture:
            outlined = prediction.outlined(done.marks, done.work.brush, stage)
            picture = outputs.picture(suffix_of(args.picture), done.work, outlined)
            overlap = None if done.is_foreign else done.figures.total.overlap
            write_outputs(args, {args.picture: picture}, len(done.plan.passes), done.time_s, overlap)
    if done.job == "painting":
        print_text(report.as_text(".json" if args.json else ".txt", done.figures, args.details))
    elif args.json:
        print_text(json.dumps(_make_json(done)) + "\n")
    else:
        print_text(f"{args.program}: {_describe_setup_job(done)}; takes about {clock(done.time_s)}\n")
    if done.problems:
        raise RefusedError(args.program, summarized(list(done.problems)))
    if not args.json:
        print_text(f"{args.program}: {_describe_outcome(done)}\n")


def _describe_outcome(done: Check) -> str:
    if done.is_foreign:
        return (
            f"brushsvg did not write it; with brush {done.work.brush.name} it keeps the limits that are checked: "
            "depth, speed, rapid moves while the brush touches, the sheet, the workspace"
        )
    if done.figures is not None and done.figures.verdict.startswith(AGAINST):
        return "it breaks no limit, but its paint is not what the drawing needs: read the verdict above"
    is_alone = not done.is_compared and done.job in ("painting", "border")
    return RUNNABLE + ("; it was not compared with a drawing" if is_alone else "")


def _describe_setup_job(done: Check) -> str:
    """What a program before the first stroke does."""
    if done.job == "border":
        left, bottom, right, top = done.border_mm
        return (
            f"goes round {left:.2f} to {right:.2f} mm, {bottom:.2f} to {top:.2f} mm of the sheet, in the air"
        )
    if done.job == "first-run":
        does = "goes round the sheet in the air, touches it at four points, strokes at heights from {:g} to {:g} mm"
        return does.format(*done.heights_mm)
    highest, lowest, step = done.heights_mm
    return f"strokes at heights from {highest:g} to {lowest:g} mm, {step:g} mm apart"


def _make_json(done: Check) -> dict:
    made = {"job": done.job, "time_s": round(done.time_s, 3)}
    return made | ({"border_mm": done.border_mm} if done.border_mm else {"heights_mm": done.heights_mm})
