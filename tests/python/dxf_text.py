"""Make DXF drawings with ezdxf and measure how far a curve is from the true one."""

import io

import numpy as np
import shapely
from fontTools.fontBuilder import FontBuilder
from fontTools.pens.ttGlyphPen import TTGlyphPen

from brushsvg.read import ReadOptions
from brushsvg.read.dxf import read_dxf
from brushsvg.read.dxf.ezdxf_import import ezdxf

TOPS = {"A": 700, "x": 500, "p": 500, ".notdef": 300}  # the descender of p reaches -200
SHEET = (1000.0, 1000.0)  # With a given sheet, the drawing's origin stays where it is.


def drawing(draw=None, units=4, version="R2010"):
    document = ezdxf.new(version, units=units)
    if draw is not None:
        draw(document.modelspace())
    return document


def encoded(document, binary=False):
    stream = io.BytesIO() if binary else io.StringIO()
    document.write(stream, **({"fmt": "bin"} if binary else {}))
    return stream.getvalue() if binary else stream.getvalue().encode(document.output_encoding, "surrogateescape")


def text_dxf(*entities, header=""):
    """Return a DXF file that has only an ENTITIES section."""
    words = f"{header} 0 SECTION 2 ENTITIES {' '.join(entities)} 0 ENDSEC 0 EOF".split()
    return "\n".join([*words, ""]).encode()


def read(document, sheet_mm=SHEET, units=None, binary=False):
    return read_dxf(encoded(document, binary), ReadOptions(sheet_mm=sheet_mm, units=units))


def only(document, **options):
    """Return the single element of a drawing that has no notices."""
    design = read(document, **options)
    assert design.notices == ()
    (element,) = design.elements
    return element


def along(cubics, count=1000):
    t = np.linspace(0, 1, count)[None, :, None]
    a, b, c, d = (cubics[:, k, None] for k in range(4))
    points = (1 - t) ** 3 * a + 3 * t * (1 - t) ** 2 * b + 3 * t**2 * (1 - t) * c + t**3 * d
    return points.reshape(-1, 2)


def apart(subpath, points):
    """Return the greatest distance [mm] between the curve and a fine polyline.

    Both directions count: from curve to polyline, and from polyline to curve.
    """
    assert (subpath.cubics[1:, 0] == subpath.cubics[:-1, 3]).all()
    if subpath.closed:
        assert (subpath.cubics[0, 0] == subpath.cubics[-1, 3]).all()
    read, true = along(subpath.cubics), np.asarray(points)[:, :2]
    return max(_off(_some(read), true), _off(_some(true), read))


def _some(points):
    """Return every eighth point and the last.

    Callers compare these points with a line that keeps all its points.
    """
    return np.vstack([points[::8], points[-1:]])


def _off(points, line):
    sides = shapely.linestrings(np.stack((line[:-1], line[1:]), axis=1))
    _, distances = shapely.STRtree(sides).query_nearest(shapely.points(points), all_matches=False, return_distance=True)
    return distances.max()


def circle(centre, rx, ry=None, begin=0.0, end=360.0, turn=0.0, count=6000):
    """Return points of an elliptical arc.

    `begin` and `end` are values of the ellipse parameter in degrees.
    """
    t, turn = np.radians(np.linspace(begin, end, count)), np.radians(turn)
    x, y = rx * np.cos(t), (rx if ry is None else ry) * np.sin(t)
    x, y = x * np.cos(turn) - y * np.sin(turn), x * np.sin(turn) + y * np.cos(turn)
    return np.column_stack((x, y)) + centre


def bulged(vertices, closed=False):
    """Return points of a polyline of (x, y, bulge), with exact arcs."""
    places = [complex(x, y) for x, y, _ in vertices]
    points = []
    for k, p in enumerate(places if closed else places[:-1]):
        q, bulge = places[(k + 1) % len(places)], vertices[k][2]
        if not bulge:
            points += [p, q]
            continue
        centre = (p + q) / 2 + 1j * (q - p) / 2 * (1 - bulge**2) / (2 * bulge)
        points += list(centre + (p - centre) * np.exp(4j * np.arctan(bulge) * np.linspace(0, 1, 4000)))
    return np.column_stack((np.real(points), np.imag(points)))


def save_font(path, family, wide=600, slanted=False):
    """Save a font in which A, x and p are boxes of the given width.

    The em has 1000 units. A, U+05D0 and U+0301 are 700 high, and the gap between letters is 100. `slanted` cuts each
    box in half along its diagonal.
    """
    builder = FontBuilder(1000, isTTF=True)
    builder.setupGlyphOrder([".notdef", "space", "A", "x", "p"])
    builder.setupCharacterMap({ord(letter): letter for letter in "Axp"} | {32: "space", 0x05D0: "A", 0x0301: "A"})
    glyphs = {"space": TTGlyphPen(None).glyph()}
    for name, top in TOPS.items():
        pen, bottom = TTGlyphPen(None), -200 if name == "p" else 0
        pen.moveTo((0, bottom))
        for corner in ((0, top), (wide, bottom)) if slanted else ((0, top), (wide, top), (wide, bottom)):
            pen.lineTo(corner)
        pen.closePath()
        glyphs[name] = pen.glyph()
    builder.setupGlyf(glyphs)
    builder.setupHorizontalMetrics({name: (wide + 100, 0) for name in glyphs})
    builder.setupHorizontalHeader(ascent=800, descent=-200)
    builder.setupNameTable({"familyName": family, "styleName": "Regular"})
    builder.setupOS2()
    builder.setupPost()
    builder.save(path)
