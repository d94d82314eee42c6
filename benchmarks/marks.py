"""Time the predicted mark of a 200 mm stroke, and measure the error of its edge.

The footprint is 14 x 10 mm, at 20 px/mm on 4000 x 4000 pixels. Our coverage is compared with the article's loop,
which rotates and places a footprint's picture for every dab. The floor is the time to fill the touched area.

The edge error is the mean distance between the outline of a dense shapely union and the edge in the coverage, along
the normals of the outline.
"""

from __future__ import annotations

import argparse
import math
import time

import cv2
import numpy as np
import shapely

from brushsvg import _core

PX_PER_MM = 20
CANVAS_MM = 200
DABS = 2000


def teardrop(length: float, width: float) -> np.ndarray:
    """Return a footprint with straight flanks from the tip and half an ellipse in front.

    It runs counter-clockwise from the tip.
    """
    widest, h = 0.62 * length, width / 2
    angle = np.linspace(-math.pi / 2, math.pi / 2, 64)
    front = np.column_stack([widest + (length - widest) * np.cos(angle), h * np.sin(angle)])
    return np.vstack([[0.0, 0.0], front])


def brush_14_by_10():
    brush = _core.Brush()
    brush.name = "14x10"
    brush.depth_range_mm = (0.0, 10.0)
    brush.lag = _core.Profile([3.1, 0.86, 0.31, -0.05, 0.0021])
    brush.tip_gap = _core.Profile([0.0, 0.6])
    brush.half_width = _core.Profile([0.0, 0.5])
    brush.tip_to_widest = _core.Profile([0.0, 0.868])
    brush.footprints = _core.FootprintTable([_core.Footprint(10.0, teardrop(14.0, 10.0))])
    _core.check(brush)
    return brush


def stroke_200_mm():
    """Return a wave of 200 mm in moves of 0.5 mm, pressed to 10 mm after a run-up."""
    x = np.linspace(0.0, 150.0, 4000)
    y = 100.0 + 26.0 * np.sin(x / 150.0 * 2.3 * math.pi)
    s = np.concatenate([[0.0], np.cumsum(np.hypot(np.diff(x), np.diff(y)))])
    at = np.arange(0.0, 200.0, 0.5)
    xs, ys = np.interp(at, s, x) + 22.0, np.interp(at, s, y)
    depth = np.minimum(10.0, 0.5 * at)
    return _core.Pass("wave", np.column_stack([xs, ys, -depth]))


def dab_loop(marks, outline: np.ndarray, px_per_mm: float, dabs: int) -> np.ndarray:
    """Paint as the article does: turn the footprint's picture and keep the darker pixels."""
    canvas = np.zeros((CANVAS_MM * PX_PER_MM,) * 2, np.uint8)
    sharp = 8
    w, h = 14 * PX_PER_MM + 8, 10 * PX_PER_MM + 8
    big = np.zeros((h * sharp, w * sharp), np.uint8)
    tip = np.array([4.0, h / 2])
    points = (outline * [1, -1] * px_per_mm + tip) * sharp
    cv2.fillPoly(big, [np.round(points).astype(np.int32)], 255)
    picture = cv2.resize(big, (w, h), interpolation=cv2.INTER_AREA)
    size = 2 * int(math.hypot(w, h)) // 2 + 4
    pose = np.linspace(marks.pose[0], marks.pose[-1], dabs)
    heading = np.unwrap(marks.heading_rad)
    at = [np.interp(pose, marks.pose, column) for column in (*marks.contact_mm.T, heading, marks.depth_mm)]
    for x, y, theta, depth in zip(*at, strict=True):
        scale = depth / 10.0
        if scale < 0.02:
            continue
        b = 0.6 * depth
        tx = (x - b * math.cos(theta)) * px_per_mm
        ty = (CANVAS_MM - (y - b * math.sin(theta))) * px_per_mm
        left, top = int(tx) - size, int(ty) - size
        c, s = scale * math.cos(theta), scale * math.sin(theta)
        matrix = np.array([[c, s, 0.0], [-s, c, 0.0]])
        # warpAffine has pixel centres at whole numbers, and the tip is at a point of the plane
        matrix[:, 2] = [tx - left - 0.5, ty - top - 0.5] - matrix[:, :2] @ (tip - 0.5)
        dab = cv2.warpAffine(picture, matrix, (2 * size, 2 * size), flags=cv2.INTER_LINEAR)
        x0, y0 = max(left, 0), max(top, 0)
        part = canvas[y0 : top + 2 * size, x0 : left + 2 * size]
        dab = dab[y0 - top : y0 - top + part.shape[0], x0 - left : x0 - left + part.shape[1]]
        np.maximum(part, dab, out=part)
    return canvas


def truth(brush, a_pass, outline: np.ndarray):
    """Return the union of footprints so dense that scallops are below 0.001 px."""
    marks = _core.simulate(_core.Plan("14x10", "", (200, 200), [a_pass]), brush, 2e-6).passes[0]
    depth, c, s = marks.depth_mm / 10.0, np.cos(marks.heading_rad), np.sin(marks.heading_rad)
    tips = marks.contact_mm - 0.6 * marks.depth_mm[:, None] * np.column_stack([c, s])
    local = outline[None] * depth[:, None, None]
    x = tips[:, None, 0] + c[:, None] * local[..., 0] - s[:, None] * local[..., 1]
    y = tips[:, None, 1] + s[:, None] * local[..., 0] + c[:, None] * local[..., 1]
    rings = np.stack([x, y], axis=-1)
    hulls = shapely.convex_hull(shapely.multipoints(np.concatenate([rings[:-1], rings[1:]], axis=1)))
    return shapely.union_all(hulls)


def edge_error_px(coverage: np.ndarray, shape, px_per_mm: float) -> float:
    """Return the mean distance [px] of the edge in the coverage from the true outline."""
    ring = shape.exterior
    at = np.arange(0.0, ring.length, 1.0 / px_per_mm)
    points = shapely.get_coordinates(shapely.line_interpolate_point(ring, at))
    step = 0.2 / px_per_mm
    along = shapely.get_coordinates(shapely.line_interpolate_point(ring, at + step)) - shapely.get_coordinates(
        shapely.line_interpolate_point(ring, at - step)
    )
    along /= np.linalg.norm(along, axis=1)[:, None]
    outward = np.column_stack([along[:, 1], -along[:, 0]]) * (1 if ring.is_ccw else -1)
    reach = np.arange(-4.0, 4.0, 0.05) + 0.025
    x = points[:, None, 0] * px_per_mm + outward[:, None, 0] * reach - 0.5
    y = (CANVAS_MM - points[:, None, 1]) * px_per_mm - outward[:, None, 1] * reach - 0.5
    inside = cv2.remap(coverage, x.astype(np.float32), y.astype(np.float32), cv2.INTER_LINEAR).sum(axis=1) * 0.05
    error = np.abs(inside - 4.0)
    # at the tip and at corners, the normal crosses another edge, so there is no valid distance
    return float(error[error < 1.5].mean())


def best_ms(work, rounds: int) -> float:
    times = []
    for _ in range(rounds):
        begin = time.perf_counter()
        work()
        times.append(time.perf_counter() - begin)
    return 1e3 * float(np.median(times))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rounds", type=int, default=9)
    rounds = parser.parse_args().rounds
    brush, a_pass = brush_14_by_10(), stroke_200_mm()
    outline = teardrop(14.0, 10.0)
    marks = _core.simulate(_core.Plan("14x10", "", (200, 200), [a_pass]), brush)
    rows = marks.passes[0]
    left, bottom, right, top = _core.painted_bounds(rows, brush)
    grid = lambda v, to: to(v * PX_PER_MM) / PX_PER_MM  # noqa: E731
    x0, y0 = grid(left, math.floor), grid(bottom, math.floor)
    window = (x0, y0, grid(right, math.ceil) - x0, grid(top, math.ceil) - y0)
    whole = (0.0, 0.0, CANVAS_MM, CANVAS_MM)

    shape = truth(brush, a_pass, outline)
    ours = _core.coverage(marks, brush, whole, PX_PER_MM)
    article = dab_loop(rows, outline, PX_PER_MM, DABS).astype(np.float32) / 255
    ms_ours = best_ms(lambda: _core.coverage(marks, brush, window, PX_PER_MM), rounds * 3)
    ms_whole = best_ms(lambda: _core.coverage(marks, brush, whole, PX_PER_MM), rounds)
    ms_article = best_ms(lambda: dab_loop(rows, outline, PX_PER_MM, DABS), max(1, rounds // 3))
    touched = np.empty((round(window[3] * PX_PER_MM), round(window[2] * PX_PER_MM)), np.float32)
    ms_floor = best_ms(lambda: touched.fill(0.5), rounds * 3)

    def line(name, ms, picture=None):
        text = f"  {name:<58} {ms:9.2f} ms"
        if picture is not None:
            painted = float(picture.sum(dtype=np.float64)) / PX_PER_MM**2
            edge_px, excess = edge_error_px(picture, shape, PX_PER_MM), 100 * (painted / shape.area - 1)
            text += f"   edge {edge_px:.3f} px   area {excess:+.3f} %"
        print(text)

    print(f"mark of 200 mm, footprint 14 x 10 mm, {PX_PER_MM} px/mm, {len(rows.pose)} rows, medians")
    line("union of spans, on the touched window", ms_ours, ours)
    line("the same on the whole canvas", ms_whole)
    line(f"peer: rotate and keep the darker, {DABS} dabs, as the article", ms_article, article)
    line("floor: filling the touched window", ms_floor)
    print(f"  peer / ours: {ms_article / ms_ours:.0f} (aim: at least 150); edge error aim: 0.05 px")


if __name__ == "__main__":
    main()
