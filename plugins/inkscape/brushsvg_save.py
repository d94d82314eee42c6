#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-2.0-or-later
"""Save a drawing as a robot program, plan, marks or animation.

The file is byte for byte the output of `brushsvg convert` or `brushsvg preview`.
"""

from __future__ import annotations

import sys

from brushsvg_dialogs import show_message
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
    if args.cell == "document" and args.else_cell and root_of(args.input_file).get("data-brushsvg-cell") is None:
        args.cell = args.else_cell
    out = f"saved.{args.format}"
    with Run(args.executable, args.input_file, args.command, DRAWING, "-o", out, *choices(args)) as run:
        _, warnings = run.finish()
        sys.stdout.buffer.write(run.made(out))
    if warnings:
        show_message("\n".join(["Saved. brushsvg warns:", *warnings]))


if __name__ == "__main__":
    guarded(main)
