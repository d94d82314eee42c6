"""Drawings in, Design out: one format per file. READERS names them all."""

from __future__ import annotations

import io
import os
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Protocol
from xml.etree import ElementTree

from ..errors import Error, need, need_number, need_one_of, need_truth
from ..files import read_bytes
from .damage import refuse_damage

if TYPE_CHECKING:
    from ezdxf.document import Drawing

    from .design import Design


@dataclass(frozen=True)
class ReadOptions:
    """Options of a reader.

    sheet_mm: (w, h) in place of the drawing's own; units: "mm" or "in", of a drawing that has numbers only (DXF);
    select: a CSS selector; elements outside of its matches are left out (SVG); background: "auto"
    leaves out a white shape that comes first and covers the page, "keep" paints it (SVG). Of G-code, pen: "z" or
    "servo", what moves its pen; paper_z_mm: the height at which it draws; skip_regions_mm: (x0, y0, x1, y1), strokes
    inside are left out; skip_comments: so are those behind comments that hold such a text. lenient: take what is
    sound of damaged geometry, with a notice for what is not.
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


AS_DRAWN = ReadOptions()
SIZE_MM = (0.001, 1e6)  # of a sheet's sides
UNITS = ("mm", "in")
BACKGROUNDS = ("auto", "keep")
SCRIPTS = ("auto", "latin", "arabic", "devanagari", "cjk")  # how filled shapes are written
PENS = ("z", "servo")  # what moves the pen of a program


def refuse_unusable(options: ReadOptions) -> None:
    """Error for options that no drawing can be read with."""
    need(options, ReadOptions, "options to read a drawing with, as ReadOptions are")
    if options.sheet_mm is not None:
        need(options.sheet_mm, (tuple, list), "a sheet's width and height [mm]")
        if len(options.sheet_mm) != 2:
            raise Error(
                f"sheet_mm has {len(options.sheet_mm)} numbers, not two", "sheet_mm", code="wrong-type"
            )
        for side in options.sheet_mm:
            need_number(side, "a side of the sheet [mm]", *SIZE_MM)
    if options.units is not None:
        need_one_of(options.units, UNITS, "units")
    need_one_of(options.background, BACKGROUNDS, "background")
    if options.pen is not None:
        need_one_of(options.pen, PENS, "pen")
    if options.paper_z_mm is not None:
        need_number(options.paper_z_mm, "the height at which a program draws [mm]", -1e4, 1e4)
    for region in options.skip_regions_mm:
        need(region, (tuple, list), "a region, four numbers [mm]")
        if len(region) != 4:
            raise Error(f"a region has {len(region)} numbers, not four", "skip_regions_mm", code="wrong-type")
    for text in options.skip_comments:
        need(text, str, "a text of comments")
    need_truth(options.lenient, "lenient")
    if options.select is not None:
        need(options.select, str, "a text, which select is")


@dataclass(frozen=True)
class InMemory:
    """A drawing that is no file, or not read here: the extension says its format, data is what a file would hold."""

    extension: str
    data: bytes


class HasTree(Protocol):
    """What svgpathtools' Document is."""

    @property
    def tree(self) -> Any: ...


if TYPE_CHECKING:
    Source = (
        str | os.PathLike[str] | InMemory | ElementTree.ElementTree | ElementTree.Element | HasTree | Drawing
    )


def _svg(data: bytes, options: ReadOptions) -> Design:
    from .svg import read_svg  # loaded for who reads, not for who only asks what can be read

    return read_svg(data, options)


def _dxf(data: bytes, options: ReadOptions) -> Design:
    from .dxf import read_dxf

    return read_dxf(data, options)


def _gcode(data: bytes, options: ReadOptions) -> Design:
    from .gcode import read_gcode

    return read_gcode(data, options)


def settings_in(path, alone: bool = False) -> dict:
    """Brush, cell, compensation, tolerance [mm] and wide that a drawing asks for, as far as it does.

    path: as for read_drawing; anything else asks for nothing. Error if the file cannot be read; alone, where nothing
    else of it will be: also if it is no drawing.
    """
    if isinstance(path, str | os.PathLike):
        if os.path.splitext(path)[1].lower() not in (".svg", ".svgz"):
            if alone:
                read_bytes(path)  # a DXF asks for nothing, but there should be one
            return {}
        data = read_bytes(path)
    elif (opened := _of_opened(path)) and opened[0] is _svg:
        data = opened[1]
    else:
        return {}
    from .svg import settings_of

    return settings_of(data, alone)


READERS = {  # by extension; each takes (bytes, ReadOptions)
    ".svg": _svg,
    ".svgz": _svg,
    ".dxf": _dxf,
    ".gcode": _gcode,
    ".ngc": _gcode,
    ".nc": _gcode,
}


def read_drawing(path: Source, options: ReadOptions = AS_DRAWN) -> Design:
    """The drawing in a file, its format chosen by extension; or one that is open already.

    path: of the file; or an ezdxf document, or an SVG as an ElementTree, its root element or svgpathtools' Document:
    read as their files would be, but an ElementTree holds nothing that stands before its root, so of links to style
    sheets there nothing is said.
    Error if it cannot be read, is of no known format, has nothing to paint, or holds damaged geometry and lenient
    is False.
    """
    refuse_unusable(options)
    reader, data = _opened(path)
    from .duplicates import without_duplicates  # loaded to read, as the readers are
    from .pressure_strokes import with_pressure_strokes

    design = without_duplicates(with_pressure_strokes(reader(data, options)))
    if not options.lenient:
        refuse_damage(design)
    return design


def _opened(path) -> tuple:
    """(Reader, bytes) of a file or of what was open already."""
    if isinstance(path, str | os.PathLike):
        extension = os.path.splitext(path)[1]
        reader = READERS.get(extension.lower())
        if reader is None:
            if os.path.isdir(path):
                raise Error("this is a directory, not a file", file=os.fspath(path), code="file-unreadable")
            known = ", ".join(READERS)
            raise Error(
                f"{extension or 'no extension'} is not a drawing format that is read; known: {known}",
                code="drawing-format",
            )
        return reader, read_bytes(path)
    opened = _of_opened(path)
    if opened is None:
        raise Error(
            f"a {type(path).__name__} is neither the path of a drawing nor an open one, "
            "an ezdxf document or an ElementTree",
            code="drawing-format",
        )
    return opened


def _of_opened(drawing) -> tuple | None:
    """The same of what was open already; None for anything else."""
    if isinstance(drawing, InMemory) and drawing.extension in READERS:
        return READERS[drawing.extension], drawing.data
    if hasattr(drawing, "modelspace"):
        text = io.StringIO()
        drawing.write(text)
        return _dxf, text.getvalue().encode(drawing.output_encoding, errors="dxfreplace")
    tree = getattr(drawing, "tree", drawing)
    root = tree.getroot() if hasattr(tree, "getroot") else tree
    if ElementTree.iselement(root) and isinstance(root, ElementTree.Element):
        return _svg, ElementTree.tostring(root)
    return None
