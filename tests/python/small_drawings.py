"""Random small drawings of the kinds that are hardest to paint.

They are corners, short strokes, crossing strokes and curves.
"""

import numpy as np

from brushsvg import Stroke, _core
from brushsvg.show.evaluation import figures

SHEET_MM = (120.0, 120.0)


def line(points_mm) -> np.ndarray:
    a, b = np.array(points_mm[:-1], float), np.array(points_mm[1:], float)
    return np.hstack([a, a + (b - a) / 3, b - (b - a) / 3, b])


def small_drawing(random, number: int) -> list:
    at, heading = random.uniform(35, 85, 2), random.uniform(-np.pi, np.pi)

    def way(angle: float, low: float, high: float):
        return random.uniform(low, high) * np.array([np.cos(angle), np.sin(angle)])

    def stroke(part: int, middle, ends: int = 1):
        half_width = [(k / max(1, ends - 1), random.uniform(0.6, 3.0)) for k in range(ends)]
        return Stroke(f"s{number}/{part}", middle, half_width=half_width)

    def corner():
        turn = at + way(heading, 5, 30)
        return [stroke(1, line([at, turn, turn + way(heading + random.uniform(-2.6, 2.6), 5, 30)]))]

    def short():
        return [stroke(1, line([at, at + way(heading, 0.1, 6)]))]

    def crossing():
        ways = [way(angle, 4, 20) for angle in (heading, heading + random.uniform(0.5, 2.6))]
        return [stroke(k, line([at - each, at + each])) for k, each in enumerate(ways, start=1)]

    def curve():
        points = np.vstack([at, *(at + random.uniform(-20, 20, 2) for _ in range(3))])
        return [stroke(1, points.reshape(1, 8), ends=2)]

    return (corner, short, crossing, curve)[number % 4]()


def overlaps(strokes, brush, method: str) -> np.ndarray:
    """Return the overlap that the report gives for each stroke painted alone."""
    plan = _core.compensate(strokes, brush, SHEET_MM, method).plan
    rows, _ = figures.measure_figures(figures.PaintedPlan(plan, _core.simulate(plan, brush), brush, strokes))
    return np.array([row.overlap for row in rows])


def gains(count: int, seed: int, brush) -> np.ndarray:
    """Return how much overlap each stroke gains from `refined` over `closed`."""
    random = np.random.default_rng(seed)
    drawings = [small_drawing(random, k) for k in range(count)]
    return np.concatenate([overlaps(each, brush, "refined") - overlaps(each, brush, "closed") for each in drawings])
