"""Average dabs to one outline per depth, in the frame of the patch.

Bad dabs are left out and named in remarks.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import cv2
import numpy as np

from ...errors import Error, Notice
from ...geometry.polylines import lengths
from ...geometry.rings import centroid, signed_area
from ...geometry.rotation import rotation

POINT_SPACING_MM = 0.05  # greatest distance of the points along a ring
VERTEX_COUNT = 96  # vertices of an outline; more cost time in every sweep
MAX_HOLLOW_SHARE = 0.03  # largest bare share inside the edge of a dab; with more, its middle has no paint
MAX_SEPARATE_SHARE = 0.1  # largest share of the paint of a dab outside its largest part
MAX_BARE_HULL_SHARE = 0.15  # largest bare share of the hull of a dab; with more, paint was dry or it is not a footprint
# Largest distance from the other dabs of a depth: times the usual distance, and at least this many mm.
MAX_DISTANCE_RATIO, MIN_DISTANCE_LIMIT_MM = 4.0, 0.15
MAX_DISPLACEMENT_RATIO, MIN_DISPLACEMENT_LIMIT_MM = 6.0, 0.6  # the same two limits for the place of a dab
MIN_DABS_PER_DEPTH = 2  # dabs per depth; a single dab cannot be distinguished from a bad one
# Difference of the two sides, in units of the difference that chance causes. Below it, the outline is the mean of both
# sides, symmetric about the axis. Sides that differ by chance would displace every stroke.
MIN_ASYMMETRY = 3.0
# Largest rms distance over the outline between the dabs of one heading and all dabs. Above it, the shape does not turn
# with the brush.
MAX_HEADING_DIFFERENCE_MM = 0.25
# Largest shift of a point by smoothing. The rms shift is also limited, by the standard error of the repeats.
MAX_SMOOTHING_MM = 0.05
CONSTRAINT_STRENGTH = 1e9  # strength of a constraint of the smoothing


@dataclass(frozen=True)
class Dab:
    """A painted dab.

    place_mm: where the tool was set down. run_mm: how far it ran along its heading while it was pressed. rings_mm: the
    outlines of its paint.
    """

    name: str
    depth_mm: float
    place_mm: np.ndarray
    heading_rad: float
    run_mm: float
    rings_mm: tuple[np.ndarray, ...]


@dataclass(frozen=True)
class PatchDab:
    """A dab in the frame of its patch.

    outline_mm: (n, 2), from the place where the dab was set down, x along its heading, moved onto the mean of its
    depth. displacement_mm: the dab's displacement from that mean.
    """

    dab: Dab
    outline_mm: np.ndarray
    displacement_mm: np.ndarray


@dataclass(frozen=True)
class Shape:
    """The mean of the dabs of one depth.

    outline_mm: the outline, starting at its tip. tip_gap_mm: distance of the tip behind the place where the tool was
    set down. repeat_mm: rms distance of single dabs from the mean. unsure_mm: standard error of the mean.
    """

    depth_mm: float
    outline_mm: np.ndarray
    tip_gap_mm: float
    seen: tuple[PatchDab, ...]
    repeat_mm: float

    @property
    def unsure_mm(self) -> float:
        return self.repeat_mm / max(1.0, len(self.seen) - 1.0) ** 0.5


@dataclass(frozen=True)
class Outlines:
    """The outlines of all depths.

    shift_mm, turn_rad: the pose of the sheet under the dabs, turned about centre_mm. turned_mm: the difference between
    the dabs of one heading and all dabs. is_even: the two sides of the outlines are equal. remarks: dabs that were left
    out, with reasons.
    """

    shapes: tuple[Shape, ...]
    shift_mm: np.ndarray
    turn_rad: float
    centre_mm: np.ndarray
    turned_mm: float
    is_even: bool
    remarks: tuple[Notice, ...]

    def predicted_mm(self) -> dict[str, np.ndarray]:
        """Return the predicted outline of each dab that was not left out.

        The outlines (n, 2) [mm] are on the sheet, by the name of the dab.
        """
        out = {}
        for shape in self.shapes:
            for patch_dab in shape.seen:
                from_patch = shape.outline_mm - [shape.tip_gap_mm, 0.0] + patch_dab.displacement_mm
                planned = from_patch @ rotation(patch_dab.dab.heading_rad) + patch_dab.dab.place_mm
                turned = (planned - self.centre_mm) @ rotation(self.turn_rad)
                out[patch_dab.dab.name] = turned + self.centre_mm + self.shift_mm
        return out


def average_dabs(dabs: list[Dab], joined: set[str], dragged_mm: Callable[[Dab], float]) -> Outlines:
    """Average dabs to one outline for each depth.

    joined: names of dabs that touch others. dragged_mm: returns how far the patch of a dab was dragged.

    Raises Error if a depth has too few dabs, and if the shape of the dabs does not turn with the brush.
    """
    depths = sorted({dab.depth_mm for dab in dabs})
    remarks, whole_dabs = [], []
    for dab in dabs:
        defect = _find_defect(dab, joined)
        remarks += [defect] if defect else []
        whole_dabs += [] if defect else [dab]
    _refuse_too_few(depths, whole_dabs, remarks)
    sheet, whole_dabs = _fit_sheet(whole_dabs, remarks)
    _refuse_too_few(depths, whole_dabs, remarks)
    patch_dabs = [_to_patch_frame(dab, sheet) for dab in whole_dabs]
    shapes = _group_by_depth(patch_dabs, lambda depth: 0.0)
    typical_mm = float(np.median(np.concatenate([shape.distances_mm() for shape in shapes])))
    for shape in shapes:
        remarks += shape.remove_unlike_dabs(max(MAX_DISTANCE_RATIO * typical_mm, MIN_DISTANCE_LIMIT_MM))
    kept_names = {patch_dab.dab.name for shape in shapes for patch_dab in shape.seen}
    patch_dabs = [patch_dab for patch_dab in patch_dabs if patch_dab.dab.name in kept_names]
    _refuse_too_few(depths, [patch_dab.dab for patch_dab in patch_dabs], remarks)
    across, beyond_chance = _fit_axis_offset(patch_dabs)
    sides = float(np.sqrt(np.mean([shape.asymmetry() ** 2 for shape in shapes])))
    is_even = max(beyond_chance, sides) < MIN_ASYMMETRY
    shapes = _group_by_depth(patch_dabs, (lambda depth: 0.0) if is_even else across)
    turned = _heading_difference_mm(shapes)
    if turned > MAX_HEADING_DIFFERENCE_MM:
        sentence = (
            f"dabs of different headings differ by {turned:.2f} mm (rms over their outlines), more than "
            f"{MAX_HEADING_DIFFERENCE_MM:g} mm: the shape does not turn with the brush, so no single outline describes "
            "it. Check that the tool is upright and the bristles are straight"
        )
        raise Error(sentence, "dabs", turned, code="dabs-turned")
    finished = tuple(shape.average(dragged_mm(shape.seen[0].dab), is_even) for shape in shapes)
    return Outlines(finished, sheet.shift_mm, sheet.turn_rad, sheet.middle_mm, turned, is_even, tuple(remarks))


def _find_defect(dab: Dab, joined: set[str]) -> Notice | None:
    """Return a notice if a dab is not whole, else None."""
    areas = np.array([signed_area(ring) for ring in dab.rings_mm])
    if not (areas > 0).any():
        return Notice(dab.name, "this dab is left out: no paint of it was found", code="mark-missing")
    if dab.name in joined:
        return Notice(dab.name, "this dab is left out: it touches another dab", code="dabs-touch")
    bare, paint = -areas[areas < 0].sum() / areas.max(), areas[areas > 0]
    if bare > MAX_HOLLOW_SHARE:
        sentence = f"this dab is left out: it has holes without paint, {100 * bare:.0f} % of its area"
        return Notice(dab.name, sentence, code="dab-hollow")
    if 1 - areas.max() / paint.sum() > MAX_SEPARATE_SHARE:
        sentence = f"this dab is left out: its paint is in {len(paint)} parts, probably because the brush ran dry"
        return Notice(dab.name, sentence, code="dab-dry")
    ragged = 1 - areas.max() / cv2.contourArea(cv2.convexHull(np.float32(_outer_ring(dab))))
    if ragged > MAX_BARE_HULL_SHARE:
        sentence = (
            f"this dab is left out: {100 * ragged:.0f} % of its hull has no paint, probably because the brush ran dry"
        )
        return Notice(dab.name, sentence, code="dab-dry")
    return None


def _refuse_too_few(depths: list[float], dabs: list[Dab], remarks: list[Notice]) -> None:
    for depth in depths:
        names = [dab.name for dab in dabs if dab.depth_mm == depth]
        if len(names) >= MIN_DABS_PER_DEPTH:
            continue
        listed = "; ".join(f"{remark.where}: {remark.sentence}" for remark in remarks[:4])
        sentence = (
            f"{len(names)} usable dabs are left at depth {depth:g} mm, at least {MIN_DABS_PER_DEPTH} are needed: paint "
            "the page again with more paint on the brush, and wipe the brush in between "
            f"({listed}{'; ...' * (len(remarks) > 4)})"
        )
        raise Error(sentence, f"{depth:g} mm", len(names), code="dabs-too-few")


def _outer_ring(dab: Dab) -> np.ndarray:
    return max(dab.rings_mm, key=signed_area)


def _close_densely(ring: np.ndarray) -> np.ndarray:
    """Close a ring and add points, because distances along a ray are interpolated between them."""
    closed = np.vstack([ring, ring[:1]])
    at = lengths(closed)
    places = np.union1d(np.arange(0.0, at[-1], POINT_SPACING_MM), at[:-1])
    return np.column_stack([np.interp(places, at, closed[:, k]) for k in (0, 1)])


@dataclass(frozen=True)
class _Sheet:
    """The pose of the sheet: shifted, and turned about its middle."""

    shift_mm: np.ndarray
    turn_rad: float
    middle_mm: np.ndarray

    def undo(self, points: np.ndarray) -> np.ndarray:
        return (points - self.shift_mm - self.middle_mm) @ rotation(-self.turn_rad) + self.middle_mm


def _fit_sheet(dabs: list[Dab], remarks: list[Notice]) -> tuple[_Sheet, list[Dab]]:
    """Fit shift and turn of the sheet to the centroids of all dabs.

    Centroids of one depth have a common offset, ahead and across, from the places of their dabs. Return the sheet and
    the dabs without outliers.
    """
    while True:
        depths = sorted({dab.depth_mm for dab in dabs})
        found = np.array([centroid([_outer_ring(dab)]) for dab in dabs])
        place = np.array([dab.place_mm for dab in dabs])
        columns = np.zeros((len(dabs), 2, 3 + 2 * len(depths)))
        columns[:, :, :2] = np.eye(2)
        arm = found - place.mean(axis=0)
        columns[:, :, 2] = np.column_stack([-arm[:, 1], arm[:, 0]])
        for row, dab in zip(columns, dabs, strict=True):
            at = 3 + 2 * depths.index(dab.depth_mm)
            row[:, at : at + 2] = rotation(dab.heading_rad).T
        columns, target = columns.reshape(2 * len(dabs), -1), (found - place).ravel()
        solution = np.linalg.lstsq(columns, target, rcond=None)[0]
        distances = np.hypot(*(target - columns @ solution).reshape(-1, 2).T)
        worst = int(distances.argmax())
        if distances[worst] <= max(MAX_DISPLACEMENT_RATIO * float(np.median(distances)), MIN_DISPLACEMENT_LIMIT_MM):
            return _Sheet(solution[:2], float(solution[2]), place.mean(axis=0)), dabs
        sentence = (
            f"this dab is left out: it is {distances[worst]:.1f} mm away from the place that the other dabs predict"
        )
        remarks.append(Notice(dabs[worst].name, sentence, code="mark-astray"))
        dabs = dabs[:worst] + dabs[worst + 1 :]
        if {dab.depth_mm for dab in dabs} != set(depths):
            return _Sheet(np.zeros(2), 0.0, np.zeros(2)), dabs


def _to_patch_frame(dab: Dab, sheet: _Sheet) -> PatchDab:
    ring = sheet.undo(_close_densely(_outer_ring(dab)))
    return PatchDab(dab, (ring - dab.place_mm) @ rotation(-dab.heading_rad), np.zeros(2))


def _fit_axis_offset(seen: list[PatchDab]) -> tuple[Callable[[float], float], float]:
    """Fit the distance of the centroids of dabs from the axis.

    Return the distance as a function of depth, and its significance.

    The distance is smaller than the scatter of single dabs. The significance is its ratio to the distance by chance.
    """
    depths = np.array([patch_dab.dab.depth_mm for patch_dab in seen])
    off_axis = np.array([centroid([patch_dab.outline_mm])[1] for patch_dab in seen])
    wide = np.array([np.ptp(patch_dab.outline_mm[:, 1]) for patch_dab in seen])
    usual = {depth: float(wide[depths == depth].mean()) for depth in depths.tolist()}
    columns = np.array([usual[depth] for depth in depths.tolist()])  # a shape that grows keeps its asymmetry
    share = float(columns @ off_axis / (columns @ columns))
    chance = np.sum((off_axis - share * columns) ** 2) / max(1, len(seen) - 1)
    significance = abs(share) * np.sqrt(columns @ columns / max(chance, 1e-12))
    return lambda depth: share * usual[depth], float(significance)


def _group_by_depth(seen: list[PatchDab], across) -> list[_DabsOfDepth]:
    depths = sorted({patch_dab.dab.depth_mm for patch_dab in seen})
    return [
        _DabsOfDepth(depth, [patch_dab for patch_dab in seen if patch_dab.dab.depth_mm == depth], across(depth))
        for depth in depths
    ]


class _DabsOfDepth:
    """The dabs of one depth, sampled on common rays from their middle.

    The spacing of the rays comes from an ellipse of the size of the dabs.
    """

    def __init__(self, depth: float, seen: list[PatchDab], across_mm: float):
        self.depth = depth
        middles = np.array([centroid([patch_dab.outline_mm]) for patch_dab in seen])
        self.middle = np.array([middles[:, 0].mean(), across_mm])
        self.seen = [
            replace(
                patch_dab,
                outline_mm=patch_dab.outline_mm + self.middle - middle,
                displacement_mm=middle - self.middle,
            )
            for patch_dab, middle in zip(seen, middles, strict=True)
        ]
        spans = np.array([np.ptp(patch_dab.outline_mm, axis=0) for patch_dab in self.seen])
        self.axes = np.median(spans, axis=0) / 2
        self.centre = np.array([self.middle[0], 0.0])  # the first ray runs back along the axis to the tip
        turn = np.pi + 2 * np.pi * np.arange(VERTEX_COUNT) / VERTEX_COUNT
        self.rays = self.axes * np.column_stack([np.cos(turn), np.sin(turn)])
        self.turn = turn
        self.reach = np.array([self._reach_along_rays(patch_dab.outline_mm) for patch_dab in self.seen])

    def _reach_along_rays(self, ring: np.ndarray) -> np.ndarray:
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

    def _to_mm(self, reach: np.ndarray) -> np.ndarray:
        """Convert distances along the rays to mm."""
        return reach * np.hypot(*self.rays.T)

    def distances_mm(self) -> np.ndarray:
        """Return the rms distance of each dab from the other dabs of its depth."""
        out = []
        for k in range(len(self.seen)):
            others = np.median(np.delete(self.reach, k, axis=0), axis=0)
            out.append(float(np.sqrt(np.mean(self._to_mm(self.reach[k] - others) ** 2))))
        return np.array(out)

    def remove_unlike_dabs(self, max_distance_mm: float) -> list[Notice]:
        """Leave out dabs that differ by more than max_distance_mm, the worst first.

        Return notices about them.
        """
        remarks = []
        while len(self.seen) > MIN_DABS_PER_DEPTH:
            away = self.distances_mm()
            worst = int(away.argmax())
            if away[worst] <= max_distance_mm:
                break
            sentence = (
                f"this dab is left out: its outline differs by {away[worst]:.2f} mm (rms) from the other dabs at depth "
                f"{self.depth:g} mm, more than {max_distance_mm:.2f} mm"
            )
            remarks.append(Notice(self.seen[worst].dab.name, sentence, code="dab-unlike"))
            del self.seen[worst]
            self.reach = np.delete(self.reach, worst, axis=0)
        return remarks

    def by_heading_mm(self) -> dict[float, np.ndarray]:
        """Return the distance of the mean of each heading from the mean of all dabs."""
        heading = np.round(np.degrees([patch_dab.dab.heading_rad for patch_dab in self.seen])) % 360
        all_ = self.reach.mean(axis=0)
        return {h: self._to_mm(self.reach[heading == h].mean(axis=0) - all_) for h in np.unique(heading)}

    def asymmetry(self) -> float:
        """Return the difference of the two sides, relative to chance.

        Chance is the expected difference of the mean of equal sides.
        """
        apart = self._to_mm(self.reach - _mirror(self.reach))
        chance = np.mean(apart.var(axis=0, ddof=1)) / len(apart)
        return float(np.sqrt(np.mean(apart.mean(axis=0) ** 2) / max(chance, 1e-12)))

    def average(self, dragged_mm: float, is_even: bool) -> Shape:
        """Return the smoothed mean of the dabs.

        dragged_mm: how far the patch was dragged. is_even: average both sides.
        """
        mean = self.reach.mean(axis=0)
        if is_even:
            mean = (mean + _mirror(mean)) / 2
        off = self._to_mm(self.reach - mean)
        repeat = float(np.sqrt(np.sum(off**2) / max(1, (len(off) - 1) * VERTEX_COUNT)))
        even = _smooth_outline(mean, np.hypot(*self.rays.T), repeat / len(off) ** 0.5)
        points = self.centre + even[:, None] * self.rays
        points = _remove_drag(points, dragged_mm)
        tip = points[0].copy()
        outline = points - tip
        outline[0] = 0.0
        return Shape(self.depth, outline, float(-tip[0]), tuple(self.seen), repeat)


def _mirror(reach: np.ndarray) -> np.ndarray:
    """Mirror distances along rays (..., n), which start at the tip, at the axis."""
    return np.roll(reach[..., ::-1], 1, axis=-1)


def _heading_difference_mm(shapes: list[_DabsOfDepth]) -> float:
    """Return the largest rms difference [mm], averaged over depths, between one heading's dabs and all dabs."""
    off: dict[float, list[np.ndarray]] = {}
    for shape in shapes:
        for heading, distance in shape.by_heading_mm().items():
            off.setdefault(heading, []).append(distance)
    return max(float(np.sqrt(np.mean(np.square(np.mean(differences, axis=0))))) for differences in off.values())


def _smooth_outline(reach: np.ndarray, size_mm: np.ndarray, unsure_mm: float) -> np.ndarray:
    """Return the smoothest outline within unsure_mm (rms) and MAX_SMOOTHING_MM; it may have a corner at the tip."""
    closed = np.append(reach, reach[0])
    bends = np.diff(np.eye(len(closed)), 2, axis=0)
    penalty = bends.T @ bends
    ends = np.zeros((len(closed), len(closed)))
    ends[0, 0] = ends[-1, -1] = 1.0
    ends[0, -1] = ends[-1, 0] = -1.0

    def bent(strength: float) -> np.ndarray:
        out = np.linalg.solve(np.eye(len(closed)) + strength * penalty + CONSTRAINT_STRENGTH * ends, closed)
        return out[:-1]

    low, high = -4.0, 9.0  # range of the strength, as powers of ten
    for _ in range(30):
        middle = (low + high) / 2
        moved = (bent(10**middle) - reach) * size_mm
        fits = np.sqrt(np.mean(moved**2)) <= unsure_mm and np.abs(moved).max() <= MAX_SMOOTHING_MM
        low, high = (middle, high) if fits else (low, middle)
    return bent(10**low)


def widths_at(outline: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return places along the axis, and the width of the outline there."""
    x = np.linspace(outline[:, 0].min(), outline[:, 0].max(), 401)[1:-1]
    ahead = int(outline[:, 0].argmax())
    right, left = outline[: ahead + 1], np.vstack([outline[ahead:], outline[:1]])[::-1]
    lower = np.interp(x, np.maximum.accumulate(right[:, 0]), right[:, 1])
    upper = np.interp(x, np.maximum.accumulate(left[:, 0]), left[:, 1])
    return x, upper - lower


def _remove_drag(points: np.ndarray, by_mm: float) -> np.ndarray:
    """Remove the length that a dragged patch swept, from the widest part of the outline."""
    if by_mm <= 0:
        return points
    x, wide = widths_at(points)
    top = x[wide >= wide.max() - 0.03]
    middle = (top[0] + top[-1]) / 2
    out = points.copy()
    out[:, 0] -= np.clip(points[:, 0] - (middle - by_mm / 2), 0.0, by_mm)
    return out
