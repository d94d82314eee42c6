"""Write programs with a post processor for RoboDK, given by its path.

Units are millimetres. The paper is the reference frame.
"""

from __future__ import annotations

import ast
import contextlib
import importlib.util
import io
import sys
import tempfile
import threading
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType

import numpy as np

from ...errors import Error
from ..cells.cell import Cell
from ..frames import frame_of_pose
from ..moves import Move, Program, Wait, via_point
from .script import blends_mm, tool_rotations_at, upright_tool_rotation
from .text import plain_text

LINE_LIMIT = 100
PROGRAM_NAME = "brushsvg"
EXACT_ZONE, UNTIL_RESUMED = -1.0, -1.0  # values of RoboDK for zones and pauses
AXIS_COUNT = 6
REQUIRED_METHODS = (
    *("ProgStart", "ProgFinish", "ProgSave", "setFrame", "setTool", "setSpeed", "setZoneData"),
    *("setAcceleration", "MoveL", "MoveC", "Pause", "RunMessage"),
)


def robodk(program: Program) -> Iterator[str]:
    """Return the one file that the post saves.

    Joints are not known, so no move is a MoveJ. There is no rise before the first move, because posts cannot query the
    arm's place.

    Raises Error for everything that the post cannot do, and if it logs anything.
    """
    where = program.cell.robodk.post
    with tempfile.TemporaryDirectory() as folder, _post_lock, contextlib.redirect_stdout(_sink):
        try:
            module = _load_post(where)
            post = module.RobotPost(PROGRAM_NAME, program.cell.name, AXIS_COUNT)
            if missing := [call for call in REQUIRED_METHODS if not callable(getattr(post, call, None))]:
                raise AttributeError(f"it has no {missing[0]}")
            _call_post(post, getattr(module, "Mat", None), program)
            post.ProgSave(folder, PROGRAM_NAME, False, False)
            log = str(getattr(post, "LOG", "") or "").strip()
        except Error:
            raise
        except (Exception, SystemExit) as error:
            message = plain_text(f"{type(error).__name__}: {error}", LINE_LIMIT)
            raise Error(f"the post {where} fails: {message}", where="robodk.post", code="post-failed") from None
        if log:
            message = plain_text(log.splitlines()[0], LINE_LIMIT)
            raise Error(f"the post {where} complains: {message}", where="robodk.post", code="post-failed")
        saved_files = [path for path in sorted(Path(folder).rglob("*")) if path.is_file()]
        if len(saved_files) != 1:
            sentence = f"the post {where} has saved {len(saved_files)} files, not one"
            raise Error(sentence, where="robodk.post", code="post-failed")
        saved = saved_files[0].read_bytes()
    yield _decode_saved(saved, where)


class _Sink(io.TextIOBase):
    """A standard output that drops what is printed."""

    def write(self, text: str) -> int:
        return len(text)


# sys.stdout and sys.path belong to all threads, so only one post runs at a time. What other threads print meanwhile is
# lost. The sink is never freed: until Python 3.12, print() crashes if another thread frees the object it prints to.
_post_lock = threading.Lock()
_sink = _Sink()


def _decode_saved(saved: bytes, where: str) -> str:
    """Return the text of the saved file. Raises Error if it is empty, or not UTF-8."""
    if not saved.strip():
        sentence = f"the post {where} has saved an empty file: let ProgSave write the program"
        raise Error(sentence, where="robodk.post", code="post-failed")
    try:
        return saved.decode()
    except UnicodeDecodeError as error:
        line = saved.count(b"\n", 0, error.start) + 1
        sentence = f"the post {where} has saved line {line} in another encoding than UTF-8: save with encoding='utf-8'"
        raise Error(sentence, where="robodk.post", code="post-failed") from None


def find_sources(where: str) -> list[str]:
    """Return the paths of a post and of the modules that it imports.

    The modules are those in its folder that it imports directly or indirectly.
    """
    unread, paths = [Path(where).expanduser().resolve()], []
    while unread:
        path = unread.pop()
        if path.is_file() and str(path) not in paths:
            paths.append(str(path))
            unread += [path.with_name(f"{name}.py") for name in _imported_modules(path)]
    return paths


def _imported_modules(path: Path) -> list[str]:
    """Return the first parts of the module names that a file imports.

    A file that is not Python has no imports here. It is refused when it is run.
    """
    try:
        nodes = list(ast.walk(ast.parse(path.read_bytes())))
    except (ValueError, SyntaxError, RecursionError, MemoryError):
        return []
    names = [alias.name for node in nodes if isinstance(node, ast.Import) for alias in node.names]
    names += [node.module or "" for node in nodes if isinstance(node, ast.ImportFrom)]
    return [name.partition(".")[0] for name in names if name]


def find_post(where: str) -> Path:
    """Return the path of a post, which may be relative to the current folder. Raises Error if there is no such file."""
    path = Path(where).expanduser()
    if not path.is_file():
        folder = "" if path.is_absolute() else f" in the folder {Path.cwd()}"
        raise Error(
            f"there is no post {where}{folder}",
            where="robodk.post",
            code="file-unreadable",
            advice="give the whole path of the post in the cell",
        )
    return path


def _load_post(where: str) -> ModuleType:
    path = find_post(where)
    spec = importlib.util.spec_from_file_location("brushsvg_robodk_post", path)
    if spec is None or spec.loader is None:
        raise Error(f"the post {where} is no file of Python", where="robodk.post", code="post-failed")
    module = importlib.util.module_from_spec(spec)
    post_folder = str(path.resolve().parent)  # a post may import another post from its folder
    sys.path.insert(0, post_folder)
    try:
        spec.loader.exec_module(module)
    finally:
        sys.path.remove(post_folder)
    return module


def _call_post(post, mat, program: Program) -> None:
    cell, upright = program.cell, upright_tool_rotation(program.cell.tool.spin_deg)

    def pose(frame: np.ndarray):
        rows = (np.round(frame, 12) + 0.0).tolist()
        return mat(rows) if mat else rows

    def at(point: np.ndarray, turned: np.ndarray = upright):
        frame = np.eye(4)
        frame[:3, :3], frame[:3, 3] = turned, np.round(point, cell.decimals)
        return pose(frame)

    post.ProgStart(PROGRAM_NAME)
    for line in program.header:
        post.RunMessage(plain_text(line, LINE_LIMIT), True)
    post.setFrame(pose(program.robot_from_frame), -1, "paper")
    post.setTool(pose(frame_of_pose(np.array(cell.tool.tcp_mm), cell.tool.rotation_deg)), -1, "brush")
    post.setAcceleration(cell.speeds.acceleration_mm_s2)
    settings = _PostSettings(post)
    for section in program.sections():
        post.RunMessage(plain_text(section.title, LINE_LIMIT), True)
        for step in section.steps:
            if isinstance(step, Wait):
                _write_wait(post, step)
            else:
                _write_move(post, settings, step, at, upright, cell)
    post.ProgFinish(PROGRAM_NAME)


class _PostSettings:
    """The current speed and zone of a post. They are only written when they change."""

    def __init__(self, post):
        self.post, self.speed, self.zone = post, None, None

    def set(self, speed_mm_s: float, zone_mm: float) -> None:
        if speed_mm_s != self.speed:
            self.post.setSpeed(speed_mm_s)
        if zone_mm != self.zone:
            self.post.setZoneData(zone_mm)
        self.speed, self.zone = speed_mm_s, zone_mm


def _write_move(post, settings: _PostSettings, move: Move, at, upright: np.ndarray, cell: Cell) -> None:
    if move.arc is not None:
        settings.set(move.speed_mm_s, EXACT_ZONE)
        post.MoveC(at(via_point(move.points_mm)), None, at(move.points_mm[-1]), None)
        return
    zones = np.zeros(len(move.points_mm)) if move.blends_mm is None else blends_mm(move, cell.decimals)
    for point, turned, zone in zip(move.points_mm, tool_rotations_at(move, upright), zones.tolist(), strict=True):
        settings.set(move.speed_mm_s, zone if zone > 0 else EXACT_ZONE)
        post.MoveL(at(point, upright if turned is None else turned), None)


def _write_wait(post, step: Wait) -> None:
    if step.seconds is None:
        post.RunMessage(plain_text(step.message, LINE_LIMIT))
        post.Pause(UNTIL_RESUMED)
    else:
        post.Pause(1000.0 * step.seconds)
