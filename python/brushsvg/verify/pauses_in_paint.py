"""Find pauses in the paint of programs that state durations."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from ..errors import Notice
from ..machine.moves import Program
from ..machine.posts import POSTS
from ..machine.posts.gcode_servo import height_at
from ..machine.writer import text_of
from .readback import Act, Readback, read_program

# Languages whose lines state durations; the lines of all others state only maximum speeds.
LANGUAGES_WITH_DURATIONS = ("ebb", "ros2")
SPEED_ROUNDING_MM_S = 0.011  # rounding of a speed that is written in steps of 0.01
MAX_PAUSE_S = 0.01  # rounded places and times change the time of a part by up to 0.003 s


def find_pauses(read: Readback, program: Program) -> list[Notice]:
    """Report the first part of a stroke that is slower than the rest of it.

    read: the program as read back; program: the program that brushsvg would write. A stroke may be slower as a whole,
    so its parts are compared with the median slowdown. Moves faster than the brush may touch are in the air.
    """
    language, touching_mm_s = program.cell.language, program.touching_mm_s
    if language not in LANGUAGES_WITH_DURATIONS:
        return []
    text = "".join(text_of(POSTS[language], program))
    found, expected = read.acts, read_program(text, POSTS[language].extensions[0], program.cell).acts
    for (name, ours), (_, theirs) in zip(
        _moves_by_stroke(found, touching_mm_s), _moves_by_stroke(expected, touching_mm_s), strict=False
    ):
        (along, when_s), (expected_mm, expected_s) = _distances_and_times(ours), _distances_and_times(theirs)
        if not (along[-1:] > 0 and expected_mm[-1:] > 0):
            continue
        along_expected_mm = along / along[-1] * expected_mm[-1]
        least_s = np.diff(np.interp(along_expected_mm, expected_mm, expected_s))
        took_s = np.diff(when_s)
        slower = max(1.0, float(np.median(took_s[least_s > 0] / least_s[least_s > 0])))
        # Where the path lengths differ, corners are displaced by up to the difference.
        off_mm = abs(along[-1] - expected_mm[-1])
        most_s = np.interp(along_expected_mm[1:] + off_mm, expected_mm, expected_s) - np.interp(
            along_expected_mm[:-1] - off_mm, expected_mm, expected_s
        )
        if language == "ebb":
            most_s = np.maximum(most_s, _longest_times_with_lift_s(ours, np.diff(along), program))
        late_s = took_s - slower * most_s
        if late_s[worst := int(late_s.argmax())] > MAX_PAUSE_S:
            sentence = f"line {ours[worst + 1].line}: the brush stands still in the paint for {late_s[worst]:.3f} s"
            return [Notice(name, sentence, code="stands-in-paint")]
    return []


def _longest_times_with_lift_s(acts: list[Act], ways_mm: np.ndarray, program: Program) -> np.ndarray:
    """Return the longest time [s] that each part may take with its possible lift.

    In this time the servo lifts or lowers the brush as far as the program allows. A part has one servo value, the value
    at its middle. The program does not state the change of height along a part: it is at most the change from the
    middle of the previous part to the middle of the next one, or a step of the servo where the brush turns from down to
    up or the stroke ends. The tip is assumed to move over this distance at its maximum speed.

    The lift begins from rest near the place where the brush turns from down to up for the last time. The servo's values
    show this place to within a part, so that part and its neighbours have the time to stop and start again.
    """
    servo = program.cell.servo
    heights_mm = np.array([height_at(servo, act.same[0]) for act in acts])
    rises_mm = np.diff(heights_mm, append=heights_mm[-1])
    before_mm, after_mm = rises_mm[:-1], rises_mm[1:]
    most_mm = np.abs(before_mm) + np.abs(after_mm)
    turns = (before_mm * after_mm <= 0) & (most_mm > 0)
    ways_mm = np.hypot(ways_mm, np.where(turns, np.maximum(most_mm, servo.step_mm), most_mm))
    speed_mm_s, acceleration_mm_s2 = program.touching_mm_s, program.cell.speeds.acceleration_mm_s2
    most_s = ways_mm / speed_mm_s
    braking_s = speed_mm_s / acceleration_mm_s2
    is_short = ways_mm < speed_mm_s * braking_s / 2  # the speed is not reached from rest
    from_rest_s = np.where(is_short, np.sqrt(2 * ways_mm / acceleration_mm_s2), most_s + braking_s / 2)
    for last in np.flatnonzero((before_mm <= 0) & (after_mm > 0))[-1:]:
        near = slice(max(last - 1, 0), last + 2)
        most_s[near] = from_rest_s[near]
    return most_s


def _moves_by_stroke(acts: list[Act], touching_mm_s: float) -> list[tuple[str, list[Act]]]:
    """Return the name of each stroke, and its moves on the paper."""
    found: list[tuple[str, list[Act]]] = []
    is_stroke = False
    for act in acts:
        if act.kind == "text" and act.text.startswith("("):
            is_stroke = act.text.startswith("(stroke ")
            if is_stroke:
                found.append((act.text.strip("()").partition(": ")[2], []))
        elif is_stroke and act.kind in ("way", "move") and act.at_most[0] <= touching_mm_s + SPEED_ROUNDING_MM_S:
            found[-1][1].append(act)
    return found


def _distances_and_times(acts: list[Act]) -> tuple[np.ndarray, np.ndarray]:
    """Return distance along the stroke [mm] and time [s] at each act's end, from the first act's end on."""
    ways_mm = np.array([np.linalg.norm(np.subtract(b.place, a.place)) for a, b in pairwise(acts)])
    speeds = np.array([act.at_most[1] for act in acts[1:]])
    took_s = np.divide(ways_mm, speeds, out=np.zeros(len(ways_mm)), where=speeds > 0)
    return np.r_[0.0, np.cumsum(ways_mm)], np.r_[0.0, np.cumsum(took_s)]
