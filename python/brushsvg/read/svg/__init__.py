"""Reader from SVG to a Design.

Notices name the parts that are not read. The rules are in docs/reference/drawings.md.
"""

from __future__ import annotations

import re
import xml.etree.ElementTree as ET
from collections.abc import Sequence
from contextlib import suppress

from ...errors import Error, list_first
from ...units import MM_PER
from .. import AS_DRAWN, ReadOptions
from ..background import remove_background
from ..design import Design, Element, Notice
from ..empty_drawing import empty_drawing_error
from ..layout import bounds_mm
from .context import local_name, printable_line
from .css.cascade import INITIAL, cascade
from .css.selectors import select_elements
from .settings import PREFIX, document_settings
from .tree_walk import SVG, TreeWalk
from .viewport import Page, read_page
from .xml import Document, parse_xml

_MAX_NAMED_ELEMENTS = 5  # elements off the page that a sentence names
_INKSCAPE_VERSION = "{http://www.inkscape.org/namespaces/inkscape}version"


def read_svg(data: bytes, options: ReadOptions = AS_DRAWN) -> Design:
    """Read an SVG document, with its elements in document order, in mm with y up.

    options.sheet_mm replaces the size of the page. The drawing keeps its scale and its upper left corner.

    Raises Error if the data is not SVG, if the drawing has no size or nothing to paint, or if it copies itself too
    often.
    """
    try:
        return _read(parse_xml(data), options)
    except RecursionError:
        raise Error("its CSS is nested too deeply", where="style", code="css-too-complex") from None


def read_svg_settings(data: bytes, alone: bool = False) -> dict:
    """Return the settings of the root element for the whole job.

    The result is {} for a damaged file, which read_svg reports.

    alone: whether read_svg is not called for this file, so that its problems are reported here.
    """
    is_plain = not data.startswith((b"\x1f\x8b", b"\xff\xfe", b"\xfe\xff"))  # neither compressed nor UTF-16
    if is_plain and PREFIX.encode() not in data and not alone:
        return {}
    try:
        return document_settings(_checked_root(parse_xml(data)).attrib)
    except Error:
        if alone:
            raise
        return {}


def _checked_root(document: Document) -> ET.Element:
    root = document.root
    if root.tag not in (SVG + "svg", "svg"):
        raise Error(f"the root element is <{local_name(root)[:40]}>, not <svg>", code="not-svg")
    return root


def _read(document: Document, options: ReadOptions) -> Design:
    root = _checked_root(document)
    style = cascade(INITIAL, root.attrib, [], 0.0)[0].geometry
    page = read_page(root.attrib, options.sheet_mm, style)
    selected = select_elements(root, options.select) if options.select else None
    walk = TreeWalk(root, page, selected, _notices_outside_tree(document, root, page))
    walk.run()
    if not walk.elements:
        raise empty_drawing_error(walk.notices, walk.left_out)
    own_page_mm = page.sheet_mm
    if options.sheet_mm is not None:
        with suppress(Error):  # a drawing without its own size has the size of the sheet
            own_page_mm = read_page(root.attrib, None, style).sheet_mm
    elements, off_page = keep_on_page(walk.elements, own_page_mm, page.sheet_mm[1])
    title = root.find(SVG + "title" if root.tag.startswith("{") else "title")
    name = "" if title is None else printable_line("".join(title.itertext()))
    design = Design(page.sheet_mm, elements, (*walk.notices, *off_page), name, walk.layers)
    return design if options.background == "keep" else remove_background(design, own_page_mm)


def _notices_outside_tree(document: Document, root: ET.Element, page: Page) -> list[Notice]:
    """Return notices about content outside of the tree: style sheets and comments."""
    notices = []
    if "xml-stylesheet" in document.instructions:
        sentence = "CSS in another file is not read: its rules are ignored"
        notices.append(Notice("xml-stylesheet", sentence, code="css-unread"))
    if page.in_px and (program_and_pixels := _find_other_pixel_size(document, root)):
        own_page = page if root.get("viewBox") is None else read_page(root.attrib)  # for any requested sheet
        notices.append(_probable_size_notice(*program_and_pixels, own_page.sheet_mm, root.get("viewBox") is not None))
    return notices


def _find_other_pixel_size(document: Document, root: ET.Element) -> tuple[str, int] | None:
    """Return the program that wrote the drawing, and its pixels per inch.

    The result is None if the program counts 96 pixels per inch or is unknown.

    Illustrator counts 72 px to the inch. Its "Save as" writes a comment, its "Export as" writes a data-name on the
    root. Only Illustrator writes "enable-background: new", which remains if a tool has removed the comment. Inkscape
    counted 90 px until 0.91 (wiki.inkscape.org, "Release notes/0.92").
    """
    is_its_style = "enable-background" in root.get("style", "") or "enable-background" in root.attrib
    if (
        any("Adobe Illustrator" in comment for comment in document.comments)
        or root.get("data-name")
        or (is_its_style and _INKSCAPE_VERSION not in root.attrib)
    ):
        return "Adobe Illustrator", 72
    version = re.match(r"0\.(\d+)", root.get(_INKSCAPE_VERSION, ""))
    return (f"Inkscape {version[0]}", 90) if version and int(version[1]) < 92 else None


def _probable_size_notice(program: str, per_inch: int, read_mm: tuple[float, float], has_box: bool) -> Notice:
    w, h = (side * 96 / per_inch for side in read_mm)
    sentence = f"written by {program}, which counts {per_inch} px to the inch, so it was probably drawn as "
    advice = f'give its svg width="{w:.6g}mm" height="{h:.6g}mm"'
    if not has_box:
        advice += f' viewBox="0 0 {read_mm[0] / MM_PER["px"]:.6g} {read_mm[1] / MM_PER["px"]:.6g}"'
    return Notice("svg", f"{sentence}{w:.4g} x {h:.4g} mm", code="other-pixels", advice=advice)


def keep_on_page(
    elements: Sequence[Element], page_mm: tuple[float, float], top_mm: float
) -> tuple[tuple[Element, ...], list[Notice]]:
    """Return the elements that touch the page, and a notice about the others.

    If no element touches the page, all are kept: --fit or --origin can still move them onto it.

    page_mm: (width, height) of the drawing's own page; top_mm: y of its upper left corner, which is the sheet's.
    """
    is_on = [_touches_page(element, page_mm, top_mm) for element in elements]
    if all(is_on) or not any(is_on):
        return tuple(elements), []
    kept = [element for element, inside in zip(elements, is_on, strict=True) if inside]
    removed = [element.id for element, inside in zip(elements, is_on, strict=True) if not inside]
    count = "1 element is" if len(removed) == 1 else f"{len(removed)} elements are"
    sentence = f"{count} off the page and left out: {list_first(removed, _MAX_NAMED_ELEMENTS)}"
    advice = "move them onto the page to paint them, or make the page larger"
    return tuple(kept), [Notice("svg", sentence, code="off-page", advice=advice)]


def _touches_page(element: Element, page_mm: tuple[float, float], top_mm: float) -> bool:
    x0, y0, x1, y1 = bounds_mm([element])
    return not (x1 < 0 or y1 < top_mm - page_mm[1] or x0 > page_mm[0] or y0 > top_mm)
