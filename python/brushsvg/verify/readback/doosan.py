"""Read back DRL programs for Doosan that brushsvg wrote."""

from __future__ import annotations

import ast
import itertools
import math
import re

import numpy as np

from ...errors import Error
from ...machine.cells.cell import Cell
from ...machine.frames import rotation, zyz_deg
from ...machine.posts.doosan import CHECKS, STOPS
from ...machine.posts.script import upright_tool_rotation
from ...machine.posts.text import PROGRAM_END
from . import Act, Readback
from .script import N, Script, read_script
from .xarm import refuse_other_encoding


def _point(names: str) -> str:
    return rf"on_paper\({', '.join(f'(?P<{name}>{N})' for name in names)}\)"


_FIXED = "|".join(re.escape(line) for line in (CHECKS + STOPS).splitlines())
_TURN_SPEED = r"(?=[\d.]*[1-9])\d+\.?\d*"  # degrees/s; with 0 or less the script stops
_LINES = tuple(
    (kind, re.compile(pattern))
    for kind, pattern in (
        ("move", rf"movel\({_point('xyz')}(?:, radius=(?P<blend>{N}))?\)"),
        (
            "move",
            rf"movel\(tilted\({', '.join(f'(?P<{name}>{N})' for name in 'xyz')}, (?P<turned>{N}, {N}, {N})\)"
            rf"(?:, radius=(?P<blend>{N}))?\)",
        ),
        ("sets", rf"set_velx\((?P<speed>{N}), {_TURN_SPEED}\)"),
        ("circle", rf"movec\({_point('uvw')}, {_point('xyz')}\)"),
        ("wait", rf"wait\((?P<seconds>{N})\)"),
        ("rise", r"    movel\(here\)"),
        ("sets", rf"set_accx\((?P<acceleration>{N}), {_TURN_SPEED}\)"),
        ("text", rf"if here\[2\] < (?P<height>{N}):|    here\[2\] = {N}"),
        (
            "text",
            rf"here = get_current_posx\(paper\)\[0\]|if abs\(tip_mm - {N}\) > {N}:|def on_paper\(x, y, z\):",
        ),
        ("text", r"def tilted\(x, y, z, a, b, c\):|    return posx\(x, y, z, a, b, c\)"),
        ("text", rf"    return posx\(x, y, z, (?P<turned>{N}, {N}, {N})\)"),
        (
            "text",
            rf"paper = set_user_cart_coord\(posx\({N}(?:, {N}){{5}}\), ref=DR_BASE\)|set_ref_coord\(paper\)",
        ),
        ("text", rf"tp_popup\(\"[^\"\\]*\", DR_PM_MESSAGE, 1\)|{_FIXED}"),
    )
)


_QUERY_MINUS_ZERO = re.compile(r"(?m)^((?:tip|here) = get_current_posx\(\w+\))\[-0\]")


def _rotation_from_zyz_deg(abc: list[float]) -> np.ndarray:
    """Return the rotation (3, 3) for angles [degrees] about z, the new y and the newest z."""
    a, b, c = abc
    return rotation((0, 0, a)) @ rotation((0, b, 0)) @ rotation((0, 0, c))


def read_doosan(text: str, cell: Cell) -> Readback:
    """Read a DRL program as steps in the paper frame.

    Raises Error with the line for a statement that brushsvg does not write.
    """
    refuse_other_encoding(text)
    try:
        ast.parse(text)
    except (SyntaxError, ValueError) as mistake:
        at = getattr(mistake, "lineno", None) or 1
        raise Error(
            f"line {at}: this is not DRL, which has the syntax of Python: {mistake}", code="line-unread"
        ) from None
    script = Script(
        remark="# ",
        lines=_LINES,
        again=re.compile(r"set_|paper|tip|flange|here|    (?:here|exit)"),
        last=(f"# {PROGRAM_END}",),
        units_mm={},
        turned_deg=tuple(zyz_deg(upright_tool_rotation(cell.tool.spin_deg)).tolist()),
        is_indented=True,
        rotation=_rotation_from_zyz_deg,
    )
    text = _QUERY_MINUS_ZERO.sub(r"\1[0]", text)  # -0 and 0 are the same index in Python
    out = read_script(text, script, Readback(in_paper_frame=True, blends_by_radius=True))
    out.acts = _move_tip_query_first(_move_function_first(out.acts))
    steps = [step for section in out.sections for step in section.steps]
    for before, step in itertools.pairwise(steps):
        if 2 * step.blend_mm > math.dist(before[2:5], step[2:5]):
            sentence = f"line {step.line}: a blend of {step.blend_mm:g} mm begins before the middle of its way"
            raise Error(sentence, code="line-unread")
    return out


def _move_function_first(acts: list[Act]) -> list[Act]:
    """Move a function definition before the settings. Their order has no effect until something moves."""
    name = next((k for k, act in enumerate(acts) if act.text.startswith("def ")), None)
    if name is None or any(act.kind != "text" for act in acts[:name]):
        return acts
    function = acts[name : name + 2]
    return [*function, *acts[:name], *acts[name + 2 :]]


def _move_tip_query_first(acts: list[Act]) -> list[Act]:
    """Put the query of the tip before the query of the flange. Their order has no effect."""
    for k, act in enumerate(acts[1:], 1):
        if act.text.startswith("tip =") and acts[k - 1].text.startswith("flange ="):
            return [*acts[: k - 1], act, acts[k - 1], *acts[k + 1 :]]
    return acts
