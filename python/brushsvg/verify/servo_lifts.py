"""Undo the steps of a servo in a program that was read back.

The result has paths and lifts as planned.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from .. import _core
from ..machine.moves import Program
from .readback import Act


def remove_servo_steps(a_pass, lines: np.ndarray, rests: np.ndarray | None):
    """Return a servo's pass without the steps of its heights.

    Poses that only begin a path are removed, and all steps of a lift on the spot become one pose. Where the servo rests
    at no pose of the last lift, this lift leaves the paper. Only its last pose is kept, as the end of the last path.
    rests: (n,) whether the servo rests at each pose; None for a servo that is never waited for.
    """
    goes = np.diff(np.asarray(a_pass.poses_mm)[:, :2], axis=0).any(axis=1)
    is_off = rests is not None and not rests[1:][np.flatnonzero(np.r_[True, goes])[-1] :].any()
    poses, is_kept = np.array(a_pass.poses_mm), np.r_[lines[1:] != lines[:-1], True]
    if not is_kept[0]:
        # The brush landed on the first path, without a last step: where it starts, the brush just touches.
        is_kept[0], poses[0, 2] = True, 0.0
    at_rest = np.zeros(len(poses), dtype=bool) if rests is None else rests
    poses, at_rest = poses[is_kept], at_rest[is_kept]
    is_new = np.r_[True, np.diff(poses, axis=0).any(axis=1)]
    poses, at_rest = poses[is_new], at_rest[is_new]
    steps = np.diff(poses, axis=0)
    still, rising = ~steps[:, :2].any(axis=1), np.sign(steps[:, 2])
    inner = np.zeros(len(poses), dtype=bool)
    inner[1:-1] = still[:-1] & still[1:] & (rising[:-1] == rising[1:]) & ~at_rest[1:-1]
    if len(still) > 1 and still[-1] and is_off:
        held = np.flatnonzero(np.r_[True, ~still])[-1]  # where the last path ends
        inner[held:-1] = held > 0
    return _core.Pass(a_pass.stroke, poses[~inner], a_pass.speed_mm_s)


def join_lifts(acts: list[Act]) -> list[Act]:
    """Join all that a servo does at one place into one lift.

    The `same` of a lift holds its last value, the sum of its waits [s], and its least and greatest value, including the
    value at which it begins. The `text` of a lift is IN_PAINT_TEXT where it begins in the paint.
    """
    out: list[Act] = []
    value, place = 0.0, ()
    up = _safe_value(acts)
    for act in acts:
        last = out[-1] if out else None
        if act.kind == "way":
            if (act.place, act.same[0]) == (place, value):
                continue
            value, place = act.same[0], act.place
        elif act.kind in ("lift", "wait"):
            is_on = bool(last) and last.kind == "way" and value != up
            if last and last.kind == "lift":
                is_on, before = bool(last.text), out.pop().same
            else:
                before = (value, 0.0, value, value)
            value = act.same[0] if act.kind == "lift" else value
            waited_s = act.same[0] if act.kind == "wait" else 0.0
            same = (value, before[1] + waited_s, min(before[2], value), max(before[3], value))
            act = act._replace(kind="lift", text=IN_PAINT_TEXT * is_on, place=place, same=same)
        out.append(act)
    return out


IN_PAINT_TEXT = "in paint"


def _safe_value(acts: list[Act]) -> float | None:
    """Return the servo value at which the brush is safe. This is the value of the first lift, None without lifts."""
    return next((act.same[0] for act in acts if act.kind == "lift"), None)


def drop_rounding_lifts(
    ours: list[Act],
    theirs: list[Act],
    is_rounding_lift: Callable[[Act], bool],
    is_same: Callable[[Act, Act], bool],
) -> tuple[list[Act], list[Act]]:
    """Return the acts of two programs without lifts that rounding explains.

    Only lifts in paint that one program alone has are dropped. is_rounding_lift: whether rounding alone explains a
    lift; is_same: whether two lifts are the same.
    """
    lift_rows = [[k for k, act in enumerate(acts) if act.kind == "lift"] for acts in (ours, theirs)]
    dropped: tuple[set, set] = (set(), set())
    at = [0, 0]
    while at[0] < len(lift_rows[0]) and at[1] < len(lift_rows[1]):
        rows = [lift_rows[side][at[side]] for side in (0, 1)]
        a, b = ours[rows[0]], theirs[rows[1]]
        side = next((side for side, act in enumerate((a, b)) if is_rounding_lift(act)), None)
        if is_same(a, b):
            at = [at[0] + 1, at[1] + 1]
        elif side is not None:
            dropped[side].add(rows[side])
            at[side] += 1
        else:
            break
    return tuple(
        [act for k, act in enumerate(acts) if k not in rows_dropped]
        for acts, rows_dropped in zip((ours, theirs), dropped, strict=True)
    )


def join_paths(acts: list[Act]) -> list[Act]:
    """Join consecutive paths of a servo in the paint into the last of them.

    The speed limit of a stroke is checked on its path itself, so acts in a stroke lose it here.
    """
    out: list[Act] = []
    in_stroke, up = False, _safe_value(acts)
    for act in acts:
        last = out[-1] if out else None
        if act.kind == "way":
            value = act.same[0]
            if last and last.kind == "way" and up not in (value, last.same[0]):
                most = () if in_stroke else (max(act.at_most[0], last.at_most[0]),)
                out[-1] = act._replace(at_most=most)
                continue
            act = act._replace(at_most=()) if in_stroke and value != up else act
        elif act.kind == "text":
            in_stroke = in_stroke if act.text[:1] != "(" else act.text.startswith("(stroke")
        out.append(act)
    return out


def projected_length_mm(program: Program) -> float:
    """Return the length [mm] of the tool's path, projected onto the paper."""
    total_mm, here = 0.0, None
    for move in (move for section in program.sections() for move in section.moves):
        if move.meaning == "paint":
            steps = np.diff(np.vstack([here, move.points_mm])[:, :2], axis=0)
            total_mm += float(np.linalg.norm(steps, axis=1).sum())
        here = move.points_mm[-1]
    return total_mm
