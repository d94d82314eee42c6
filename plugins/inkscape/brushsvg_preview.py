#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-2.0-or-later
"""Show the marks that the brush will paint, in a locked layer of their own.

Nothing else in the drawing changes. Live preview runs this script at each change in the dialog, so it has to
be fast. It starts brushsvg before it loads any other module, and it uses lxml instead of inkex, which is
built on lxml.
"""

from __future__ import annotations

import math
import re
import sys
from xml.etree import ElementTree

from brushsvg_program import DRAWING, Run, arguments, choices, guarded, selection

# Each pair of colours differs so much that one of the two is visible on any ink. The drawing shows through.
PAINTED, MISSED = ("#1c8fd4", "#d98200"), ("#d4351c", "#7000b0")
OPACITY = 0.6
SVG = "{http://www.w3.org/2000/svg}"
INKSCAPE = "{http://www.inkscape.org/namespaces/inkscape}"
SODIPODI = "{http://sodipodi.sourceforge.net/DTD/sodipodi-0.dtd}"
SKIPPED = "data-brushsvg-skip"
MOVED = "svg: the whole drawing has a transform, which Inkscape 1.2 does not show; it is painted with it"
OUTLINE = "outline"  # label of the group that holds the original of a converted letter
LAYER_ID = "brushsvg-preview"
PX_PER_MM = 96 / 25.4


def main() -> None:
    args = arguments(brush="document", brush_file="", compensation="document")
    words = [*choices(args), *selection(own_ids(args.input_file, args.ids))]
    with Run(args.executable, args.input_file, "preview", DRAWING, "-o", "marks.svg", *words) as run:
        from lxml import etree  # imported while brushsvg runs, to save time

        document = etree.parse(args.input_file, etree.XMLParser(huge_tree=True))
        _, warnings = run.finish()
        marks = ElementTree.fromstring(run.made("marks.svg"))
    root = document.getroot()
    remove_layer(root, LAYER_ID)
    root.append(_layer(etree, marks, root, warnings, run.save_refuses))
    document.write(sys.stdout.buffer)


def own_ids(drawing: str, ids: list[str]) -> list[str]:
    """Return the ids that stand for the selected ids.

    The hidden original of a converted letter stands for the group of its strokes. Objects in layers of this
    extension are left out.
    """
    with open(drawing, "rb") as file:
        if not ids or SKIPPED.encode() not in file.read():
            return ids
    root, chosen = ElementTree.parse(drawing).getroot(), set(ids)
    parents = {child: parent for parent in root.iter() for child in parent}
    found = []
    for node in (node for node in root.iter() if node.get("id") in chosen):
        above = [node]
        while above[-1] in parents:
            above.append(parents[above[-1]])
        skipped = next((each for each in above if each.get(SKIPPED)), None)
        if skipped is not None and skipped.get(f"{INKSCAPE}label") == OUTLINE:
            found.append(parents[skipped].get("id"))
        elif skipped is None or not skipped.get("id", "").startswith("brushsvg-"):
            found.append(node.get("id"))
    return found


def remove_layer(root, name: str) -> None:
    """Remove a layer or a page that this extension made.

    Any other element with this id belongs to the user and stays.
    """
    for node in [node for node in root.iter() if node.get("id") == name]:
        if node.get(SKIPPED) or node.tag == f"{INKSCAPE}page":
            node.getparent().remove(node)


def _layer(etree, marks, root, warnings: list[str], save_refuses: list[str]):
    paths = marks.findall(f"{SVG}path")
    missed = {path for path in paths if path.get("data-off-line") == "yes"}
    if root.get("transform"):
        warnings = [*warnings, MOVED]
    label = _label(paths, len(missed), marks, len(warnings), save_refuses)
    layer = locked_layer(etree, LAYER_ID, label)
    in_user = user_from_mm(root, _mm(marks.get("width")), _mm(marks.get("height")))
    layer.set("transform", f"{own_undone(root)} {in_user}".strip())
    if warnings:
        etree.SubElement(layer, f"{SVG}desc").text = "\n".join(warnings)
    for path in paths:
        colour = seen_on(path.get("fill"), MISSED if path in missed else PAINTED)
        mark = etree.SubElement(layer, f"{SVG}path")
        mark.set("d", path.get("d").strip())
        mark.set("style", f"fill:{colour};fill-opacity:{OPACITY};fill-rule:nonzero;stroke:none")
        mark.set(f"{INKSCAPE}label", path.get("data-stroke"))
    return layer


def seen_on(ink: str, colours: tuple[str, str]) -> str:
    """Return the colour that differs most from the ink; all are #rrggbb."""
    return max(colours, key=lambda colour: math.dist(rgb(colour), rgb(ink)))


def rgb(colour: str) -> tuple[int, ...]:
    return tuple(bytes.fromhex(colour[1:]))


def locked_layer(etree, name: str, label: str):
    """Return an empty layer that is never painted and is safe from accidental edits."""
    layer = etree.Element(f"{SVG}g")
    layer.set("id", name)
    layer.set(f"{INKSCAPE}groupmode", "layer")
    layer.set(f"{INKSCAPE}label", label)
    layer.set(f"{SODIPODI}insensitive", "true")
    layer.set(SKIPPED, "yes")
    return layer


def _label(paths, missed: int, marks, warnings: int, save_refuses: list[str]) -> str:
    if save_refuses:
        more = f" (and {len(save_refuses) - 1} more)" if save_refuses[1:] else ""
        return f"Brush preview: saving a program will be refused: {save_refuses[0]}{more}"
    count = len(paths)
    parts = [f"{count} stroke{'s' * (count != 1)}"]
    errors_mm = [float(path.get("data-tracking-error-mm")) for path in paths if path.get("data-tracking-error-mm")]
    if errors_mm:
        parts.append(f"tracking error at most {max(errors_mm):.2f} mm")
    if missed:
        parts.append(f"{missed} painted elsewhere than drawn")
    if warnings:
        parts.append(f"{warnings} warning{'s' * (warnings != 1)}")
    return f"Brush preview: {marks.get('data-made')}: " + ", ".join(parts)


def own_undone(root) -> str:
    """Return the inverse of the root's own transform, for layers of this extension.

    With the inverse, the layers cover their objects in any program: SVG and brushsvg apply the root's
    transform, Inkscape 1.2 does not.
    """
    if not root.get("transform"):
        return ""
    from inkex import Transform  # loading inkex takes too long for every preview

    return str(-Transform(root.get("transform")))


def _mm(length: str) -> float:
    return float(length[: -len("mm")])


def user_from_mm(root, width_mm: float, height_mm: float) -> str:
    """Return the transform from mm of the sheet, y down, to the units of the root."""
    box = root.get("viewBox")
    numbers = [float(part) for part in re.split(r"[\s,]+", box.strip())] if box and box.strip() else []
    if len(numbers) != 4 or numbers[2] <= 0 or numbers[3] <= 0:
        return f"scale({PX_PER_MM:.9g})"
    x, y, width, height = numbers
    across, down = width_mm / width, height_mm / height  # mm per unit
    wish = (root.get("preserveAspectRatio") or "").replace("defer", "").split() or ["xMidYMid"]
    if wish[0] != "none":
        across = down = (max if wish[1:] == ["slice"] else min)(across, down)
        place = {"Min": 0.0, "Mid": 0.5, "Max": 1.0}
        x -= place.get(wish[0][1:4], 0.5) * (width_mm / across - width)
        y -= place.get(wish[0][5:8], 0.5) * (height_mm / down - height)
    return f"matrix({1 / across:.9g},0,0,{1 / down:.9g},{x:.9g},{y:.9g})"


if __name__ == "__main__":
    guarded(main)
