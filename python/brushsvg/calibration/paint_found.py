"""How marks narrow by the way since the last dip, found along with the brush from a sheet painted with one load."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from .. import _core
from ..errors import Error
from ..geometry.polylines import lengths
from ..geometry.rotation import rotation
from .from_marks import MarkCalibration, calibrate_marks, simulated
from .mark_input import Painted

ROUNDS = 8
SETTLED = 0.3  # of the standard deviation: added in squares 4 % of it; fits of like marks differ by up to 0.2
LEAST_OWN = 0.1  # of the way's say that depth may not take: with less its interval is three times as wide
OUTLYING = 4.0  # standard deviations of the edges
ACROSS = (0.5, 1.5)  # half widths from the middle: flanks, not what ends and crossings paint
STEP_MM = 0.5
FEWEST = 3  # marks more than there are numbers to find


def calibrate_paint(painted: Painted, name: str, *args, **kwargs) -> MarkCalibration:
    """calibrate_marks() of marks that get narrower from the first stroke of their plan to the last, since paint was
    fetched before the first one only; its brush is the freshly dipped one, and says by how much marks narrow.

    What the marks would be freshly dipped is what the fit is given: each edge as much farther from the middle line as
    the paint took. By how much it took is what makes the edges' residuals depend on the way no more. Intervals of the
    laws hold what the other number leaves open. Error where the way grows with the depth so that narrower and
    shallower marks are alike, where marks get wider, and where the number does not settle.
    """
    rate, fresh = 0.0, painted
    for _ in range(ROUNDS):
        made = calibrate_marks(fresh, name, *args, **kwargs)
        change, sigma, freedom = _left(made)
        rate += change
        fresh = freshly_dipped(painted, made, rate)
        if abs(change) < SETTLED * sigma:
            break
    else:
        sentence = f"how marks narrow does not settle, the last change was {change:.2g} per metre"
        raise Error(sentence, "paint", change, code="paint-undetermined")
    half = _core.deviations_of_95(freedom) * sigma
    if rate + half < 0:
        raise Error(
            f"marks get wider by {-rate:.2g} +- {half:.2g} per metre along the job: was paint fetched in between?",
            "paint",
            rate,
            code="paint-undetermined",
        )
    made = calibrate_marks(fresh, name, *args, **kwargs, off=freshly_dipped(painted, made, rate + sigma))
    last_mm = max(painted.before_mm[mark.stroke] + _lengths(mark)[-1] for mark in made.painted.marks)
    made.brush.paint = _core.Paint(
        max(rate, 0.0),
        calibrated_mm=(0.0, last_mm),
        source=f"Fitted to {len(made.painted.marks)} marks painted with one load.",
        covariance=[[sigma**2]],
        degrees_of_freedom=freedom,
    )
    return replace(made, painted=replace(made.painted, before_mm=painted.before_mm))


def freshly_dipped(painted: Painted, made: MarkCalibration, rate_per_m: float) -> list:
    """The marks as a brush would have painted them that was dipped at every place: edges farther from where the widest
    section ran by what the paint took of it."""
    brush, traces = simulated(made, painted.marks)
    fit, turned = made.fit, rotation(made.fit.turn_rad)
    centre = np.array(fit.centre_mm)
    aside = dict(zip((each.stroke for each in made.painted.marks), fit.marks, strict=True))
    paint = _core.Paint(abs(rate_per_m))
    marks = []
    for mark, trace in zip(painted.marks, traces, strict=True):
        moved = np.array(aside[mark.stroke].displacement_mm) if mark.stroke in aside else np.zeros(2)
        side = Sides(brush, trace, painted.before_mm[mark.stroke])
        rings = []
        for ring in map(np.asarray, mark.outline_mm):
            at = side.beside((ring - fit.shift_mm - centre) @ turned.T + centre - moved)
            shares = np.array([paint.width_share(way) for way in at.way_mm])
            more = 1 / shares - 1 if rate_per_m > 0 else shares - 1
            rings.append(ring + (more * at.across_mm)[:, None] * (at.normal @ turned))
        marks.append(_core.PaintedMark(mark.stroke, np.array(mark.poses_mm), rings, mark.arcs))
    return replace(painted, marks=marks)


@dataclass(frozen=True)
class Beside:
    """Of each point: depth and way of the brush where its widest section was nearest, how far to the left of it the
    point lies, which way that is, and how far the section ran to there, or from there on, whichever is less."""

    depth_mm: np.ndarray
    way_mm: np.ndarray
    across_mm: np.ndarray
    normal: np.ndarray
    ends_mm: np.ndarray


class Sides:
    """Where points lie beside the way of the widest section."""

    def __init__(self, brush, trace, before_mm: float) -> None:
        down = np.flatnonzero(np.asarray(trace.depth_mm) >= 0)
        widest = _core.widest_points(trace, brush)[down]
        heading = np.unwrap(np.asarray(trace.heading_rad)[down])
        at = lengths(widest)
        fine = np.union1d(at, np.arange(0.0, at[-1], STEP_MM))  # straight lines have rows at their ends only

        def between(values):
            return np.interp(fine, at, values)

        heading, self.depth_mm = between(heading), between(np.asarray(trace.depth_mm)[down])
        self.widest_mm = np.column_stack([between(column) for column in widest.T])
        self.normals = np.column_stack([-np.sin(heading), np.cos(heading)])
        self.ways_mm = before_mm + between(lengths(np.asarray(trace.tcp_mm)[down]))
        self.along_mm = fine

    def beside(self, points: np.ndarray) -> Beside:
        row = np.concatenate(
            [
                ((part[:, None] - self.widest_mm) ** 2).sum(axis=2).argmin(axis=1)
                for part in np.array_split(points, len(points) // 256 + 1)
            ]
        )
        normal = self.normals[row]
        across = ((points - self.widest_mm[row]) * normal).sum(axis=1)
        ends = np.minimum(self.along_mm[row], self.along_mm[-1] - self.along_mm[row])
        return Beside(self.depth_mm[row], self.ways_mm[row], across, normal, ends)


def _left(made: MarkCalibration) -> tuple[float, float, float]:
    """By how much the rate is off that the marks were made fresh with, per metre, by the edges' residuals: its standard
    deviation, by how marks differ from each other, and marks beyond what is found."""
    brush, traces = simulated(made, made.painted.marks)
    astray = {each.mark.stroke for each in made.strays}
    rows, off, of_mark = [], [], []
    for number, (miss, trace) in enumerate(zip(made.fit.marks, traces, strict=True)):
        if trace.stroke in astray or miss.outlier:
            continue
        at = Sides(brush, trace, made.painted.before_mm[trace.stroke]).beside(np.asarray(miss.point_mm))
        half = np.array([brush.half_width(d) for d in at.depth_mm])
        long = np.array([brush.tip_to_widest(d) for d in at.depth_mm]) + half
        share = np.abs(at.across_mm) / np.maximum(half, 1e-6)
        distance = np.asarray(miss.distance_mm)
        told = (share > ACROSS[0]) & (share < ACROSS[1]) & (at.ends_mm > long)
        told &= np.abs(distance) < OUTLYING * made.fit.noise_mm
        powers = at.depth_mm[:, None] ** np.arange(3 if made.painted.depths > 1 else 1)
        rows.append(np.column_stack([-1e-3 * half * at.way_mm, powers])[told])
        off.append(distance[told])
        of_mark += [number] * int(told.sum())
    if len(set(of_mark)) < FEWEST + 4:
        sentence = f"{len(set(of_mark))} marks show their flanks, at least {FEWEST + 4} are needed"
        raise Error(sentence, "paint", code="paint-undetermined")
    return _regression(np.vstack(rows), np.concatenate(off), np.array(of_mark))


def _regression(rows: np.ndarray, off: np.ndarray, of_mark: np.ndarray) -> tuple[float, float, float]:
    """Least squares of the first column beside the others; its standard deviation by whole marks, whose points know of
    each other."""
    others = rows[:, 1:]
    own = rows[:, 0] - others @ np.linalg.lstsq(others, rows[:, 0], rcond=None)[0]
    about = rows[:, 0] - rows[:, 0].mean()
    left = float(own @ own) / max(float(about @ about), 1e-12)
    if left < LEAST_OWN:
        raise Error(
            f"{100 * (1 - left):.0f} % of how the way since the dip grows is told by the depth alone, so narrower and "
            "shallower marks are alike: paint strokes of one depth early and late",
            "paint",
            code="paint-undetermined",
        )
    rate = float(own @ off) / float(own @ own)
    beside = off - others @ np.linalg.lstsq(others, off, rcond=None)[0] - rate * own
    marks = np.unique(of_mark)
    sums = np.array([float((own * beside)[of_mark == mark].sum()) for mark in marks])
    freedom = float(len(marks) - rows.shape[1])
    variance = float(sums @ sums) * len(marks) / freedom / float(own @ own) ** 2
    return rate, float(np.sqrt(variance)), freedom


def _lengths(mark) -> np.ndarray:
    return lengths(np.asarray(mark.poses_mm)[:, :2])
