"""The judge's own frames, (4, 4), from poses of cells and of URScript."""

from __future__ import annotations

import math

import numpy as np
from scipy.interpolate import RegularGridInterpolator
from scipy.optimize import least_squares


def turned_deg(x_deg: float, y_deg: float, z_deg: float) -> np.ndarray:
    """Return the rotation (3, 3) about the fixed x, then y, then z axis."""
    (a, b, c), (s, t, u) = zip(
        *((math.cos(math.radians(v)), math.sin(math.radians(v))) for v in (x_deg, y_deg, z_deg)), strict=True
    )
    about_x = np.array([[1, 0, 0], [0, a, -s], [0, s, a]])
    about_y = np.array([[b, 0, t], [0, 1, 0], [-t, 0, b]])
    about_z = np.array([[c, -u, 0], [u, c, 0], [0, 0, 1]])
    return about_z @ about_y @ about_x


def turned_vector(vector) -> np.ndarray:
    """Return the rotation (3, 3) about a vector by its length [rad], after Rodrigues.

    URScript writes rotations as rotation vectors.
    """
    angle = float(np.linalg.norm(vector))
    if angle == 0:
        return np.eye(3)
    x, y, z = np.asarray(vector) / angle
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + math.sin(angle) * cross + (1 - math.cos(angle)) * cross @ cross


def frame(origin, rotation) -> np.ndarray:
    made = np.eye(4)
    made[:3, :3], made[:3, 3] = rotation, origin
    return made


def paper_of(cell: dict, z_offset_mm: float) -> np.ndarray:
    """Return the paper's frame in the robot's frame, from a cell's TOML dictionary."""
    paper = cell["paper"]
    if paper.get("taught_mm"):
        origin, along, near_by = (np.array(point, dtype=float) for point in paper["taught_mm"][:3])
        x = (along - origin) / np.linalg.norm(along - origin)
        y = near_by - origin - x * (x @ (near_by - origin))
        y /= np.linalg.norm(y)
        made = frame(origin, np.column_stack([x, y, np.cross(x, y)]))
    else:
        made = frame(paper.get("origin_mm", (0, 0, 0)), turned_deg(*map(float, paper.get("rotation_deg", (0, 0, 0)))))
    made[:3, 3] += z_offset_mm * made[:3, 2]
    return made


def down_of(cell: dict) -> np.ndarray:
    """Return the tool's rotation (3, 3) in the paper's frame, z into the paper."""
    return np.diag([1.0, -1.0, -1.0]) @ turned_deg(0, 0, cell["tool"].get("spin_deg", 0.0))


def tool_of(cell: dict) -> np.ndarray:
    tool = cell["tool"]
    return frame(tool["tcp_mm"], turned_deg(*map(float, tool.get("rotation_deg", (0, 0, 0)))))


def moved(by: np.ndarray, points: np.ndarray) -> np.ndarray:
    return points @ by[:3, :3].T + by[:3, 3]


def true_of(commanded: np.ndarray, machine: dict | None) -> np.ndarray:
    """Return the true places (n, 3) of commanded places, in the paper's frame.

    machine is the table of the cell that describes the machine's errors.
    """
    if not machine or not len(commanded):
        return commanded
    along, across = machine.get("scale", (1.0, 1.0))
    lean = machine.get("lean_mm_per_mm", (0.0, 0.0))
    x, y, z = commanded.T
    z = z - paper_height(commanded, machine)
    pressed = np.maximum(-z, 0.0)
    displaced = np.array([bent(place, machine) for place in commanded[:, :2]])
    x, y = along * x + machine.get("skew", 0.0) * y + lean[0] * pressed, across * y + lean[1] * pressed
    return np.column_stack([x + displaced[:, 0], y + displaced[:, 1], z])


def paper_height(commanded: np.ndarray, machine: dict) -> np.ndarray:
    """Return the paper's height (n,) at commanded places above the taught plane."""
    tilts = machine.get("tilt_mm_per_mm", (0.0, 0.0))
    on = on_map(commanded, machine.get("map_mm", ()))
    return machine.get("height_mm", 0.0) + commanded[:, 0] * tilts[0] + commanded[:, 1] * tilts[1] + on


def highest_paper(x: float, y: float, machine: dict | None) -> float:
    """Return the largest height of the paper around a place above the taught plane.

    Travel moves are higher by this height.
    """
    if not machine:
        return 0.0
    flat = {key: value for key, value in machine.items() if key != "map_mm"}
    plane = float(paper_height(np.array([[x, y, 0.0]]), flat)[0])
    return max(0.0, plane + max((row[2] for row in machine.get("map_mm", ())), default=0.0))


def bent(place, machine: dict) -> np.ndarray:
    """Return the displacement (2,) of the tool by the machine's field.

    For x and for y, it is half of the value of a quadratic form.
    """
    if "field_mm" not in machine:
        return np.zeros(2)
    reach = np.array(machine["field_reach_mm"])
    at = np.minimum(np.maximum((place - np.array(machine["field_middle_mm"])) / reach, -1), 1)
    forms = (np.array([[2 * xx, xy], [xy, 2 * yy]]) for xx, xy, yy in machine["field_mm"])
    return np.array([at @ form @ at / 2 for form in forms])


def on_map(commanded: np.ndarray, rows) -> np.ndarray:
    """Return the height (n,) of a map of the paper at places."""
    if not len(rows):
        return np.zeros(len(commanded))
    xs, ys = (sorted({row[k] for row in rows}) for k in range(2))
    heights = {(row[0], row[1]): row[2] for row in rows}
    known = RegularGridInterpolator((xs, ys), np.array([[heights[x, y] for y in ys] for x in xs]))
    return known(np.clip(commanded[:, :2], (xs[0], ys[0]), (xs[-1], ys[-1])))


def commanded_in_air(place, height: float, machine: dict | None) -> np.ndarray:
    """Return the command (3,) that takes the tool over a place of the paper.

    In the air, the tool does not lean.
    """
    if not machine:
        return np.array([*place[:2], height])
    along, across = machine.get("scale", (1.0, 1.0))
    y = place[1] / across
    commanded = np.array([(place[0] - machine.get("skew", 0.0) * y) / along, y])
    if "field_mm" in machine:
        axes = np.array([[along, machine.get("skew", 0.0)], [0.0, across]])
        commanded = least_squares(lambda at: axes @ at + bent(at, machine) - place[:2], commanded, xtol=1e-15).x
    return np.array([*commanded, height + paper_height(commanded[None], machine)[0]])


def angle_rad(one: np.ndarray, other: np.ndarray) -> float:
    """Return the angle between two rotations."""
    return 2 * math.asin(min(1.0, float(np.linalg.norm(one - other)) / math.sqrt(8)))
