"""Posts: one robot language per file. POSTS lists all of them."""

from __future__ import annotations

import importlib
from collections.abc import Iterator, Mapping
from types import MappingProxyType, ModuleType
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from ..cells.cell import Cell
    from ..moves import Program


class Post(NamedTuple):
    """A robot language and the function that writes it.

    title: name of the language for people.
    extensions: extensions of its files.
    source: "module.function" of the function that writes a program. The module is imported on use.
    in_robot_frame: whether points are in the robot's frame. Otherwise they are in the paper's frame, which the program
        then defines.
    circles_by: how a circle is defined: by its "centre" or by a "pose" on it; "" if circles are run as lines. For a
        firmware that divides circles into lines, the cell gives the length of the lines, or 0 if no circles are
        written. See the function circles_by.
    line_end: line ending of the controller's own files.
    has_tabs: whether the controller's own files have tabs.
    parted: whether a long job has several files. The module then has the functions `programs` and `called`.
    others: sources of the functions that write files of other extensions in another way.
    """

    title: str
    extensions: tuple[str, ...]
    source: str
    in_robot_frame: bool = True
    circles_by: str = "centre"
    line_end: str = "\n"
    has_tabs: bool = False
    parted: bool = False
    others: Mapping[str, str] = MappingProxyType({})

    def write(self, program: Program, extension: str = "") -> Iterator:
        """Return the program as successive pieces of 7-bit text, or of bytes where the file is binary."""
        source = self.others.get(extension, self.source)
        return getattr(_module_of(source), source.partition(".")[2])(program)

    def programs(self, text: str) -> dict[str, str]:
        """Return the texts of a job's files, keyed by file name.

        The name of the requested file is "". A name that begins with "-" is appended to the requested file's name.
        """
        return _module_of(self.source).programs(text) if self.parted else {"": text}

    def controller_name(self, name: str) -> str:
        """Return the name that the controller gives a program, or the same name if the language has no names."""
        return getattr(_module_of(self.source), "controller_name", str)(name)

    def name_in(self, text: str) -> str:
        """Return the name of a program in its text, or "" if the language has no names."""
        return getattr(_module_of(self.source), "name_in", lambda text: "")(text)

    def called(self, text: str) -> list[str]:
        """Return the names of the files with which a program continues."""
        return _module_of(self.source).called(text) if self.parted else []


def _module_of(source: str) -> ModuleType:
    return importlib.import_module(f".{source.partition('.')[0]}", __name__)


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
    from ..cells.language_limits import ARCS_IN_SEGMENTS

    post = POSTS.get(cell.language)
    if cell.language in ARCS_IN_SEGMENTS and not cell.arc_segment_mm:
        return ""
    return post.circles_by if post else "centre"


GCODE = (".ngc", ".gcode", ".nc")
POSTS = {  # by the language that a cell names
    "linuxcnc": Post("G-code for LinuxCNC", GCODE, "gcode.linuxcnc"),
    "grbl": Post("G-code for grbl", GCODE, "gcode.gcode"),
    "fluidnc": Post("G-code for FluidNC", GCODE, "gcode.gcode"),
    "marlin": Post("G-code for Marlin", GCODE, "gcode.gcode"),
    "klipper": Post("G-code for Klipper", GCODE, "gcode.gcode"),
    "grbl-servo": Post("G-code for grbl, the brush on a servo", GCODE, "gcode_servo.grbl_servo", circles_by=""),
    "marlin-servo": Post("G-code for Marlin, a pen on a servo", GCODE, "gcode_pen.marlin_servo", circles_by=""),
    "urscript": Post("URScript for Universal Robots", (".script",), "urscript.urscript", False, "pose", parted=True),
    "jaka": Post("JAKA script", (".jks",), "jaka.jaka", circles_by="pose"),
    "rapid": Post("RAPID for ABB", (".mod",), "rapid.rapid", False, "pose", "\r\n"),
    "xarm": Post("Python for UFACTORY xArm", (".py",), "xarm.xarm", circles_by=""),
    "krl": Post("KRL for KUKA", (".src",), "krl.krl", False, "pose", "\r\n", parted=True),
    "dobot": Post("Lua for Dobot CR and Nova", (".lua",), "dobot.dobot", False, "pose"),
    "fanuc": Post("TP for FANUC", (".ls",), "fanuc.fanuc", False, "pose", "\r\n", True, True),
    "doosan": Post("DRL for Doosan", (".drl",), "doosan.doosan", False, "pose"),
    "ros2": Post(
        "poses with times for ROS 2",
        (".csv", ".traj", ".cdr"),
        "ros2.csv",
        circles_by="",
        others={".traj": "ros2.traj", ".cdr": "ros2.cdr"},
    ),
    "ebb": Post("commands for EBB boards (AxiDraw, NextDraw)", (".ebb",), "ebb.ebb", circles_by=""),
    "hpgl": Post("HP-GL for pen plotters", (".hpgl", ".plt"), "hpgl.hpgl", circles_by=""),
    "robodk": Post("the output of a RoboDK post", (".robodk",), "robodk.robodk", False, "pose"),
}
