"""Moves -> what a post processor of RoboDK's kind, given by its path, writes: millimetres, the paper as frame."""

from __future__ import annotations

import ast
import contextlib
import importlib.util
import io
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType

import numpy as np

from ...errors import Error
from ..cells.cell import Cell
from ..frames import frame_of_pose
from ..motion import Move, Program, Wait, via_point
from .script import blends_mm, down, tool_rotations_at
from .text import plain_text

LINE_LIMIT = 100
NAME = "brushsvg"
EXACT, UNTIL_RESUMED = -1.0, -1.0  # as RoboDK calls zones and pauses
AXES = 6
CALLS = (
    *("ProgStart", "ProgFinish", "ProgSave", "setFrame", "setTool", "setSpeed", "setZoneData"),
    *("setAcceleration", "MoveL", "MoveC", "Pause", "RunMessage"),
)


def robodk(program: Program) -> Iterator[str]:
    """The one file that the post saves. Joints are not known, so that no move is MoveJ, and there is no rise before the
    first one: posts cannot ask where the arm is. Error for anything the post cannot do, and for what it logs."""
    where = program.cell.robodk.post
    with tempfile.TemporaryDirectory() as folder, contextlib.redirect_stdout(io.StringIO()):
        try:
            module = _loaded(where)
            post = module.RobotPost(NAME, program.cell.name, AXES)
            if missing := [call for call in CALLS if not callable(getattr(post, call, None))]:
                raise AttributeError(f"it has no {missing[0]}")
            _called(post, getattr(module, "Mat", None), program)
            post.ProgSave(folder, NAME, False, False)
            log = str(getattr(post, "LOG", "") or "").strip()
        except Error:
            raise
        except (Exception, SystemExit) as mistake:
            said = plain_text(f"{type(mistake).__name__}: {mistake}", LINE_LIMIT)
            raise Error(f"the post {where} fails: {said}", where="robodk.post", code="post-failed") from None
        if log:
            said = plain_text(log.splitlines()[0], LINE_LIMIT)
            raise Error(f"the post {where} complains: {said}", where="robodk.post", code="post-failed")
        saved = [path for path in sorted(Path(folder).rglob("*")) if path.is_file()]
        if len(saved) != 1:
            sentence = f"the post {where} has saved {len(saved)} files, not one"
            raise Error(sentence, where="robodk.post", code="post-failed")
        text = saved[0].read_bytes().decode("utf-8", "replace")
    yield text


def sources(where: str) -> list[str]:
    """Paths of a post and of the modules next to it that it imports, and they in turn."""
    left, found = [Path(where).expanduser().resolve()], []
    while left:
        path = left.pop()
        if path.is_file() and str(path) not in found:
            found.append(str(path))
            left += [path.with_name(f"{name}.py") for name in _imported(path)]
    return found


def _imported(path: Path) -> list[str]:
    """First parts of the names that a file imports; none of what is no Python, which is refused when it is run."""
    try:
        nodes = list(ast.walk(ast.parse(path.read_bytes())))
    except (ValueError, SyntaxError, RecursionError, MemoryError):
        return []
    names = [each.name for node in nodes if isinstance(node, ast.Import) for each in node.names]
    names += [node.module or "" for node in nodes if isinstance(node, ast.ImportFrom)]
    return [name.partition(".")[0] for name in names if name]


def _loaded(where: str) -> ModuleType:
    path = Path(where).expanduser()
    if not path.is_file():
        raise Error(f"there is no post {where}", where="robodk.post", code="file-unreadable")
    spec = importlib.util.spec_from_file_location("brushsvg_robodk_post", path)
    if spec is None or spec.loader is None:
        raise Error(f"the post {where} is no file of Python", where="robodk.post", code="post-failed")
    module = importlib.util.module_from_spec(spec)
    post_folder = str(path.resolve().parent)  # where a post looks for the one that it changes
    sys.path.insert(0, post_folder)
    try:
        spec.loader.exec_module(module)
    finally:
        sys.path.remove(post_folder)
    return module


def _called(post, mat, program: Program) -> None:
    cell, upright = program.cell, down(program.cell.tool.spin_deg)

    def pose(frame: np.ndarray):
        rows = (np.round(frame, 12) + 0.0).tolist()
        return mat(rows) if mat else rows

    def at(point: np.ndarray, turned: np.ndarray = upright):
        frame = np.eye(4)
        frame[:3, :3], frame[:3, 3] = turned, np.round(point, cell.decimals)
        return pose(frame)

    post.ProgStart(NAME)
    for line in program.header:
        post.RunMessage(plain_text(line, LINE_LIMIT), True)
    post.setFrame(pose(program.robot_from_frame), -1, "paper")
    post.setTool(pose(frame_of_pose(np.array(cell.tool.tcp_mm), cell.tool.rotation_deg)), -1, "brush")
    post.setAcceleration(cell.speeds.acceleration_mm_s2)
    settings = _Settings(post)
    for section in program.sections():
        post.RunMessage(plain_text(section.title, LINE_LIMIT), True)
        for step in section.steps:
            if isinstance(step, Wait):
                _wait(post, step)
            else:
                _move(post, settings, step, at, upright, cell)
    post.ProgFinish(NAME)


class _Settings:
    """What holds until another one is said: speeds and zones."""

    def __init__(self, post):
        self.post, self.speed, self.zone = post, None, None

    def at(self, speed_mm_s: float, zone_mm: float) -> None:
        if speed_mm_s != self.speed:
            self.post.setSpeed(speed_mm_s)
        if zone_mm != self.zone:
            self.post.setZoneData(zone_mm)
        self.speed, self.zone = speed_mm_s, zone_mm


def _move(post, settings: _Settings, move: Move, at, upright: np.ndarray, cell: Cell) -> None:
    if move.arc is not None:
        settings.at(move.speed_mm_s, EXACT)
        post.MoveC(at(via_point(move.points_mm)), None, at(move.points_mm[-1]), None)
        return
    zones = np.zeros(len(move.points_mm)) if move.blends_mm is None else blends_mm(move, cell.decimals)
    for point, turned, zone in zip(
        move.points_mm, tool_rotations_at(move, upright), zones.tolist(), strict=True
    ):
        settings.at(move.speed_mm_s, zone if zone > 0 else EXACT)
        post.MoveL(at(point, upright if turned is None else turned), None)


def _wait(post, step: Wait) -> None:
    if step.seconds is None:
        post.RunMessage(plain_text(step.message, LINE_LIMIT))
        post.Pause(UNTIL_RESUMED)
    else:
        post.Pause(1000.0 * step.seconds)
