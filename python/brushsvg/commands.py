"""What the commands do: call the steps in order, warn, refuse, write everything or nothing."""

from __future__ import annotations

import os
from dataclasses import replace

from . import _core, convert, machine, paint, report
from . import cell_check as cell_checks
from ._core import remarks, write_brush
from .brushes import brush_names, find_brush
from .cell import Cell
from .cell_file import DEFAULT_CELL, cell_names, find_cell, read_cell, write_cell
from .console import RefusedError, about, clear_stage, say, stage, tell, warn
from .describe import LAWS, cell_page, one_line, page, reach
from .design import Notice
from .errors import Error
from .files import read_bytes, write_files
from .fold import folded
from .importers import ReadOptions, read_drawing, settings_in
from .layout import Layout, arrange
from .moves import duration_s
from .posts import POSTS
from .program import Job
from .strokes import strokes as strokes_of


def convert_file(args) -> None:
    _check_places(args.output, args.preview, args.report)
    _settle(args)
    cell = _cell(args)
    work = _prepare(args, cell)
    cell = machine.as_exact_as(cell, work.options.tolerance_mm)
    damaged = [] if args.lenient else [notice for notice in work.notices if notice.damaged]
    warn(args.input, [(n.where, n.sentence) for n in work.notices if n not in damaged])
    job = Job(args.z_offset, args.from_stroke)
    notes = convert.notes(work)
    if args.order == "nearest":
        work, notes = convert.nearest_first(work), (*notes, "order: nearest first")
    with about(args.input):
        if _suffix(args.output) != ".json":
            machine.post_for(_suffix(args.output), cell)
        marks = convert.predict(work, _suffix(args.preview) == ".svg", stage)
        problems = machine.problems(work.plan, work.brush, marks, cell, work.options.tolerance_mm, job)
        problems = folded([*problems, *((n.where, n.sentence) for n in damaged)])
        if damaged:
            where, sentence = problems[-1]
            problems[-1] = (where, f"{sentence} (--lenient draws what is sound)")
        if problems:
            raise RefusedError([(args.input, *problem) for problem in problems])
        program = machine.encode(_suffix(args.output), work.plan, work.brush, work.title, notes, cell, job)
        files = {args.output: program}
        if args.preview:
            files[args.preview] = convert.picture(_suffix(args.preview), work, marks)
        if args.report:
            files[args.report] = convert.report_text(_suffix(args.report), work, marks, cell)
        too_long = paint.too_long(convert.in_loads(work, cell).plan, work.brush, cell)
    if _suffix(args.output) != ".json":
        warn(args.input, too_long)
    _warn_of_example(args, cell)
    _write(files)


def _warn_of_example(args, cell: Cell) -> None:
    if cell.paper.example and _suffix(args.output) != ".json":
        sentence = "the paper's place is an example: teach yours (brushsvg cell new --taught ...)"
        say(cell.name, "paper", sentence)


def border_file(args) -> None:
    from .jobs import border

    _check_places(args.output)
    _settle(args)
    cell = _cell(args)
    work, marks, _ = _look(args, cell, outlines=False)
    with about(args.input):
        post = machine.post_for(_suffix(args.output), cell)
        made = border(machine.bounds_mm(marks, work.brush), work.brush, cell, args.z_offset)
        header = (f"title: border of {work.title or 'untitled'}", *machine.about(made, Job(args.z_offset)))
        text = machine.text_of(post, replace(made, header=header))
    _warn_of_example(args, cell)
    _write({args.output: text})


def height_file(args) -> None:
    from .jobs import paper_height

    _check_places(args.output)
    cell, brush = _cell(args), _brush(args) or find_brush(convert.DEFAULT_BRUSH)
    with about(cell.name):
        post = machine.post_for(_suffix(args.output), cell)
        made = paper_height(brush, cell, args.sheet, args.highest, args.lowest, args.step)
        header = ("title: how high the paper lies", f"brush: {brush.name}", *machine.about(made))
        text = machine.text_of(post, replace(made, header=header))
    _warn_of_example(args, cell)
    _write({args.output: text})


def chart_file(args) -> None:
    from .chart import chart
    from .chart_json import write_chart
    from .chart_page import chart_page
    from .chart_report import chart_report

    _check_places(args.output, args.page, args.chart)
    brush = _brush(args) or find_brush(convert.DEFAULT_BRUSH)
    cell = machine.as_exact_as(_cell(args), machine.DEFAULT_TOLERANCE_MM)
    with about(args.output):
        if _suffix(args.output) != ".json":
            machine.post_for(_suffix(args.output), cell)
        stage("laying out the chart")
        made = chart(brush, args.sheet, args.strokes, -cell.heights.lowest_mm)
        job = Job(args.z_offset)
        marks = _core.simulate(made.plan, brush)
        problems = machine.problems(made.plan, brush, marks, cell, machine.DEFAULT_TOLERANCE_MM, job)
        if problems:
            raise RefusedError([(args.output, *problem) for problem in folded(problems)])
        title = f"calibration chart of brush {brush.name}"
        files = {args.output: machine.encode(_suffix(args.output), made.plan, brush, title, (), cell, job)}
    if args.page:
        files[args.page] = chart_page(made).encode()
    if args.chart:
        files[args.chart] = write_chart(made).encode()
    _warn_of_example(args, cell)
    _write(files)
    tell(chart_report(made, brush, args.noise))


def check_file(args) -> None:
    from . import checking, comparing  # here and below: what only one command needs is loaded by it
    from .readback import read_program
    from .readback.header import made as made_of

    _check_places(args.preview)
    with about(args.program):
        text = read_bytes(args.program).decode("latin-1")
        made = made_of(text)
        for kind, name, names in (("cell", made.cell, cell_names()), ("brush", made.brush, brush_names())):
            if getattr(args, kind) is None and name not in names:
                raise Error(
                    f"the program names {kind} {name!r}, which does not come along: give --{kind} FILE"
                )
        cell = find_cell(args.cell if args.cell is not None else made.cell)
        brush = _brush(args) or find_brush(made.brush)
        z_offset_mm = made.z_offset_mm if args.z_offset is None else args.z_offset
        read = read_program(text, _suffix(args.program), cell)
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
            _write({args.preview: convert.picture(_suffix(args.preview), shown, outlined)})
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
    if _suffix(args.input) != ".json":
        args.compensation, args.tolerance, args.lag = made.compensation, made.tolerance_mm, made.lag_mm
    work = _prepare(args, cell, brush)
    return convert.nearest_first(work) if made.nearest_first else work


def predict_file(args) -> None:
    _check_places(args.output)
    _settle(args)
    suffix = _suffix(args.output)
    outlines = suffix != ".png" or args.band
    work, marks, _ = _look(args, _cell(args), outlines=outlines, whole=suffix == ".json")
    with about(args.input):
        band = None
        if args.band:
            from .uncertainty import band as band_of

            stage("finding how sure it is")
            band = band_of(work.plan, work.brush, marks)
            if not any(band.rings):
                say(work.brush.name, band.words)
        picture = convert.picture(_suffix(args.output), work, marks, band)
    _write({args.output: picture})


def animate_file(args) -> None:
    _check_places(args.output)
    _settle(args)
    cell = _cell(args)
    work, marks, _ = _look(args, cell, outlines=True, in_loads=True)
    with about(args.input):
        page = convert.played(work, marks, cell, args.speed)
    _write({args.output: page})


def import_file(args) -> None:
    _check_places(args.output)
    with about(args.input):
        stage("reading")
        design = arrange(read_drawing(args.input, _reading(args)), _layout(args))
        try:
            strokes, notices = strokes_of(design, args.paths_as)
        except Error as nothing:  # a drawing with nothing to paint is worth looking at, too
            if args.editable:
                raise
            strokes, notices = [], [Notice(nothing.where, str(nothing))]
        notices = [*design.notices, *notices]
        warn(args.input, [(notice.where, notice.sentence) for notice in notices])
        if args.editable:
            from .lines_svg import lines_svg

            picture = lines_svg(strokes, design.sheet_mm, design.title).encode()
        else:
            from .overview import overview

            picture = overview(_suffix(args.output), design, strokes, notices)
    _write({args.output: picture})


def text_file(args) -> None:
    _check_places(args.output)
    from .text import text_svg

    with about(args.font):
        stage("setting the text")
        drawing, notices = text_svg(
            args.input.replace("\\n", "\n"),
            read_bytes(args.font),
            size_mm=args.size,
            width_mm=args.width,
            sheet_mm=args.sheet,
        )
    warn(args.font, [(notice.where, notice.sentence) for notice in notices])
    _write({args.output: drawing.encode()})


def report_file(args) -> None:
    _check_places(args.preview)
    if args.all_brushes:
        return _all_brushes(args)
    args.brush = args.brush[0] if args.brush else None
    _settle(args)
    cell = _cell(args)
    work, marks, warnings = _look(args, cell, outlines=_suffix(args.preview) == ".svg", partly=True)
    with about(args.input):
        stage("trying other sizes")
        advice = convert.advice(work)
        if args.preview:
            _write({args.preview: convert.misses_picture(_suffix(args.preview), work, marks)})
        suffix = ".json" if args.json else ".txt"
        text = convert.report_text(suffix, work, marks, cell, warnings, advice=advice)
    if work.plan.passes or args.json:
        tell(text)
    elif advice:
        tell(advice + "\n")
    if work.refused:
        refused = folded((notice.where, notice.sentence) for notice in work.refused)
        raise RefusedError([(args.input, *each) for each in refused])


def _all_brushes(args) -> None:
    from . import suit

    given, args.brush = args.brush or [], None
    _settle(args)
    asked = [*brush_names(), *(name for name in given if name not in brush_names())]
    brushes = []
    for name in asked:
        with about(name):
            brushes.append(find_brush(name))
    cell = _cell(args)
    with about(args.input):
        suits = convert.suits(args.input, _options(args, cell), brushes, stage)
        title = arrange(read_drawing(args.input, _reading(args)), _layout(args)).title
        tell(suit.to_json(title, suits) if args.json else report.brushes_text(title, suits))


def _look(args, cell: Cell, outlines: bool, in_loads: bool = False, partly: bool = False, whole: bool = True):
    """Work, marks and warnings: what would forbid to run a program is only a warning to someone who looks."""
    work = _prepare(args, cell, partly=partly)
    with about(args.input):
        cell = machine.as_exact_as(cell, work.options.tolerance_mm)
        if in_loads:
            work = convert.in_loads(work, cell)
            too_long = paint.too_long(work.plan, work.brush, cell)
        marks = convert.predict(work, outlines, stage, whole)
        warnings = [(n.where, n.sentence) for n in work.notices]
        if work.plan.passes or not work.refused:
            warnings += machine.problems(work.plan, work.brush, marks, cell, work.options.tolerance_mm)
        warnings += too_long if in_loads else []
    warn(args.input, warnings)
    return work, marks, warnings


def _prepare(args, cell: Cell, brush=None, partly: bool = False) -> convert.Work:
    if _suffix(args.input) == ".json":
        for flag in (*LAYOUT_FLAGS, "wide", "compensation", "lag", "tolerance"):
            if getattr(args, {"as": "paths_as"}.get(flag, flag)) is not None:
                say(args.input, f"--{flag} has no effect on a plan, whose poses are fixed")
    with about(args.input):
        return convert.prepare(args.input, _options(args, cell, brush), stage, partly)


def _options(args, cell: Cell, brush=None) -> convert.Options:
    return convert.Options(
        brush=brush or _brush(args),
        reading=_reading(args),
        layout=_layout(args),
        compensation=args.compensation or convert.Options.compensation,
        lag_mm=args.lag,
        tolerance_mm=(_suffix(args.input) != ".json" and args.tolerance) or convert.Options.tolerance_mm,
        paths_as=args.paths_as,
        wide=args.wide or convert.Options.wide,
        speed_mm_s=min(convert.Options.speed_mm_s, cell.speeds.paint_mm_s),
    )


def _settle(args) -> None:
    """What was not typed is as the drawing says. It can only name what comes along: it reads no other file."""
    with about(args.input):
        said = settings_in(args.input)
        if args.brush is None and said.get("brush") not in brush_names():
            said.pop("brush", None)  # the strokes that ask for it are warned of
        if args.cell is None and said.get("cell", DEFAULT_CELL) not in cell_names():
            raise Error(f"the drawing asks for cell {said['cell']}, which does not come along: give --cell")
    for name, value in said.items():
        if getattr(args, name) is None:
            setattr(args, name, value)


LAYOUT_FLAGS = ("sheet", "units", "select", "layer", "width", "fit", "scale", "origin", "as")


def _brush(args):
    with about(args.brush or ""):
        return find_brush(args.brush) if args.brush is not None else None


def _cell(args) -> Cell:
    with about(args.cell or ""):
        return find_cell(args.cell) if args.cell is not None else find_cell()


def _reading(args) -> ReadOptions:
    return ReadOptions(args.sheet, args.units, args.select, lenient=True)  # damage is told with all the rest


def _layout(args) -> Layout:
    return Layout(tuple(args.layer or ()), args.width, args.fit, args.scale, args.origin)


def _suffix(path: str | None) -> str:
    return os.path.splitext(path or "")[1].lower()


def _check_places(*paths: str | None) -> None:
    """Whether the outputs can be written, as far as that can be said before any work is done."""
    for path in filter(None, paths):
        folder = os.path.dirname(os.path.realpath(path))
        reason = None
        if os.path.isdir(path):
            reason = "it is a directory"
        elif not os.path.isdir(folder):
            reason = "its directory does not exist"
        elif not os.access(folder, os.W_OK | os.X_OK):
            reason = "its directory is not writable"
        if reason:
            raise RefusedError([(path, "", f"the file cannot be written: {reason}")])


def _write(files) -> None:
    stage("writing")
    with about(""):  # the error names the file
        write_files(files)
    clear_stage()


def _tell_list(names: list[str], describe) -> None:
    width = max(map(len, names))
    for name in names:
        with about(name):
            tell(f"{name.ljust(width)}  {describe(name)}\n")


def brush_list(_args) -> None:
    _tell_list(brush_names(), lambda name: one_line(find_brush(name)))


def brush_show(args) -> None:
    with about(args.input):
        tell(page(find_brush(args.input)) + "\n")


def brush_check(args) -> None:
    with about(args.input):
        brush = find_brush(args.input)
        odd = remarks(brush)
    warn(args.input, odd)
    tell(f"{args.input}: brush {brush.name} can be used\n")


def calibrate_file(args) -> None:
    from .calibrate import calibrate
    from .fit_report import report, report_picture
    from .measurements import read_measurements

    _check_places(args.output, args.plot)
    with about(args.input):
        measured = read_measurements(read_bytes(args.input), _suffix(args.input))
        name = measured.name or os.path.splitext(os.path.basename(args.output))[0]
        if measured.marks is not None:
            made, report, report_picture = _from_marks(args, measured, name)
        else:
            made = calibrate(measured, name, args.norm == "absolute", args.total)
        files = {args.output: write_brush(made.brush)}
        if args.plot:
            files[args.plot] = report_picture(made, _suffix(args.plot))
    _write(files)
    warn(args.output, remarks(made.brush))
    tell(report(made))


def _from_marks(args, measured, name: str):
    """A brush from painted marks, and what tells of it in words and as a picture."""
    from .mark_calibrate import calibrate_marks, options_for
    from .mark_report import report, report_picture
    from .painted import read_painted

    folder = os.path.dirname(args.input)
    painted = read_painted(measured.plan, measured.marks, lambda path: read_bytes(os.path.join(folder, path)))
    options = options_for(measured.expected)
    made = calibrate_marks(painted, name, measured.depth_range_mm, measured.max_speed_mm_s, options)
    return made, report, report_picture


def brush_new(args) -> None:
    from .new_brush import new_brush, read_widths

    path = args.name if _suffix(args.name) == ".json" else f"{args.name}.json"
    name = os.path.splitext(os.path.basename(path))[0]
    _check_places(path)
    if os.path.exists(path):
        raise RefusedError([(path, "", "the file is there already: it might be somebody's brush")])
    widths = list(args.width_at)
    if args.widths:
        with about(args.widths):
            widths += read_widths(read_bytes(args.widths).decode("utf-8", "replace"))
    with about(path):
        if name in brush_names():
            raise Error(f"a brush named {name} comes along: give yours another name", "name")
        brush = new_brush(name, args.lag, widths, args.depth_max, args.speed)
        text = write_brush(brush)
    _write({path: text})
    tell(f"{path}: {reach(brush)}\n")
    assumed = [law for law, _ in LAWS if getattr(brush, law).assumed]
    tell(f"assumed: {', '.join(assumed)} and the footprints; brushsvg brush show {path} says how\n")


def brush_plot(args) -> None:
    from .plot import brush_picture

    _check_places(args.output)
    with about(args.input):
        picture = brush_picture(find_brush(args.input), _suffix(args.output))
    _write({args.output: picture})


def cell_list(_args) -> None:
    _tell_list(cell_names(), lambda name: find_cell(name).description)


def cell_show(args) -> None:
    with about(args.input):
        tell(cell_page(find_cell(args.input)) + "\n")


def cell_check(args) -> None:
    with about(args.input):
        cell = find_cell(args.input)
    if cell.language not in POSTS:
        known = ", ".join(POSTS)
        say(
            args.input,
            "language",
            f"no program can be written in {cell.language!r} yet, only plans; known: {known}",
        )
    if problems := cell_checks.out_of_reach(cell):
        raise RefusedError([(args.input, *problem) for problem in problems])
    warn(args.input, cell_checks.remarks(cell))
    tell(f"{args.input}: cell {cell.name} can be used\n")


def install_plugin(args) -> None:
    from .plugin import install_inkscape

    with about(args.plugin):
        folder = install_inkscape(args.zip)
    tell(f"{folder}: installed; start Inkscape again, and look under Extensions > Brush\n")


def cell_new(args) -> None:
    _check_places(args.output)
    if os.path.exists(args.output):
        raise RefusedError([(args.output, "", "the file is there already: it might be somebody's machine")])
    with about(args.like or DEFAULT_CELL):
        cell = find_cell(args.like or DEFAULT_CELL)
    name = os.path.splitext(os.path.basename(args.output))[0]
    with about(args.output):
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
        text = write_cell(replace(cell, name=name, paper=paper))
        made = read_cell(text)
    _write({args.output: text})
    warn(args.output, cell_checks.out_of_reach(made) or cell_checks.remarks(made))
