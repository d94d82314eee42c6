"""Simulate a run on a machine whose axes have play.

When an axis reverses, its slide stands until the screw has crossed the play.
"""

from __future__ import annotations

import numpy as np

from .moves import Run, arc_points

STEP_MM = 0.01


def with_play(run: Run, backlash_mm) -> Run:
    """Return the run of the slides, with chords instead of circles.

    The slides may start anywhere in their play. Here x and y start on opposite sides.
    """
    half = np.array([*backlash_mm, 0.0]) / 2
    lag, legs, first = half * (1, -1, 0), [], []
    for leg in run.legs:
        first.append(len(legs))
        start = np.array(leg.start, dtype=float)
        for end in arc_points(leg) if leg.kind == "arc" else np.array([leg.end], dtype=float):
            for a, b in _small_steps(start, end, lag, half):
                after = np.clip(lag + b - a, -half, half)
                here, there = (tuple(np.round(each, 9)) for each in (a - lag, b - after))
                lag = after
                kind = "feed" if leg.kind == "arc" else leg.kind
                does = leg._replace(kind=kind, start=here, end=there, centre=None, turn=0)
                if here == there and bool((a != b).any()):
                    last = legs.pop() if len(legs) > first[-1] and legs[-1].takes_up and legs[-1].end == here else None
                    seconds = float(np.linalg.norm(b - a)) / max(leg.speed_mm_s, 1e-9)
                    does = does._replace(takes_up=True, seconds=seconds + (last.seconds if last else 0.0))
                legs.append(does)
            start = end
    at = [*first, len(legs)]
    run.legs, run.titles = legs, [(words, at[number]) for words, number in run.titles]
    return run


def _small_steps(start: np.ndarray, end: np.ndarray, lag: np.ndarray, half: np.ndarray):
    """Split a straight way into small steps until all moving slides are pushed.

    The last step is the rest of the way.
    """
    pushed, here = np.sign(end - start) * half, start
    count = int(np.ceil(np.abs(end - start)[:2].max() / STEP_MM))
    for k in range(1, count):
        if not (np.abs(pushed - lag)[end != start] > 1e-9).any():
            break
        there = start + (end - start) * k / count
        yield here, there
        lag, here = np.clip(lag + there - here, -half, half), there
    yield here, end
