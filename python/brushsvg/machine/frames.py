"""Frames in space as (4, 4) matrices, made from a pose or from taught points."""

from __future__ import annotations

import numpy as np

from ..errors import Error

MIN_TAUGHT_GAP_MM = 20.0  # with closer points, an error of 0.2 mm turns the frame by half a degree


def frame_of_pose(origin_mm, rotation_deg) -> np.ndarray:
    """Return the frame with an origin and a rotation.

    rotation_deg: angles about the fixed x, then y, then z axis [degrees]: Rz Ry Rx.
    """
    frame = np.eye(4)
    frame[:3, :3] = rotation(rotation_deg)
    frame[:3, 3] = origin_mm
    return frame


def rotation(rotation_deg) -> np.ndarray:
    """Return the rotation Rz Ry Rx (3, 3) of angles [degrees].

    The angles are about the fixed axes x, y and z. Right angles are exact.
    """
    result = np.eye(3)
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
        result = about @ result
    return result


def rotation_deg(turned: np.ndarray) -> np.ndarray:
    """Return the angles [degrees] of a rotation (3, 3), the inverse of `rotation`.

    The angles are about the fixed axes x, y and z.
    """
    level = np.hypot(turned[2, 1], turned[2, 2])
    about_y = np.arctan2(-turned[2, 0], level)
    if level > 1e-9:
        about_x, about_z = np.arctan2(turned[2, 1], turned[2, 2]), np.arctan2(turned[1, 0], turned[0, 0])
    else:  # the first and the last angle turn about the same axis
        about_x, about_z = np.arctan2(-turned[1, 2], turned[1, 1]), 0.0
    return np.degrees([about_x, about_y, about_z])


def zyz_deg(turned: np.ndarray) -> np.ndarray:
    """Return the z-y-z angles [degrees] of a rotation (3, 3).

    The rotation is about z, then the new y, then the newest z.
    """
    sideways = np.hypot(turned[0, 2], turned[1, 2])
    b = np.arctan2(sideways, turned[2, 2])
    if sideways > 1e-9:
        a, c = np.arctan2(turned[1, 2], turned[0, 2]), np.arctan2(turned[2, 1], -turned[2, 0])
    else:  # the first and the last angle turn about the same axis
        a, c = 0.0, np.arctan2(turned[1, 0], turned[1, 1])
    return np.degrees([a, b, c])


def frame_of_points(points_mm, flatness_mm: float) -> np.ndarray:
    """Return the frame that taught points define.

    points_mm: the origin, a point along x, a point on the side of positive y, and optionally a fourth point that checks
        the plane.
    flatness_mm: largest distance of the fourth point from the plane of the others.

    Raises Error for points that are too close together or on one line, and for a fourth point outside of the plane.
    """
    points = np.asarray(points_mm, dtype=float)
    origin, along_x, on_left = points[:3]
    x, y = along_x - origin, on_left - origin
    for name, side in (("second", x), ("third", y)):
        if np.linalg.norm(side) < MIN_TAUGHT_GAP_MM:
            raise Error(
                f"the {name} point is {np.linalg.norm(side):.1f} mm from the first, less than {MIN_TAUGHT_GAP_MM:g} mm",
                code="paper-taught",
            )
    x /= np.linalg.norm(x)
    across = y - x * (x @ y)
    if np.linalg.norm(across) < MIN_TAUGHT_GAP_MM:
        raise Error(
            f"the third point is {np.linalg.norm(across):.1f} mm off the line of the other two, "
            f"less than {MIN_TAUGHT_GAP_MM:g} mm",
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
    """Return the angle [degrees] of a frame's z axis.

    It is the angle to the z axis of the frame in which the frame is given.
    """
    return float(np.degrees(np.arctan2(np.hypot(frame[0, 2], frame[1, 2]), frame[2, 2])))


def transform_points(frame: np.ndarray, points: np.ndarray) -> np.ndarray:
    """Transform points (n, 3) of a frame into the frame in which it is given."""
    return points @ frame[:3, :3].T + frame[:3, 3]


def is_upright(frame: np.ndarray) -> bool:
    """Return whether a frame's z axis is upright.

    Circles on the paper are then circles in the x-y plane of the frame in which the paper is given.
    """
    return bool(np.allclose(frame[:3, 2], (0, 0, 1), atol=1e-9))


def quaternion(turned: np.ndarray) -> np.ndarray:
    """Return the quaternion w, x, y, z (4,) of a rotation (3, 3); w >= 0.

    The largest part is found first (Shepperd's method). Half a turn, at which a tool points down, is therefore as exact
    as any other rotation.
    """
    squares = np.array([1 + turned.trace(), *(1 + 2 * turned.diagonal() - turned.trace())])
    largest = int(squares.argmax())
    m = turned
    skew = np.array([m[2, 1] - m[1, 2], m[0, 2] - m[2, 0], m[1, 0] - m[0, 1]])
    if largest == 0:
        wxyz = np.array([squares[0], *skew])
    else:
        axis = largest - 1
        wxyz = np.array([skew[axis], *(m[axis] + m[:, axis])])
        wxyz[largest] = squares[largest]
    wxyz /= np.linalg.norm(wxyz)
    return -wxyz if wxyz[0] < 0 else wxyz


def of_quaternion(wxyz) -> np.ndarray:
    """Return the rotations (..., 3, 3) of unit quaternions w, x, y, z (..., 4)."""
    w, x, y, z = np.moveaxis(np.asarray(wxyz, dtype=float), -1, 0)
    rows = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
    ]
    return np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)


def of_rotation_vector(vector_rad) -> np.ndarray:
    """Return the rotation (3, 3) of a rotation vector, axis times angle [rad].

    Rodrigues: I + sin t [n] + (1 - cos t) [n]^2.
    """
    angle = float(np.linalg.norm(vector_rad))
    x, y, z = np.asarray(vector_rad, dtype=float) / angle if angle > 0 else np.zeros(3)
    across = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.eye(3) + np.sin(angle) * across + (1 - np.cos(angle)) * across @ across


def apart_deg(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Return the angles [degrees] between rotations (..., 3, 3).

    Small angles are exact, too: |a - b| = sqrt(8) sin(t / 2).
    """
    return np.degrees(2 * np.arcsin(np.clip(np.linalg.norm(a - b, axis=(-2, -1)) / np.sqrt(8), 0, 1)))


def rotation_vector(turned: np.ndarray) -> np.ndarray:
    """Return the rotation vector (3,) of a rotation (3, 3). It is axis times angle [rad], with the angle in [0, pi]."""
    turn = quaternion(turned)
    sine = np.linalg.norm(turn[1:])
    angle = 2 * np.arctan2(sine, turn[0])
    return turn[1:] / sine * angle if sine > 0 else np.zeros(3)
