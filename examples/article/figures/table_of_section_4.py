"""Table: section 4, one after the other and all in one fit

The article recommends footprints, then angular strokes, then a video or straight strokes. Each is read with
the results of the one before. These are simulated measurements of its brush with its scatter, the median of
20 sets. k +- says how well each way alone, and one fit to all of it, gives b = k z. The printed +- takes r
and w as exact, and ours includes their uncertainty. On the right is the error of r, root mean square over
depths 1 to 10.
"""

import numpy as np
from matplotlib.figure import Figure

import brushsvg

brush, z, rng = brushsvg.find_brush("round-6"), np.arange(1, 11.0), np.random.default_rng(4)
w, r, b = brushsvg.laws.Profile([-2.35, 2.75, -0.42, 0.024], floor=0)(z), brush.lag(z), brush.tip_gap(z)
exact = {  # what is read, and its scatter, in mm; w by (24)
    "width": (2 * brush.half_width(z), 0.0),
    "tip_to_widest": (w, 0.51),
    "lag": (r, 0.58),
    "tip_gap": (b, 1.21),
    "angular": (r + b - w, 0.58),
    "side_view": (r + b - brush.lag(0.0), 0.85),
    "straight": (r + b - w, 0.95),
}


def read(y: np.ndarray, sigma: float) -> list[dict[str, float]]:
    return [{"depth_mm": d, "value_mm": v} for d, v in zip(z, y + rng.normal(0, sigma, 10), strict=True)]


sets = [{kind: read(*one) for kind, one in exact.items()} for _ in range(20)]
for x in (x for one in sets for x in one["straight"]):
    x |= {"path_mm": 60, "distance_mm": 60 - x.pop("value_mm")}
ways: dict[str, tuple[float | None, str]] = {
    "values of b": (0.14, "lag tip_gap"),
    "video": (0.09, "lag side_view"),
}
ways["straight strokes"], ways["one fit"] = (0.11, "lag tip_to_widest straight"), (None, " ".join(exact))
rows: list[tuple[str, float | None, float]] = []
for name, (printed, kinds) in ways.items():
    brushes = [brushsvg.calibrate({k: one[k] for k in {"width", *kinds.split()}}).brush for one in sets]
    k = np.median([made.tip_gap.half_interval_95[1] for made in brushes])
    off = np.sqrt(np.mean([(made.lag(z) - r) ** 2 for made in brushes]))
    rows += [(f"k +-, {name}", printed, k), (f"r off, mm, {name}", None, off)]
figure = Figure(figsize=(8, 2.6), layout="constrained")
for k, axes in enumerate(figure.subplots(1, 2, sharey=True)):
    axes.barh([*ways], [row[2] for row in rows[k::2]], color=["#9db8dd"] * 3 + ["#2b3a67"])
    axes.set(title=("k of b: +-", "r: off, mm")[k])
