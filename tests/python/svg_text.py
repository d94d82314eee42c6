"""SVG drawings for tests: a page of 100 x 50 mm, red strokes 1 mm wide, no fill."""

from brushsvg.read import ReadOptions
from brushsvg.read.svg import read_svg

HEAD = (
    '<svg xmlns="http://www.w3.org/2000/svg" xmlns:xlink="http://www.w3.org/1999/xlink" '
    'xmlns:inkscape="http://www.inkscape.org/namespaces/inkscape" width="100mm" height="50mm" '
    'viewBox="0 0 100 50" fill="none" stroke="red" stroke-width="1">'
)


def read(body, **options):
    return read_svg(f"{HEAD}{body}</svg>".encode(), ReadOptions(**options))


def lines(design):
    """Return (id, start, end) of every subpath in SVG coordinates (y down)."""
    return [
        (element.id, (x0, 50 - y0), (x1, 50 - y1))
        for element in design.elements
        for subpath in element.subpaths
        for (x0, y0), (x1, y1) in [(subpath.cubics[0, 0].round(9).tolist(), subpath.cubics[-1, 3].round(9).tolist())]
    ]


def sentences(design):
    return [f"{notice.where}: {notice.sentence}" for notice in design.notices]
