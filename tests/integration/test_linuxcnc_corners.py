"""LinuxCNC's own planner cuts corners as brushsvg predicts."""

from dataclasses import replace

import numpy as np
from controller import ran

from brushsvg import _core
from brushsvg.machine import writer
from brushsvg.machine.cells.cell_file import find_cell
from brushsvg.machine.realised.corner_blending import blend_radii, cut_corners
from brushsvg.model.library import find_brush

TURNS_DEG = (10, -45, 90, -120, 5, 60, -90, 150, -30, 20, 20, 20)
TOLERANCE_MM = 0.04
SMOOTH_DEG = 15.0  # smaller turns are cut by a slower change of speed, and by less than allowed
NEAR_MM = 5e-4


def way_with_corners():
    """Return (n, 3) short lines with corners of all kinds and slightly changing depth.

    The landing and the lift in place are corners as well.
    """
    directions = np.radians(np.cumsum([0, *TURNS_DEG]))
    sinks = 0.08 * np.cos(np.arange(len(directions)))
    steps = 4.0 * np.column_stack([np.cos(directions), np.sin(directions), sinks])
    poses = np.array([30.0, 30.0, -2.0]) + np.cumsum(np.vstack([np.zeros(3), steps]), axis=0)
    return np.vstack([poses[0] * (1, 1, 0), poses, poses[-1] * (1, 1, 0)])


def turn_and_circle(before, here, after, reach_mm):
    """Return the turn of a corner [degrees], and (n, 3) the circle that rounds it.

    The circle touches both lines at the given distance from the corner.
    """
    along, out = here - before, after - here
    along, out = along / np.linalg.norm(along), out / np.linalg.norm(out)
    across = out - (along @ out) * along
    across /= np.linalg.norm(across)
    turn = np.arccos(np.clip(along @ out, -1, 1))
    radius = reach_mm / np.tan(turn / 2)
    angle = np.linspace(0, turn, 200)[:, None]
    circle = here - along * reach_mm + radius * (np.sin(angle) * along + (1 - np.cos(angle)) * across)
    return np.degrees(turn), circle


def distances(points, path):
    """Return the distances (n,) from points (n, 3) to a path (m, 3)."""
    starts, ways = path[:-1], np.diff(path, axis=0)
    along = np.einsum("nmk,mk->nm", points[:, None] - starts, ways) / (ways**2).sum(axis=1)
    nearest = starts + np.clip(along, 0, 1)[..., None] * ways
    return np.linalg.norm(points[:, None] - nearest, axis=2).min(axis=1)


def test_linuxcnc_cuts_corners_as_predicted(tmp_path):
    cell = find_cell("linuxcnc-3axis")
    cell = replace(cell, blending=replace(cell.blending, tolerance_mm=TOLERANCE_MM))
    way = way_with_corners()
    plan = _core.Plan("round-6", "", (100.0, 100.0), [_core.Pass("corners", way, 20.0)])
    text = "".join(writer.encode(".ngc", plan, find_brush("round-6"), "corners", (), cell))
    assert f"G64 P{TOLERANCE_MM:.4f}" in text
    went = ran(text, tmp_path, cell.speeds.travel_mm_s, cell.speeds.acceleration_mm_s2)
    painted = went[went[:, 2] < -0.5]
    reach_mm = blend_radii(way, cell.blending)
    ours, _, _ = cut_corners(way, reach_mm)
    tried = 0
    for k in range(1, len(way) - 1):
        around = painted[np.linalg.norm(painted - way[k], axis=1) < 1.9]
        assert len(around) > 50
        assert distances(way[k : k + 1], around) < TOLERANCE_MM + NEAR_MM
        turn_deg, circle = turn_and_circle(*way[k - 1 : k + 2], reach_mm[k])
        cut = np.vstack([way[k - 1], circle, way[k + 1]])
        if turn_deg > SMOOTH_DEG:
            assert distances(around, cut).max() < NEAR_MM
            # three points of that circle are simulated; their chords deviate from it by a quarter of the cut
            assert distances(around, ours).max() < TOLERANCE_MM / 4
            assert distances(around, way).max() > 2 * TOLERANCE_MM * np.sin(np.radians(180 - turn_deg) / 2) / 3
            tried += 1
        else:
            assert distances(around, way).max() < TOLERANCE_MM
    assert tried > 10
