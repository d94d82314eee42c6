"""Arguments of the commands for drawings.

These are text, preview, convert, batch, compare and simulate-photo.
"""

from __future__ import annotations

from ...photo import PHOTOS
from ...read import READERS
from . import flags, values
from .usage_checks import (
    DRAWINGS,
    PICTURES,
    PROGRAMS,
    check_compensation,
    check_drawing,
    check_extension,
    check_files,
    check_job,
    suffix_of,
)


def add_convert(commands) -> None:
    convert = commands.add_parser("convert", help="turn a drawing into a robot program")
    flags.add_input(convert)
    flags.add_output(convert, flags.list_output_formats())
    flags.add_choices(convert)
    flags.add_speed(convert)
    flags.add_job_options(convert)
    flags.add_corrections(convert)
    flags.add_margin_strokes(convert)
    convert.add_argument(
        "--per-colour",
        action="store_true",
        help="write a program for each colour, the lightest first: OUT-1-ffd400.EXT, OUT-2-1a237e.EXT ...",
    )
    flags.add_picture(convert, "what will be painted")
    convert.add_argument(
        "--page", metavar="FILE", help="also write the page to paint on, with markers for compare (.pdf .svg)"
    )
    convert.add_argument("--report", metavar="FILE", help="also write the report (.txt .json .csv)")
    flags.add_write_options(convert)
    convert.set_defaults(run="convert_file", parser=convert, check=_check_convert)


def _check_convert(args) -> None:
    check_drawing(args)
    check_job(args)
    if args.per_colour and (args.colour or args.from_stroke != 1):
        args.parser.error(
            "--per-colour writes a whole program for each colour: for a part of them, leave it out and add --colour"
        )
    if args.per_colour and args.margin_strokes == "on":
        args.parser.error("--margin-strokes on does not go with --per-colour: leave one of them out")
    written = [
        (args.output, (".json", *PROGRAMS)),
        (args.picture, PICTURES),
        (args.page, (".pdf", ".svg")),
        (args.report, (".txt", ".json", ".csv")),
    ]
    read = [(args.input, DRAWINGS), (args.brush, None), (args.corrections, (".json",))]
    check_files(args, read, written)


def add_batch(commands) -> None:
    batch = commands.add_parser("batch", help="convert many drawings; continue where the last run ended")
    batch.add_argument(
        "inputs",
        metavar="IN",
        nargs="*",
        help=f"drawings ({' '.join(READERS)}), folders of them, patterns with *, lists (.txt, a path on each line); "
        "the brushsvg.toml of the first drawing applies to all",
    )
    flags.add_output(batch, "a folder for programs, pictures and tables")
    batch.add_argument("--words", metavar="FILE", help="a text: each line is set in --font and painted (.txt)")
    batch.add_argument("--font", metavar="FILE", help="the font of --words, as for brushsvg text")
    batch.add_argument("--size", metavar="MM", type=values.width, help="the size of the em of --font; default: 20")
    batch.add_argument(
        "--format",
        metavar="EXT",
        choices=(".json", *PROGRAMS),
        help="the extension of the programs; default: the first one of the cell's language",
    )
    batch.add_argument(
        "--jobs", metavar="N", type=values.jobs, help="the number of processes; default: one for each processor"
    )
    batch.add_argument(
        "--cluster",
        metavar="ADDRESS",
        help="the address of a Dask scheduler, whose workers convert the drawings (tcp://host:8786)",
    )
    batch.add_argument("--parquet", action="store_true", help="also write the table as table.parquet")
    flags.add_choices(batch)
    batch.set_defaults(project_near="inputs")
    flags.add_speed(batch)
    flags.add_z_offset(batch)
    flags.add_order(batch)
    flags.add_quiet(batch)
    batch.set_defaults(run="batch_files", parser=batch, check=_check_batch)


def _check_batch(args) -> None:
    if not args.inputs and args.words is None:
        args.parser.error("there is nothing to paint: give drawings, or --words FILE with --font FILE")
    if (args.words is None) != (args.font is None):
        args.parser.error("--words and --font go together")
    if args.size is not None and args.words is None:
        args.parser.error("--size is for --words")
    check_compensation(args)
    if args.jobs is not None and args.cluster is not None:
        args.parser.error("--jobs is for this machine, not for --cluster")
    if args.z_offset and args.format == ".json":
        args.parser.error("--z-offset is for programs; a plan (.json) always has the whole job, on the paper")
    check_files(args, [(args.words, (".txt",)), (args.font, None), (args.brush, None)], [])
    args.input = args.output


def add_compare(commands) -> None:
    compare = commands.add_parser(
        "compare", help="compare photographs of a painted job with the drawing, and correct the next one"
    )
    compare.add_argument(
        "photos",
        metavar="PHOTO",
        nargs="+",
        help=f"a photograph of the painted page of `convert --page` ({' '.join(PHOTOS)})",
    )
    flags.add_input(compare)
    flags.add_choices(compare)
    flags.add_speed(compare)
    flags.add_corrections(compare)
    flags.add_margin_strokes(compare)
    flags.add_output(compare, "the figures and the corrections for the next sheet (.json), or the report (.txt)", False)
    flags.add_picture(compare, "the paint, the drawing and the prediction; with --sheets the spread", ".png")
    compare.add_argument(
        "--corrected-cell",
        metavar="FILE",
        help="also write the cell with the certain errors of the machine corrected (.toml)",
    )
    compare.add_argument(
        "--at-least",
        metavar="OVERLAP",
        type=values.share,
        help="exit with status 1 if the paint overlaps the drawing by less than this",
    )
    compare.add_argument(
        "--sheets",
        action="store_true",
        help="report how well sheets repeat; each photograph shows another sheet, or one sheet has copies of strokes",
    )
    flags.add_report(compare)
    flags.add_write_options(compare)
    compare.set_defaults(run="compare_files", parser=compare, check=_check_compare)


def _check_compare(args) -> None:
    if suffix_of(args.input) in PHOTOS and any(suffix_of(path) in DRAWINGS for path in args.photos):
        args.parser.error(f"give the drawing or plan last, after the photographs: {args.input} is a photograph")
    check_drawing(args)
    for flag, value in (
        ("corrected-cell", args.corrected_cell),
        ("at-least", args.at_least),
    ):
        if args.sheets and value is not None:
            args.parser.error(f"--{flag} is for one sheet, not for --sheets")
    read = [*((path, PHOTOS) for path in args.photos), (args.input, DRAWINGS), (args.brush, None)]
    read.append((args.corrections, (".json",)))
    written = [(args.output, (".json", ".txt")), (args.picture, (".png",)), (args.corrected_cell, (".toml",))]
    check_files(args, read, written)


def add_simulate_photo(commands) -> None:
    simulate = commands.add_parser(
        "simulate-photo", help="render a photograph of the painted job, to try `compare` without a robot"
    )
    flags.add_input(simulate)
    flags.add_output(simulate, "a photograph (.jpg)")
    flags.add_choices(simulate)
    flags.add_speed(simulate)
    flags.add_corrections(simulate)
    flags.add_margin_strokes(simulate)
    simulate.add_argument(
        "--studio",
        metavar="FILE",
        help="the errors to simulate (.toml); default: drawn at random by --seed, and printed",
    )
    simulate.add_argument(
        "--true-brush", metavar="NAME|FILE", help="the brush that paints; default: the brush of the plan"
    )
    simulate.add_argument(
        "--seed", metavar="N", type=values.count, default=1, help="the seed of the random errors; default: 1"
    )
    flags.add_write_options(simulate)
    simulate.set_defaults(run="simulate_photo_file", parser=simulate, check=_check_simulate_photo)


def _check_simulate_photo(args) -> None:
    check_drawing(args)
    read = [
        (args.input, DRAWINGS),
        (args.brush, None),
        (args.true_brush, None),
        (args.corrections, (".json",)),
    ]
    check_files(args, [*read, (args.studio, (".toml",))], [(args.output, (".jpg", ".jpeg"))])


def add_preview(commands) -> None:
    preview = commands.add_parser("preview", help="show what will be painted, and how close it is to the drawing")
    flags.add_input(preview)
    flags.add_output(
        preview,
        "a picture (.png .svg), a page that plays the motion (.html), or marks (.json); default: print the report",
        False,
    )
    preview.add_argument(
        "--show",
        choices=("paint", "toolpath", "strokes", "errors"),
        default="paint",
        help="draw the paint, the paint with the path of the tool, the strokes read from the drawing, or missing and "
        "surplus paint with the report; default: paint",
    )
    flags.add_choices(preview, several_brushes=True)
    flags.add_speed(preview)
    preview.add_argument(
        "--band", action="store_true", help="also draw the 95 %% confidence band of the edges of the paint"
    )
    preview.add_argument(
        "--editable",
        action="store_true",
        help="with --show strokes: write lines with a width, which you can edit (.svg)",
    )
    preview.add_argument(
        "--playback",
        metavar="FACTOR",
        type=values.playback_factor,
        help="with .html: the speed at which the page starts, as a multiple of the robot's; default: 1",
    )
    preview.add_argument("--all-brushes", action="store_true", help="report one line for each brush, the best first")
    flags.add_report(preview)
    flags.add_write_options(preview)
    preview.set_defaults(parser=preview, check=_check_preview)


def _check_preview(args) -> None:
    check_drawing(args)
    args.run = _select_preview(args)
    suffix, error = suffix_of(args.output or ""), args.parser.error
    shows_report = args.run == "preview_report"
    if args.show != "paint" and args.output is None:
        error(f"--show {args.show} needs a picture to draw: add -o FILE.png")
    if args.show != "paint" and suffix not in PICTURES:
        error(f"--show {args.show} is for pictures ({' '.join(PICTURES)})")
    if args.band and (args.run != "preview_paint" or suffix == ".json"):
        error("--band is for pictures of the paint: add -o FILE.png or -o FILE.svg, without --show")
    if args.editable and (args.run != "preview_strokes" or suffix != ".svg"):
        error("--editable needs --show strokes and -o FILE.svg")
    if args.playback is not None and args.run != "preview_animation":
        error("--playback needs -o FILE.html")
    if args.all_brushes and args.output is not None:
        error("--all-brushes prints a list: leave -o out")
    for flag in ("json", "details"):
        if getattr(args, flag) and not shows_report:
            error(f"--{flag} is for the report, which is printed without -o, or with --show errors")
    if len(args.brush or ()) > 1 and not args.all_brushes:
        error("--brush is given more than once, which needs --all-brushes")
    if args.all_brushes and suffix_of(args.input) == ".json":
        error("--all-brushes needs a drawing: a plan is made for one brush")
    if args.show == "errors" and suffix_of(args.input) == ".json":
        error("--show errors needs a drawing: a plan does not have the target shapes")
    brushes = [(brush, None) for brush in args.brush or ()]
    read = tuple(READERS) if args.show == "strokes" else DRAWINGS
    check_files(args, [(args.input, read), *brushes], [(args.output, (*PICTURES, ".html", ".json"))])


def _select_preview(args) -> str:
    """Return the name of the function of `commands` that shows this view."""
    if args.show == "strokes":
        return "preview_strokes"
    if args.show == "errors" or args.output is None:
        return "preview_report"
    return "preview_animation" if suffix_of(args.output) == ".html" else "preview_paint"


def add_text(commands) -> None:
    text = commands.add_parser("text", help="write a text in a font as a drawing")
    text.add_argument(
        "input",
        metavar="TEXT",
        help="what to write; \\n starts a new line; put a text that begins with - last, after --",
    )
    flags.add_output(text, "a drawing (.svg)")
    text.add_argument(
        "--font",
        metavar="FILE",
        required=True,
        help="a TrueType, OpenType or single-line SVG font, or the name of a single-line font of Inkscape",
    )
    text.add_argument("--size", metavar="MM", type=values.width, default=20.0, help="the size of the em; default: 20")
    text.add_argument(
        "--width", metavar="MM", type=values.width, help="the width of the lines of an SVG font; default: 1"
    )
    text.add_argument(
        "--sheet", metavar="WxH", type=values.sheet, help="the sheet; default: the text and 20 mm around it"
    )
    flags.add_script(text, "how the letters are written")
    flags.add_write_options(text)
    text.set_defaults(run="text_file", parser=text, check=_check_text)


def _check_text(args) -> None:
    check_extension(args, args.output, (".svg",))
    check_files(args, [(args.font, None)], [(args.output, (".svg",))])
