#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-2.0-or-later
"""Brush settings: brush, machine, compensation and tolerance of the document. The command line uses them, too."""

from __future__ import annotations

import sys

from brushsvg_program import arguments, guarded

CHOICES = ("brush", "compensation", "cell")


def main() -> None:
    from lxml import etree

    args = arguments(tolerance="0.05", **dict.fromkeys(CHOICES, "document"))
    document = etree.parse(args.input_file, etree.XMLParser(huge_tree=True))
    root = document.getroot()
    said = {name: getattr(args, name) for name in CHOICES}
    said["tolerance"] = f"{float(args.tolerance):g}mm"
    for name, value in said.items():
        root.attrib.pop(f"data-brushsvg-{name}", None)
        if value not in ("document", "0.05mm"):
            root.set(f"data-brushsvg-{name}", value)
    document.write(sys.stdout.buffer)


if __name__ == "__main__":
    guarded(main)
