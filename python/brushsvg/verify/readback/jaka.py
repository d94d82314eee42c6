"""Read back JAKA scripts that brushsvg wrote."""

from __future__ import annotations

import re

from ...machine.cells.cell import Cell
from ...machine.frames import rotation
from ...machine.posts.jaka import upright_deg
from ...machine.posts.text import PROGRAM_END
from . import Readback
from .script import N, Script, place, read_script

_TURNED = rf"(?P<turned>{N}, {N}, {N})"
_RUN = rf"(?P<speed>{N}), (?P<acceleration>{N})"
_LINES = tuple(
    (kind, re.compile(pattern))
    for kind, pattern in (
        ("sets", rf"to = \[{place('xyz')}, {_TURNED}\]"),
        ("sets", rf"via = \[{place('uvw')}, {_TURNED}\]"),
        ("move", rf"movl\(to, 0, {_RUN}, (?P<blend>{N})\)"),
        ("circle", rf"movc\(via, to, 0, {_RUN}, (?:0+\.?0*|\.0+)\)"),
        ("wait", rf"sleep\((?P<seconds>{N})\)"),
        ("rise", rf"movl\(up, 1, {_RUN}, 0\)"),
        (
            "text",  # the frame around the moves
            rf"set_user_frame_id\(0\)|tool = \[{N}(?:, {N}){{5}}\]|set_tool\(tool\)|here = get_atl_tcp_pose\(\)"
            rf"|if\(here\[2\] < {N}\):|rise = \((?P<height>{N}) - here\[2\]\)|up = \[0, 0, rise, 0, 0, 0\]|end"
            r"|pause\(\)",
        ),
    )
)


def read_jaka(text: str, cell: Cell) -> Readback:
    """Read a JAKA script as steps in the robot frame.

    Raises Error with the line for a statement that brushsvg does not write.
    """
    turned = tuple(upright_deg(cell).tolist())
    script = Script("# ", _LINES, re.compile(r"set_|\w+ = "), (f"# {PROGRAM_END}",), {}, turned, rotation=rotation)
    return read_script(text, script, Readback())
