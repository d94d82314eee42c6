"""Backlash: axes stay behind where they turn back.

The test checks the path on paper, which needs few more poses than it has bends.
"""

import numpy as np
import pytest
from shapely.geometry import LineString

core = pytest.importorskip("brushsvg._core")

from brushsvg.machine.cells.cell import Machine  # noqa: E402
from brushsvg.machine.realised.passes import as_run, passes_with_backlash  # noqa: E402


def ways_in_small_steps(passes, backlash):
    """Return the paths by the rule alone.

    The slide moves once the backlash is crossed.
    """
    half, slide, last, out = 0.5 * np.array(backlash), None, None, []
    for poses in passes:
        rows = []
        for a, b in zip(np.vstack([poses[:1], poses])[:-1], poses, strict=True):
            for share in np.linspace(0, 1, max(2, int(np.hypot(*(b - a)[:2]) / 0.01)))[1:]:
                place = a + share * (b - a)
                if slide is None:
                    slide = place[:2].copy()
                slide = np.clip(slide, place[:2] - half, place[:2] + half)
                rows.append([*slide, place[2]])
        last = rows
        out.append(np.array(last))
    return out


def test_the_backlash_path_agrees_with_a_simulation_in_small_steps():
    rng = np.random.default_rng(3)
    passes = [np.column_stack([rng.uniform(0, 60, (6, 2)), [0.0, -2.0, -4.0, -3.0, -1.0, 0.0]]) for _ in range(3)]
    reported = [core.Pass(stroke=f"s{k}", poses_mm=poses, speed_mm_s=20.0) for k, poses in enumerate(passes)]
    run = passes_with_backlash(reported, (0.8, 0.5))
    for one, target in zip(run, ways_in_small_steps(passes, (0.8, 0.5)), strict=True):
        poses = np.array(one.poses_mm)
        assert LineString(poses[:, :2]).hausdorff_distance(LineString(target[:, :2])) < 0.2
        assert np.allclose(poses[-1], target[-1], atol=1e-9)
        depth = np.interp(
            LineString(target[:, :2]).length / 2,
            np.concatenate([[0], np.cumsum(np.hypot(*np.diff(target[:, :2], axis=0).T))]),
            target[:, 2],
        )
        come = np.concatenate([[0], np.cumsum(np.hypot(*np.diff(poses[:, :2], axis=0).T))])
        assert np.interp(come[-1] / 2, come, poses[:, 2]) == pytest.approx(depth, abs=0.1)
        assert len(poses) < 6 * 8  # with a pose every 0.4 mm there would be several hundred


@pytest.mark.parametrize("height", [-0.4, 0.4])
def test_a_tool_starts_to_lean_where_it_touches_the_paper(height):
    """A tool begins to lean where it touches the paper.

    The brush is pressed on the spot and drawn to the right. The paper is lower or higher than taught.
    """
    reported = core.Pass(
        stroke="s",
        poses_mm=np.array([[10.0, 20, 0], [10, 20, -2], [30, 20, -2], [30, 20, 0]]),
        speed_mm_s=20.0,
    )
    (one,) = as_run([reported], Machine(lean_mm_per_mm=(0.2, -0.1), height_mm=height))
    run, deep = np.array(one.poses_mm), 2 + height
    target = [
        [10, 20, 0],
        [10 + 0.2 * deep, 20 - 0.1 * deep, -deep],
        [30 + 0.2 * deep, 20 - 0.1 * deep, -deep],
        [30, 20, 0],
    ]
    for place in target:
        assert np.abs(run - place).max(axis=1).min() < 1e-9, place
    assert np.allclose(run[[0, -1]], [target[0], target[-1]])
