"""brushsvg check: read a program back, simulate it, and compare it."""

from __future__ import annotations

import json

from ....errors import Error
from ....jobs import outputs, prediction
from ....jobs.checking import Check, check_program
from ....notice_summary import summarize_notices
from ....reporting.report_text import AGAINST
from ....show.evaluation import report
from ....units import clock
from ...console import RefusedError, print_text, refuse_errors, stage, warn
from ...steps.options import make_choices
from ...steps.output_places import check_outputs, suffix_of, write_outputs

RUNNABLE = "OK to run: no problem found"


def check_file(args) -> None:
    check_outputs(args, args.picture)
    with refuse_errors(""):  # errors name their file themselves
        result = check_program(args.program, make_choices(args), stage, warn)
    with refuse_errors(args.program):
        if result.is_foreign and args.lenient:
            sentence = "brushsvg did not write this program: --lenient has no effect"
            raise Error(sentence, code="flag-without-effect")
        if result.work is None and args.picture:
            raise Error("the program paints no drawing: there is no picture of it", code="nothing-to-show")
        if args.picture:
            outlined = prediction.trace_mark_outlines(result.marks, result.work.brush, stage)
            picture = outputs.make_picture(suffix_of(args.picture), result.work, outlined)
            overlap = None if result.is_foreign else result.figures.total.overlap
            write_outputs(args, {args.picture: picture}, len(result.plan.passes), result.time_s, overlap)
    if result.job == "painting":
        print_text(report.as_text(".json" if args.json else ".txt", result.figures, args.details))
    elif args.json:
        print_text(json.dumps(_make_json(result)) + "\n")
    else:
        print_text(f"{args.program}: {_describe_setup_job(result)}; takes about {clock(result.time_s)}\n")
    if result.problems:
        raise RefusedError(args.program, summarize_notices(list(result.problems)))
    if not args.json:
        print_text(f"{args.program}: {_describe_outcome(result)}\n")


def _describe_outcome(result: Check) -> str:
    if result.is_foreign:
        return (
            f"brushsvg did not write it; with brush {result.work.brush.name} it keeps the limits that are checked: "
            "depth, speed, rapid moves while the brush touches, the sheet, the workspace"
        )
    if result.figures is not None and result.figures.verdict.startswith(AGAINST):
        return "it breaks no limit, but its paint is not what the drawing needs: read the verdict above"
    is_alone = not result.is_compared and result.job in ("painting", "border")
    return RUNNABLE + ("; it was not compared with a drawing" if is_alone else "")


def _describe_setup_job(result: Check) -> str:
    """Describe what a program before the first stroke does."""
    if result.job == "border":
        left, bottom, right, top = result.border_mm
        return f"goes round {left:.2f} to {right:.2f} mm, {bottom:.2f} to {top:.2f} mm of the sheet, in the air"
    if result.job == "first-run":
        template = "goes round the sheet in the air, touches it at four points, strokes at heights from {:g} to {:g} mm"
        return template.format(*result.heights_mm)
    highest, lowest, step = result.heights_mm
    return f"strokes at heights from {highest:g} to {lowest:g} mm, {step:g} mm apart"


def _make_json(result: Check) -> dict:
    common = {"job": result.job, "time_s": round(result.time_s, 3)}
    return common | ({"border_mm": result.border_mm} if result.border_mm else {"heights_mm": result.heights_mm})
