"""Undo the steps of a servo in a program that was read: ways and lifts as planned."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from .. import _core
from ..machine.motion import Program
from .readback import Act


def without_steps(a_pass, lines: np.ndarray, rests: np.ndarray | None):
    """A servo's pass without the poses with which its ways begin, and with one pose for all steps of a lift alone.
    Where the servo rests at no pose of the last lift, that is the one off the paper, next to which its last way was
    held. rests: at which poses; None for one that is never waited for.
    """
    goes = np.diff(np.asarray(a_pass.poses_mm)[:, :2], axis=0).any(axis=1)
    is_off = rests is not None and not rests[1:][np.flatnonzero(np.r_[True, goes])[-1] :].any()
    poses, is_kept = np.array(a_pass.poses_mm), np.r_[lines[1:] != lines[:-1], True]
    if not is_kept[0]:
        # landed on the first way, without the last step: where it starts, the brush just touches
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
        held = np.flatnonzero(np.r_[True, ~still])[-1]  # where the last way ends
        inner[held:-1] = held > 0
    return _core.Pass(a_pass.stroke, poses[~inner], a_pass.speed_mm_s)


def as_lifts(acts: list[Act]) -> list[Act]:
    """A servo's acts: all that it does at one place as one lift: its last value, what is waited in all, its least and
    its greatest value, the one that it begins with among them. Its text marks one that begins in paint."""
    out: list[Act] = []
    value, place = 0.0, ()
    up = _up(acts)
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
            act = act._replace(kind="lift", text=IN_PAINT * is_on, place=place, same=same)
        out.append(act)
    return out


IN_PAINT = "in paint"


def _up(acts: list[Act]) -> float | None:
    """The value at which a servo's brush is safe: that of its first lift."""
    return next((act.same[0] for act in acts if act.kind == "lift"), None)


def without_none(
    ours: list[Act], theirs: list[Act], is_none: Callable[[Act], bool], is_same: Callable[[Act, Act], bool]
) -> tuple[list[Act], list[Act]]:
    """Two programs' acts with lifts, without those lifts in paint that are none and that only one of both has."""
    stops = [[k for k, act in enumerate(acts) if act.kind == "lift"] for acts in (ours, theirs)]
    lost: tuple[set, set] = (set(), set())
    at = [0, 0]
    while at[0] < len(stops[0]) and at[1] < len(stops[1]):
        rows = [stops[side][at[side]] for side in (0, 1)]
        a, b = ours[rows[0]], theirs[rows[1]]
        side = next((side for side, act in enumerate((a, b)) if is_none(act)), None)
        if is_same(a, b):
            at = [at[0] + 1, at[1] + 1]
        elif side is not None:
            lost[side].add(rows[side])
            at[side] += 1
        else:
            break
    return tuple(
        [act for k, act in enumerate(acts) if k not in gone]
        for acts, gone in zip((ours, theirs), lost, strict=True)
    )


def as_ways(acts: list[Act]) -> list[Act]:
    """Join a servo's acts: ways in paint that follow each other become the last one. The limit of a stroke's speed
    comes from the way itself."""
    out: list[Act] = []
    in_stroke, up = False, _up(acts)
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


def seen_from_above_mm(program: Program) -> float:
    """Length of the tool's way on the paper, its heights left out."""
    total_mm, here = 0.0, None
    for move in (move for section in program.sections() for move in section.moves):
        if move.meaning == "paint":
            steps = np.diff(np.vstack([here, move.points_mm])[:, :2], axis=0)
            total_mm += float(np.linalg.norm(steps, axis=1).sum())
        here = move.points_mm[-1]
    return total_mm
