"""brushsvg text: write words in a font as a drawing."""

from __future__ import annotations

from pathlib import Path

from ....errors import Error
from ....files import read_bytes
from ...console import refuse_errors, stage, warn
from ...steps.output_places import check_outputs, write_outputs

SINGLE_LINE_FONTS = Path("/usr/share/inkscape/extensions/svg_fonts")


def text_file(args) -> None:
    check_outputs(args, args.output, sources=[args.output])
    from ....read.text import text_svg

    with refuse_errors(args.font):
        stage("setting the text")
        drawing, notices = text_svg(
            args.input.replace("\\n", "\n"),
            read_font(args.font),
            size_mm=args.size,
            width_mm=args.width,
            sheet_mm=args.sheet,
            script=args.script or "auto",
        )
    warn(args.font, notices)
    write_outputs(args, {args.output: drawing.encode()}, sources=[args.output])


def read_font(name: str) -> bytes:
    """Read a font file, or one of Inkscape's single-line fonts by its name."""
    if not Path(name).exists():
        for font_path in (SINGLE_LINE_FONTS / name, SINGLE_LINE_FONTS / f"{name}.svg"):
            if Path(name).name == name and font_path.is_file():
                return read_bytes(font_path)
        sentence = "there is no such file"
        if Path(name).suffix.lower() in ("", ".svg"):
            sentence += f"; the names of Inkscape's single-line fonts are looked up in {SINGLE_LINE_FONTS}"
        raise Error(sentence, file=name, code="file-unreadable")
    return read_bytes(name)
