"""brushsvg calibrate: a brush of what was measured, or of photographs of a painted chart or job."""

from __future__ import annotations

import os

from ...._core import remarks, write_brush
from ....files import read_bytes
from ....jobs.json_files import read_plan
from ....jobs.machine_parts import undoable_parts
from ...console import about, stage, tell, warn
from ...steps.options import brush_of, cell_of
from ...steps.output_places import check_places, suffix_of, write
from .scan import read_photographs


def calibrate_file(args) -> None:
    from ....calibration.from_file import calibrate
    from ....calibration.marks.from_marks import MarkCalibration
    from ....calibration.marks.machine_found import doubts
    from ....calibration.numbers.law_report import report, report_picture
    from ....calibration.overlap.by_overlap import OverlapCalibration, by_overlap

    check_places(args, args.output, args.plot, args.picture, sources=[args.output])
    if args.cell is not None:
        cell = cell_of(args.cell)
        args.machine, left_out = undoable_parts(args.machine, cell)
        warn(args.cell, left_out)
    if args.plan is not None:
        update_file(args)
        return
    name = os.path.splitext(os.path.basename(args.output))[0]
    read = read_photographs(args, args.photos) if args.photos else None
    if read and _is_of_dabs(args, read):
        _calibrate_dabs(args, read, name)
        return
    if read and args.brush is not None:
        _calibrate_lag(args, read, name)
        return
    with about(args.input):
        if read:
            of_marks, report, report_picture = _from_photo(read, name, args)
            made = of_marks
            if args.aim == "overlap":
                from ....calibration.overlap.by_overlap_report import report, report_picture

                made = by_overlap(of_marks, stage)
        else:
            made = calibrate(
                args.input,
                name,
                absolute=args.norm == "absolute",
                total=args.total,
                machine=args.machine,
                paint=args.paint,
                aim=args.aim,
                progress=stage,
            )
            if isinstance(made, OverlapCalibration):
                from ....calibration.overlap.by_overlap_report import report, report_picture

                warn(args.input, doubts(made.by_edges.painted, made.by_edges.expected))
            elif isinstance(made, MarkCalibration):
                from ....calibration.marks.mark_report import report, report_picture

                warn(args.input, doubts(made.painted, made.expected))
            else:
                warn(args.input, made.doubts)
        files = {args.output: write_brush(made.brush)}
        if args.plot:
            files[args.plot] = report_picture(made, suffix_of(args.plot))
        more = ""
        if read:
            from ....calibration.chart.photograph import told
            from ....calibration.marks.mark_report import strays_told
            from ....calibration.marks.photo_report import read_picture

            warn(args.photos[0], strays_told(of_marks) + doubts(of_marks.painted, of_marks.expected))
            more = told(read)
            if args.picture:
                files[args.picture] = read_picture(read, made.made if args.aim == "overlap" else made)
    warn(args.output, remarks(made.brush))
    write(args, files, more=more, sources=[args.output])
    tell(report(made, of_photo=True) if read else report(made))


def _is_of_dabs(args, read) -> bool:
    from ....calibration.chart.dabs import is_of_dabs

    dabs = is_of_dabs(read.chart)
    if dabs and args.brush is None:
        args.parser.error(f"{args.chart} is a chart of dabs: give the brush whose lag is known, --brush FILE")
    if dabs and args.machine:
        args.parser.error("--machine needs strokes: dabs say nothing of the machine")
    if dabs and args.height is not None:
        args.parser.error("--height is for strokes: dabs are taken to be as deep as they were told")
    return dabs


def _calibrate_dabs(args, read, name: str) -> None:
    """Outlines of dabs into a brush whose lag is known."""
    from ....calibration.chart.dabs import dabs_of
    from ....calibration.chart.photograph import edge_mm, told
    from ....calibration.dabs.dab_report import report, report_picture
    from ....calibration.dabs.from_dabs import calibrate_dabs
    from ....calibration.marks.photo_report import dabs_picture

    before = brush_of(args.brush)
    joined = tuple(stroke for pair in read.marks.joined for stroke in pair)
    with about(args.input):
        made = calibrate_dabs(dabs_of(read), before, name, edge_mm(read), joined)
    files = {args.output: write_brush(made.brush)}
    if args.plot:
        files[args.plot] = report_picture(made, suffix_of(args.plot))
    if args.picture:
        files[args.picture] = dabs_picture(read, made)
    warn(args.input, made.remarks)
    warn(args.output, remarks(made.brush))
    write(args, files, more=told(read), sources=[args.output])
    tell(report(made))


def _calibrate_lag(args, read, name: str) -> None:
    """The lag of strokes into a brush whose outlines are known."""
    from ....calibration.chart.photograph import told
    from ....calibration.marks.mark_report import strays_told
    from ....calibration.marks.photo_report import read_picture
    from ....calibration.overlap.lag_by_outlines import lag_by_outlines, refuse_assumed
    from ....calibration.overlap.lag_by_outlines_report import report
    from ....model.plot import brush_picture

    own = brush_of(args.brush)
    with about(args.brush):
        refuse_assumed(own)
    with about(args.input):
        made, *_ = _from_photo(read, name, args)
        found = lag_by_outlines(made, own, name)
    files = {args.output: write_brush(found.brush)}
    if args.plot:
        files[args.plot] = brush_picture(found.brush, suffix_of(args.plot))
    if args.picture:
        files[args.picture] = read_picture(read, found.made)
    warn(args.photos[0], strays_told(made))
    warn(args.output, remarks(found.brush))
    write(args, files, more=told(read), sources=[args.output])
    tell(report(found))


def _from_photo(read, name: str, args):
    """The same from a photograph of a chart."""
    import json

    from ...._core import write_plan
    from ....calibration.chart.photograph import edge_mm, expected, marks_of
    from ....calibration.marks.from_marks import calibrate_marks, options_for
    from ....calibration.marks.machine_found import ask_for
    from ....calibration.marks.mark_input import read_painted
    from ....calibration.marks.mark_report import report, report_picture
    from ....calibration.marks.paint_found import calibrate_paint
    from ....comparison.repeats import read_displacement_mm

    stage("fitting the brush")
    painted = read_painted(json.loads(write_plan(read.chart.plan)), marks_of(read), read_bytes)
    known = {"displacement_mm": read_displacement_mm(args.spread)} if args.spread else {}
    known |= {"height_mm": args.height} if args.height is not None else {}
    options = options_for(expected(read) | known)
    ask_for(options, args.machine)
    fit = calibrate_paint if args.paint else calibrate_marks
    made = fit(painted, name, options=options, edge_mm=edge_mm(read), leave_out_strays=True)
    return made, report, report_picture


def update_file(args) -> None:
    """A brush that is known, updated by photographs of a painted job."""
    import hashlib

    from ....calibration.prior.from_prior import other_brush, refuse_learned, with_lineage
    from ....calibration.prior.update_report import report
    from ....comparison.learning import learn
    from ....comparison.repeats import read_displacement_mm

    before = brush_of(args.prior)
    with about(args.plan):
        plan = read_plan(args.plan)
    with about(args.spread or ""):
        spread_mm = read_displacement_mm(args.spread) if args.spread else None
    photos = [(path, _photo(path)) for path in args.photos]
    of_photos = [hashlib.sha256(data).hexdigest() for _, data in photos]
    with about(args.prior):
        refuse_learned(before, of_photos)
    warn(args.plan, other_brush(plan, before))
    name = os.path.splitext(os.path.basename(args.output))[0]
    with about(args.photos[0]):
        stage("reading the photographs and fitting the brush")
        learnt = learn(plan, before, photos, name, args.machine, spread_mm)
    made = learnt.updated
    with_lineage(made.brush, before, of_photos)
    warn(args.photos[0], list(learnt.notices))
    warn(args.output, remarks(made.brush))
    write(args, {args.output: write_brush(made.brush)}, sources=[args.output])
    tell(report(made))


def _photo(path: str) -> bytes:
    with about(path):
        return read_bytes(path)
