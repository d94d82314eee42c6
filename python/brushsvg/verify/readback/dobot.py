"""Read back Lua programs for Dobot that brushsvg wrote."""

from __future__ import annotations

import re

from ...errors import Error
from ...machine.cells.cell import Cell
from ...machine.frames import rotation, rotation_deg
from ...machine.posts.dobot import INDEX
from ...machine.posts.script import upright_tool_rotation
from ...machine.posts.text import PROGRAM_END
from . import Act, Readback
from .script import Script, read_script

N = r"-?(?:\d+\.?\d*|\.\d+)"  # Lua has no plus sign before a number
_WHOLE = r"\d+"


def _point(names: str) -> str:
    return rf"on_paper\({', '.join(f'(?P<{name}>{N})' for name in names)}\)"


_FRAME = rf"\{{{N}(?:, {N}){{5}}\}}"
_SPEED = rf"speed = (?P<speed>{_WHOLE})"
_LINES = tuple(
    (kind, re.compile(pattern))
    for kind, pattern in (
        ("move", rf"MovL\({_point('xyz')}, \{{{_SPEED}(?:, r = (?P<blend>{N}))?\}}\)"),
        (
            "move",
            rf"MovL\(tilted\({', '.join(f'(?P<{name}>{N})' for name in 'xyz')}, (?P<turned>{N}, {N}, {N})\), "
            rf"\{{{_SPEED}(?:, r = (?P<blend>{N}))?\}}\)",
        ),
        ("circle", rf"Arc\({_point('uvw')}, {_point('xyz')}, \{{{_SPEED}\}}\)"),
        ("wait", rf"Wait\((?P<seconds>{_WHOLE})\)"),
        ("rise", rf"MovL\(\{{pose = here\}}, \{{{_SPEED}\}}\)"),
        ("text", rf"if here\[3\] < (?P<height>{N}) then|here\[3\] = {N}|end|Pause\(\)|print\(\"[^\"\\]*\"\)"),
        ("text", rf"here = GetPose\({INDEX}, {INDEX}\)\.pose|function on_paper\(x, y, z\)"),
        ("text", r"function tilted\(x, y, z, rx, ry, rz\)|return \{pose = \{x, y, z, rx, ry, rz\}\}"),
        ("text", rf"return \{{pose = \{{x, y, z, (?P<turned>{N}, {N}, {N})\}}\}}"),
        ("text", rf"Set(?:User|Tool)\({INDEX}, {_FRAME}\)|(?:User|Tool)\({INDEX}\)|CP\(-?0\)"),
    )
)


_SETTING = re.compile(r"SetUser\(|User\(|SetTool\(|Tool\(")
_PREPARATION = re.compile(rf"{_SETTING.pattern}|\(|function |return |end")


def read_dobot(text: str, cell: Cell) -> Readback:
    """Read a Dobot program as steps in the paper frame.

    Raises Error with the line for a statement that brushsvg does not write.
    """
    script = Script(
        remark="-- ",
        lines=_LINES,
        again=re.compile(r"Set|User|Tool|CP|here"),
        last=(f"-- {PROGRAM_END}",),
        units_mm={"seconds": 1e-3},
        turned_deg=tuple(rotation_deg(upright_tool_rotation(cell.tool.spin_deg)).tolist()),
        rotation=rotation,
    )
    out = read_script(text, script, Readback(in_paper_frame=True, blends_by_radius=True))
    out.acts = _sort_settings(_drop_default_settings(out.acts))
    return out


def _drop_default_settings(acts: list[Act]) -> list[Act]:
    """Drop statements that only set the default.

    Raises Error with the line for such a statement in the function, because in Lua nothing may follow a `return`.
    """
    out, in_function = [], False
    for act in acts:
        in_function = act.text.startswith("function ") or (in_function and act.text != "end")
        is_default = act.text in ("CP(0)", "CP(-0)")
        if is_default and in_function:
            raise Error(f"line {act.line}: {act.text!r} stands in the function", code="line-unread")
        if not is_default:
            out.append(act)
    return out


def _sort_settings(acts: list[Act]) -> list[Act]:
    """Sort the settings before the first move, without repetitions.

    The order of settings has no effect. Raises Error where a frame is changed after it was chosen, since the manual
    does not define the effect.
    """
    ready = next((k for k, act in enumerate(acts) if not _PREPARATION.match(act.text)), len(acts))
    head = acts[:ready]
    settings = [act for act in head if _SETTING.match(act.text)]
    for changes, chooses in (("SetUser(", "User("), ("SetTool(", "Tool(")):
        chosen = min((act.line for act in settings if act.text.startswith(chooses)), default=None)
        for act in settings:
            if act.text.startswith(changes) and chosen and act.line > chosen:
                sentence = f"line {act.line}: {act.text[:60]!r} changes a frame that was chosen before"
                raise Error(sentence, code="line-unread")
    if _has_setting_in_function(head):
        return acts
    unique = {act.text: act for act in settings}.values()
    remarks = [act for act in head if act.text.startswith("(")]
    rest = [act for act in head if act not in settings and act not in remarks]
    return [*sorted(unique, key=lambda act: act.text), *remarks, *rest, *acts[ready:]]


def _has_setting_in_function(head: list[Act]) -> bool:
    """Return whether a setting is inside a function. A function runs only when it is called."""
    lines = [act.text for act in head if not act.text.startswith("(")]
    first = next((k for k, line in enumerate(lines) if line.startswith("function")), len(lines))
    last = next((k for k, line in enumerate(lines) if k > first and line == "end"), len(lines))
    return any(_SETTING.match(line) for line in lines[first:last])
