"""Posts: one robot language per file. POSTS lists all of them."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from types import MappingProxyType, ModuleType
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from ..cells.cell import Cell
    from ..motion import Program


class Post(NamedTuple):
    """A robot language and the function that writes it.

    title: name of the language for people.
    extensions: extensions of its files.
    write: returns the program as successive pieces of 7-bit text.
    in_robot_frame: whether points are in the robot's frame. Otherwise they are in the paper's frame, which the program
        then defines.
    circles_by: how a circle is defined: by its "centre" or by a "pose" on it; "" if circles are run as lines. For a
        firmware that divides circles into lines, the cell gives the length of the lines, or 0 if no circles are
        written. See the function circles_by.
    line_end: line ending of the controller's own files.
    has_tabs: whether the controller's own files have tabs.
    parted: returns the module that handles the several files of a long job; None if there is only one file.
    others: functions that write files of other extensions in another way.
    """

    title: str
    extensions: tuple[str, ...]
    write: Callable[[Program], Iterator[str]]
    in_robot_frame: bool = True
    circles_by: str = "centre"
    line_end: str = "\n"
    has_tabs: bool = False
    parted: Callable[[], ModuleType] | None = None
    others: Mapping[str, Callable[[Program], Iterator[str | bytes]]] = MappingProxyType({})

    def programs(self, text: str) -> dict[str, str]:
        """Return the texts of a job's files, keyed by file name.

        The name of the requested file is "". A name that begins with "-" is appended to the requested file's name.
        """
        return self.parted().programs(text) if self.parted else {"": text}

    def called(self, text: str) -> list[str]:
        """Return the names of the files with which a program continues."""
        return self.parted().called(text) if self.parted else []


def _linuxcnc(program: Program) -> Iterator[str]:
    from .gcode import linuxcnc  # loaded only when a program is written, not to list the languages

    return linuxcnc(program)


def _dialect(program: Program) -> Iterator[str]:
    from .gcode import gcode

    return gcode(program)


def _grbl_servo(program: Program) -> Iterator[str]:
    from .gcode_servo import grbl_servo

    return grbl_servo(program)


def _marlin_servo(program: Program) -> Iterator[str]:
    from .gcode_pen import marlin_servo

    return marlin_servo(program)


def _urscript(program: Program) -> Iterator[str]:
    from .urscript import urscript

    return urscript(program)


def _urscript_parts() -> ModuleType:
    from . import urscript

    return urscript


def _jaka(program: Program) -> Iterator[str]:
    from .jaka import jaka

    return jaka(program)


def _rapid(program: Program) -> Iterator[str]:
    from .rapid import rapid

    return rapid(program)


def _xarm(program: Program) -> Iterator[str]:
    from .xarm import xarm

    return xarm(program)


def _krl(program: Program) -> Iterator[str]:
    from .krl import krl

    return krl(program)


def _krl_parts() -> ModuleType:
    from . import krl

    return krl


def _dobot(program: Program) -> Iterator[str]:
    from .dobot import dobot

    return dobot(program)


def _fanuc(program: Program) -> Iterator[str]:
    from .fanuc import fanuc

    return fanuc(program)


def _fanuc_parts() -> ModuleType:
    from . import fanuc

    return fanuc


def _doosan(program: Program) -> Iterator[str]:
    from .doosan import doosan

    return doosan(program)


def _ros2(program: Program) -> Iterator[str]:
    from .ros2 import csv

    return csv(program)


def _ros2_json(program: Program) -> Iterator[str]:
    from .ros2 import traj

    return traj(program)


def _ros2_message(program: Program) -> Iterator[bytes]:
    from .ros2 import cdr

    return cdr(program)


def _hpgl(program: Program) -> Iterator[str]:
    from .hpgl import hpgl

    return hpgl(program)


def _ebb(program: Program) -> Iterator[str]:
    from .ebb import ebb

    return ebb(program)


def _robodk(program: Program) -> Iterator[str]:
    from .robodk import robodk

    return robodk(program)


def sources_of_post(cell: Cell) -> list[str]:
    """Return the paths of further files on which a program depends.

    These are the files of a RoboDK post that the cell names.
    """
    if cell.robodk is None:
        return []
    from .robodk import find_sources

    return find_sources(cell.robodk.post)


def circles_by(cell: Cell) -> str:
    """Return how a circle is defined on a cell, see Post."""
    from ..cells.cell import ARCS_IN_SEGMENTS

    post = POSTS.get(cell.language)
    if cell.language in ARCS_IN_SEGMENTS and not cell.arc_segment_mm:
        return ""
    return post.circles_by if post else "centre"


GCODE = (".ngc", ".gcode", ".nc")
POSTS = {  # by the language that a cell names
    "linuxcnc": Post("G-code for LinuxCNC", GCODE, _linuxcnc),
    "grbl": Post("G-code for grbl", GCODE, _dialect),
    "fluidnc": Post("G-code for FluidNC", GCODE, _dialect),
    "marlin": Post("G-code for Marlin", GCODE, _dialect),
    "klipper": Post("G-code for Klipper", GCODE, _dialect),
    "grbl-servo": Post("G-code for grbl, the brush on a servo", GCODE, _grbl_servo, circles_by=""),
    "marlin-servo": Post("G-code for Marlin, a pen on a servo", GCODE, _marlin_servo, circles_by=""),
    "urscript": Post("URScript for Universal Robots", (".script",), _urscript, False, "pose", parted=_urscript_parts),
    "jaka": Post("JAKA script", (".jks",), _jaka, circles_by="pose"),
    "rapid": Post("RAPID for ABB", (".mod",), _rapid, False, "pose", "\r\n"),
    "xarm": Post("Python for UFACTORY xArm", (".py",), _xarm, circles_by=""),
    "krl": Post("KRL for KUKA", (".src",), _krl, False, "pose", "\r\n", parted=_krl_parts),
    "dobot": Post("Lua for Dobot CR and Nova", (".lua",), _dobot, False, "pose"),
    "fanuc": Post("TP for FANUC", (".ls",), _fanuc, False, "pose", "\r\n", True, _fanuc_parts),
    "doosan": Post("DRL for Doosan", (".drl",), _doosan, False, "pose"),
    "ros2": Post(
        "poses with times for ROS 2",
        (".csv", ".traj", ".cdr"),
        _ros2,
        circles_by="",
        others={".traj": _ros2_json, ".cdr": _ros2_message},
    ),
    "ebb": Post("commands for EBB boards (AxiDraw, NextDraw)", (".ebb",), _ebb, circles_by=""),
    "hpgl": Post("HP-GL for pen plotters", (".hpgl", ".plt"), _hpgl, circles_by=""),
    "robodk": Post("what a post of RoboDK's kind writes", (".robodk",), _robodk, False, "pose"),
}
