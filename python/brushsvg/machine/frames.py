"""Frames in space: the paper's in the robot's, from a pose or from points that were taught. Arrays are (4, 4)."""

from __future__ import annotations

import numpy as np

from ..errors import Error

LEAST_TAUGHT_MM = 20.0  # closer points turn a touch of 0.2 mm into half a degree


def frame_of_pose(origin_mm, rotation_deg) -> np.ndarray:
    """Origin and rotation about the fixed x, then y, then z axis [degrees]: Rz Ry Rx."""
    frame = np.eye(4)
    frame[:3, :3] = rotation(rotation_deg)
    frame[:3, 3] = origin_mm
    return frame


def rotation(rotation_deg) -> np.ndarray:
    """(3, 3) Rz Ry Rx of angles about the fixed axes x, y, z [degrees]; right angles are exact."""
    turned = np.eye(3)
    for axis, angle in enumerate(np.asarray(rotation_deg, dtype=float)):
        quarter = angle % 360 / 90
        c, s = (
            [(1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0)][int(quarter) % 4]
            if quarter == int(quarter)
            else (np.cos(np.radians(angle)), np.sin(np.radians(angle)))
        )
        j, k = (axis + 1) % 3, (axis + 2) % 3
        about = np.eye(3)
        about[j, j], about[j, k], about[k, j], about[k, k] = c, -s, s, c
        turned = about @ turned
    return turned


def rotation_deg(turned: np.ndarray) -> np.ndarray:
    """(3,) angles [degrees] about the fixed axes x, y, z of a rotation (3, 3): what `rotation` makes it of."""
    about_x = np.arctan2(turned[2, 1], turned[2, 2])
    about_y = np.arctan2(-turned[2, 0], np.hypot(turned[2, 1], turned[2, 2]))
    about_z = np.arctan2(turned[1, 0], turned[0, 0])
    return np.degrees([about_x, about_y, about_z])


def zyz_deg(turned: np.ndarray) -> np.ndarray:
    """(3,) angles [degrees] about z, then the new y, then the newest z of a rotation (3, 3)."""
    sideways = np.hypot(turned[0, 2], turned[1, 2])
    b = np.arctan2(sideways, turned[2, 2])
    if sideways > 1e-9:
        a, c = np.arctan2(turned[1, 2], turned[0, 2]), np.arctan2(turned[2, 1], -turned[2, 0])
    else:  # both turn about one axis
        a, c = 0.0, np.arctan2(turned[1, 0], turned[1, 1])
    return np.degrees([a, b, c])


def frame_of_points(points_mm, flatness_mm: float) -> np.ndarray:
    """From the origin, a point along x, a point on the side of positive y, perhaps one more to try the plane.

    Error for points too close together or on one line, and when the last is more than flatness_mm off the
    plane of the others.
    """
    points = np.asarray(points_mm, dtype=float)
    origin, along_x, on_left = points[:3]
    x, y = along_x - origin, on_left - origin
    for name, side in (("second", x), ("third", y)):
        if np.linalg.norm(side) < LEAST_TAUGHT_MM:
            raise Error(
                f"the {name} point is {np.linalg.norm(side):.1f} mm from the first, less than {LEAST_TAUGHT_MM:g} mm",
                code="paper-taught",
            )
    x /= np.linalg.norm(x)
    across = y - x * (x @ y)
    if np.linalg.norm(across) < LEAST_TAUGHT_MM:
        raise Error(
            f"the third point is {np.linalg.norm(across):.1f} mm off the line of the other two, "
            f"less than {LEAST_TAUGHT_MM:g} mm",
            code="paper-taught",
        )
    frame = np.eye(4)
    frame[:3, 0] = x
    frame[:3, 1] = across / np.linalg.norm(across)
    frame[:3, 2] = np.cross(frame[:3, 0], frame[:3, 1])
    frame[:3, 3] = origin
    for point in points[3:]:
        off_mm = abs(frame[:3, 2] @ (point - origin))
        if off_mm > flatness_mm:
            raise Error(
                f"the fourth point is {off_mm:.2f} mm off the plane of the other three, outside the range "
                f"[0, {flatness_mm:g}] mm of flatness_mm: the paper is not flat, or a point was taught wrongly",
                code="paper-not-flat",
            )
    return frame


def normal_tilt_deg(frame: np.ndarray) -> float:
    """Angle between the frame's z axis and that of the frame it is given in."""
    return float(np.degrees(np.arctan2(np.hypot(frame[0, 2], frame[1, 2]), frame[2, 2])))


def moved(frame: np.ndarray, points: np.ndarray) -> np.ndarray:
    """(n, 3) points of the frame, in the frame that it is given in."""
    return points @ frame[:3, :3].T + frame[:3, 3]


def is_upright(frame: np.ndarray) -> bool:
    """Whether a circle on the paper is one in the x-y plane of the frame it is given in."""
    return bool(np.allclose(frame[:3, 2], (0, 0, 1), atol=1e-9))


def quaternion(turned: np.ndarray) -> np.ndarray:
    """(4,) w, x, y, z of a rotation (3, 3), w not negative: the largest part is found first (Shepperd), so that half a
    turn, at which a tool points down, is as exact as any other."""
    squares = np.array([1 + turned.trace(), *(1 + 2 * turned.diagonal() - turned.trace())])
    largest = int(squares.argmax())
    m = turned
    skew = np.array([m[2, 1] - m[1, 2], m[0, 2] - m[2, 0], m[1, 0] - m[0, 1]])
    if largest == 0:
        found = np.array([squares[0], *skew])
    else:
        axis = largest - 1
        found = np.array([skew[axis], *(m[axis] + m[:, axis])])
        found[largest] = squares[largest]
    found /= np.linalg.norm(found)
    return -found if found[0] < 0 else found


def of_quaternion(wxyz) -> np.ndarray:
    """(..., 3, 3) the rotations of unit quaternions (..., 4): w, x, y, z."""
    w, x, y, z = np.moveaxis(np.asarray(wxyz, dtype=float), -1, 0)
    rows = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
    ]
    return np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)


def of_rotation_vector(vector_rad) -> np.ndarray:
    """(3, 3) the rotation of axis times angle [rad]. Rodrigues: I + sin t [n] + (1 - cos t) [n]^2."""
    angle = float(np.linalg.norm(vector_rad))
    x, y, z = np.asarray(vector_rad, dtype=float) / angle if angle > 0 else np.zeros(3)
    across = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.eye(3) + np.sin(angle) * across + (1 - np.cos(angle)) * across @ across


def apart_deg(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """(...) angle between rotations (..., 3, 3), exact for small ones, too: |a - b| = sqrt(8) sin(t / 2)."""
    return np.degrees(2 * np.arcsin(np.clip(np.linalg.norm(a - b, axis=(-2, -1)) / np.sqrt(8), 0, 1)))


def rotation_vector(turned: np.ndarray) -> np.ndarray:
    """(3,) axis times angle [rad] of a rotation (3, 3), angle in [0, pi]."""
    turn = quaternion(turned)
    sine = np.linalg.norm(turn[1:])
    angle = 2 * np.arctan2(sine, turn[0])
    return turn[1:] / sine * angle if sine > 0 else np.zeros(3)
