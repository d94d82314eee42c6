"""Turn dabs into outlines: each seen from its patch, those of a depth averaged, others left out with their names."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import cv2
import numpy as np

from ...errors import Error, Notice
from ...geometry.polylines import lengths
from ...geometry.rings import signed_area
from ...geometry.rotation import rotation

STEP_MM = 0.05
VERTICES = 96  # of an outline; more cost time in every sweep
HOLLOW = 0.03  # share of a dab that is bare inside of its edge: more, and its middle has no paint
BROKEN = 0.1  # share of its paint that is apart
RAGGED = 0.15  # share of its hull that is bare: paint was dry, or it is no footprint
# times the usual distance from the others of its depth, and at least so far: no repeat of them
UNLIKE, UNLIKE_MM = 4.0, 0.15
MAX_DISPLACEMENT, MAX_DISPLACEMENT_MM = 6.0, 0.6  # the same of its place
LEAST_LEFT = 2  # dabs of a depth: one alone cannot be distinguished from a bad one
# times what chance does to sides that are alike: less, and the outline is the mean of both sides, amid the axis. Sides
# that differ by chance would displace every stroke
LOPSIDED = 3.0
# rms over the outline, of dabs of one heading against all: more, and the shape does not turn with the brush
MOST_TURNED_MM = 0.25
SMOOTHED_MM = 0.05  # that smoothing moves a point at most; and by no more, rms, than repeats leave open
STRONGEST = 1e9  # smoothing: a straight line


@dataclass(frozen=True)
class Dab:
    """place_mm: where the tool was set down; run_mm: how far it went while it was pressed, along its heading."""

    name: str
    depth_mm: float
    place_mm: np.ndarray
    heading_rad: float
    run_mm: float
    rings_mm: tuple[np.ndarray, ...]


@dataclass(frozen=True)
class Seen:
    """A dab as its patch sees it: (n, 2) mm from where it was set down, x along its heading, moved by aside_mm onto the
    mean of its depth."""

    dab: Dab
    outline_mm: np.ndarray
    displacement_mm: np.ndarray


@dataclass(frozen=True)
class Shape:
    """What the dabs of one depth say: the outline from its tip, where the tip is behind the place at which the tool
    was set down, the distance of single dabs from the mean (rms), and the possible one of all."""

    depth_mm: float
    outline_mm: np.ndarray
    tip_gap_mm: float
    seen: tuple[Seen, ...]
    repeat_mm: float

    @property
    def unsure_mm(self) -> float:
        return self.repeat_mm / max(1.0, len(self.seen) - 1.0) ** 0.5


@dataclass(frozen=True)
class Outlines:
    """shift_mm, turn_rad: the pose of the sheet under the dabs, turned about centre_mm; turned_mm: by how much dabs of
    one heading differ; is_even: both sides of the outlines are alike; remarks: dabs that were left out, and why."""

    shapes: tuple[Shape, ...]
    shift_mm: np.ndarray
    turn_rad: float
    centre_mm: np.ndarray
    turned_mm: float
    is_even: bool
    remarks: tuple[Notice, ...]

    def predicted_mm(self) -> dict[str, np.ndarray]:
        """Return the predicted outline for each dab that was not left out, in a dictionary of names, (n, 2) mm on the
        sheet."""
        out = {}
        for shape in self.shapes:
            for seen in shape.seen:
                from_patch = shape.outline_mm - [shape.tip_gap_mm, 0.0] + seen.displacement_mm
                planned = from_patch @ rotation(seen.dab.heading_rad) + seen.dab.place_mm
                turned = (planned - self.centre_mm) @ rotation(self.turn_rad)
                out[seen.dab.name] = turned + self.centre_mm + self.shift_mm
        return out


def outlines_of(dabs: list[Dab], joined: set[str], slid_mm) -> Outlines:
    """One outline for each depth. joined: names of dabs that touch others; slid_mm: of a dab, how far its patch was
    dragged. Error where a depth is left open, or where dabs show no shape that turns with the brush."""
    depths = sorted({dab.depth_mm for dab in dabs})
    remarks, sound = [], []
    for dab in dabs:
        bad = _bad(dab, joined)
        remarks += [bad] if bad else []
        sound += [] if bad else [dab]
    _refuse_open(depths, sound, remarks)
    sheet, sound = _placed(sound, remarks)
    _refuse_open(depths, sound, remarks)
    seen = [_seen_from_patch(dab, sheet) for dab in sound]
    shapes = _by_depth(seen, lambda depth: 0.0)
    usual = float(np.median(np.concatenate([shape.distances_mm() for shape in shapes])))
    for shape in shapes:
        remarks += shape.without_strangers(max(UNLIKE * usual, UNLIKE_MM))
    left = {each.dab.name for shape in shapes for each in shape.seen}
    seen = [each for each in seen if each.dab.name in left]
    _refuse_open(depths, [each.dab for each in seen], remarks)
    across, beyond_chance = _across(seen)
    sides = float(np.sqrt(np.mean([shape.lopsided() ** 2 for shape in shapes])))
    is_even = max(beyond_chance, sides) < LOPSIDED
    shapes = _by_depth(seen, (lambda depth: 0.0) if is_even else across)
    turned = _turned_mm(shapes)
    if turned > MOST_TURNED_MM:
        raise Error(
            f"dabs of different headings differ by {turned:.2f} mm (rms over their outlines), {MOST_TURNED_MM:g} is "
            "the most: their shape does not turn with the brush, so no one outline is it; is the tool upright, and "
            "do the bristles grow straight?",
            "dabs",
            turned,
            code="dabs-turned",
        )
    finished = tuple(shape.finished(slid_mm(shape.seen[0].dab), is_even) for shape in shapes)
    return Outlines(
        finished, sheet.shift_mm, sheet.turn_rad, sheet.middle_mm, turned, is_even, tuple(remarks)
    )


def _bad(dab: Dab, joined: set[str]) -> Notice | None:
    """What is no whole dab."""
    areas = np.array([signed_area(ring) for ring in dab.rings_mm])
    if not (areas > 0).any():
        return Notice(dab.name, "no paint is found of it: left out", code="mark-missing")
    if dab.name in joined:
        return Notice(dab.name, "it runs together with another dab: left out", code="dabs-touch")
    bare, paint = -areas[areas < 0].sum() / areas.max(), areas[areas > 0]
    if bare > HOLLOW:
        return Notice(
            dab.name, f"{100 * bare:.0f} % of it has no paint, amid the rest: left out", code="dab-hollow"
        )
    if 1 - areas.max() / paint.sum() > BROKEN:
        sentence = f"its paint is in {len(paint)} parts, as where paint runs dry: left out"
        return Notice(dab.name, sentence, code="dab-dry")
    ragged = 1 - areas.max() / cv2.contourArea(cv2.convexHull(np.float32(_outer(dab))))
    if ragged > RAGGED:
        sentence = f"{100 * ragged:.0f} % of its hull has no paint, as where paint runs dry: left out"
        return Notice(dab.name, sentence, code="dab-dry")
    return None


def _refuse_open(depths: list[float], dabs: list[Dab], remarks: list[Notice]) -> None:
    for depth in depths:
        left = [dab.name for dab in dabs if dab.depth_mm == depth]
        if len(left) >= LEAST_LEFT:
            continue
        listed = "; ".join(f"{each.where}: {each.sentence}" for each in remarks[:4])
        raise Error(
            f"{len(left)} dabs are left at depth {depth:g} mm, at least {LEAST_LEFT} are needed: paint the page again "
            f"with more paint on the brush, and wipe it in between ({listed}{'; ...' * (len(remarks) > 4)})",
            f"{depth:g} mm",
            len(left),
            code="dabs-too-few",
        )


def _outer(dab: Dab) -> np.ndarray:
    return max(dab.rings_mm, key=signed_area)


def _close(ring: np.ndarray) -> np.ndarray:
    """With points every STEP_MM: between them a ray is met where their distances say, which is no straight line."""
    closed = np.vstack([ring, ring[:1]])
    at = lengths(closed)
    places = np.union1d(np.arange(0.0, at[-1], STEP_MM), at[:-1])
    return np.column_stack([np.interp(places, at, closed[:, k]) for k in (0, 1)])


def _middle(ring: np.ndarray) -> np.ndarray:
    """Centre of the area."""
    after = np.roll(ring, -1, axis=0)
    cross = ring[:, 0] * after[:, 1] - after[:, 0] * ring[:, 1]
    return (ring + after).T @ cross / (3 * cross.sum())


@dataclass(frozen=True)
class _Sheet:
    """Shifted, and turned about its middle."""

    shift_mm: np.ndarray
    turn_rad: float
    middle_mm: np.ndarray

    def undone(self, points: np.ndarray) -> np.ndarray:
        return (points - self.shift_mm - self.middle_mm) @ rotation(-self.turn_rad) + self.middle_mm


def _placed(dabs: list[Dab], remarks: list[Notice]) -> tuple[_Sheet, list[Dab]]:
    """Fit shift and turn of the sheet to all middles; those of a depth have one place ahead of and across the place of
    each dab. Returns also the dabs without outliers."""
    while True:
        depths = sorted({dab.depth_mm for dab in dabs})
        found, place = (
            np.array([_middle(_outer(dab)) for dab in dabs]),
            np.array([dab.place_mm for dab in dabs]),
        )
        columns = np.zeros((len(dabs), 2, 3 + 2 * len(depths)))
        columns[:, :, :2] = np.eye(2)
        away = found - place.mean(axis=0)
        columns[:, :, 2] = np.column_stack([-away[:, 1], away[:, 0]])
        for row, dab in zip(columns, dabs, strict=True):
            at = 3 + 2 * depths.index(dab.depth_mm)
            row[:, at : at + 2] = rotation(dab.heading_rad).T
        columns, target = columns.reshape(2 * len(dabs), -1), (found - place).ravel()
        answer = np.linalg.lstsq(columns, target, rcond=None)[0]
        off = np.hypot(*(target - columns @ answer).reshape(-1, 2).T)
        worst = int(off.argmax())
        if off[worst] <= max(MAX_DISPLACEMENT * float(np.median(off)), MAX_DISPLACEMENT_MM):
            return _Sheet(answer[:2], float(answer[2]), place.mean(axis=0)), dabs
        sentence = f"it is {off[worst]:.1f} mm from where the others say it should: left out"
        remarks.append(Notice(dabs[worst].name, sentence, code="mark-astray"))
        dabs = dabs[:worst] + dabs[worst + 1 :]
        if {dab.depth_mm for dab in dabs} != set(depths):
            return _Sheet(np.zeros(2), 0.0, np.zeros(2)), dabs


def _seen_from_patch(dab: Dab, sheet: _Sheet) -> Seen:
    ring = sheet.undone(_close(_outer(dab)))
    return Seen(dab, (ring - dab.place_mm) @ rotation(-dab.heading_rad), np.zeros(2))


def _across(seen: list[Seen]) -> tuple[Callable[[float], float], float]:
    """Return the distance of a dab's middle from the axis, over depth, which is less than the scatter of single dabs;
    and its ratio to that by chance."""
    depths = np.array([each.dab.depth_mm for each in seen])
    off_axis = np.array([_middle(each.outline_mm)[1] for each in seen])
    wide = np.array([np.ptp(each.outline_mm[:, 1]) for each in seen])
    usual = {depth: float(wide[depths == depth].mean()) for depth in depths.tolist()}
    columns = np.array(
        [usual[depth] for depth in depths.tolist()]
    )  # a shape that grows is as lopsided as before
    share = float(columns @ off_axis / (columns @ columns))
    chance = np.sum((off_axis - share * columns) ** 2) / max(1, len(seen) - 1)
    times = abs(share) * np.sqrt(columns @ columns / max(chance, 1e-12))
    return lambda depth: share * usual[depth], float(times)


def _by_depth(seen: list[Seen], across) -> list[_Depth]:
    depths = sorted({each.dab.depth_mm for each in seen})
    return [
        _Depth(depth, [each for each in seen if each.dab.depth_mm == depth], across(depth))
        for depth in depths
    ]


class _Depth:
    """The dabs of one depth over a common fan of rays from their middle, which ellipses of their size make even."""

    def __init__(self, depth: float, seen: list[Seen], across_mm: float):
        self.depth = depth
        middles = np.array([_middle(each.outline_mm) for each in seen])
        self.middle = np.array([middles[:, 0].mean(), across_mm])
        self.seen = [
            replace(
                each, outline_mm=each.outline_mm + self.middle - middle, displacement_mm=middle - self.middle
            )
            for each, middle in zip(seen, middles, strict=True)
        ]
        spans = np.array([np.ptp(each.outline_mm, axis=0) for each in self.seen])
        self.axes = np.median(spans, axis=0) / 2
        self.centre = np.array([self.middle[0], 0.0])  # the first ray runs back along the axis: the tip
        turn = np.pi + 2 * np.pi * np.arange(VERTICES) / VERTICES
        self.rays = self.axes * np.column_stack([np.cos(turn), np.sin(turn)])
        self.turn = turn
        self.reach = np.array([self._reach(each.outline_mm) for each in self.seen])

    def _reach(self, ring: np.ndarray) -> np.ndarray:
        """Return the distance of an outline along each ray."""
        even = (ring - self.centre) / self.axes
        angle = np.unwrap(np.arctan2(even[:, 1], even[:, 0]))
        order = np.argsort(np.mod(angle, 2 * np.pi))
        return np.interp(
            np.mod(self.turn, 2 * np.pi),
            np.mod(angle, 2 * np.pi)[order],
            np.hypot(*even.T)[order],
            period=2 * np.pi,
        )

    def _mm(self, reach: np.ndarray) -> np.ndarray:
        """Distances along the rays."""
        return reach * np.hypot(*self.rays.T)

    def distances_mm(self) -> np.ndarray:
        """Of each dab from the others of its depth, rms."""
        out = []
        for k in range(len(self.seen)):
            others = np.median(np.delete(self.reach, k, axis=0), axis=0)
            out.append(float(np.sqrt(np.mean(self._mm(self.reach[k] - others) ** 2))))
        return np.array(out)

    def without_strangers(self, most_mm: float) -> list[Notice]:
        """Leaves out one after the other, the worst first."""
        remarks = []
        while len(self.seen) > LEAST_LEFT:
            away = self.distances_mm()
            worst = int(away.argmax())
            if away[worst] <= most_mm:
                break
            sentence = (
                f"its outline is {away[worst]:.2f} mm (rms) from those of the others at depth {self.depth:g} mm, "
                f"{most_mm:.2f} is the most: left out"
            )
            remarks.append(Notice(self.seen[worst].dab.name, sentence, code="dab-unlike"))
            del self.seen[worst]
            self.reach = np.delete(self.reach, worst, axis=0)
        return remarks

    def by_heading_mm(self) -> dict[float, np.ndarray]:
        """Return the distance of the mean of the dabs of each heading from the mean of all."""
        heading = np.round(np.degrees([each.dab.heading_rad for each in self.seen])) % 360
        all_ = self.reach.mean(axis=0)
        return {h: self._mm(self.reach[heading == h].mean(axis=0) - all_) for h in np.unique(heading)}

    def lopsided(self) -> float:
        """By how much its sides differ, times what chance does to the mean of so many dabs."""
        apart = self._mm(self.reach - _mirrored(self.reach))
        chance = np.mean(apart.var(axis=0, ddof=1)) / len(apart)
        return float(np.sqrt(np.mean(apart.mean(axis=0) ** 2) / max(chance, 1e-12)))

    def finished(self, slid_mm: float, is_even: bool) -> Shape:
        """is_even: both sides are alike."""
        mean = self.reach.mean(axis=0)
        if is_even:
            mean = (mean + _mirrored(mean)) / 2
        off = self._mm(self.reach - mean)
        repeat = float(np.sqrt(np.sum(off**2) / max(1, (len(off) - 1) * VERTICES)))
        even = _smooth(mean, np.hypot(*self.rays.T), repeat / len(off) ** 0.5)
        points = self.centre + even[:, None] * self.rays
        points = _shortened(points, slid_mm)
        tip = points[0].copy()
        outline = points - tip
        outline[0] = 0.0
        return Shape(self.depth, outline, float(-tip[0]), tuple(self.seen), repeat)


def _mirrored(reach: np.ndarray) -> np.ndarray:
    """Of rays (..., n) from the tip on around, those on the other side of the axis."""
    return np.roll(reach[..., ::-1], 1, axis=-1)


def _turned_mm(shapes: list[_Depth]) -> float:
    """rms over the outline, mean over depths, of the heading whose dabs differ most from the others'."""
    off: dict[float, list[np.ndarray]] = {}
    for shape in shapes:
        for heading, distance in shape.by_heading_mm().items():
            off.setdefault(heading, []).append(distance)
    return max(float(np.sqrt(np.mean(np.square(np.mean(each, axis=0))))) for each in off.values())


def _smooth(reach: np.ndarray, size_mm: np.ndarray, unsure_mm: float) -> np.ndarray:
    """Return the least bent outline within unsure_mm (rms) and SMOOTHED_MM; free to have a corner at the tip."""
    closed = np.append(reach, reach[0])
    bends = np.diff(np.eye(len(closed)), 2, axis=0)
    penalty = bends.T @ bends
    ends = np.zeros((len(closed), len(closed)))
    ends[0, 0] = ends[-1, -1] = 1.0
    ends[0, -1] = ends[-1, 0] = -1.0

    def bent(strength: float) -> np.ndarray:
        out = np.linalg.solve(np.eye(len(closed)) + strength * penalty + STRONGEST * ends, closed)
        return out[:-1]

    low, high = -4.0, 9.0  # powers of ten
    for _ in range(30):
        middle = (low + high) / 2
        moved = (bent(10**middle) - reach) * size_mm
        fits = np.sqrt(np.mean(moved**2)) <= unsure_mm and np.abs(moved).max() <= SMOOTHED_MM
        low, high = (middle, high) if fits else (low, middle)
    return bent(10**low)


def widths_at(outline: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Along the axis, how wide the outline is."""
    x = np.linspace(outline[:, 0].min(), outline[:, 0].max(), 401)[1:-1]
    ahead = int(outline[:, 0].argmax())
    right, left = outline[: ahead + 1], np.vstack([outline[ahead:], outline[:1]])[::-1]
    lower = np.interp(x, np.maximum.accumulate(right[:, 0]), right[:, 1])
    upper = np.interp(x, np.maximum.accumulate(left[:, 0]), left[:, 1])
    return x, upper - lower


def _shortened(points: np.ndarray, by_mm: float) -> np.ndarray:
    """Without what a patch that was dragged so far swept: a piece of the widest part."""
    if by_mm <= 0:
        return points
    x, wide = widths_at(points)
    top = x[wide >= wide.max() - 0.03]
    middle = (top[0] + top[-1]) / 2
    out = points.copy()
    out[:, 0] -= np.clip(points[:, 0] - (middle - by_mm / 2), 0.0, by_mm)
    return out
