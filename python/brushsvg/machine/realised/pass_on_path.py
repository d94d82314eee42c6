"""Move a pass to another path."""

from __future__ import annotations

from ... import _core


def move_pass_to_path(a_pass, poses_mm, arcs, tool_axes=None):
    """Move a pass with all its settings to other poses (n, 3) and arcs.

    tool_axes: (n, 3) the brush's axes at the poses. If they are None, a pass with a tilted brush raises Error.
    """
    if tool_axes is None:
        _core.refuse_tilted([a_pass], "a pass is moved to another path only with the brush upright")
    return _core.Pass(
        a_pass.origin,
        poses_mm,
        a_pass.speed_mm_s,
        a_pass.layer,
        a_pass.colour,
        a_pass.settings,
        a_pass.extra,
        arcs,
        a_pass.load,
        () if tool_axes is None else tool_axes,
    )
