"""Read back RAPID that brushsvg wrote."""

from __future__ import annotations

import re

import numpy as np

from ...machine.cells.cell import Cell
from ...machine.cells.language_limits import LEAST_ACCELERATION_MM_S2
from ...machine.frames import of_quaternion
from ...machine.posts.text import PROGRAM_END
from . import Readback
from .script import N, Script, place, read_script

_NUMBERS = rf"(?:{N}|9e9)(?:, (?:{N}|9e9))*"
_MOVE = rf"mm_s\((?P<speed>{N})\), "
_TOOL_AND_FRAME = r"brush\\wobj:=paper;"
_FRAME = (  # the lines around the moves, in lower case
    r"(?:end)?(?:module|proc|func|if)|module brushsvg|proc paint\(\)|stop;|confl \\off;|return fine;",
    rf"local pers tooldata brush := \[true, \[\[{_NUMBERS}\], \[{_NUMBERS}\]\], "
    rf"\[{N}, \[{_NUMBERS}\], \[{_NUMBERS}\], {_NUMBERS}\]\];",
    rf'local pers wobjdata paper := \[false, true, "", \[\[{_NUMBERS}\], \[{_NUMBERS}\]\], '
    rf"\[\[{_NUMBERS}\], \[{_NUMBERS}\]\]\];",
    r"func robtarget tilted\(num x, num y, num z, num q1, num q2, num q3, num q4\)",
    rf"return \[\[x, y, z\], \[q1, q2, q3, q4\], \[{_NUMBERS}\], \[{_NUMBERS}\]\];",
    r"local var robtarget here;|func robtarget on_paper\(num x, num y, num z\)",
    rf"return \[\[x, y, z\], \[{_NUMBERS}\], \[{_NUMBERS}\], \[{_NUMBERS}\]\];",
    r"func speeddata mm_s\(num speed\)|return \[speed, 500, 5000, 1000\];",
    r"func zonedata within\(num radius\)|if radius = 0 then",
    r"return \[false, radius, radius, radius, 0\.1, radius, 0\.1\];",
    r'here := crobt\(\\tool:=brush \\wobj:=paper\);|tpwrite "[^"\\]*";',
    rf"if here\.trans\.z < (?P<height>{N}) then|here\.trans\.z := {N};",
)
QUATERNION_LENGTH_TOLERANCE = 1e-3  # deviation from length 1 above which the controller refuses a quaternion


def _rotation(wxyz: list[float]) -> np.ndarray | None:
    size = float(np.linalg.norm(wxyz))
    return of_quaternion(np.array(wxyz) / size) if abs(size - 1) <= QUATERNION_LENGTH_TOLERANCE else None


_SCRIPT = Script(
    remark="! ",
    lines=tuple(
        (kind, re.compile(pattern))
        for kind, pattern in (
            (
                "move",
                rf"movel tilted\({place('xyz')}, (?P<turned>{N}(?:, {N}){{3}})\), {_MOVE}"
                rf"(?:within\((?P<blend>{N})\)|fine), {_TOOL_AND_FRAME}",
            ),
            (
                "move",
                rf"movel on_paper\({place('xyz')}\), {_MOVE}(?:within\((?P<blend>{N})\)|fine), {_TOOL_AND_FRAME}",
            ),
            (
                "circle",
                rf"movec on_paper\({place('uvw')}\), on_paper\({place('xyz')}\), {_MOVE}fine, {_TOOL_AND_FRAME}",
            ),
            ("wait", rf"waittime \\inpos, (?P<seconds>{N});"),
            ("rise", rf"movel here, {_MOVE}fine, {_TOOL_AND_FRAME}"),
            ("most", rf"pathacclim true \\accmax:=(?P<more>{N}), true \\decelmax:=(?P<less>{N});"),
            ("text", "|".join(_FRAME)),
        )
    ),
    again=re.compile(r"confl|here := crobt|here\.trans|return"),
    last=(f"! {PROGRAM_END}", "ENDPROC", "ENDMODULE"),
    units_mm={"more": 1e3, "less": 1e3},
    least=LEAST_ACCELERATION_MM_S2["rapid"],
    any_case=True,
    either_way=r"confl \off;",
    rotation=_rotation,
)


def read_rapid(text: str, _cell: Cell) -> Readback:
    """Read a RAPID program as steps in the paper frame.

    Raises Error with the line for a statement that brushsvg does not write.
    """
    return read_script(text, _SCRIPT, Readback(in_paper_frame=True, blends_by_radius=True))
