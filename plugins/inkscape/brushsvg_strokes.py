#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-2.0-or-later
"""Convert filled letters and text to single lines with a width.

Lines with a varying width become PowerStrokes. A group of strokes replaces each shape. The group also holds
the unchanged shape, hidden.
"""

from __future__ import annotations

import math
import re
import sys
import tempfile
from xml.etree import ElementTree

from brushsvg_dialogs import show_message
from brushsvg_preview import INKSCAPE, OUTLINE, SKIPPED, SVG, own_ids, user_from_mm
from brushsvg_program import DRAWING, Run, StopError, arguments, element_of, guarded, selection
from brushsvg_text import name_of, with_letters

STROKES = "strokes.svg"
EFFECT, ORIGINAL = f"{INKSCAPE}path-effect", f"{INKSCAPE}original-d"
WIDTH = re.compile("(stroke-width:)([0-9.e+-]+)")
UNEVEN = 1e-4
# These elements move their contents by their transforms only.
HOLDERS = {f"{SVG}{name}" for name in ("g", "a", "switch")}
HIDDEN = "display:none"


def main() -> None:
    args = arguments(shapes="filled")
    words = [
        "--editable",
        *selection(own_ids(args.input_file, args.ids)),
        *(["--as", "outline"] if args.shapes == "all" else []),
    ]
    import inkex
    from lxml import etree

    document = etree.parse(args.input_file, etree.XMLParser(huge_tree=True))
    svg = document.getroot()
    with tempfile.TemporaryDirectory(prefix="brushsvg") as folder:
        drawing, by_id = with_letters(etree, svg, args.input_file, folder)
        with Run(args.executable, drawing, "preview", DRAWING, "-o", STROKES, "--show", "strokes", *words) as run:
            _, warnings = run.finish()
            drawn = ElementTree.fromstring(run.made(STROKES))
    per_shape = _of_shapes(by_id, drawn)
    if not per_shape:
        message = "There is no filled shape: lines with a width are strokes already."
        raise StopError("\n".join([message, *warnings]))
    effects = {each.get("id"): each for each in drawn.iter(EFFECT)}
    writer = _Writer(etree, inkex, svg, effects, _mm(drawn.get("width")), _mm(drawn.get("height")))
    for shape, paths in per_shape:
        writer.replace(shape, paths)
    document.write(sys.stdout.buffer)
    if warnings:
        show_message("\n".join(["Converted. brushsvg warns:", *warnings]))


def _mm(length: str) -> float:
    return float(length[: -len("mm")])


def _of_shapes(by_id: dict, drawn) -> list:
    """Return the shapes of the document, each with the paths of its strokes.

    Shapes that were drawn as lines are left out.
    """
    found: dict = {}
    for path in drawn.iter(f"{SVG}path"):
        name = path.get("data-stroke")
        shape = element_of(by_id, name) if path.get("data-outline") == "yes" else None
        drawn_as = element_of(by_id, name.split("/")[-1])  # for a copy, its original
        if shape is not None and not _is_line(by_id, drawn_as):
            found.setdefault(shape.get("id"), (shape, []))[1].append(path)
    return list(found.values())


def _is_line(by_id: dict, shape) -> bool:
    """Return whether a shape is a PowerStroke.

    When Inkscape converts text to paths, it converts PowerStrokes to outlines as well.
    """
    names = shape.get(EFFECT, "").split(";") if shape is not None else []
    effects = (by_id.get(name.strip()[1:]) for name in names)
    return any(effect is not None and effect.get("effect") == "powerstroke" for effect in effects)


class _Writer:
    def __init__(self, etree, inkex, svg, effects: dict, width_mm: float, height_mm: float):
        self.etree, self.inkex, self.svg, self.effects = etree, inkex, svg, effects
        self.user_from_mm = inkex.Transform(user_from_mm(svg, width_mm, height_mm))
        self.defs = svg.find(f"{SVG}defs")
        if self.defs is None:
            self.defs = etree.Element(f"{SVG}defs")
            svg.insert(0, self.defs)
        self.taken = {node.get("id") for node in svg.iter() if node.get("id")}

    def replace(self, shape, paths: list) -> None:
        """Replace a shape by a group of its strokes.

        The group also holds the shape, hidden and never painted.
        """
        parent = shape.getparent()
        group = self.etree.Element(f"{SVG}g", id=self._free(f"{shape.get('id')}-strokes"))
        group.set(f"{INKSCAPE}label", f"{name_of(shape)}, strokes")
        parent.replace(shape, group)  # removes the white space after the shape, too
        kept = self.etree.SubElement(group, f"{SVG}g", style=HIDDEN)
        kept.set("id", self._free(f"{shape.get('id')}-outline"))
        kept.set(f"{INKSCAPE}label", OUTLINE)
        kept.set(SKIPPED, "yes")
        kept.append(shape)
        is_plain = self._is_plain(parent)
        place = -self._place(parent if is_plain else self.svg) @ self.user_from_mm
        if not is_plain:  # in a nested drawing: its strokes go on top of all objects
            strokes = self.etree.SubElement(self.svg, f"{SVG}g", id=self._free(f"{shape.get('id')}-strokes"))
            strokes.set(f"{INKSCAPE}label", group.get(f"{INKSCAPE}label"))
            group = strokes
        for path in paths:
            self._add(group, path, place)

    def _is_plain(self, node) -> bool:
        while node is not self.svg and node is not None:
            if node.tag not in HOLDERS:
                return False
            node = node.getparent()
        return node is not None

    def _place(self, node):
        """Return the transform of the groups around the contents of a node.

        The function of inkex is not used, because it rewrites elements that nobody changed.
        """
        place = self.inkex.Transform()
        while node is not None:
            place = self.inkex.Transform(node.get("transform")) @ place
            node = node.getparent()
        return place

    def _add(self, group, path, place) -> None:
        """Add a path in the group's own coordinates.

        When Inkscape moves a path, it changes the data of the path but not the widths of its effect.
        """
        line = self.etree.SubElement(group, f"{SVG}path", id=self._free(path.get("id")))
        scale = math.hypot(place.a, place.b)
        if abs(place.a * place.c + place.b * place.d) > UNEVEN * scale**2 or (
            abs(math.hypot(place.c, place.d) - scale) > UNEVEN * scale
        ):
            # The width differs along and across the path: only a transform can express this.
            line.set("transform", str(place))
            place, scale = self.inkex.Transform(), 1.0
        for name, value in path.attrib.items():
            if name in ("d", ORIGINAL):
                line.set(name, str(self.inkex.Path(value).transform(place)))
            elif name == "style":
                line.set(name, WIDTH.sub(lambda found: f"{found[1]}{float(found[2]) * scale:.6g}", value))
            elif name not in ("id", "data-stroke", "data-outline", EFFECT):
                line.set(name, value)
        effect = self.effects.get(path.get(EFFECT, "")[1:])
        if effect is not None:
            name = self._free(effect.get("id"))
            pairs = [pair.split(",") for pair in effect.get("offset_points").split(" | ")]
            points = " | ".join(f"{at},{float(half) * scale:.6g}" for at, half in pairs)
            said = {**effect.attrib, "id": name, "offset_points": points}
            self.defs.append(self.etree.Element(EFFECT, said))
            line.set(EFFECT, f"#{name}")

    def _free(self, name: str) -> str:
        number, free = 1, name
        while free in self.taken:
            number += 1
            free = f"{name}-{number}"
        self.taken.add(free)
        return free


if __name__ == "__main__":
    guarded(main)
