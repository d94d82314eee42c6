"""The report compares refined plans of many small drawings with the closed form."""

import sys
from pathlib import Path

import pytest

from brushsvg import find_brush

sys.path.insert(0, str(Path(__file__).parents[1] / "python"))
from small_drawings import gains


@pytest.mark.parametrize("seed", [1, 2])
def test_refined_plans_are_never_worse_in_the_report(seed):
    won = gains(200, seed, find_brush("round-6"))
    print(f"{len(won)} strokes, {won.mean():.4f} won on average, nothing for {(won == 0).mean():.0%}")
    assert won.min() >= 0.0
    assert won.mean() > 0.02
