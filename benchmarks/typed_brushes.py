"""Measure how well a word is painted with a brush file from a few typed numbers.

    typed_brushes.py [--brushes 12] [--seed 1]

Random brushes are hidden from the planner. Each is measured with a ruler: lag and width at some depths, to the nearest
0.5 mm. `brush new` makes a file from the numbers, a word is planned with it, and the slow stepping simulator of
tests/laws paints the plan with the hidden brush. The program prints the overlap of
paint and drawing (intersection over union).
"""

from __future__ import annotations

import argparse
import re
import sys
import tempfile
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1] / "tests" / "laws"))
import painter
import studio

import brushsvg
from brushsvg._core import MarkLaws
from brushsvg.calibration.marks.from_marks import brush_of
from brushsvg.calibration.numbers.from_widths import lag_of_turn, new_brush
from brushsvg.show.evaluation.figures import target_rings

READ_TO_MM = 0.5
SHARES = (0.25, 0.6, 1.0)  # shares of the greatest depth
WIDEST_OF_WORD_MM = 5.5


def measured(hidden, share: float) -> tuple[float, float, float]:
    """Return depth, lag and width as read with a ruler."""
    depth = share * hidden.deepest
    lag, half = (hidden.law(name)(depth) for name in ("lag", "half_width"))
    return depth, *(max(round(true / READ_TO_MM), 1) * READ_TO_MM for true in (lag, 2 * half))


def turn_of(hidden, depth: float) -> float:
    """Return the distance of the mark's turn from the tool's second line.

    It is the lag less the distance by which the widest section is ahead.
    """
    lag, gap, half = (hidden.law(name)(depth) for name in ("lag", "tip_gap", "half_width"))
    return max(round((lag + gap - hidden.widest_per_half * half) / READ_TO_MM), 0) * READ_TO_MM


def files_of(hidden) -> dict[str, object]:
    """Return typed brushes by the number of measured values."""
    rows = [measured(hidden, share) for share in SHARES]
    lags, widths = [row[:2] for row in rows], [(row[0], row[2]) for row in rows]
    turns = [(depth, lag_of_turn(turn_of(hidden, depth), width)) for depth, width in widths]
    true = [hidden.lag.tolist(), hidden.tip_gap.tolist(), hidden.half_width.tolist()]
    laws = MarkLaws(*true, hidden.widest_per_half, hidden.front_per_half)
    return {
        "one lag, one width": new_brush("one", lags[1][1], widths[1:2], hidden.deepest),
        "one lag, two widths": new_brush("two", lags[1][1], widths[1:], hidden.deepest),
        "three depths": new_brush("three", lags, sorted(widths), hidden.deepest),
        "three depths by a turn": new_brush("turn", turns, sorted(widths), hidden.deepest),
        "the brush itself": brush_of(laws, "itself", (0.0, hidden.deepest)),
    }


def main() -> None:
    words = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    words.add_argument("--brushes", type=int, default=12)
    words.add_argument("--seed", type=int, default=1)
    given = words.parse_args()
    found: dict[str, list[float]] = {}
    for number in range(given.brushes):
        rng = np.random.default_rng((given.seed, number))
        hidden = painter.random_brush(rng)
        size = 0.75 * 2 * hidden.law("half_width")(hidden.deepest) / WIDEST_OF_WORD_MM
        with tempfile.TemporaryDirectory() as folder:
            word = Path(folder, "word.svg")
            word.write_text(with_widths(studio.WORD, size))
            drawing = brushsvg.read_drawing(word)
        for name, brush in files_of(hidden).items():
            try:
                strokes, _ = brushsvg.strokes(drawing)
                plan = brushsvg.compensate(strokes, brush, (150, 90)).plan
            except brushsvg.Error as refusal:
                print(number, name, "refused:", refusal)
                continue
            ways = [(one.stroke, painter.dense(np.array(one.poses_mm), one.arcs)) for one in plan.passes]
            regions = painter.swept(hidden, ways, 0.0)
            painted = {str(k): region for k, region in enumerate(regions) if region is not None}
            overlap = studio.overlap(painted, {"": studio.as_region(target_rings(strokes))})
            found.setdefault(name, []).append(overlap)
        print(number, {name: round(values[-1], 3) for name, values in found.items()}, flush=True)
    for name, values in found.items():
        print(f"{name}: median {np.median(values):.2f}, from {min(values):.2f} to {max(values):.2f}")


def with_widths(svg: str, size: float) -> str:
    """Return the word with strokes this many times as wide."""
    return re.sub(r'stroke-width="([\d.]+)"', lambda found: f'stroke-width="{size * float(found[1]):.3f}"', svg)


if __name__ == "__main__":
    main()
