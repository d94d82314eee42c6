"""Figure 18: four times the same letters, and a histogram of distances from the reference

We do not have the article's photographs. Of its distances it prints only the greatest, 5 mm, and says that
their counts fall almost exponentially. Our own illustration paints "abcdo" with `liner-1` four times. Each
stroke finds the brush bent by the one before, so its lag is drawn at random for each stroke. The standard
deviation of 10 % is chosen, not measured. (a) The paths of the centre of friction over the reference. (b)
Their distances from it, counted on a logarithmic scale. For photographs, `brushsvg compare` reports how far
painted strokes are off, and how well they repeat.
"""

import numpy as np
from matplotlib.figure import Figure

import brushsvg

drawn = {
    "a": "M32 30C26 40 8 36 8 24S26 8 32 20V34C31 20 33 12 40 14",
    "b": "M52 58C51 40 51 26 52 16C62 8 78 14 76 26S56 38 52 28",
    "c": "M112 32C102 42 88 34 90 22S104 10 114 18",
    "d": "M150 26C144 40 126 36 126 24S144 8 150 20M151 58C150 40 150 24 156 14",
    "o": "M182 36C164 36 164 12 182 12S200 36 182 36",
}
brush, rng = brushsvg.find_brush("liner-1"), np.random.default_rng(18)
parts = {f"{k}{i}": "M" + p for k, d in drawn.items() for i, p in enumerate(d[1:].split("M"))}
strokes = [brushsvg.stroke_from_path(path, 1.4, name) for name, path in parts.items()]
plan = brushsvg.compensate(strokes, brush, sheet_mm=(215, 70)).plan
reference = brushsvg.simulate(plan, brush).passes
figure = Figure(figsize=(8, 6), layout="constrained")
above, below = figure.subplots(2, 1, height_ratios=(1.2, 1))
distances: list[np.ndarray] = []
for colour in ("#3f8fd9", "#e07a2f", "#2f8f4e", "#8a4fbf"):
    for way, expected in zip(plan.passes, reference, strict=True):
        bent = brushsvg.brush_like("bent", brush)
        bent.lag = brushsvg.laws.Profile(np.multiply(brush.lag.coefficients, rng.normal(1, 0.1)).tolist())
        alone = brushsvg.Plan(plan.brush, "", plan.sheet_mm, [way])
        painted = brushsvg.simulate(alone, bent).passes[0].contact_mm
        above.plot(*painted.T, color=colour, lw=0.8)
        distances.append(np.hypot(*(painted[:, None] - expected.contact_mm).T).min(axis=0))
for expected in reference:
    above.plot(*expected.contact_mm[::12].T, "k+", ms=3, mew=0.5)
above.set(aspect="equal", title="(a)", xlabel="mm", ylabel="mm")
off = np.concatenate(distances)
below.hist(off, bins=np.arange(0, off.max() + 0.1, 0.1), color="#2b3a67", log=True)
below.set(title="(b)", xlabel="distance, mm", ylabel="points")
rows = [("greatest distance, mm", 5.0, off.max()), ("median, mm", None, np.median(off))]
