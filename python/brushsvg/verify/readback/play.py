"""Model axes with backlash that run a program: each stands until the command is half of it ahead."""

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

EQUAL_MM = 1e-7
CHORD_RAD = 0.02


def as_gone(read: Readback, cell: Cell) -> Readback:
    """Return the program with the places of the tool in place of the commanded ones, in its steps and in its acts.
    Steps on which the tool stands while an axis takes up its play are kept apart."""
    half = half_mm(cell)
    if not half.any():
        return read
    known = [step for section in read.sections for step in section.steps if not math.isnan(step.x + step.y)]
    if known:
        step_mm = cell.servo.step_mm + value_mm(cell) if cell.servo else 0.0
        axes = _Axes(known, half, 2 * unit_mm(cell), step_mm)
        for section in read.sections:
            _go_along(section, axes)
        read.acts[:] = _acts(read.acts, axes)
        read.unsure = axes.unsure
    return read


class _Axes:
    """near_mm: the effect of rounding on places; step_mm: of a servo's heights. commanded (3,): the last commanded
    place; slide (2,): where the axes are; far_side (2,): where they are if they began on the other side of their
    backlash; unsure: the lines behind which that makes a difference; stood: whether the tool stood on the last step;
    gone: by line the steps that its own steps became, None for one on which the tool stands."""

    def __init__(self, known: list[Step], half: np.ndarray, near_mm: float, step_mm: float):
        self.half, self.near_mm, self.step_mm = half, near_mm, step_mm
        self.commanded = np.array([known[0].x, known[0].y, known[0].z])
        places = np.array([(step.x, step.y) for step in known])
        first = first_side(np.diff(places, axis=0))
        # as a program begins, its axes are on the way to the other side of their play
        sides = np.where(first == 0, 1.0, first)
        self.slide, self.far_side = self.commanded[:2] + sides * half, self.commanded[:2] - sides * half
        self.unsure: set[int] = set()
        self.stood = False
        self.gone: dict[int, list[Step | None]] = defaultdict(list)

    def go(self, step: Step) -> tuple[list[Step], list[Step]]:
        """The steps that a step leads to, and those on which the tool stands."""
        commanded, slide = self.commanded, self.slide
        steps = list(self._along_circle(step) if step.centre else self._straight(step))
        if (np.abs(self.far_side - self.slide) > self.near_mm).any():
            self.unsure.add(step.line)
        places = [(*slide.tolist(), float(commanded[2])), *((each.x, each.y, each.z) for each in steps)]
        is_move = (
            bool((commanded[:2] != self.commanded[:2]).any()) or self.stood
        )  # or once more where it stands
        stay = [is_move and before == after for before, after in pairwise(places)]
        goes, stands = (
            [each for each, stays in zip(steps, stay, strict=True) if stays == which]
            for which in (False, True)
        )
        self.stood = not goes
        self.gone[step.line].append(goes[-1] if goes else None)
        return goes, stands

    def is_held(self, steps: list[Step], step: Step) -> bool:
        """Whether a servo's last step is but the height of a way on which the tool stands: the next way has its own."""
        if len(steps) < 2 or steps[-1].line != step.line:
            return False
        before, lift = steps[-2:]
        return (before.x, before.y) == (lift.x, lift.y) and abs(lift.z - before.z) <= self.step_mm

    def _straight(self, step: Step) -> Iterator[Step]:
        begin, end = self.commanded, np.array([step.x, step.y, step.z])
        way = end[:2] - begin[:2]
        after = self._dragged(end)
        starts = set()  # shares of the way from where on an axis follows
        for axis in np.flatnonzero(np.abs(after - self.slide) > EQUAL_MM):
            ahead_mm = self.slide[axis] + np.sign(way[axis]) * self.half[axis] - begin[axis]
            if EQUAL_MM < abs(ahead_mm) < abs(way[axis]) - EQUAL_MM:
                starts.add(float(ahead_mm / way[axis]))
        for share in sorted(starts):
            place = begin + share * (end - begin)
            x, y = self._dragged(place).tolist()
            yield step._replace(x=x, y=y, z=float(place[2]), blend_mm=0.0, wait_s=0.0, waits=0)
        self.far_side = self._pushed(self.far_side, end)
        self.commanded, self.slide = end, after
        yield step._replace(x=float(after[0]), y=float(after[1]))

    def _dragged(self, commanded: np.ndarray) -> np.ndarray:
        """(2,) where the slides are then."""
        return self._pushed(self.slide, commanded)

    def _pushed(self, slide: np.ndarray, commanded: np.ndarray) -> np.ndarray:
        return np.round(np.clip(slide, commanded[:2] - self.half, commanded[:2] + self.half), 9) + 0.0

    def _along_circle(self, step: Step) -> Iterator[Step]:
        """A circle, where both axes push one way all along it; else straight moves close to where they go."""
        begin, end = self.commanded, np.array([step.x, step.y, step.z])
        x, y, turn = step.centre
        first, last = (math.atan2(place[1] - y, place[0] - x) for place in (begin, end))
        sweep = (last - first) * turn % math.tau * turn
        count = max(2, math.ceil(abs(sweep) / CHORD_RAD))
        angles = first + sweep * np.arange(1, count) / count
        radius = math.hypot(*(begin[:2] - (x, y)))
        on = np.column_stack([x + radius * np.cos(angles), y + radius * np.sin(angles)])
        low, high = (of(np.vstack([begin[:2], end[:2]]), axis=0) for of in (np.min, np.max))
        near_mm = self.near_mm + OVER_MM  # no program's circle is cut for less
        is_one_way = (on > low - near_mm).all() and (on < high + near_mm).all()
        pushes = np.abs(begin[:2] - self.slide - np.sign(end - begin)[:2] * self.half) < self.near_mm
        if is_one_way and (pushes | (np.abs(end - begin)[:2] < self.near_mm)).all():
            slack, self.far_side = self.slide - begin[:2], self._pushed(self.far_side, end)
            after = np.round(np.clip(end[:2] + slack, end[:2] - self.half, end[:2] + self.half), 9) + 0.0
            self.commanded, self.slide = end, after
            centre = (x + float(slack[0]), y + float(slack[1]), turn)
            yield step._replace(x=float(after[0]), y=float(after[1]), centre=centre)
            return
        heights = begin[2] + (end[2] - begin[2]) * np.arange(1, count) / count
        for place in np.column_stack([on, heights]).tolist():
            yield from self._straight(Step(step.line, step.rapid, *place, step.speed_mm_s))
        yield from self._straight(step._replace(centre=None, via=()))


def _go_along(section: ReadSection, axes: _Axes) -> None:
    steps: list[Step] = []
    for step in section.steps:
        if math.isnan(step.x + step.y):
            steps.append(step)
            continue
        goes, stands = axes.go(step)
        if not goes and axes.is_held(steps, step):
            steps.pop()
        steps += goes
        section.taking_up += stands
        if steps and not goes and step.waits:
            last = steps[-1]
            steps[-1] = last._replace(wait_s=last.wait_s + step.wait_s, waits=last.waits + step.waits)
    section.steps[:] = steps


def _acts(acts: list[Act], axes: _Axes) -> list[Act]:
    """Acts of a line lead where its steps do; those on which the tool stands are left out."""
    out = []
    for act in reversed(acts):
        gone = axes.gone.get(act.line)
        if act.place and gone:
            step = gone.pop()
            if step is None:
                continue
            if act.kind != "circle":
                act = act._replace(place=(step.x, step.y, *act.place[2:]))
            elif step.centre:
                act = act._replace(place=(step.x, step.y, *act.place[2:]), same=step.centre[:2])
        out.append(act)
    return out[::-1]
