"""Moves -> poses with times for ROS 2: a table (.csv), the same as JSON (.traj), and a serialized
trajectory_msgs/msg/MultiDOFJointTrajectory (.cdr). Metres, seconds, the flange in the robot's base frame."""

from __future__ import annotations

import json
import struct
from collections.abc import Iterator
from itertools import chain
from tempfile import SpooledTemporaryFile

import numpy as np

from ..cells.cell import Cell, robot_from_paper
from ..frames import frame_of_pose, quaternion, rotation
from ..motion import Program
from ..tool_axes import is_parallel, turned_to
from ..trajectory import make_timed_sections
from .script import format_rounded_down, upright_deg
from .text import plain_text

LINE_LIMIT = 100
SECOND_DECIMALS, SPEED_DECIMALS, TURN_DECIMALS = 7, 6, 9
FINER = 5  # decimals of metres beyond those of millimetres: the flange's places are on no grid, the tip's are
COLUMNS = "time_s,x_m,y_m,z_m,qx,qy,qz,qw,limit_m_s,row"
KINDS = ("pose", "way", "rest")  # as trajectory numbers them
ROS2_END = "end: the brush is held up"
HELD_BYTES = 20_000_000
TILTED_COLUMNS = 6  # of a row, behind which stands how the brush is held


def csv(program: Program) -> Iterator[str]:
    """Remarks begin with #: readers of tables can be set to skip them."""
    yield "".join(map(comment, _head(program))) + COLUMNS + "\n"
    for title, table in make_timed_sections(program):
        yield comment(title)
        yield "".join(f"{numbers},{kind}\n" for numbers, kind in _lines(table, program.cell))
    yield comment(ROS2_END)


def traj(program: Program) -> Iterator[str]:
    """A list of lists in lines: remarks have one text, rows ten values."""
    yield '{"format": "brushsvg/trajectory", "version": 1, "rows": [\n'
    yield "".join(json.dumps([comment(line)[:-1]]) + ",\n" for line in _head(program))
    yield json.dumps(COLUMNS.split(","), separators=(",", ":")) + ",\n"
    for title, table in make_timed_sections(program):
        yield json.dumps([comment(title)[:-1]]) + ",\n"
        yield "".join(f'[{numbers},"{kind}"],\n' for numbers, kind in _lines(table, program.cell))
    yield json.dumps([comment(ROS2_END)[:-1]]) + "]}\n"


def cdr(program: Program) -> Iterator[bytes]:
    """Little-endian CDR: stamp 0, one joint, the flange, with one transform a point, no velocities, no accelerations.
    A double begins at a multiple of eight bytes behind the first four."""
    tool = program.cell.tool
    head = struct.pack("<iI", 0, 0)
    for text in (tool.base_frame, None, tool.flange_frame):
        head += bytes(-len(head) % 4)
        head += (
            struct.pack("<I", 1) if text is None else struct.pack("<I", len(text) + 1) + text.encode() + b"\0"
        )
    head += bytes(-len(head) % 4)
    with SpooledTemporaryFile(HELD_BYTES) as held:
        for _, table in make_timed_sections(program):
            held.write(_points(table, program.cell).tobytes())
        count = held.tell() // POINT.itemsize
        yield b"\0\1\0\0" + head + struct.pack("<I", count)
        held.seek(0)
        first = held.read(8)
        yield first if (len(head) + 4) % 8 == 0 else first[:4]
        while piece := held.read(1_000_000):
            yield piece


POINT = np.dtype(
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


def _points(table: np.ndarray, cell: Cell) -> np.ndarray:
    places_m, turn = _placed(table, cell)
    points = np.zeros(len(table), dtype=POINT)
    nanoseconds = np.round(table[:, 0] * 1e9).astype(np.int64)
    points["transforms"], points["place_m"], points["turn_xyzw"] = 1, places_m, turn
    points["seconds"], points["nanoseconds"] = nanoseconds // 10**9, nanoseconds % 10**9
    return points


def comment(text: str) -> str:
    return f"# {plain_text(text, LINE_LIMIT - 2)}\n"


def flange_from_tip(cell: Cell) -> np.ndarray:
    """(4, 4) the flange's frame in that of the brush's tip."""
    return np.linalg.inv(frame_of_pose(np.array(cell.tool.tcp_mm), cell.tool.rotation_deg))


def _head(program: Program) -> tuple[str, ...]:
    tool = program.cell.tool
    return (
        *program.header,
        f"frame: {tool.base_frame}",
        f"link: {tool.flange_frame}",
        "units: seconds from the first row on, metres, quaternion, metres per second",
    )


def _placed(table: np.ndarray, cell: Cell) -> tuple[np.ndarray, np.ndarray]:
    """(n, 3) where the flange is [m], (4,) how it is turned, x, y, z, w: the brush stands upright on the paper; (n, 4)
    where a program tilts it."""
    tip = rotation(upright_deg(cell))
    flange = flange_from_tip(cell)
    if table.shape[1] > TILTED_COLUMNS:
        tip = turned_to(table[:, TILTED_COLUMNS:], tip)
        stands = is_parallel(table[:, TILTED_COLUMNS:], robot_from_paper(cell)[:3, 2])
        tip[stands] = rotation(upright_deg(cell))
        turned = np.array([quaternion(each) for each in tip @ flange[:3, :3]]).reshape(-1, 4)[:, [1, 2, 3, 0]]
    else:
        w, *xyz = quaternion(tip @ flange[:3, :3])
        turned = np.array([*xyz, w])
    places_m = (table[:, 1:4] + tip @ flange[:3, 3]) / 1e3
    return np.round(places_m, cell.decimals + FINER) + 0.0, np.round(turned, TURN_DECIMALS) + 0.0


def _shortest(limit_mm_s: float) -> str:
    return (
        format_rounded_down(limit_mm_s / 1e3, SPEED_DECIMALS).rstrip("0").rstrip(".") if limit_mm_s else "0"
    )


def _lines(table: np.ndarray, cell: Cell) -> Iterator[tuple[str, str]]:
    places_m, turn = _placed(table, cell)
    place = f"%.{cell.decimals + FINER}f"
    turns: list[list[float]] = []
    if turn.ndim == 1:
        turned = ",".join(f"{value:.{TURN_DECIMALS}f}" for value in turn)
    else:
        turned, turns = ",".join([f"%.{TURN_DECIMALS}f"] * 4), turn.T.tolist()
    pattern = f"%.{SECOND_DECIMALS}f,{place},{place},{place},{turned},%s"
    limits = {limit: _shortest(limit) for limit in set(table[:, 4])}
    limited = [limits[limit] for limit in table[:, 4].tolist()]
    values = zip(table[:, 0].tolist(), *places_m.T.tolist(), *turns, limited, strict=True)
    lines = ("\n".join([pattern] * len(table)) % tuple(chain.from_iterable(values))).split("\n")
    return zip(lines if len(table) else [], (KINDS[int(kind)] for kind in table[:, 5]), strict=True)
