"""A DXF as ezdxf's drawing add-on shows it and as we read it: polygons by colour."""

import io
import math

import numpy as np
import shapely

from brushsvg import Error
from brushsvg.read import ReadOptions
from brushsvg.read.dxf import read_dxf
from brushsvg.read.dxf.ezdxf_import import ezdxf

from ezdxf.addons.drawing import Frontend, RenderContext, config, recorder  # isort: skip  after the library

PAPER = "#ffffff"
NEAR_MM = 0.05  # edges nearer than this count as equal
_SHOWN = config.Configuration(
    background_policy=config.BackgroundPolicy.WHITE,
    max_flattening_distance=1e-3,
    circle_approximation_count=1000,
    min_dash_length=0.0,
)


def shown(data: bytes) -> dict[str, shapely.Geometry]:
    """Return the polygons that the add-on shows on white paper.

    Lines have their weight and round ends.
    """
    document = ezdxf.read(io.StringIO(data.decode("utf-8", "surrogateescape")))
    paper = recorder.Recorder()
    try:
        Frontend(RenderContext(document), paper, _SHOWN).draw_layout(document.modelspace(), finalize=True)
    except (ezdxf.DXFError, AttributeError):  # the add-on cannot draw everything, for example a missing block
        return {}
    found: dict[str, list] = {}
    for record in paper.records:
        pen = paper.properties[record.property_hash]
        mark = _mark(record, pen.lineweight)
        if pen.color[:7] == PAPER:
            found = {colour: [each.difference(mark) for each in marks] for colour, marks in found.items()}
        else:
            found.setdefault(pen.color[:7], []).append(mark)
    return {colour: shapely.union_all(marks) for colour, marks in found.items()}


def _mark(record, width_mm):
    match record:
        case recorder.PointsRecord():
            points = [(p.x, p.y) for p in record.points.vertices()]
            if len(points) > 2:
                return _even_odd([points])
            return _stroked([points], width_mm)
        case recorder.SolidLinesRecord():
            points = [(p.x, p.y) for p in record.lines.vertices()]
            return _stroked(list(zip(points[::2], points[1::2], strict=True)), width_mm)
        case recorder.PathRecord():
            return _stroked(_flat(record.path), width_mm)
        case recorder.FilledPathsRecord():
            return _even_odd([line for path in record.paths for line in _flat(path)])
    raise TypeError(record)


def _flat(path):
    whole = path.to_path2d() if hasattr(path, "to_path2d") else path
    return [[(p.x, p.y) for p in part.flattening(1e-3)] for part in whole.sub_paths()]


def _stroked(lines, width_mm):
    lines = [line if len(line) > 1 else [line[0]] * 2 for line in lines if len(line)]
    return shapely.union_all([shapely.LineString(line).buffer(width_mm / 2, 16) for line in lines])


def _even_odd(rings):
    mark = shapely.Polygon()
    for ring in rings:
        if len(ring) > 2:
            mark = mark.symmetric_difference(shapely.make_valid(shapely.Polygon(ring), method="linework"))
    return mark


def painted(data: bytes) -> tuple[dict[str, shapely.Geometry], list[str]]:
    """Return our polygons, and all notices except those of parts read as intended."""
    try:
        design = read_dxf(data, ReadOptions(sheet_mm=(1000, 1000), lenient=True))
    except Error as refusal:
        return {}, [str(refusal)]
    found: dict[str, list] = {}
    for element in design.elements:
        found.setdefault(element.colour, []).append(_of_element(element))
    usual = ("dashed", "text-outlined")
    reported = [
        f"{n.where}: {n.sentence}"
        for n in design.notices
        if n.code not in usual and (n.code, n.where) != ("hidden", "Defpoints")
    ]
    return {colour: shapely.union_all(marks) for colour, marks in found.items()}, reported


def _of_element(element):
    lines = [_points(subpath.cubics) for subpath in element.subpaths]
    if element.fill_rule == "evenodd":
        return _even_odd(lines)
    if element.fill_rule:
        return shapely.union_all([shapely.Polygon(line).buffer(0) for line in lines if len(line) > 2])
    marks = []
    for subpath, line in zip(element.subpaths, lines, strict=True):
        widths = subpath.widths
        if widths is None:
            marks.append(_stroked([line], element.stroke_width_mm))
        else:
            marks.append(_swept(line, widths))
    return shapely.union_all(marks)


def _swept(line, widths):
    steps = np.hypot(*np.diff(line, axis=0).T)
    at = np.concatenate([[0.0], np.cumsum(steps)])
    at /= at[-1]
    marks = []
    for a, b, s, t in zip(line, line[1:], at, at[1:], strict=False):
        if math.dist(a, b) == 0:
            continue
        middle = (s + t) / 2
        near = s + (middle - s) * 1e-6, t - (t - middle) * 1e-6
        w = np.interp(near, widths[:, 0], widths[:, 1])
        n = np.array([a[1] - b[1], b[0] - a[0]]) / math.dist(a, b) / 2
        a, b = np.array(a), np.array(b)
        marks.append(shapely.Polygon([a + n * w[0], b + n * w[1], b - n * w[1], a - n * w[0]]).buffer(0))
    return shapely.union_all(marks)


def _points(cubics):
    t = np.linspace(0, 1, 65)[1:, None, None]
    p0, p1, p2, p3 = (cubics[:, k] for k in range(4))
    points = (1 - t) ** 3 * p0 + 3 * t * (1 - t) ** 2 * p1 + 3 * t**2 * (1 - t) * p2 + t**3 * p3
    return np.vstack([cubics[:1, 0], points.transpose(1, 0, 2).reshape(-1, 2)])


def difference(theirs, ours) -> float:
    """Return the share of the area that only one of them shows.

    Parts within NEAR_MM of the other do not count.
    """
    nothing = shapely.Polygon()
    off = every = 0.0
    for colour in theirs.keys() | ours.keys():
        a, b = theirs.get(colour, nothing), ours.get(colour, nothing)
        off += a.difference(b.buffer(NEAR_MM)).area + b.difference(a.buffer(NEAR_MM)).area
        every += a.union(b).area
    return off / every if every else 0.0
