#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-2.0-or-later
"""Add a calibration sheet next to the document, and save the program for it.

The marks of the sheet are in a locked layer, which no command paints. A second run replaces the page of the
first.
"""

from __future__ import annotations

import os
import sys

from brushsvg_dialogs import show_message
from brushsvg_preview import INKSCAPE, SODIPODI, SVG, locked_layer, remove_layer
from brushsvg_program import DRAWING, Run, StopError, arguments, choices, guarded

LAYER_ID, PAGE_ID = "brushsvg-chart", "brushsvg-chart-page"
GAP_MM = 10
PROGRAMS = (".ngc", ".script", ".jks", ".mod", ".py", ".src", ".lua", ".ls", ".drl", ".csv", ".ebb", ".json")


def main() -> None:
    args = arguments(
        brush="document", brush_file="", cell="document", cell_file="", sheet="a4", strokes="all", output=""
    )
    wished = "" if os.path.isdir(args.output) else args.output  # Inkscape turns an empty choice into a folder
    suffix = os.path.splitext(wished)[1].lower() or ".json"
    if suffix not in PROGRAMS:
        raise StopError(f"{wished} ends in none of {' '.join(PROGRAMS)}: choose another name for the program.")
    program = f"chart{suffix}"
    words = ["-o", program, "--drawing", DRAWING, "--page", "page.svg", "--chart", "read-by.json"]
    words += ["--sheet", args.sheet, *choices(args)]
    words += ["--strokes", args.strokes] if args.strokes != "all" else []
    with Run(args.executable, args.input_file, "chart", *words) as run:
        import inkex  # imported while brushsvg runs, to save time
        from lxml import etree

        document = etree.parse(args.input_file, etree.XMLParser(huge_tree=True))
        measured = inkex.load_svg(args.input_file).getroot()
        report, lines = run.finish()
        warnings = [line for line in lines if not line.startswith("brushsvg: ")]  # that line says what was written
        page, made, read_by = (run.made(name) for name in ("page.svg", program, "read-by.json"))
    _insert(etree, document.getroot(), measured, etree.fromstring(page), report.splitlines()[0])
    document.write(sys.stdout.buffer)
    if wished:
        chart_path = f"{os.path.splitext(wished)[0]}.chart.json"
        _save({wished: made, chart_path: read_by})
        show_message("\n".join([f"Saved: {wished} and {chart_path}.", *warnings]))
    elif warnings:
        show_message("\n".join(["The page was added. brushsvg warns:", *warnings]))


def _save(files: dict[str, bytes]) -> None:
    for path, data in files.items():
        try:
            with open(path, "wb") as file:
                file.write(data)
        except OSError as problem:
            raise StopError(f"{path} cannot be written: {problem.strerror}.") from None


def _insert(etree, root, measured, page, report: str) -> None:
    remove_layer(root, LAYER_ID)
    remove_layer(root, PAGE_ID)
    unit = measured.unittouu("1mm")
    x, y, width, height = measured.get_viewbox()
    if not (width and height):
        x, y = 0.0, 0.0
        width, height = (measured.unittouu(root.get(name, "100px")) for name in ("width", "height"))
    view = root.find(f"{SODIPODI}namedview")
    if view is None:
        view = etree.Element(f"{SODIPODI}namedview")
        root.insert(0, view)
    pages = view.findall(f"{INKSCAPE}page")
    if not pages:
        pages = [_page(etree, view, x, y, width, height)]
    at = max(float(each.get("x")) + float(each.get("width")) for each in pages) + GAP_MM * unit
    size_mm = [float(page.get(name)[: -len("mm")]) for name in ("width", "height")]
    _page(etree, view, at, y, *(unit * side for side in size_mm)).set("id", PAGE_ID)
    layer = locked_layer(etree, LAYER_ID, f"Calibration sheet: {report}")
    layer.set("transform", f"translate({at:.9g},{y:.9g}) scale({unit:.9g})")
    layer.extend(child for child in list(page) if child.tag != f"{SVG}title")
    root.append(layer)


def _page(etree, view, x: float, y: float, width: float, height: float):
    page = etree.SubElement(view, f"{INKSCAPE}page")
    for name, value in (("x", x), ("y", y), ("width", width), ("height", height)):
        page.set(name, f"{value:.9g}")
    return page


if __name__ == "__main__":
    guarded(main)
