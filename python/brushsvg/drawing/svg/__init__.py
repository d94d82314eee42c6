"""SVG to Design. What is not read is named in a notice. How it is read: docs/drawings.md."""

from __future__ import annotations

import xml.etree.ElementTree as ET

from ...errors import Error
from ...units import MM_PER
from .. import AS_DRAWN, ReadOptions
from ..design import Design, Notice
from ..empty_drawing import nothing_to_paint
from .context import local, one_line
from .css_cascade import INITIAL, cascade
from .selection import selected
from .settings import PREFIX, document_settings
from .tree_walk import SVG, Walk
from .viewport import Page, read_page
from .xml import Document, parse_xml


def read_svg(data: bytes, options: ReadOptions = AS_DRAWN) -> Design:
    """The drawing, its elements in document order, in mm with y up.

    A sheet given replaces the viewport's size; the drawing keeps its scale and its upper left corner.

    Error if it is not SVG, has no size, has nothing to paint, or copies itself beyond all bounds.
    """
    try:
        return _read(parse_xml(data), options)
    except RecursionError:
        raise Error("its CSS is nested too deeply", where="style", code="css-too-complex") from None


def settings_of(data: bytes, alone: bool = False) -> dict:
    """What the root says of the whole job; {} for a file that is not sound, of which read_svg tells what is wrong.
    alone: nobody asks read_svg, so that is told here."""
    is_plain = not data.startswith((b"\x1f\x8b", b"\xff\xfe", b"\xfe\xff"))  # neither compressed nor UTF-16
    if is_plain and PREFIX.encode() not in data and not alone:
        return {}
    try:
        return document_settings(_root_of(parse_xml(data)).attrib)
    except Error:
        if alone:
            raise
        return {}


def _root_of(document: Document) -> ET.Element:
    root = document.root
    if root.tag not in (SVG + "svg", "svg"):
        raise Error(f"the root element is <{local(root)[:40]}>, not <svg>", code="not-svg")
    return root


def _read(document: Document, options: ReadOptions) -> Design:
    root = _root_of(document)
    page = read_page(root.attrib, options.sheet_mm, cascade(INITIAL, root.attrib, [], 0.0)[0].geometry)
    chosen = selected(root, options.select) if options.select else None
    walk = Walk(root, page, chosen, _outside_the_tree(document, root, page))
    walk.run()
    if not walk.elements:
        raise nothing_to_paint(walk.notices, walk.left_out)
    title = root.find(SVG + "title" if root.tag.startswith("{") else "title")
    name = "" if title is None else one_line("".join(title.itertext()))
    return Design(page.sheet_mm, tuple(walk.elements), tuple(walk.notices), name, walk.layers)


def _outside_the_tree(document: Document, root: ET.Element, page: Page) -> list[Notice]:
    """What is to be told of what stands beside the tree."""
    notices = []
    if "xml-stylesheet" in document.instructions:
        sentence = "CSS in another file is not read: what it says is missing"
        notices.append(Notice("xml-stylesheet", sentence, code="css-unread"))
    if any("Adobe Illustrator" in comment for comment in document.comments) and page.in_px:
        own = page if root.get("viewBox") is None else read_page(root.attrib)  # whatever sheet is asked for
        w, h = own.sheet_mm
        sentence = (
            "written by Adobe Illustrator, which counts 72 px to the inch: if it has "
            f"{w * 96 / 72:.4g} x {h * 96 / 72:.4g} mm there, give its svg "
            f'width="{w / MM_PER["px"]:.6g}pt" height="{h / MM_PER["px"]:.6g}pt"'
        )
        notices.append(Notice("svg", sentence, code="illustrator-pixels"))
    return notices
