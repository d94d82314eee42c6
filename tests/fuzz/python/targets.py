"""The fuzz targets of the Python package.

Each has a function that reads its bytes, seed files, and the words and form for the mutators.

A target may end in an answer that its judge accepts, or in `brushsvg.errors.Error` with a code and one line
of text. Anything else that leaves it is a finding.
"""

from __future__ import annotations

import contextlib
import io
import json
import os
import tempfile
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from brushsvg import _core
from brushsvg.errors import Error

ROOT = Path(__file__).resolve().parents[3]
DATA = ROOT / "python" / "brushsvg" / "data"
GOLDEN = ROOT / "tests" / "golden"
LONGEST_MESSAGE = 2000  # characters: a file must not fill the terminal

Seeds = Callable[[], Iterator[bytes]]


@dataclass(frozen=True)
class Target:
    """A fuzz target.

    read: the code under test with its judge.
    seeds: sound files and unusual ones.
    words: the words of the format, for the mutators.
    most_bytes: the largest size of an input.
    form: the parts of an input: "text", "lines", "json", "xml" or "picture".
    """

    read: Callable[[bytes], None]
    seeds: Seeds
    words: tuple[str, ...] = ()
    most_bytes: int = 4096
    form: str = "text"


class PropertyBrokenError(AssertionError):
    """The code gave a result that no input may have."""


def require(holds: bool, sentence: str) -> None:
    if not holds:
        raise PropertyBrokenError(sentence)


def judged(target: Target, data: bytes) -> None:
    """Read the data; a refusal is allowed if it can be printed on one line."""
    try:
        target.read(data)
    except Error as refusal:
        text = str(refusal)
        require(bool(refusal.code), f"a refusal without a code: {text[:200]!r}")
        require("\n" not in text and "\x1b" not in text, f"a refusal of more than one line: {text[:200]!r}")
        require(0 < len(text) <= LONGEST_MESSAGE, f"a refusal of {len(text)} characters: {text[:200]!r}")


# Drawings


def _design(design) -> None:
    require(all(np.isfinite(design.sheet_mm)), f"the sheet is {design.sheet_mm}")
    for element in design.elements:
        require(np.isfinite(element.stroke_width_mm), f"{element.id[:40]!r} is {element.stroke_width_mm} mm wide")
        for part in element.subpaths:
            require(part.cubics.ndim == 3 and part.cubics.shape[1:] == (4, 2), f"cubics {part.cubics.shape}")
            require(bool(np.isfinite(part.cubics).all()), f"{element.id[:40]!r} is not finite")
            if part.widths is not None:
                require(bool(np.isfinite(part.widths).all()), f"widths of {element.id[:40]!r} are not finite")
    for notice in design.notices:
        require(bool(notice.code), f"a notice without a code: {notice.text[:200]!r}")
        require(len(notice.text) <= LONGEST_MESSAGE, f"a notice of {len(notice.text)} characters")


def _read_svg(data: bytes) -> None:
    from brushsvg.read import ReadOptions
    from brushsvg.read.svg import read_svg, read_svg_settings

    read_svg_settings(data)
    _design(read_svg(data, ReadOptions(lenient=True)))


SVG = '<svg xmlns="http://www.w3.org/2000/svg" width="90mm" height="90mm" viewBox="0 0 90 90">{}</svg>'
SHAPES = (
    '<path id="a" d="M9 9h40v20z" fill="none" stroke="red" stroke-width="3"/>',
    '<g transform="rotate(30) scale(2,-1)" style="stroke:#123;fill:none"><circle cx="9" cy="9" r="5"/></g>',
    '<rect x="1" y="2" width="30" height="20" rx="4" stroke="blue" stroke-dasharray="5 2 1"/>',
    '<defs><path id="p" d="M0 0 5 5"/></defs><use href="#p" x="3" y="4" stroke="#000"/>',
    '<clipPath id="c"><rect width="20" height="20"/></clipPath><ellipse rx="9" ry="4" clip-path="url(#c)"/>',
    '<symbol id="s" viewBox="0 0 9 9"><line x2="9" y2="9"/></symbol><use href="#s" width="20" height="20"/>',
    '<g id="l" xmlns:inkscape="http://www.inkscape.org/namespaces/inkscape" inkscape:groupmode="layer" '
    'inkscape:label="Ink" data-brushsvg-width="2mm"><polyline points="1,2 3,4 5 6" stroke="green"/></g>',
    '<mask id="m"><circle r="9" fill="white"/></mask><polygon points="0,0 9,0 9,9" mask="url(#m)"/>',
    '<marker id="k"><path d="M0 0 1 1"/></marker><path d="M1 1 9 9" marker-end="url(#k)" stroke="red"/>',
    '<text x="3" y="9">abc</text><image href="x.png"/><switch><path d="M0 0 9 9" stroke="red"/></switch>',
)
STYLE = "<style>path, .a > g:nth-child(2n+1) {{ stroke: rgb(1, 2, 3); stroke-width: calc(2px + 1mm) }} {}</style>"


def _svg_seeds() -> Iterator[bytes]:
    for shape in SHAPES:
        yield SVG.format(shape).encode()
    yield SVG.format(STYLE.format("") + "".join(SHAPES)).encode()
    yield b'<?xml version="1.0"?><!DOCTYPE svg [<!ENTITY e "red">]><svg xmlns="http://www.w3.org/2000/svg"/>'
    for file in ("robot.svg", "vincent.svg"):
        text = (ROOT / "examples" / file).read_bytes()
        if len(text) < 16000:
            yield text


SVG_WORDS = (
    *"<path/> <g> </g> <use/> <svg> </svg> <style> </style> <defs> </defs> <clipPath> <mask> <symbol> <rect/>".split(),
    *"d= id= href= transform= style= class= viewBox= width= height= fill= stroke= stroke-width= x= y= r=".split(),
    *"rotate( scale( matrix( skewX( translate( url(#a) none inherit currentColor evenodd nonzero !important".split(),
    *"px mm in % em deg rad turn calc( var( --a min( clamp( preserveAspectRatio= xMidYMid slice &#0; &amp;".split(),
    *"M m L l H h V v C c S s Q q T t A a Z z 1e309 -1e-320 NaN 0.0 99999999 <!-- --> <![CDATA[ ]]>".split(),
    *"data-brushsvg-width= data-brushsvg-passes= data-brushsvg-start= stroke-dasharray= vector-effect=".split(),
)


def _read_css(data: bytes) -> None:
    """Read a style sheet; the first line is a selector that a user gives."""
    from brushsvg.read import ReadOptions
    from brushsvg.read.svg import read_svg

    selector, _, sheet = data.decode("utf-8", "replace").partition("\n")
    sheet = "".join(each for each in sheet if each.isprintable() or each == "\n").replace("]]>", "")
    text = SVG.format(f"<style><![CDATA[{sheet}]]></style>" + "".join(SHAPES[:4]))
    _design(read_svg(text.encode(), ReadOptions(lenient=True)))
    _design(read_svg(text.encode(), ReadOptions(lenient=True, select=selector)))


def _css_seeds() -> Iterator[bytes]:
    for text in (
        "path\npath { stroke: red; stroke-width: 3mm }",
        "g > circle:not(.a)\n* { transform: rotate(3deg) translate(5%, 2px) !important; transform-origin: 50% 50% }",
        "#a, rect[x='1']\n@media print { path { fill: none } } :root { --w: 3px } rect { stroke-width: var(--w) }",
        "svg *:nth-child(2n + 1)\n.a, #a { d: path('M0 0 L 9 9'); stroke-dasharray: 1, 2 3; opacity: .5 }",
        "*\nrect { x: calc(1px * (2 + 3) - min(4mm, 5%)); fill: hsl(120deg 50% 50% / 30%); display: none }",
    ):
        yield text.encode()


CSS_WORDS = (
    *"{ } : ; , > + ~ * # . [ ] ( ) :not( :is( :nth-child( :first-child ::before @media @import @charset".split(),
    *"stroke stroke-width fill display transform transform-origin d opacity visibility --a var(--a) calc( min(".split(),
    *"rgb( hsl( color-mix( path( url( rotate( px mm % em rem vw deg inherit initial unset !important /* */ \\".split(),
    *"1e400 -0 NaN 2n+1 odd even currentColor none".split(),
)


def _read_path(data: bytes) -> None:
    """Read the first line as d, the second as points and the rest as transform."""
    from brushsvg.read.svg.paths.path_data import parse_path, parse_points
    from brushsvg.read.svg.paths.path_to_cubics import trace
    from brushsvg.read.svg.transform import parse_transform

    d, _, rest = data.decode("latin-1").partition("\n")
    points, _, transform = rest.partition("\n")
    matrix = (1.0, 0.0, 0.0, 1.0, 0.0, 0.0)
    with contextlib.suppress(Error, ValueError):  # parse_transform documents ValueError
        matrix = tuple(parse_transform(transform))
    for parse, text in ((parse_path, d), (parse_points, points)):
        commands, position = parse(text)
        require(position is None or 0 <= position <= len(text), f"damage at {position} of {len(text)}")
        for subpath in trace(commands, matrix, 1.0).subpaths:
            require(bool(np.isfinite(subpath.cubics).all()), f"cubics of {text[:60]!r} are not finite")
            joins = subpath.cubics[1:, 0] == subpath.cubics[:-1, 3]
            require(bool(joins.all()), f"cubics of {text[:60]!r} do not join")


def _path_seeds() -> Iterator[bytes]:
    for d in (
        "M9 9 40 9 l5 5H3v-9C1 2 3 4 5 6s1 2 3 4Q1,2,3,4T9 9A5 3 30 0 1 20 20z m1 1 2 2",
        "M.5.5-1e2+3 a1 1 0 1 0 5 5a25,25 -30 0,1 50,-25 Z",
        "m0 0c0 0 0 0 0 0zM1e300 1e300L-1e300 3",
    ):
        yield f"{d}\n1,2 3,4 5 6\nmatrix(1 0 0 1 3 4) rotate(30, 1, 2) skewX(10)".encode()


PATH_WORDS = tuple("M m L l H h V v C c S s Q q T t A a Z z 0 1 -1 . , + - 1e309 1e-320 .5 9e9 1e5".split())


def _read_dxf(data: bytes) -> None:
    from brushsvg.read import ReadOptions
    from brushsvg.read.dxf import read_dxf

    _design(read_dxf(data, ReadOptions(units="mm", lenient=True)))


def _dxf_seeds() -> Iterator[bytes]:
    from brushsvg.read.dxf.ezdxf_import import ezdxf

    def lines(words: str) -> bytes:
        return ("\n".join(words.split()) + "\n").encode()

    entities = (
        "0 LINE 8 0 10 0 20 0 11 5 21 5",
        "0 LWPOLYLINE 90 3 70 1 43 2.5 10 0 20 0 62 1 10 50 20 0 42 1 10 50 20 50 8 L",
        "0 SPLINE 8 L 70 8 71 3 72 8 73 4 40 0 40 0 40 0 40 0 40 1 40 1 40 1 40 1 10 0 20 0 10 10 20 0 10 10 20 10 "
        "10 20 20 10 62 1",
        "0 HATCH 8 L 62 1 10 0 20 0 30 0 210 0 220 0 230 1 2 SOLID 70 1 71 0 91 1 92 2 72 0 73 1 93 3 10 0 20 0 10 5 "
        "20 0 10 5 20 5 97 0 75 0 76 1 98 0",
        "0 MTEXT 8 L 62 1 10 0 20 0 40 5 71 1 1 Hello",
        "0 CIRCLE 8 0 10 0 20 0 40 5",
        "0 ARC 8 0 10 0 20 0 40 5 50 10 51 200",
        "0 ELLIPSE 8 0 10 0 20 0 11 9 21 3 40 0.5 41 0 42 6.28",
        "0 INSERT 2 b 10 5 20 5 41 2 70 2 44 9",
        "0 POLYLINE 66 1 70 1 0 VERTEX 10 1 20 1 42 0.5 0 VERTEX 10 9 20 1 0 SEQEND",
    )
    for entity in entities:
        yield lines(f"0 SECTION 2 ENTITIES {entity} 0 ENDSEC 0 EOF")
    yield lines(
        "0 SECTION 2 HEADER 9 $ACADVER 1 AC1015 9 $INSUNITS 70 4 0 ENDSEC 0 SECTION 2 BLOCKS 0 BLOCK 2 b 10 0 20 0 "
        f"{entities[0]} 0 ENDBLK 0 ENDSEC 0 SECTION 2 ENTITIES {' '.join(entities)} 0 ENDSEC 0 EOF"
    )
    document = ezdxf.new("R12", units=4)
    document.modelspace().add_line((0, 0), (5, 5))
    stream = io.StringIO()
    document.write(stream)
    yield stream.getvalue().encode()


DXF_WORDS = (
    *"SECTION ENDSEC EOF ENTITIES BLOCKS HEADER TABLES BLOCK ENDBLK INSERT LINE ARC CIRCLE ELLIPSE SPLINE".split(),
    *"LWPOLYLINE POLYLINE VERTEX SEQEND HATCH TEXT MTEXT DIMENSION POINT SOLID 3DFACE $ACADVER AC1009 AC1015".split(),
    *"$INSUNITS 0 1 2 8 10 20 11 21 40 41 42 43 50 51 62 70 71 72 73 90 93 100 210 220 230 370 1e308 -1 b L".split(),
)


def _read_foreign_gcode(data: bytes) -> None:
    from brushsvg.read import ReadOptions
    from brushsvg.read.gcode import read_gcode

    _design(read_gcode(data, ReadOptions(lenient=True)))


def _gcode_seeds() -> Iterator[bytes]:
    for text in (
        "G21 G90\nG0 Z5\nG0 X1 Y1\nG1 Z-1 F100\nG1 X20 Y5\nG2 X30 Y15 I10 J0\nG3 X9 Y9 R12\nG0 Z5\nM2\n",
        "%\nO1\nG20\nG91\n(dip: blue)\nG00 X1.\nM3 S90\nG01 X1. Y.5 F30.\nM5\nG90 G92 X0 Y0\nM30\n%",
        "G21\nM280 P0 S30\nG4 P100\nG1 X9 Y9\nG28\nN10 G1 X1 *33\n; a comment\nG17 G54 G64 P0.1\n",
        "#1=5\nG1 X[#1+2] Y[3*4]\nG5.1 X1 Y1 I2 J2\nG81 X1 Y1 Z-2 R1\n",
    ):
        yield text.encode()
    yield (GOLDEN / "flat_bench.ngc").read_bytes()[:4096]


GCODE_WORDS = (
    *"G0 G1 G2 G3 G4 G5 G17 G18 G20 G21 G28 G53 G54 G61 G64 G90 G91 G90.1 G91.1 G92 M0 M2 M3 M5 M30 M280".split(),
    *"X Y Z I J K R F S P E N O A ( ) ; % * # [ ] = 1e9 -0 . 99999999 0.0001 Q0 $ !".split(),
)


def _read_font(data: bytes) -> None:
    from brushsvg.read.text import text_svg

    text_svg("Aa1 fi\nÄ", data, size_mm=10.0)


def _outline_font_seeds() -> Iterator[bytes]:
    from fontTools.fontBuilder import FontBuilder
    from fontTools.pens.t2CharStringPen import T2CharStringPen
    from fontTools.pens.ttGlyphPen import TTGlyphPen

    names = [".notdef", "A", "a", "one", "space", "f", "i"]
    for is_cff in (False, True):
        builder = FontBuilder(1000, isTTF=not is_cff)
        builder.setupGlyphOrder(names)
        builder.setupCharacterMap({65: "A", 97: "a", 49: "one", 32: "space", 102: "f", 105: "i"})
        outlines = {}
        for name in names:
            pen = T2CharStringPen(500, None) if is_cff else TTGlyphPen(None)
            if name != "space":
                pen.moveTo((0, 0))
                pen.lineTo((400, 0))
                pen.lineTo((200, 700))
                pen.closePath()
            outlines[name] = pen.getCharString() if is_cff else pen.glyph()
        if is_cff:
            builder.setupCFF("F", {}, outlines, {})
        else:
            builder.setupGlyf(outlines)
        builder.setupHorizontalMetrics(dict.fromkeys(names, (500, 0)))
        builder.setupHorizontalHeader(ascent=800, descent=-200)
        builder.setupNameTable({"familyName": "F", "styleName": "Regular"})
        builder.setupOS2()
        builder.setupPost()
        stream = io.BytesIO()
        builder.save(stream)
        yield stream.getvalue()


def _svg_font_seeds() -> Iterator[bytes]:
    yield (
        b'<svg xmlns="http://www.w3.org/2000/svg"><defs><font id="f" horiz-adv-x="600"><font-face units-per-em="1000" '
        b'ascent="800" descent="-200"/><missing-glyph d="M0 0h9"/><glyph unicode="A" horiz-adv-x="500" '
        b'd="M0 700L500 700M250 700L250 0"/><glyph unicode="fi" d="M0 0L5 9"/><glyph unicode="a" glyph-name="a" '
        b'd="M0 0q9 9 20 20"/><hkern u1="A" u2="a" k="50"/><hkern g1="a" g2="a" k="-9"/></font></defs></svg>'
    )


# Tables and TOML


def _brush(brush) -> None:
    _core.check(brush)
    require(
        _core.write_brush(_core.read_brush(_core.write_brush(brush))) == _core.write_brush(brush),
        "brush.json",
    )


def _read_measurements(suffix: str) -> Callable[[bytes], None]:
    def read(data: bytes) -> None:
        from brushsvg.calibration.from_file import fit_measurements

        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, f"measured{suffix}")
            Path(path).write_bytes(data)
            found = fit_measurements(path)
        _brush(found.brush)

    return read


def _csv_seeds() -> Iterator[bytes]:
    rows = [f"{kind},{depth},{k * depth}" for depth in range(1, 7) for kind, k in (("lag", 2), ("width", 1))]
    yield "\n".join(["kind,depth_mm,value_mm", *rows]).encode()
    yield "kind;depth_mm;value_mm\nlag;1,5;3,2\nlag;4;5,0\nwidth;1,5;1\nwidth;4;3,5\n".encode("utf-8-sig")
    yield b"depth_mm\tvalue_mm\tkind\n1\t2\tlag\n3\t4\tlag\n1\t1\twidth\n2\t1.5\twidth\n"


def _json_measurement_seeds() -> Iterator[bytes]:
    def file(**content) -> bytes:
        return json.dumps({"format": "brushsvg/measurements", "version": 1, **content}).encode()

    def rows(times: float) -> list[dict]:
        return [{"depth_mm": depth, "value_mm": times * depth} for depth in (1, 3, 5, 6)]

    line = [[float(x), 0.0] for x in range(8)] + [[8.0 + x, 0.1 * x] for x in range(8)]
    yield file(name="b", lag=rows(2.0), width=rows(1.0), tip_gap=rows(0.5), depth_range_mm=[0, 8])
    yield file(lag=rows(2.0), half_width=rows(0.4), tip_to_widest=rows(1.0), side_view=rows(0.5), max_speed_mm_s=20)
    yield file(
        width=rows(1.0),
        angles=[
            {
                "depth_mm": 3,
                "alpha0_deg": 85,
                "s_mm": [1, 3, 6],
                "alpha_deg": [68, 51, 28],
                "beta_deg": [130, 115, 92],
            }
        ],
        angular=rows(2.0),
        straight=[{"depth_mm": 3, "path_mm": 30, "distance_mm": 24}],
    )
    yield file(
        width=rows(1.0),
        centre_line=[{"depth_mm": 3, "points_mm": line}],
        video=[{"ferrule_mm": [[0, 9], [0, 8], [1, 6]], "tip_mm": [[0, 0], [-1, 0], [-2, 0]]}],
    )
    poses = [[0, 0, 0], [12, 0, -3], [30, 0, -3], [30, 25, -3]]
    ring = [[4, -1.5], [24, -1.5], [31.5, 5], [31.5, 20], [28.5, 20], [28.5, 6], [22, 1.5], [4, 1.5]]
    yield file(
        plan={"passes": [{"stroke": "a", "poses_mm": poses}]},
        marks=[{"stroke": "a", "outline_mm": [ring]}],
        expected={"placement_mm": 1},
    )


MEASUREMENT_WORDS = (
    *"kind depth_mm value_mm width_mm lag width tip_gap half_width tip_to_widest angular side_view straight".split(),
    *"angles centre_line video plan marks passes poses_mm stroke outline_mm name format version".split(),
    *"depth_range_mm max_speed_mm_s expected alpha0_deg alpha_deg beta_deg s_mm points_mm".split(),
    *"picture touch , ; 1e400 nan inf -1 0 null true [] {} 1,5".split(),
    "brushsvg/measurements",
)


def _read_widths(data: bytes) -> None:
    from brushsvg.calibration.numbers.measurements import read_widths

    for depth, width in read_widths(data.decode("utf-8", "replace")):
        require(np.isfinite(depth + width) and depth > 0 and width > 0, f"{depth}, {width}")


def _width_seeds() -> Iterator[bytes]:
    yield b"depth_mm,width_mm\n3,2\n5,4.5\n"
    yield b"width_mm;depth_mm\n3,5;2\n"


def _read_cell(data: bytes) -> None:
    from brushsvg.machine.cells.cell_file import parse_cell, write_cell

    cell = parse_cell(data.decode("utf-8", "replace"))
    require(write_cell(parse_cell(write_cell(cell))) == write_cell(cell), "a cell is written and read the same")


def _cell_seeds() -> Iterator[bytes]:
    from brushsvg.machine.cells.cell_file import parse_cell, write_cell

    for path in sorted((DATA / "cells").glob("*.toml")):
        text = path.read_text(encoding="utf-8")
        yield "\n".join(line for line in text.splitlines() if not line.startswith("#")).encode()
    # Every key, with the shipped words.
    yield write_cell(parse_cell((DATA / "cells" / "grbl-3axis.toml").read_text(encoding="utf-8"))).encode()


TOML_WORDS = (
    *"[paper] [heights] [speeds] [workspace] [blending] [paint] [servo] [motion] [backlash] [[stations]]".split(),
    *'language decimals name = true false inf -inf nan 1e400 -1 0 [ ] { } \' """ 0x1 1_0 1979-05-27 \\u0000'.split(),
    *"[distortion] [tilt] [arm] [field] origin_mm safe_mm travel_mm_s".split(),
)


def _read_studio(data: bytes) -> None:
    from brushsvg.simulated.studio_errors import read_studio, write_studio

    studio = read_studio(data)
    require(
        write_studio(read_studio(write_studio(studio).encode())) == write_studio(studio),
        "a studio is read back",
    )


def _studio_seeds() -> Iterator[bytes]:
    from brushsvg.simulated.studio_errors import Studio, random_studio, write_studio

    yield write_studio(Studio()).encode()
    yield write_studio(random_studio(3, (100.0, 100.0))).encode()


def _read_chart(data: bytes) -> None:
    from brushsvg.calibration.chart.file import read_chart, write_chart

    chart = read_chart(data)
    require(write_chart(read_chart(write_chart(chart).encode())) == write_chart(chart), "a chart is read back")


def _chart_seeds() -> Iterator[bytes]:
    from brushsvg.calibration.chart.file import write_chart
    from brushsvg.calibration.chart.layout import chart
    from brushsvg.model.library import find_brush

    text = write_chart(chart(find_brush("round-6"), sheet_mm=(148.0, 210.0)))
    yield text.encode()


def _read_manifest(data: bytes) -> None:
    """Read a foreign manifest, which must not reach files outside of its folder."""
    from brushsvg.jobs.batch.manifest import Manifest, Row

    with tempfile.TemporaryDirectory() as above:
        outside = Path(above) / "outside.ngc"
        outside.write_bytes(b"x")
        folder = Path(above) / "out"
        folder.mkdir()
        (folder / "a.ngc").write_bytes(b"x")
        (folder / "manifest.jsonl").write_bytes(data)
        try:
            manifest = Manifest(folder)
            try:
                for name in list(manifest._by_name):
                    manifest.remove_outdated(Row(name, name, "", code="drawing-empty"))
                manifest.finish([])
            finally:
                manifest.close()
        finally:
            require(outside.read_bytes() == b"x", "a file outside of the folder was changed")
            names = sorted(os.listdir(above))
            require(names == ["out", "outside.ngc"], f"there are {names} above the folder")


def _manifest_seeds() -> Iterator[bytes]:
    import hashlib

    from brushsvg.jobs.batch.manifest import FORMAT, Row, format_row

    digest = hashlib.sha256(b"x").hexdigest()
    head = json.dumps(FORMAT) + "\n"
    rows = [
        Row("a", "a.svg", "k", files={"a.ngc": digest}),
        Row("b", "b.svg", "k", code="drawing-empty", sentence="no", files={"../outside.ngc": digest}),
    ]
    yield head.encode()
    for row in rows:
        yield (head + format_row(row)).encode()


# Programs read back


READ_BACK = {  # {cell: one of its golden programs}
    "linuxcnc-3axis": "two_strokes.ngc",
    "grbl-3axis": "two_strokes_grbl.ngc",
    "grbl-servo": "two_strokes_servo.ngc",
    "fluidnc-3axis": "two_strokes_fluidnc.gcode",
    "marlin-3axis": "two_strokes_marlin.gcode",
    "marlin-servo": "two_strokes_marlin_servo.gcode",
    "klipper-3axis": "two_strokes_klipper.gcode",
    "ur5e": "two_strokes.script",
    "jaka-zu3": "two_strokes.jks",
    "irb120": "two_strokes.mod",
    "xarm6": "two_strokes.py",
    "kr6-r900": "two_strokes.src",
    "cr5": "two_strokes.lua",
    "lrmate200id": "two_strokes.ls",
    "m0609": "two_strokes.drl",
    "fr3": "two_strokes.csv",
    "axidraw-ebb": "two_strokes.ebb",
    "hpgl-plotter": "two_strokes.hpgl",
}


def _read_back(name: str) -> Callable[[bytes], None]:
    def read(data: bytes) -> None:
        from brushsvg.machine.cells.cell_file import find_cell
        from brushsvg.machine.posts import POSTS
        from brushsvg.model.library import find_brush
        from brushsvg.verify.readback import read_program, text_of_file
        from brushsvg.verify.readback.header import read_header
        from brushsvg.verify.simulate_program import simulate_program

        cell = find_cell(name)
        text = text_of_file(data)
        with contextlib.suppress(Error):  # a program without our header is still read
            read_header(text)
        found = read_program(text, POSTS[cell.language].extensions[0], cell)
        for section in found.sections:
            for step in section.steps:
                numbers = np.array([step.x, step.y, step.z])
                require(not np.isinf(numbers).any(), f"line {step.line} goes to {numbers}")
                require(step.speed_mm_s > 0 or np.isnan(step.speed_mm_s), f"line {step.line} at {step.speed_mm_s}")
        simulate_program(found, find_brush("round-6"), cell, (297.0, 210.0))

    return read


def _program_seeds(file: str) -> Seeds:
    def seeds() -> Iterator[bytes]:
        data = (GOLDEN / file).read_bytes()
        yield data
        lines = data.splitlines(keepends=True)
        yield b"".join(lines[: len(lines) // 2])
        if len(lines) > 40:
            yield b"".join(lines[:25] + lines[-15:])

    return seeds


# Pictures


def _read_photo(data: bytes) -> None:
    from brushsvg.photo.photo import read_photo

    pixels = read_photo(data)
    require(pixels.dtype == np.uint8 and pixels.ndim == 3 and pixels.shape[2] == 3, f"pixels {pixels.shape}")


def _picture_seeds() -> Iterator[bytes]:
    import cv2

    pixels = np.full((48, 64, 3), 240, np.uint8)
    cv2.line(pixels, (8, 40), (8, 10), (20, 20, 20), 5)
    cv2.line(pixels, (8, 10), (56, 10), (20, 20, 20), 5)
    for suffix in (".png", ".jpg", ".bmp", ".tiff", ".webp"):
        yield cv2.imencode(suffix, pixels)[1].tobytes()
    yield cv2.imencode(".png", pixels[:, :, 0])[1].tobytes()


def _read_turn(data: bytes) -> None:
    from brushsvg.calibration.numbers.turn_picture import centre_line

    line = centre_line(data, 0.5, (8.0, 10.0), "right")
    require(bool(np.isfinite(line).all()) and line.shape[1] == 2, f"a line {line.shape}")


MARKERS_PX = (
    (20, 20),
    (344, 20),
    (344, 344),
    (20, 344),
    (180, 20),
    (180, 344),
)  # the upper left corners of the markers, which are 36 pixels wide


def _read_chart_photo(data: bytes) -> None:
    """Read a small photograph of a page with markers."""
    from brushsvg.photo.markers import Printed, find_view
    from brushsvg.photo.photo import read_photo

    corners = {
        number: np.array([[x, 400 - y], [x + 36, 400 - y], [x + 36, 364 - y], [x, 364 - y]]) / 10
        for number, (x, y) in enumerate(MARKERS_PX)
    }
    view = find_view(read_photo(data), Printed((40.0, 40.0), corners, "DICT_4X4_50"))
    require(bool(np.isfinite(view.homography).all()), "the view is not finite")


def _marker_photo_seeds() -> Iterator[bytes]:
    import cv2

    dictionary = cv2.aruco.getPredefinedDictionary(cv2.aruco.DICT_4X4_50)
    page = np.full((400, 400), 245, np.uint8)
    for number, (x, y) in enumerate(MARKERS_PX):
        page[y : y + 36, x : x + 36] = cv2.aruco.generateImageMarker(dictionary, number, 36)
    yield cv2.imencode(".png", page)[1].tobytes()
    yield cv2.imencode(".jpg", page)[1].tobytes()


TARGETS: dict[str, Target] = {
    "svg": Target(_read_svg, _svg_seeds, SVG_WORDS, 16384, form="xml"),
    "css": Target(_read_css, _css_seeds, CSS_WORDS, 1024),
    "path_data": Target(_read_path, _path_seeds, PATH_WORDS, 1024),
    "dxf": Target(_read_dxf, _dxf_seeds, DXF_WORDS, 16384, form="lines"),
    "outline_font": Target(_read_font, _outline_font_seeds, (), 8192),
    "svg_font": Target(
        _read_font, _svg_font_seeds, (*SVG_WORDS, "<glyph/>", "<hkern/>", "unicode=", "k="), 4096, form="xml"
    ),
    "foreign_gcode": Target(_read_foreign_gcode, _gcode_seeds, GCODE_WORDS, 4096, form="lines"),
    "measurements_csv": Target(_read_measurements(".csv"), _csv_seeds, MEASUREMENT_WORDS, 2048, form="lines"),
    "measurements_json": Target(
        _read_measurements(".json"), _json_measurement_seeds, MEASUREMENT_WORDS, 8192, form="json"
    ),
    "widths_csv": Target(_read_widths, _width_seeds, MEASUREMENT_WORDS, 1024, form="lines"),
    "cell": Target(_read_cell, _cell_seeds, TOML_WORDS, 8192, form="lines"),
    "studio": Target(_read_studio, _studio_seeds, TOML_WORDS, 4096, form="lines"),
    "chart": Target(
        _read_chart, _chart_seeds, ("dictionary", "markers", "strokes", "labels", "null"), 65536, form="json"
    ),
    "manifest": Target(
        _read_manifest, _manifest_seeds, ("../", "/etc/", "\\u0000", "null", "files"), 4096, form="lines"
    ),
    "photo": Target(_read_photo, _picture_seeds, most_bytes=16384),
    "turn_picture": Target(_read_turn, _picture_seeds, most_bytes=65536, form="picture"),
    "chart_photo": Target(_read_chart_photo, _marker_photo_seeds, most_bytes=262144, form="picture"),
    **{
        f"readback_{name.replace('-', '_')}": Target(
            _read_back(name), _program_seeds(file), GCODE_WORDS, 20000, form="lines"
        )
        for name, file in READ_BACK.items()
    },
}


def seeds_of(name: str) -> list[bytes]:
    """Return the seeds of a target without the ones that are too long."""
    target = TARGETS[name]
    found = [data for data in target.seeds() if len(data) <= target.most_bytes]
    if not found:
        raise ValueError(f"all seeds of {name} are longer than {target.most_bytes} bytes")
    return found
