# SPDX-License-Identifier: GPL-2.0-or-later
"""Let Inkscape convert text to paths of the letters that it draws."""

from __future__ import annotations

import os

from brushsvg_preview import INKSCAPE, SKIPPED, SVG

TEXT = (f"{SVG}text", f"{SVG}flowRoot")
LETTERS = "letters.svg"


def with_letters(etree, root, drawing: str, folder: str) -> tuple[str, dict]:
    """Return a drawing without text, and the element of root for each of its ids.

    If Inkscape cannot run, the drawing is returned unchanged. brushsvg then warns that it does not read text.
    """
    by_id = {node.get("id"): node for node in root.iter() if node.get("id")}
    if not any(_may_be_painted(text) for text in root.iter(*TEXT)):
        return drawing, by_id
    from inkex.command import INKSCAPE_EXECUTABLE_NAME, call

    out = os.path.join(folder, LETTERS)
    try:
        call(
            INKSCAPE_EXECUTABLE_NAME,
            drawing,
            export_text_to_path=True,
            export_filename=out,
            return_binary=True,
        )
        letters = etree.parse(out, etree.XMLParser(huge_tree=True))
    except (OSError, ValueError, etree.XMLSyntaxError):
        return drawing, by_id
    for node in letters.iter(f"{SVG}path"):
        texts = (by_id.get(each.get("id")) for each in node.iterancestors())
        text = next((each for each in texts if each is not None and each.tag in TEXT), None)
        if text is not None:
            by_id[node.get("id")] = text
    return out, by_id


def _may_be_painted(text) -> bool:
    return not any(each.get(SKIPPED) for each in (text, *text.iterancestors()))


def name_of(shape) -> str:
    """Return the name of a shape among the drawing's objects: for text, its words."""
    words = " ".join("".join(shape.itertext()).split()) if shape.tag in TEXT else ""
    return shape.get(f"{INKSCAPE}label") or words or shape.get("id")
