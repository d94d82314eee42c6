"""brushsvg text: words in a font, as a drawing."""

from __future__ import annotations

from ...files import read_bytes
from ..console import about, stage, warn
from .outputs import check_places, write


def text_file(args) -> None:
    check_places(args.output)
    from ...drawing.text import text_svg

    with about(args.font):
        stage("setting the text")
        drawing, notices = text_svg(
            args.input.replace("\\n", "\n"),
            read_bytes(args.font),
            size_mm=args.size,
            width_mm=args.width,
            sheet_mm=args.sheet,
        )
    warn(args.font, notices)
    write(args, {args.output: drawing.encode()})
