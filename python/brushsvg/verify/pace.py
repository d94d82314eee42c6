"""Where a program that says when the tool is where stands still in the paint."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from ..errors import Notice
from ..machine.motion import Program
from ..machine.posts import POSTS
from ..machine.posts.gcode_servo import height_at
from ..machine.writer import text_of
from .readback import Act, Readback, read_program

TIMED = ("ebb", "ros2")  # languages whose lines say how long they take; others say how fast they are at most
FASTER_MM_S = 0.011  # of a speed that is written in steps of 0.01
STANDS_S = 0.01  # rounded places and times make up to 0.003 s of a part's time


def stops(read: Readback, program: Program) -> list[Notice]:
    """A notice for the first part of a stroke that takes longer than the rest of it does.

    read: the program that was read; program: what brushsvg would write. A stroke may be slower as a whole: its parts
    are held against the median of how much slower they are. What is faster than the brush may touch is in the air.
    """
    language, touching_mm_s = program.cell.language, program.touching_mm_s
    if language not in TIMED:
        return []
    text = "".join(text_of(POSTS[language], program))
    found, expected = read.acts, read_program(text, POSTS[language].extensions[0], program.cell).acts
    for (name, ours), (_, theirs) in zip(
        _strokes(found, touching_mm_s), _strokes(expected, touching_mm_s), strict=False
    ):
        (along, when_s), (expected_mm, expected_s) = _times(ours), _times(theirs)
        if not (along[-1:] > 0 and expected_mm[-1:] > 0):
            continue
        at_mm = along / along[-1] * expected_mm[-1]
        least_s = np.diff(np.interp(at_mm, expected_mm, expected_s))
        took_s = np.diff(when_s)
        slower = max(1.0, float(np.median(took_s[least_s > 0] / least_s[least_s > 0])))
        # paths of other length have their corners elsewhere by as much
        off_mm = abs(along[-1] - expected_mm[-1])
        most_s = np.interp(at_mm[1:] + off_mm, expected_mm, expected_s) - np.interp(
            at_mm[:-1] - off_mm, expected_mm, expected_s
        )
        if language == "ebb":
            most_s = np.maximum(most_s, _with_lift_s(ours, np.diff(along), program))
        late_s = took_s - slower * most_s
        if late_s[worst := int(late_s.argmax())] > STANDS_S:
            sentence = (
                f"line {ours[worst + 1].line}: the brush stands still in the paint for {late_s[worst]:.3f} s"
            )
            return [Notice(name, sentence, code="stands-in-paint")]
    return []


def _with_lift_s(acts: list[Act], ways_mm: np.ndarray, program: Program) -> np.ndarray:
    """The time [s] of each part along which the servo lifts or lowers the brush as much as its program may mean.

    A part has one value of the servo, that of its middle. How far the height changes along it is not in the program:
    at most from the middle of the part before to that of the next. Over this way the tip is as fast as it may be.
    """
    heights_mm = np.array([height_at(program.cell.servo, act.same[0]) for act in acts])
    steps_mm = np.abs(np.diff(heights_mm, append=heights_mm[-1]))
    return np.hypot(ways_mm, steps_mm[:-1] + steps_mm[1:]) / program.touching_mm_s


def _strokes(acts: list[Act], touching_mm_s: float) -> list[tuple[str, list[Act]]]:
    """The name of each stroke, and the acts that say when it is where on the paper."""
    found: list[tuple[str, list[Act]]] = []
    is_stroke = False
    for act in acts:
        if act.kind == "text" and act.text.startswith("("):
            is_stroke = act.text.startswith("(stroke ")
            if is_stroke:
                found.append((act.text.strip("()").partition(": ")[2], []))
        elif is_stroke and act.kind in ("way", "move") and act.at_most[0] <= touching_mm_s + FASTER_MM_S:
            found[-1][1].append(act)
    return found


def _times(acts: list[Act]) -> tuple[np.ndarray, np.ndarray]:
    """How far along a stroke [mm], and when [s], each act ends; from where the first one does."""
    ways_mm = np.array([np.linalg.norm(np.subtract(b.place, a.place)) for a, b in pairwise(acts)])
    speeds = np.array([act.at_most[1] for act in acts[1:]])
    took_s = np.divide(ways_mm, speeds, out=np.zeros(len(ways_mm)), where=speeds > 0)
    return np.r_[0.0, np.cumsum(ways_mm)], np.r_[0.0, np.cumsum(took_s)]
