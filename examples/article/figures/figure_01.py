"""Figure 1: a bristle as a beam, clamped at its root and sliding on the paper (Lemma 1)

Our own illustration: the article gives the boundary conditions only. Left: its example (2), with the fourth
condition as printed, and with a tip free of shear. Right: bristles that become softer towards the tip, EI =
exp(k (1 - z)), under the same load. Lemma 1 holds for every EI > 0 if the tip is free of shear. With
w'''(1) = 0, as printed, it fails for some bristles that become stiffer towards the tip. (3) as printed does
not solve (2): it leaves a straight line where exp(1 - z) should be.
"""

import numpy as np
from matplotlib.figure import Figure

from brushsvg import laws

z = np.linspace(0, 1, 101)
figure = Figure(figsize=(8, 3.2), layout="constrained")
left, right = figure.subplots(1, 2, sharey=True)


def of_article(z: np.ndarray) -> np.ndarray:
    return np.exp(1 - z)


ends = {"third_derivative": "w'''(1) = 0, as printed", "shear_free": "(EI w'')'(1) = 0, free of shear"}
for end, words in ends.items():
    left.plot(laws.bristle(of_article, of_article, end)(z), z, label=words)
for k in range(4):

    def softer(z: np.ndarray, k: float = k) -> np.ndarray:
        return np.exp(k * (1 - z))

    right.plot(laws.bristle(softer, of_article)(z), z, label=f"k = {k}")
for axes, title in ((left, "EI = q = exp(1 - z)"), (right, "EI = exp(k (1 - z)), q = exp(1 - z)")):
    axes.set(title=title, xlabel="w, in lengths of the bristle")
    axes.legend(frameon=False, fontsize=8)
left.set_ylabel("z: root 0, tip 1")
left.invert_yaxis()  # of both
line = np.polynomial.Polynomial.fit(z, of_article(z), 1)
rows = [
    ("w(1), w'''(1) = 0", None, laws.bristle_of_article(1.0)),
    ("w(1), free of shear", None, laws.bristle_of_article(1.0, "shear_free")),
    ("what (3) leaves in (2) at least, greatest on [0, 1]", 0.0, np.abs(of_article(z) - line(z)).max()),
]
