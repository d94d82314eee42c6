"""Model axes with backlash that run a program.

An axis stands still until the command is ahead of it by half its backlash.
"""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Iterator
from itertools import pairwise

import numpy as np

from ...machine.cells.cell import Cell, unit_mm, value_mm
from ...machine.realised.arc_chords import OVER_MM
from ...machine.realised.backlash import first_side, half_mm
from . import Act, Readback, ReadSection, Step

EQUAL_TOLERANCE_MM = 1e-7
MAX_CHORD_RAD = 0.02


def with_backlash(read: Readback, cell: Cell) -> Readback:
    """Return the program with the true places of the tool.

    They replace the commanded places in its steps and its acts. Steps on which the tool stands while an axis takes up
    its backlash go to `taking_up` of their section.
    """
    half = half_mm(cell)
    if not half.any():
        return read
    known = [step for section in read.sections for step in section.steps if not math.isnan(step.x + step.y)]
    if known:
        step_mm = cell.servo.step_mm + value_mm(cell) if cell.servo else 0.0
        axes = _BacklashAxes(known, half, 2 * unit_mm(cell), step_mm)
        for section in read.sections:
            _run_section(section, axes)
        read.acts[:] = _acts_at_true_places(read.acts, axes)
        read.unsure = axes.unsure
    return read


class _BacklashAxes:
    """Two axes with backlash, and the places to which commands lead them.

    near_mm: effect of rounding on places; step_mm: height step of a servo; commanded: (3,) last commanded place [mm];
    slide: (2,) place of the axes; far_side: (2,) place of the axes if they began on the other side of their backlash;
    unsure: lines after which slide and far_side differ; stood: whether the tool stood on the last step; run_steps: by
    line, the steps that its own steps became, None for a step on which the tool stands.
    """

    def __init__(self, known: list[Step], half: np.ndarray, near_mm: float, step_mm: float):
        self.half, self.near_mm, self.step_mm = half, near_mm, step_mm
        self.commanded = np.array([known[0].x, known[0].y, known[0].z])
        places = np.array([(step.x, step.y) for step in known])
        first = first_side(np.diff(places, axis=0))
        # When a program begins, its axes are assumed to be on the way to the other side of their backlash.
        sides = np.where(first == 0, 1.0, first)
        self.slide, self.far_side = self.commanded[:2] + sides * half, self.commanded[:2] - sides * half
        self.unsure: set[int] = set()
        self.stood = False
        self.run_steps: dict[int, list[Step | None]] = defaultdict(list)

    def go(self, step: Step) -> tuple[list[Step], list[Step]]:
        """Return the steps that a step becomes, and those on which the tool stands."""
        commanded, slide = self.commanded, self.slide
        steps = list(self._along_circle(step) if step.centre else self._straight(step))
        if (np.abs(self.far_side - self.slide) > self.near_mm).any():
            self.unsure.add(step.line)
        places = [(*slide.tolist(), float(commanded[2])), *((each.x, each.y, each.z) for each in steps)]
        # A step also counts as a move if the tool stood on the step before.
        is_move = bool((commanded[:2] != self.commanded[:2]).any()) or self.stood
        stay = [is_move and before == after for before, after in pairwise(places)]
        goes, stands = (
            [each for each, stays in zip(steps, stay, strict=True) if stays == which] for which in (False, True)
        )
        self.stood = not goes
        self.run_steps[step.line].append(goes[-1] if goes else None)
        return goes, stands

    def is_superfluous_lift(self, steps: list[Step], step: Step) -> bool:
        """Return whether a servo's last step is only the height of a standing path.

        The tool stands on this path. Such a step is superfluous, because the next path has its own height.
        """
        if len(steps) < 2 or steps[-1].line != step.line:
            return False
        before, lift = steps[-2:]
        return (before.x, before.y) == (lift.x, lift.y) and abs(lift.z - before.z) <= self.step_mm

    def _straight(self, step: Step) -> Iterator[Step]:
        begin, end = self.commanded, np.array([step.x, step.y, step.z])
        way = end[:2] - begin[:2]
        after = self._place_of_axes(end)
        starts = set()  # shares of the move at which an axis begins to follow
        for axis in np.flatnonzero(np.abs(after - self.slide) > EQUAL_TOLERANCE_MM):
            ahead_mm = self.slide[axis] + np.sign(way[axis]) * self.half[axis] - begin[axis]
            if EQUAL_TOLERANCE_MM < abs(ahead_mm) < abs(way[axis]) - EQUAL_TOLERANCE_MM:
                starts.add(float(ahead_mm / way[axis]))
        for share in sorted(starts):
            place = begin + share * (end - begin)
            x, y = self._place_of_axes(place).tolist()
            yield step._replace(x=x, y=y, z=float(place[2]), blend_mm=0.0, wait_s=0.0, waits=0)
        self.far_side = self._push_axes(self.far_side, end)
        self.commanded, self.slide = end, after
        yield step._replace(x=float(after[0]), y=float(after[1]))

    def _place_of_axes(self, commanded: np.ndarray) -> np.ndarray:
        """Return (2,) the place of the axes when the command is at this place."""
        return self._push_axes(self.slide, commanded)

    def _push_axes(self, slide: np.ndarray, commanded: np.ndarray) -> np.ndarray:
        return np.round(np.clip(slide, commanded[:2] - self.half, commanded[:2] + self.half), 9) + 0.0

    def _along_circle(self, step: Step) -> Iterator[Step]:
        """Yield a circle while both axes push in one direction along it, else straight moves close to it."""
        begin, end = self.commanded, np.array([step.x, step.y, step.z])
        x, y, turn = step.centre
        first, last = (math.atan2(place[1] - y, place[0] - x) for place in (begin, end))
        sweep = (last - first) * turn % math.tau * turn
        count = max(2, math.ceil(abs(sweep) / MAX_CHORD_RAD))
        angles = first + sweep * np.arange(1, count) / count
        radius = math.hypot(*(begin[:2] - (x, y)))
        on = np.column_stack([x + radius * np.cos(angles), y + radius * np.sin(angles)])
        low, high = (of(np.vstack([begin[:2], end[:2]]), axis=0) for of in (np.min, np.max))
        near_mm = self.near_mm + OVER_MM  # brushsvg cuts no circle of a program for a smaller excess
        is_one_way = (on > low - near_mm).all() and (on < high + near_mm).all()
        pushes = np.abs(begin[:2] - self.slide - np.sign(end - begin)[:2] * self.half) < self.near_mm
        if is_one_way and (pushes | (np.abs(end - begin)[:2] < self.near_mm)).all():
            slack, self.far_side = self.slide - begin[:2], self._push_axes(self.far_side, end)
            after = np.round(np.clip(end[:2] + slack, end[:2] - self.half, end[:2] + self.half), 9) + 0.0
            self.commanded, self.slide = end, after
            centre = (x + float(slack[0]), y + float(slack[1]), turn)
            yield step._replace(x=float(after[0]), y=float(after[1]), centre=centre)
            return
        heights = begin[2] + (end[2] - begin[2]) * np.arange(1, count) / count
        for place in np.column_stack([on, heights]).tolist():
            yield from self._straight(Step(step.line, step.rapid, *place, step.speed_mm_s))
        yield from self._straight(step._replace(centre=None, via=()))


def _run_section(section: ReadSection, axes: _BacklashAxes) -> None:
    steps: list[Step] = []
    for step in section.steps:
        if math.isnan(step.x + step.y):
            steps.append(step)
            continue
        goes, stands = axes.go(step)
        if not goes and axes.is_superfluous_lift(steps, step):
            steps.pop()
        steps += goes
        section.taking_up += stands
        if steps and not goes and step.waits:
            last = steps[-1]
            steps[-1] = last._replace(wait_s=last.wait_s + step.wait_s, waits=last.waits + step.waits)
    section.steps[:] = steps


def _acts_at_true_places(acts: list[Act], axes: _BacklashAxes) -> list[Act]:
    """Return the acts with the places of their steps. Acts on which the tool stands are left out."""
    out = []
    for act in reversed(acts):
        run_steps = axes.run_steps.get(act.line)
        if act.place and run_steps:
            step = run_steps.pop()
            if step is None:
                continue
            if act.kind != "circle":
                act = act._replace(place=(step.x, step.y, *act.place[2:]))
            elif step.centre:
                act = act._replace(place=(step.x, step.y, *act.place[2:]), same=step.centre[:2])
        out.append(act)
    return out[::-1]
