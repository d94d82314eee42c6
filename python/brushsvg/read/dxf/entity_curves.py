"""Convert a DXF entity to cubics, in its own world and in drawing units.

The cubics are exact where this is possible, otherwise they keep a tolerance.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from ...geometry.cubics import arc_count
from .ezdxf_import import ezdxf
from .splines import b_spline_to_cubics, fit_points_to_cubics, make_continuous

FILLED_TYPES = frozenset(("HATCH", "MPOLYGON", "SOLID", "TRACE"))
_PLANE = ezdxf.math.OCS()


@dataclass(frozen=True)
class Curve:
    """One line of an entity.

    cubics: (n, 4, 3), end to end.
    closed: whether the line ends where it begins.
    widths: (n, 2), at the start and end of each cubic; None if the entity has no widths. A width of 0 is drawn with
    the line weight of the entity.
    pattern_restarts: (n,), whether the pattern of a line type restarts at each cubic; None if it continues along the
    whole line.
    """

    cubics: np.ndarray
    closed: bool = False
    widths: np.ndarray | None = None
    pattern_restarts: np.ndarray | None = None


def entity_to_curves(entity, tolerance: float) -> list[Curve] | None:
    """Return the lines of an entity, or the outlines of a filled entity.

    The result is [] if the entity has no geometry, and None if entities of its type are not read.

    tolerance: in drawing units. Raises the errors of ezdxf if the entity is damaged.
    """
    draw = _CONVERTERS_BY_TYPE.get(entity.dxftype())
    return None if draw is None else draw(entity, tolerance)


def lines_to_cubics(points) -> np.ndarray:
    """Return the straight lines through points (n, d) as cubics (n - 1, 4, d)."""
    points = np.asarray(points, dtype=float)
    a, b = points[:-1, None], points[1:, None]
    return a + (b - a) * (np.arange(4) / 3)[:, None]


# Straight and round ---------------------------------------------------------------------------------


def _line(entity, _tolerance: float) -> list[Curve]:
    return [Curve(lines_to_cubics([entity.dxf.start.xyz, entity.dxf.end.xyz]))]


def _point(entity, _tolerance: float) -> list[Curve]:
    return [Curve(lines_to_cubics([entity.dxf.location.xyz] * 2))]


def _arc(entity, tolerance: float) -> list[Curve]:
    dxf = entity.dxf
    if dxf.radius == 0:
        return []
    angles = (dxf.start_angle, dxf.end_angle) if entity.dxftype() == "ARC" else (0.0, 360.0)
    tool = ezdxf.math.ConstructionEllipse.from_arc(dxf.center, abs(dxf.radius), dxf.extrusion, *angles)
    return _ellipse_to_curves(tool, tolerance)


def _ellipse(entity, tolerance: float) -> list[Curve]:
    return _ellipse_to_curves(entity.construction_tool(), tolerance)


def _ellipse_to_curves(tool, tolerance: float) -> list[Curve]:
    if tool.major_axis.magnitude == 0:
        return []
    count = arc_count(tool.param_span, tool.major_axis.magnitude, tolerance)
    beziers = list(ezdxf.math.cubic_bezier_from_ellipse(tool, count))
    if not beziers:
        return []
    cubics = np.array([[point.xyz for point in bezier.control_points] for bezier in beziers])
    return [Curve(cubics, math.isclose(tool.param_span, math.tau, rel_tol=1e-9))]


# Polylines ------------------------------------------------------------------------------------------


def _lwpolyline(entity, tolerance: float) -> list[Curve]:
    rows = np.array(entity.get_points("xybse"), dtype=float).reshape(-1, 5)
    if entity.dxf.hasattr("const_width") and not rows[:, 3:].any():  # widths of the vertices take precedence
        rows[:, 3:] = entity.dxf.const_width
    runs_on = bool(entity.dxf.flags & _PLINEGEN)
    return _polyline_2d(rows, entity.closed, entity.ocs(), entity.dxf.elevation, tolerance, runs_on)


def _polyline(entity, tolerance: float) -> list[Curve] | None:
    if entity.is_polygon_mesh or entity.is_poly_face_mesh:
        return None
    vertices = entity.vertices
    if entity.dxf.flags & entity.SPLINE_FIT_VERTICES_ADDED:
        vertices = [vertex for vertex in vertices if not vertex.dxf.flags & vertex.SPLINE_FRAME_CONTROL_POINT]
    if entity.is_3d_polyline:
        points = [vertex.dxf.location.xyz for vertex in vertices]
        if entity.is_closed and len(points) > 1:
            points.append(points[0])
        return [Curve(lines_to_cubics(points if len(points) > 1 else points * 2), entity.is_closed)] if points else []
    widths = entity.dxf.get("default_start_width", 0.0), entity.dxf.get("default_end_width", 0.0)
    rows = [
        (
            vertex.dxf.location.x,
            vertex.dxf.location.y,
            vertex.dxf.get("bulge", 0.0),
            vertex.dxf.get("start_width", widths[0]),
            vertex.dxf.get("end_width", widths[1]),
        )
        for vertex in vertices
    ]
    if not rows:
        return []
    elevation = entity.dxf.elevation.z if entity.dxf.hasattr("elevation") else vertices[0].dxf.location.z
    runs_on = bool(entity.dxf.flags & _PLINEGEN)
    return _polyline_2d(np.array(rows), entity.is_closed, entity.ocs(), elevation, tolerance, runs_on)


_PLINEGEN = 128  # polyline flag: dashes continue over the vertices


def _polyline_2d(
    rows: np.ndarray, closed: bool, ocs, elevation: float, tolerance: float, runs_on: bool = True
) -> list[Curve]:
    """Return the curve of a plane polyline.

    rows: (n, 5), x, y, bulge, start and end width of each vertex. The bulge and widths of the last vertex count only
    if the polyline is closed.
    """
    if not len(rows):
        return []
    if len(rows) == 1:
        rows, closed = np.repeat(rows, 2, axis=0), False
    p = rows[:, 0] + 1j * rows[:, 1]
    q = np.roll(p, -1)
    count = len(rows) if closed else len(rows) - 1
    pieces = list((p[:count, None] + (q - p)[:count, None] * np.arange(4) / 3)[:, None])
    # A bulge counts as an arc if the arc leaves its chord by more than 1e-3 tolerances.
    for k in np.flatnonzero(~(np.abs(rows[:count, 2] * (q - p)[:count]) / 2 <= 1e-3 * tolerance)):
        pieces[k] = _bulge_to_cubics(p[k], q[k], rows[k, 2], tolerance)
    flat = np.concatenate(pieces)
    cubics = _to_world(np.stack((flat.real, flat.imag, np.full(flat.shape, float(elevation))), axis=-1), ocs)
    pattern_restarts = None if runs_on else np.concatenate([np.arange(len(piece)) == 0 for piece in pieces])
    if not rows[:count, 3:].any():
        return [Curve(make_continuous(cubics), closed, pattern_restarts=pattern_restarts)]
    piece_widths = []
    for piece, ends in zip(pieces, rows[:count, 3:], strict=True):
        steps = np.linspace(*ends, len(piece) + 1)
        piece_widths.append(np.column_stack((steps[:-1], steps[1:])))
    return [Curve(make_continuous(cubics), closed, np.concatenate(piece_widths), pattern_restarts)]


def _bulge_to_cubics(p: complex, q: complex, bulge: float, tolerance: float) -> np.ndarray:
    """Return the arc from p to q as cubics (n, 4), complex; bulge: tangent of a quarter angle, > 0 to the left."""
    turn = 4 * math.atan(bulge)
    chord = 2 * math.sin(turn / 2)
    count = arc_count(abs(turn), abs((q - p) / chord), tolerance)
    s = np.linspace(0.0, 1.0, count + 1)
    at = p + (q - p) * np.exp(0.5j * turn * (s - 1)) * np.sin(turn * s / 2) / math.sin(turn / 2)
    at[-1] = q
    handle = 4 / 3 * math.tan(turn / count / 4) * (q - p) / chord * np.exp(1j * turn * (s - 0.5))
    return np.column_stack((at[:-1], at[:-1] + handle[:-1], at[1:] - handle[1:], at[1:]))


def _to_world(points: np.ndarray, ocs) -> np.ndarray:
    return points @ np.array([ocs.ux.xyz, ocs.uy.xyz, ocs.uz.xyz]) if ocs.transform else points


# Splines --------------------------------------------------------------------------------------------


def _spline(entity, tolerance: float) -> list[Curve]:
    dxf = entity.dxf
    if len(entity.control_points):
        lines = b_spline_to_cubics(dxf.degree, entity.knots, entity.control_points, entity.weights, tolerance)
    else:
        tangents = dxf.get("start_tangent"), dxf.get("end_tangent")
        lines = fit_points_to_cubics(entity.fit_points, tangents, tolerance)
    return [Curve(cubics) for cubics in lines]


# Faces and fillings ---------------------------------------------------------------------------------


def _quadrilateral(entity, _tolerance: float) -> list[Curve]:
    points = [point.xyz for point in entity.wcs_vertices()]
    return [Curve(lines_to_cubics([*points, points[0]]), True)]


def _face(entity, tolerance: float) -> list[Curve]:
    points = [point.xyz for point in entity.wcs_vertices()]
    visible = entity.get_edges_visibility()[: len(points)]
    if all(visible):
        return _quadrilateral(entity, tolerance)
    edges = zip(points, [*points[1:], points[0]], visible, strict=True)
    return [Curve(lines_to_cubics([begin, end])) for begin, end, seen in edges if seen]


def _hatch(entity, tolerance: float) -> list[Curve]:
    ocs, elevation = entity.ocs(), entity.dxf.elevation.z
    offset = entity.dxf.get("offset_vector", (0, 0)) if entity.dxftype() == "MPOLYGON" else (0, 0)
    paths = list(entity.paths.rendering_paths(entity.dxf.hatch_style)) or list(entity.paths)
    outlines = []
    for path in paths:
        if isinstance(path, ezdxf.entities.PolylinePath):
            rows = [(x, y, bulge, 0.0, 0.0) for x, y, bulge in path.vertices]
            pieces = [line.cubics for line in _polyline_2d(np.array(rows), True, _PLANE, 0.0, tolerance)]
        else:
            pieces = [line.cubics for edge in path.edges for line in _edge_to_curves(edge, tolerance)]
        if pieces:
            shift = np.array([offset[0], offset[1], elevation])
            outlines.append(Curve(_to_world(_join_edges(pieces) + shift, ocs), True))
    return outlines


def _edge_to_curves(edge, tolerance: float) -> list[Curve]:
    """Return the lines of an edge of a hatch, in the plane of the hatch."""
    match edge.EDGE_TYPE:
        case "LineEdge":
            return [Curve(lines_to_cubics([(*edge.start, 0.0), (*edge.end, 0.0)]))]
        case "ArcEdge":
            angles = edge.start_angle, edge.end_angle
            tool = ezdxf.math.ConstructionEllipse.from_arc(edge.center, abs(edge.radius), (0, 0, 1), *angles)
            return _ellipse_to_curves(tool, tolerance)
        case "EllipseEdge":
            return _ellipse_to_curves(edge.construction_tool(), tolerance)
    points = [(*point, 0.0) for point in edge.control_points]
    if not points:
        fit_points = [(*point, 0.0) for point in edge.fit_points]
        lines = fit_points_to_cubics(fit_points, (edge.start_tangent, edge.end_tangent), tolerance)
    else:
        lines = b_spline_to_cubics(edge.degree, edge.knot_values, points, edge.weights, tolerance)
    return [Curve(cubics) for cubics in lines]


def _join_edges(pieces: list[np.ndarray]) -> np.ndarray:
    """Join edges to one closed line. Each edge may be drawn in either direction."""
    first = pieces[0]
    if len(pieces) > 1 and _distance_to_ends(first[0, 0], pieces[1]) < _distance_to_ends(first[-1, 3], pieces[1]):
        first = reverse_cubics(first)
    line = [first]
    for piece in pieces[1:]:
        end = line[-1][-1, 3]
        if math.dist(end, piece[-1, 3]) < math.dist(end, piece[0, 0]):
            piece = reverse_cubics(piece)
        line += [lines_to_cubics([end, piece[0, 0]]), piece]
    # This line may have no length. Later all cubics without length are removed.
    line.append(lines_to_cubics([line[-1][-1, 3], first[0, 0]]))
    return np.concatenate(line)


def _distance_to_ends(point: np.ndarray, piece: np.ndarray) -> float:
    return min(math.dist(point, piece[0, 0]), math.dist(point, piece[-1, 3]))


def reverse_cubics(cubics: np.ndarray) -> np.ndarray:
    return cubics[::-1, ::-1].copy()


_CONVERTERS_BY_TYPE: dict[str, Callable[[object, float], list[Curve] | None]] = {
    "LINE": _line,
    "POINT": _point,
    "ARC": _arc,
    "CIRCLE": _arc,
    "ELLIPSE": _ellipse,
    "LWPOLYLINE": _lwpolyline,
    "POLYLINE": _polyline,
    "SPLINE": _spline,
    "HELIX": _spline,
    "SOLID": _quadrilateral,
    "TRACE": _quadrilateral,
    "3DFACE": _face,
    "HATCH": _hatch,
    "MPOLYGON": _hatch,
}
