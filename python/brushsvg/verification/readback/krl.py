"""KRL as brushsvg writes it, read back."""

from __future__ import annotations

import re

from ...machine.cell import Cell
from ...machine.frames import rotation, rotation_deg
from ...machine.posts.krl import KRL_END
from ...machine.posts.script import down
from . import Readback
from .script import N, Script, read_script


def _point(names: str, turned: str) -> str:
    x, y, z = (f"{axis} (?P<{name}>{N})" for axis, name in zip("xyz", names, strict=True))
    return rf"\{{{x}, {y}, {z}, {turned}\}}"


_TURN = rf"a {N}, b {N}, c {N}"
_TO = _point("xyz", f"(?P<turned>{_TURN})")
_VIA = _point("uvw", f"(?P<turned_via>{_TURN})")
_FRAME = rf"\{{x {N}, y {N}, z {N}, {_TURN}\}}"
_LINES = tuple(  # in small letters
    (kind, re.compile(pattern))
    for kind, pattern in (
        ("blended", rf"lin {_TO} c_dis"),
        ("sets", rf"\$apo\.cdis = (?P<blend>{N})"),
        ("move", rf"lin {_TO}"),
        ("sets", rf"\$vel\.cp = (?P<speed>{N})"),
        ("circle", rf"circ {_VIA}, {_TO}"),
        ("wait", rf"wait sec (?P<seconds>{N})"),
        ("rise", r"lin here"),
        ("sets", rf"\$acc\.cp = (?P<acceleration>{N})"),
        ("text", rf"if here\.z < (?P<height>{N}) then|here\.z = {N}|here = \$pos_act|endif|halt"),
        (
            "text",
            rf"def brushsvg\(\)|decl e6pos here|end|\$(?:tool|base) = {_FRAME}",
        ),
        ("text", r"bas\(#initmov, 0\)|ptp \$axis_act|\$ori_type = #var"),
    )
)
_READY = "bas(#initmov, 0)"  # which sets all of them


def read_krl(text: str, cell: Cell) -> Readback:
    """The program as steps in the paper's frame. Error with the line for what brushsvg does not write."""
    script = Script(
        remark="; ",
        lines=_LINES,
        again=re.compile(r"\$|bas\(|ptp|here"),
        last=(f"; {KRL_END}", "END"),
        units_mm={"speed": 1e3, "acceleration": 1e3},
        sets_after=_READY,
        turned_deg=tuple(rotation_deg(down(cell.tool.spin_deg))[::-1].tolist()),
        any_case=True,
        rotation=lambda abc: rotation(abc[::-1]),
    )
    return read_script(text, script, Readback(in_paper_frame=True, blends_by_radius=True))
