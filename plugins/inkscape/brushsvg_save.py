#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-2.0-or-later
"""Save a drawing as a robot program, plan, marks or animation.

The file is byte for byte the output of `brushsvg convert` or `brushsvg preview`.
"""

from __future__ import annotations

import re
import sys
from pathlib import Path

from brushsvg_dialogs import show_message
from brushsvg_preview import SODIPODI
from brushsvg_program import DRAWING, Run, arguments, choices, guarded, root_of


def main() -> None:
    args = arguments(
        command="convert",
        format="ngc",
        else_cell="",
        brush="document",
        brush_file="",
        cell="document",
        cell_file="",
    )
    root = root_of(args.input_file)
    if args.cell == "document" and args.else_cell and root.get("data-brushsvg-cell") is None:
        args.cell = args.else_cell
    out = f"{_find_file_stem(root)}.{args.format}"
    with Run(args.executable, args.input_file, args.command, DRAWING, "-o", out, *choices(args)) as run:
        _, warnings = run.finish()
        sys.stdout.buffer.write(run.made(out))
    if warnings:
        show_message("\n".join(["Saved. brushsvg warns:", *warnings]))


def _find_file_stem(root: dict[str, str]) -> str:
    """Return the stem of the file's name, after which some languages name the program.

    Inkscape does not say where it writes the output. `Save As` first gives the document the name of this file. `Save a
    Copy` keeps the name of the drawing.
    """
    name = re.sub(r"[^\w .-]", "_", Path(root.get(f"{SODIPODI}docname", "")).stem)
    return name.lstrip("-") or "saved"


if __name__ == "__main__":
    guarded(main)
