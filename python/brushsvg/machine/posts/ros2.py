"""Write poses with times for ROS 2.

The formats are a table (.csv), the table as JSON (.traj), and a serialized
trajectory_msgs/msg/MultiDOFJointTrajectory (.cdr). Units are metres and seconds. The poses are those of the flange in
the robot's base frame.
"""

from __future__ import annotations

import json
import struct
from collections.abc import Iterator
from itertools import chain
from tempfile import SpooledTemporaryFile

import numpy as np

from ..cells.cell import Cell, robot_from_paper
from ..frames import frame_of_pose, quaternion, rotation
from ..moves import Program
from ..timed_moves import make_timed_sections
from ..tool_axes import is_parallel, turned_to
from .script import format_rounded_down, upright_deg
from .text import PROGRAM_END, plain_text

LINE_LIMIT = 100
SECOND_DECIMALS, SPEED_DECIMALS, TURN_DECIMALS = 7, 6, 9
# More decimals of metres than of millimetres: the tip's places are on a grid, the flange's are not.
EXTRA_METRE_DECIMALS = 5
COLUMNS = "time_s,x_m,y_m,z_m,qx,qy,qz,qw,limit_m_s,row"
ROW_KINDS = ("pose", "way", "rest")  # in the numbering of timed_moves
MAX_BYTES_IN_MEMORY = 20_000_000
AXIS_COLUMN = 6  # first column with the brush's axis


def csv(program: Program) -> Iterator[str]:
    """Write the poses as a table. Remarks begin with #, and readers of tables can be set to skip them."""
    yield "".join(map(comment, _header_lines(program))) + COLUMNS + "\n"
    for title, table in make_timed_sections(program):
        yield comment(title)
        yield "".join(f"{numbers},{kind}\n" for numbers, kind in _row_lines(table, program.cell))
    yield comment(PROGRAM_END)


def traj(program: Program) -> Iterator[str]:
    """Write the poses as a JSON list of lists, one per line. Remarks have one text, and rows have ten values."""
    yield '{"format": "brushsvg/trajectory", "version": 1, "rows": [\n'
    yield "".join(json.dumps([comment(line)[:-1]]) + ",\n" for line in _header_lines(program))
    yield json.dumps(COLUMNS.split(","), separators=(",", ":")) + ",\n"
    for title, table in make_timed_sections(program):
        yield json.dumps([comment(title)[:-1]]) + ",\n"
        yield "".join(f'[{numbers},"{kind}"],\n' for numbers, kind in _row_lines(table, program.cell))
    yield json.dumps([comment(PROGRAM_END)[:-1]]) + "]}\n"


def cdr(program: Program) -> Iterator[bytes]:
    """Write little-endian CDR.

    The message has the stamp 0 and one joint, the flange. Each point has one transform, and no velocities and
    accelerations. A double begins at a multiple of eight bytes after the first four bytes.
    """
    tool = program.cell.tool
    header = struct.pack("<iI", 0, 0)
    for text in (tool.base_frame, None, tool.flange_frame):
        header += bytes(-len(header) % 4)
        header += struct.pack("<I", 1) if text is None else struct.pack("<I", len(text) + 1) + text.encode() + b"\0"
    header += bytes(-len(header) % 4)
    with SpooledTemporaryFile(MAX_BYTES_IN_MEMORY) as held_file:
        for _, table in make_timed_sections(program):
            held_file.write(_point_records(table, program.cell).tobytes())
        count = held_file.tell() // POINT_DTYPE.itemsize
        yield b"\0\1\0\0" + header + struct.pack("<I", count)
        held_file.seek(0)
        first = held_file.read(8)
        yield first if (len(header) + 4) % 8 == 0 else first[:4]
        while piece := held_file.read(1_000_000):
            yield piece


POINT_DTYPE = np.dtype(
    [
        ("transforms", "<u4"),
        ("fill", "<u4"),
        ("place_m", "<f8", 3),
        ("turn_xyzw", "<f8", 4),
        ("velocities", "<u4"),
        ("accelerations", "<u4"),
        ("seconds", "<i4"),
        ("nanoseconds", "<u4"),
    ]
)


def _point_records(table: np.ndarray, cell: Cell) -> np.ndarray:
    places_m, turn = _flange_poses(table, cell)
    points = np.zeros(len(table), dtype=POINT_DTYPE)
    nanoseconds = np.round(table[:, 0] * 1e9).astype(np.int64)
    points["transforms"], points["place_m"], points["turn_xyzw"] = 1, places_m, turn
    points["seconds"], points["nanoseconds"] = nanoseconds // 10**9, nanoseconds % 10**9
    return points


def comment(text: str) -> str:
    return f"# {plain_text(text, LINE_LIMIT - 2)}\n"


def flange_from_tip(cell: Cell) -> np.ndarray:
    """Return the flange's frame (4, 4) in the frame of the brush's tip."""
    return np.linalg.inv(frame_of_pose(np.array(cell.tool.tcp_mm), cell.tool.rotation_deg))


def _header_lines(program: Program) -> tuple[str, ...]:
    tool = program.cell.tool
    return (
        *program.header,
        f"frame: {tool.base_frame}",
        f"link: {tool.flange_frame}",
        "units: seconds from the first row on, metres, quaternion, metres per second",
    )


def _flange_poses(table: np.ndarray, cell: Cell) -> tuple[np.ndarray, np.ndarray]:
    """Return places (n, 3) [m] and quaternion x, y, z, w of the flange: (4,) if upright, else (n, 4)."""
    tip_rotations = rotation(upright_deg(cell))
    flange = flange_from_tip(cell)
    if table.shape[1] > AXIS_COLUMN:
        tip_rotations = turned_to(table[:, AXIS_COLUMN:], tip_rotations)
        is_upright_at = is_parallel(table[:, AXIS_COLUMN:], robot_from_paper(cell)[:3, 2])
        tip_rotations[is_upright_at] = rotation(upright_deg(cell))
        turned = np.array([quaternion(rotation_matrix) for rotation_matrix in tip_rotations @ flange[:3, :3]]).reshape(
            -1, 4
        )[:, [1, 2, 3, 0]]
    else:
        w, *xyz = quaternion(tip_rotations @ flange[:3, :3])
        turned = np.array([*xyz, w])
    places_m = (table[:, 1:4] + tip_rotations @ flange[:3, 3]) / 1e3
    return np.round(places_m, cell.decimals + EXTRA_METRE_DECIMALS) + 0.0, np.round(turned, TURN_DECIMALS) + 0.0


def _speed_text(limit_mm_s: float) -> str:
    return format_rounded_down(limit_mm_s / 1e3, SPEED_DECIMALS).rstrip("0").rstrip(".") if limit_mm_s else "0"


def _row_lines(table: np.ndarray, cell: Cell) -> Iterator[tuple[str, str]]:
    places_m, turn = _flange_poses(table, cell)
    place = f"%.{cell.decimals + EXTRA_METRE_DECIMALS}f"
    turns: list[list[float]] = []
    if turn.ndim == 1:
        turned = ",".join(f"{value:.{TURN_DECIMALS}f}" for value in turn)
    else:
        turned, turns = ",".join([f"%.{TURN_DECIMALS}f"] * 4), turn.T.tolist()
    pattern = f"%.{SECOND_DECIMALS}f,{place},{place},{place},{turned},%s"
    limits = {limit: _speed_text(limit) for limit in set(table[:, 4])}
    limited = [limits[limit] for limit in table[:, 4].tolist()]
    values = zip(table[:, 0].tolist(), *places_m.T.tolist(), *turns, limited, strict=True)
    lines = ("\n".join([pattern] * len(table)) % tuple(chain.from_iterable(values))).split("\n")
    return zip(lines if len(table) else [], (ROW_KINDS[int(kind)] for kind in table[:, 5]), strict=True)
