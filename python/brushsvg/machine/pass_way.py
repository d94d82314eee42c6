"""The same pass on another way."""

from __future__ import annotations

from .. import _core


def on_way(a_pass, poses_mm, arcs):
    """The pass, with all that is said of it, led along other poses (n, 3) and arcs. Error for a tilted one: how the
    brush would be held there is not known."""
    _core.refuse_tilted([a_pass], "a pass is led another way with the brush upright")
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
    )
