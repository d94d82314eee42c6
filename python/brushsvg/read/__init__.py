"""Readers from drawings to a Design, one package per format, listed in READERS."""

from __future__ import annotations

import io
import os
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, Protocol
from xml.etree import ElementTree

from ..errors import Error, as_listed, need_number, need_numbers, need_one_of, need_truth, require_type
from ..files import read_bytes
from .damage import refuse_damage

if TYPE_CHECKING:
    from ezdxf.document import Drawing

    from .design import Design


@dataclass(frozen=True)
class ReadOptions:
    """Options of a reader. Each format uses the options that apply to it.

    sheet_mm: (width, height) of the sheet, in place of the drawing's own size.
    units: "mm" or "in", the unit of a drawing that has numbers only (DXF).
    select: a CSS selector; elements that it does not match are left out (SVG).
    background: "auto" leaves out a white shape that comes first and covers the page, "keep" paints it (SVG).
    pen: "z" or "servo", what moves the pen (G-code).
    paper_z_mm: the height at which the pen draws (G-code).
    skip_regions_mm: rectangles (x0, y0, x1, y1); strokes inside a rectangle are left out (G-code).
    skip_comments: texts; strokes that follow a comment with one of these texts are left out (G-code).
    lenient: read the undamaged part of damaged geometry and add a notice about the damaged part.
    is_placed_later: the marks get their place on the sheet after reading, so a drawing may be any distance away from
    the sheet (DXF).
    """

    sheet_mm: tuple[float, float] | None = None
    units: str | None = None
    select: str | None = None
    background: str = "auto"
    pen: str | None = None
    paper_z_mm: float | None = None
    skip_regions_mm: tuple[tuple[float, float, float, float], ...] = ()
    skip_comments: tuple[str, ...] = ()
    lenient: bool = False
    is_placed_later: bool = False


AS_DRAWN = ReadOptions()
SIZE_MM = (0.001, 1e6)  # range of the sides of a sheet
UNITS = ("mm", "in")
BACKGROUNDS = ("auto", "keep")
SCRIPTS = ("auto", "latin", "arabic", "devanagari", "cjk")  # writing systems of filled shapes
PENS = ("z", "servo")  # the axes that can move the pen of a program


def check_read_options(options: ReadOptions) -> ReadOptions:
    """Return the options, validated and with numbers as floats.

    Raises Error if an option is of a wrong type or out of range.
    """
    require_type(options, ReadOptions, "a ReadOptions")
    sheet_mm, paper_z_mm = options.sheet_mm, options.paper_z_mm
    if sheet_mm is not None:
        sheet_mm = need_numbers(sheet_mm, "sheet_mm", 2, *SIZE_MM)
    if options.units is not None:
        need_one_of(options.units, UNITS, "units")
    need_one_of(options.background, BACKGROUNDS, "background")
    if options.pen is not None:
        need_one_of(options.pen, PENS, "pen")
    if paper_z_mm is not None:
        paper_z_mm = need_number(paper_z_mm, "the height at which a program draws [mm]", -1e4, 1e4)
    regions = need_regions(options.skip_regions_mm, "skip_regions_mm")
    need_texts(options.skip_comments, "skip_comments")
    need_truth(options.lenient, "lenient")
    need_truth(options.is_placed_later, "is_placed_later")
    if options.select is not None:
        require_type(options.select, str, "a text", "select")
    return replace(options, sheet_mm=sheet_mm, paper_z_mm=paper_z_mm, skip_regions_mm=regions)


def need_regions(regions, what: str) -> tuple[tuple[float, ...], ...]:
    """Return rectangles (x0, y0, x1, y1) in mm as floats; raise Error for anything else."""
    regions = as_listed(regions)
    require_type(regions, (tuple, list), "a list of regions, (x0, y0, x1, y1) in mm", what)
    return tuple(need_numbers(region, f"a region of {what}", 4, -1e6, 1e6) for region in regions)


def need_texts(texts, what: str) -> None:
    """Raise Error unless texts are a list or tuple of texts. One text would be read as a list of its letters."""
    require_type(texts, (tuple, list), "a list of texts", what)
    for text in texts:
        require_type(text, str, "a text", f"each of {what}")


@dataclass(frozen=True)
class InMemory:
    """A drawing that is not read from a file.

    extension: the key in READERS that selects the format; data: the content that a file would have.
    """

    extension: str
    data: bytes


class HasTree(Protocol):
    """An object with an element tree, for example a Document of svgpathtools."""

    @property
    def tree(self) -> Any: ...


if TYPE_CHECKING:
    Source = str | os.PathLike[str] | InMemory | ElementTree.ElementTree | ElementTree.Element | HasTree | Drawing


def _read_svg_bytes(data: bytes, options: ReadOptions) -> Design:
    from .svg import read_svg  # imported here so that looking up READERS does not load the readers

    return read_svg(data, options)


def _read_dxf_bytes(data: bytes, options: ReadOptions) -> Design:
    from .dxf import read_dxf

    return read_dxf(data, options)


def _read_gcode_bytes(data: bytes, options: ReadOptions) -> Design:
    from .gcode import read_gcode

    return read_gcode(data, options)


def settings_in(path, alone: bool = False) -> dict:
    """Return the settings for the whole job that a drawing contains.

    Among them are brush, cell, compensation, tolerance [mm] and wide. A setting that the drawing does not contain
    is absent. Formats other than SVG have no settings.

    path: as for read_drawing; any other object has no settings.
    alone: whether read_drawing is not called for this file, so that its problems are reported here.

    Raises Error if the file cannot be read and, with alone, also if it is not a drawing.
    """
    if isinstance(path, str | os.PathLike):
        if os.path.splitext(path)[1].lower() not in (".svg", ".svgz"):
            if alone:
                read_bytes(path)  # a DXF has no settings, but a missing file is still an error
            return {}
        data = read_bytes(path)
    elif (loaded := _load_open_document(path)) and loaded[0] is _read_svg_bytes:
        data = loaded[1]
    else:
        return {}
    from .svg import read_svg_settings

    return read_svg_settings(data, alone)


READERS = {  # by file extension; each reader takes (bytes, ReadOptions)
    ".svg": _read_svg_bytes,
    ".svgz": _read_svg_bytes,
    ".dxf": _read_dxf_bytes,
    ".gcode": _read_gcode_bytes,
    ".ngc": _read_gcode_bytes,
    ".nc": _read_gcode_bytes,
}


def read_drawing(path: Source, options: ReadOptions = AS_DRAWN) -> Design:
    """Read a drawing from a file, or from a document that is already open.

    path: the path of a file, whose extension selects the format; an ezdxf document; or an SVG as an ElementTree,
    as its root element or as a Document of svgpathtools. An open document is read as its file would be. One
    difference: an ElementTree has nothing before its root, so links to style sheets there are not reported.

    Raises Error if the drawing cannot be read, has an unknown format or has nothing to paint. Damaged geometry is an
    error, too, unless options.lenient is True.
    """
    options = check_read_options(options)
    reader, data = _load_source(path)
    from .duplicates import remove_duplicates  # imported here for the same reason as the readers
    from .pressure_strokes import join_pressure_strokes

    design = remove_duplicates(join_pressure_strokes(reader(data, options)))
    if not options.lenient:
        refuse_damage(design)
    return design


def _load_source(path) -> tuple:
    """Return (reader, bytes) for a file or an open document."""
    if isinstance(path, str | os.PathLike):
        extension = os.path.splitext(path)[1]
        reader = READERS.get(extension.lower())
        if reader is None:
            if os.path.isdir(path):
                raise Error("this is a directory, not a file", file=os.fspath(path), code="file-unreadable")
            known = ", ".join(READERS)
            sentence = f"{extension or 'no extension'} is not a drawing format that is read; known: {known}"
            raise Error(sentence, code="drawing-format")
        return reader, read_bytes(path)
    loaded = _load_open_document(path)
    if loaded is None:
        sentence = f"{type(path).__name__} is not the type of a drawing"
        advice = "give the path of a file, an ezdxf document or an ElementTree"
        raise Error(sentence, code="drawing-format", advice=advice)
    return loaded


def _load_open_document(drawing) -> tuple | None:
    """Return (reader, bytes) for an open document, None for any other object."""
    if isinstance(drawing, InMemory) and drawing.extension in READERS:
        return READERS[drawing.extension], drawing.data
    if hasattr(drawing, "modelspace"):
        text = io.StringIO()
        drawing.write(text)
        return _read_dxf_bytes, text.getvalue().encode(drawing.output_encoding, errors="dxfreplace")
    tree = getattr(drawing, "tree", drawing)
    root = tree.getroot() if hasattr(tree, "getroot") else tree
    if ElementTree.iselement(root) and isinstance(root, ElementTree.Element):
        return _read_svg_bytes, _tree_to_bytes(root)
    return None


def _tree_to_bytes(root: ElementTree.Element) -> bytes:
    try:
        return ElementTree.tostring(root)
    except TypeError as problem:
        sentence = f"the tree cannot be written as XML: {str(problem)[:80]}"
        raise Error(sentence, code="not-xml", advice="its tags, attributes and texts must be str") from None
    except RecursionError:
        raise Error("the elements of the tree are nested too deep", code="drawing-too-large") from None
