#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-2.0-or-later
"""Mark the objects that the brush or the machine cannot paint, with the reason.

The marks are at the places of the objects, in a locked layer.
"""

from __future__ import annotations

import sys
import textwrap

from brushsvg_preview import INKSCAPE, SVG, locked_layer, own_undone, remove_layer
from brushsvg_program import DRAWING, Run, arguments, choices, element_of, guarded

LAYER_ID = "brushsvg-check"
REFUSED, WARNED = "#d4351c", "#e08700"
SHAPES = {f"{SVG}{name}" for name in ("path", "rect", "circle", "ellipse", "line", "polyline", "polygon")}
OWN_TO_A_SHAPE = (f"{INKSCAPE}path-effect", f"{INKSCAPE}original-d", "class", "id", "transform")
TEXT_MM = 3
LETTERS = 50  # characters in a line of text
HALO = "paint-order:stroke;stroke:#ffffff"  # keeps letters readable on top of a drawing


def main() -> None:
    args = arguments(brush="document", brush_file="", cell="document", cell_file="", compensation="document")
    with Run(args.executable, args.input_file, "preview", DRAWING, "--json", *choices(args)) as run:
        import inkex  # imported while brushsvg runs; it finds the places of objects
        from lxml import etree

        document = etree.parse(args.input_file, etree.XMLParser(huge_tree=True))
        # A second copy, which is not written: inkex rewrites the elements that it reads.
        measured = inkex.load_svg(args.input_file)
        report = run.report()
    remove_layer(document.getroot(), LAYER_ID)
    layer = locked_layer(etree, LAYER_ID, _label(report))
    if undone := own_undone(document.getroot()):
        layer.set("transform", undone)
    unplaced = _mark_all(etree, measured.getroot(), layer, report)
    if unplaced:
        etree.SubElement(layer, f"{SVG}desc").text = "\n".join(unplaced)
    document.getroot().append(layer)
    document.write(sys.stdout.buffer)


def _label(report: dict) -> str:
    forbidden = len(report["forbidden"])
    refused, warned = len(report["refused"]) + forbidden, len(report["warnings"]) - forbidden
    if not refused and not warned:
        return f"Brush check: {report['brush']}: all can be painted"
    return f"Brush check: {report['brush']}: {refused} cannot be painted, {warned} warned of"


def _mark_all(etree, svg, layer, report: dict) -> list[str]:
    """Mark the objects, and return the sentences that have no object in the drawing."""
    unplaced = []
    by_id = {node.get("id"): node for node in svg.iterdescendants() if node.get("id")}
    per_element: dict[str, list[tuple[str, str]]] = {}
    warned = [each for each in report["warnings"] if each not in report["forbidden"]]
    for colour, kind in ((REFUSED, report["refused"] + report["forbidden"]), (WARNED, warned)):
        for each in kind:
            per_element.setdefault(each["where"], []).append((colour, each["sentence"]))
    for where, said in per_element.items():
        element = element_of(by_id, where)
        if element is None:
            unplaced += [": ".join(filter(None, (where, sentence))) for _, sentence in said]
        else:
            _mark(etree, svg, layer, element, said)
    return unplaced


def _mark(etree, svg, layer, element, said: list[tuple[str, str]]) -> None:
    colour = said[0][0]
    sentence = "; ".join(dict.fromkeys(sentence for _, sentence in said))  # each copy repeats the sentence
    place = element.composed_transform()
    unit = svg.unittouu("1mm")
    if element.tag in SHAPES:
        layer.append(_copy(etree, element, place, colour))
    at = place.apply_to_point((_number(element, "x"), _number(element, "y")))
    if element.tag in SHAPES and (box := element.bounding_box(element.getparent().composed_transform())):
        drawn = element.specified_style().get("stroke-width", "1")
        # A number without a unit is in the units of the element.
        width = svg.unittouu(drawn) if drawn[-1:].isalpha() else _float(drawn)
        half_width = width * abs(place.a * place.d - place.b * place.c) ** 0.5 / 2
        at = (box.left, box.top - half_width - unit)
    _write(etree, layer, sentence, at, TEXT_MM * unit, colour)


def _write(etree, layer, sentence: str, at, size: float, colour: str) -> None:
    """Write lines of text that end above a point."""
    text = etree.SubElement(layer, f"{SVG}text")
    text.set(
        "style",
        f"font-size:{size:.6g}px;font-family:sans-serif;fill:{colour};{HALO};stroke-width:{size / 5:.6g}",
    )
    lines = textwrap.wrap(sentence, LETTERS)
    for number, line in enumerate(lines):
        part = etree.SubElement(text, f"{SVG}tspan", x=f"{at[0]:.6g}")
        part.set("y", f"{at[1] - (len(lines) - 1 - number) * 1.2 * size:.6g}")
        part.text = line


def _copy(etree, element, place, colour: str):
    shape = etree.fromstring(etree.tostring(element, with_tail=False))
    for name in [*OWN_TO_A_SHAPE, *(name for name in shape.attrib if name.startswith("data-brushsvg-"))]:
        shape.attrib.pop(name, None)
    for child in list(shape):
        shape.remove(child)
    width = element.specified_style().get("stroke-width", "1")
    shape.set("style", f"fill:none;stroke:{colour};stroke-opacity:0.7;stroke-width:{width}")
    shape.set("transform", str(place))
    return shape


def _number(element, name: str) -> float:
    return _float(element.get(name, "0"))


def _float(text: str) -> float:
    try:
        return float(text)
    except ValueError:
        return 0.0


if __name__ == "__main__":
    guarded(main)
