"""Search for the brush whose marks overlap most with painted ones, in few numbers on top of the fit by edges.

Changed are lag (as values at depths), tip gap, half width, the footprint's two lengths, the height of the paper and the
displacement of the sheet; on request lean and a map of the ways. By a simplex of Nelder and Mead, on a part of the
marks first.

Where marks are displaced by chance, a wider brush overlaps more than the true one: its mark reaches all places at which
paint may be. So half of the aim is the overlap where each mark may move by what displacements are expected to be: there
the true width overlaps most. See docs/reference/measurements.md.

What the machine does is changed with the laws, in one search: found before or after them, lean is what lag makes of it.
A simplex of so many numbers stops too early: pictures of predicted and painted marks are registered first, by least
squares. The laws without a machine are one more start.

Lag and footprint are hard to separate where the brush hardly turns, so that a footprint that is not round has its
price, as for the edges: squares of what it is off, weighed against overlaps as if those scattered normally.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from functools import cache

import cv2
import numpy as np
from numpy.polynomial.polynomial import polyval

from ... import _core
from ..marks.from_marks import brush_of, front_ratio, widest_ratio

# Share of the overlap with each mark moved: 0 paints too wide, 1 ignores the places of marks
SHIFTED = 0.5
FARTHEST = 2.0  # how far, in standard deviations of what displacements are expected to be
FEW = 30  # marks on which the search begins
# How far overlaps of single marks scatter, and beyond what a footprint is not called round, in half widths: length
# behind the widest section, in front of it, from there to the centre of friction
SCATTER, ROUND = 0.1, (0.4, 0.3, 0.4)
ROUGHLY_MM = 0.2  # rows of a mark while searching; the area changes by 0.05 %
# Numbers by which laws change; half widths only where the edges' have as many. At one depth, too, lag at the touch is
# not that of the depth: a brush that is lifted draws its mark on behind it. It begins as this share
LAG_TERMS, HALF_TERMS, TOUCH = 2, 2, 0.5
# By how much ways are scaled, skewed and turned at all, per mm: robot and camera are not one frame
MAP = 0.03
STEPS = {
    "lag": 0.8,
    "tip_gap": 0.4,
    "half_width": 0.4,
    "shape": 0.2,
    "height": 0.4,
    "shift": 0.4,
    "lean": 0.2,
    "map": MAP,
}
# Overlaps looked at: by a disc; from each start on few marks, then from the better one, and on all
DISC, FIRST, BETTER, LAST = 120, 100, 160, 200
# With the machine's numbers pictures are registered first: blurs, steps at each, differences as shares of STEPS
BLURS_PX, ROUNDS, NEAR = (6, 2), 6, 0.1
HIGHEST_MM, WIDEST_MM, LEAST_LAG_MM, LEAST_SHAPE = 6.0, 20.0, 0.02, 0.1  # outside: no brush, no paper
MACHINE = ("lean", "map")
# What may be changed: nothing; a dragged disc; laws and footprint; those and the machine
KINDS = ("edges", "disc", "laws", "machine")
HELD = {"disc": ("tip_gap", "shape", *MACHINE), "laws": MACHINE, "machine": ()}


@dataclass(frozen=True, eq=False)
class Target:
    """A mark to be predicted. poses_mm: of the TCP on the plan; paint: share of each pixel that is painted, row 0 at
    the top; window_mm: lower left corner and size."""

    poses_mm: np.ndarray
    paint: np.ndarray
    window_mm: tuple[float, float, float, float]
    px_per_mm: float


@dataclass(frozen=True, eq=False)
class MachineOffsets:
    """Displacement of a machine's ways in addition to the fit by edges: by lean_mm_per_mm (2,) of depth, and by map
    (2, 2) times the way from centre_mm (2,), mm per mm."""

    lean_mm_per_mm: np.ndarray
    map: np.ndarray
    centre_mm: np.ndarray

    def way(self, poses_mm: np.ndarray, height_mm: float) -> np.ndarray:
        """poses_mm (n, 3) as it runs them over paper of this height."""
        poses = np.array(poses_mm)
        depth = np.maximum(height_mm - poses[:, 2:], 0.0)
        poses[:, :2] += (poses[:, :2] - self.centre_mm) @ self.map.T + depth * self.lean_mm_per_mm
        return poses


@dataclass(frozen=True, eq=False)
class Begin:
    """The fit by edges, at which the search starts. shift_mm: of the marks, where their frame does not hold it."""

    laws: _core.MarkLaws
    height_mm: float
    shift_mm: tuple[float, float] = (0.0, 0.0)


class Search:
    """The numbers that are changed, as one vector, and what it costs."""

    def __init__(self, begin: Begin, options: _core.MarkOptions, targets: list[Target], centre_mm):
        laws, height_mm = begin.laws, begin.height_mm
        self.laws, self.height_mm, self.count = laws, height_mm, len(targets)
        self.deepest_mm = deepest = options.deepest_mm
        self.farthest_mm = FARTHEST * options.displacement_mm
        half = min(HALF_TERMS, len(laws.half_width) - 1)
        self.lag_at = np.linspace(0, deepest, LAG_TERMS)
        self.half_at = np.linspace(0, deepest, half + 1)
        self.one_depth = len(laws.lag) == 1
        self.has_height = options.height_mm.sigma > 0
        parts = {
            "lag": polyval(self.lag_at, laws.lag),
            "tip_gap": [polyval(deepest, laws.tip_gap)],
            "half_width": np.diff(polyval(self.half_at, laws.half_width)),
            "shape": [polyval(deepest, widest_ratio(laws)), polyval(deepest, front_ratio(laws))],
            "height": [height_mm] if self.has_height else [],
            "shift": begin.shift_mm,
        }
        # lean is a shift where all depths are one
        parts["lean"] = np.zeros(2 if options.lean_mm_per_mm > 0 and self.has_height else 0)
        parts["map"] = np.zeros(4 if options.axes > 0 else 0)
        self.begin = np.concatenate([np.asarray(each, float) for each in parts.values()])
        ends = np.cumsum([len(each) for each in parts.values()])
        self.at = {
            name: slice(end - len(each), end) for (name, each), end in zip(parts.items(), ends, strict=True)
        }
        self.steps = np.concatenate([np.full(len(each), STEPS[name]) for name, each in parts.items()])
        self.has_machine = bool(len(parts["lean"]) + len(parts["map"]))
        self.lean_sigma = options.lean_mm_per_mm
        self.centre_mm = centre_mm
        # a round tail's length in half widths is that of a disc, a pointed one's what it usually is
        self.usual_shape = np.array([1.0 if laws.round_tail else options.widest_per_half.value, 1.0])

    def disc(self) -> np.ndarray:
        x = self.as_disc(self.begin)
        if self.one_depth:
            x[self.at["lag"]][0] = max(TOUCH * x[self.at["lag"]][0], LEAST_LAG_MM)
        return x

    def as_disc(self, x) -> np.ndarray:
        x = np.array(x)
        x[self.at["tip_gap"]], x[self.at["shape"]] = x[self.at["half_width"]].sum(), 1.0
        return x

    def changed(self, kind: str) -> int:
        """How many numbers a kind of search changes."""
        return 0 if kind == "edges" else int(self.without(*HELD[kind]).sum())

    def without(self, *names: str) -> np.ndarray:
        """Which numbers are changed when these are not."""
        free = np.ones(len(self.begin), bool)
        for name in names:
            free[self.at[name]] = False
        return free

    def read(self, x) -> tuple[_core.MarkLaws, float, np.ndarray, MachineOffsets]:
        """Laws, height of the paper, displacement, machine."""
        change, deepest, old = x - self.begin, self.deepest_mm, self.laws
        half = np.cumsum(change[self.at["half_width"]])
        behind, front = change[self.at["shape"]]
        laws = _core.MarkLaws(
            _added(old.lag, _through(self.lag_at, change[self.at["lag"]], 0)),
            _added(old.tip_gap, [0.0, float(change[self.at["tip_gap"]][0]) / deepest]),
            _added(old.half_width, [0.0, *_through(self.half_at[1:], half, 1)]),
            old.widest_per_half + behind,
            old.front_per_half + front,
            old.round_tail,
            _added(old.widest_by_depth, [behind]) if old.widest_by_depth else [],
            _added(old.front_by_depth, [front]) if old.front_by_depth else [],
        )
        height = float(x[self.at["height"]][0]) if self.has_height else self.height_mm
        lean, by_map = (x[self.at[name]] for name in MACHINE)
        machine = MachineOffsets(
            lean if len(lean) else np.zeros(2),
            by_map.reshape(2, 2) if len(by_map) else np.zeros((2, 2)),
            self.centre_mm,
        )
        return laws, height, x[self.at["shift"]], machine

    def loss(self, x, targets: list[Target]) -> float:
        laws, height, shift, machine = self.read(x)
        if self._impossible(x, laws, height):
            return 1.0
        aim = self._overlaps(targets, laws, height, shift, machine) @ (1 - SHIFTED, SHIFTED)
        return 1 - float(aim.mean()) + float(self._price(x) @ self._price(x)) / self.count

    def differences(self, x, targets: list[Target], blur_px: int) -> np.ndarray | None:
        """Of predicted and painted pixels, blurred; squares are shares of each mark's paint, and the price. None where
        there is no such brush."""
        laws, height, shift, machine = self.read(x)
        if self._impossible(x, laws, height):
            return None
        pictures = predicted(_move_targets(targets, machine, height), laws, height, shift, self.deepest_mm)
        out = [
            blur_px / np.sqrt(target.paint.sum()) * _blurred(picture - target.paint, blur_px).ravel()
            for target, picture in zip(targets, pictures, strict=True)
        ]
        return np.concatenate([*out, self._price(x)])

    def overlaps(self, x, targets: list[Target]) -> np.ndarray:
        """Return the overlap of each mark at its place, and where it may move (n, 2)."""
        laws, height, shift, machine = self.read(x)
        return self._overlaps(targets, laws, height, shift, machine)

    def _overlaps(
        self, targets: list[Target], laws, height: float, shift, machine: MachineOffsets
    ) -> np.ndarray:
        def compared(target: Target, picture: np.ndarray) -> tuple[float, float]:
            moved, _ = best_shift(picture, target.paint, 1 / target.px_per_mm, self.farthest_mm)
            return soft_overlap(target.paint, picture), moved

        moved_targets = _move_targets(targets, machine, height)
        return np.array(of_predicted(compared, moved_targets, laws, height, shift, self.deepest_mm))

    def _price(self, x) -> np.ndarray:
        """Return the cost of a footprint that is not round, and of a machine with errors: its squares over all
        marks."""
        behind, front = x[self.at["shape"]]
        friction = x[self.at["tip_gap"]][0] / max(0.1, x[self.at["half_width"]].sum()) - behind
        if not self.laws.round_tail:
            friction = 0.0  # drops hold no disc
        off = np.array([behind - self.usual_shape[0], front - self.usual_shape[1], friction]) / ROUND
        lean, by_map = x[self.at["lean"]] / (self.lean_sigma or 1.0), x[self.at["map"]] / MAP
        return np.sqrt(SCATTER / 2) * np.concatenate([off, lean, by_map])

    def _impossible(self, x, laws, height: float) -> bool:
        """Laws that no brush has: a lag below 0, a width that falls, on all depths that the paper's height makes; a lag
        at the touch that is longer than at the one depth, which no mark would show."""
        if (
            abs(height) > HIGHEST_MM
            or x[self.at["shape"]].min() < LEAST_SHAPE
            or x[self.at["half_width"]][0] <= 0
            or (self.one_depth and np.diff(x[self.at["lag"]])[0] < 0)
        ):
            return True
        depths = np.linspace(0, self.deepest_mm + max(0.0, height), 12)
        half, lag = polyval(depths, laws.half_width), polyval(depths, laws.lag)
        return bool(lag.min() < LEAST_LAG_MM or np.diff(half).min() < 0 or half[-1] > WIDEST_MM)


def each_kind(
    search: Search, few: list[Target], look: Callable[[], None] = lambda: None
) -> Iterator[tuple[str, np.ndarray]]:
    """KINDS that there are, one after the other, with the numbers that overlap most with few marks; each begins where
    those before it ended."""

    def loss(x) -> float:
        look()
        return search.loss(x, few)

    yield "edges", search.begin
    starts, steps = [search.begin], search.steps
    alone = search.without(*HELD["laws"])
    if search.laws.round_tail:
        disc = _simplex(
            lambda x: loss(search.as_disc(x)),
            search.disc(),
            steps,
            search.without(*HELD["disc"]),
            DISC,
        )
        starts.append(search.as_disc(disc.all_x))
        yield "disc", starts[-1]
    x = _best_of(loss, starts, steps, alone)
    yield "laws", x
    if search.has_machine:
        machine = search.without(*HELD["machine"])
        x = _best_of(loss, [_registered(search, search.begin, machine, few, look), x], 0.4 * steps, machine)
        yield "machine", x


def _best_of(loss, starts: list[np.ndarray], steps, free) -> np.ndarray:
    """The best of searches from these starts; only the one that is ahead goes on."""
    found = [_simplex(loss, start, steps, free, FIRST) for start in starts]
    best = min(found, key=lambda one: one.fun)
    return _simplex(loss, best.all_x, steps, free, BETTER, best.final_simplex[0]).all_x


def polished(search: Search, kind: str, x, targets: list[Target], look: Callable[[], None]) -> np.ndarray:
    """Continue the search of few marks with all."""
    if kind == "edges":
        return x

    def loss(x) -> float:
        look()
        return search.loss(search.as_disc(x) if kind == "disc" else x, targets)

    found = _simplex(loss, x, 0.4 * search.steps, search.without(*HELD[kind]), LAST).all_x
    return search.as_disc(found) if kind == "disc" else found


def middle_of(targets: list[Target]) -> np.ndarray:
    """What a map of ways leaves where it is."""
    return np.vstack([target.poses_mm[:, :2] for target in targets]).mean(axis=0)


def best_from(
    search: Search, kind: str, starts: list[np.ndarray], few: list[Target], look: Callable[[], None]
):
    """The numbers of one kind that overlap most, from what such searches with a part of the marks ended with."""

    def loss(x) -> float:
        look()
        return search.loss(search.as_disc(x) if kind == "disc" else x, few)

    if kind == "edges":
        return search.begin
    return _best_of(loss, starts, 0.4 * search.steps, search.without(*HELD[kind]))


def few_of(targets: list[Target]) -> list[Target]:
    return targets[:: max(1, len(targets) // FEW)]


def _move_targets(targets: list[Target], machine: MachineOffsets, height_mm: float) -> list[Target]:
    if not (machine.lean_mm_per_mm.any() or machine.map.any()):
        return targets
    return [replace(one, poses_mm=machine.way(one.poses_mm, height_mm)) for one in targets]


def _registered(search: Search, x, free, targets: list[Target], look: Callable[[], None]) -> np.ndarray:
    """Least squares of predicted less painted pixels, blurred pictures first, by forward differences, as
    pictures are registered. free: which numbers are changed."""
    from scipy.optimize import least_squares

    steps, x = search.steps[free], np.array(x)

    def filled(changed) -> np.ndarray:
        out = x.copy()
        out[free] = changed
        return out

    for blur_px in BLURS_PX:

        def differences(changed, blur_px=blur_px):
            look()
            return search.differences(filled(changed), targets, blur_px)

        begin = differences(x[free])
        if begin is None:
            return x

        def or_far(changed, begin=begin, differences=differences):
            found = differences(changed)
            return np.ones(len(begin)) if found is None else found

        def slopes(changed, differences=differences):
            now, out = differences(changed), []
            for d in np.diag(NEAR * steps):
                there, sign = differences(changed + d), 1.0
                if there is None:
                    there, sign = differences(changed - d), -1.0
                out.append(np.zeros(len(now)) if there is None else sign * (there - now) / d.sum())
            return np.column_stack(out)

        x = filled(least_squares(or_far, x[free], slopes, x_scale=steps, max_nfev=ROUNDS, ftol=1e-3).x)
    return x


def _blurred(picture, blur_px: int) -> np.ndarray:
    return cv2.GaussianBlur(np.float64(picture), (0, 0), blur_px)[::blur_px, ::blur_px]


def _simplex(loss, x, steps, free, most: int, corners=None):
    """Nelder and Mead over the free numbers, from x or from the corners that an earlier search ended with."""
    from scipy.optimize import minimize

    def filled(changed) -> np.ndarray:
        out = np.array(x)
        out[free] = changed
        return out

    if corners is None:
        corners = np.vstack([x[free], *(x[free] + d for d in np.diag(steps[free]))])
    simplex = {"initial_simplex": corners, "maxfev": most, "adaptive": True, "xatol": 0.01, "fatol": 1e-5}
    found = minimize(lambda changed: loss(filled(changed)), x[free], method="Nelder-Mead", options=simplex)
    found.all_x = filled(found.x)
    return found


def _through(depths, values, first: int) -> list[float]:
    """Coefficients from the power `first` on of the law with these values at as many depths."""
    powers = np.arange(first, first + len(values))
    return np.linalg.solve(np.asarray(depths)[:, None] ** powers, values).tolist()


def _added(law, change) -> list[float]:
    out = np.zeros(max(len(law), len(change)))
    out[: len(law)] += law
    out[: len(change)] += change
    return out.tolist()


def predicted(targets: list[Target], laws, height_mm: float, shift_mm, deepest_mm: float) -> list[np.ndarray]:
    """Anti-aliased pictures of what such a brush paints, which change smoothly; footprints of half as many vertices."""
    return of_predicted(lambda target, picture: picture, targets, laws, height_mm, shift_mm, deepest_mm)


def of_predicted(
    what: Callable, targets: list[Target], laws, height_mm: float, shift_mm, deepest_mm: float
) -> list:
    """what(target, picture) of each target, on all processors."""
    deepest = max(deepest_mm, *(-target.poses_mm[:, 2].min() for target in targets))
    brush = brush_of(laws, "fitted", (0.0, deepest + max(0.0, height_mm)))
    outlines = [(one.depth_mm, np.array(one.outline_mm)[::2]) for one in brush.footprints.dragged]
    brush.footprints = _core.FootprintTable([_core.Footprint(depth, ring) for depth, ring in outlines])

    def of_one(target: Target):
        way = _core.Pass("mark", on_paper(target.poses_mm, height_mm, shift_mm))
        marks = _core.simulate(_core.Plan("fitted", "", (1.0, 1.0), [way]), brush, ROUGHLY_MM)
        return what(target, _core.coverage(marks, brush, target.window_mm, target.px_per_mm))

    return list(_workers().map(of_one, targets))


@cache
def _workers() -> ThreadPoolExecutor:
    return ThreadPoolExecutor(os.cpu_count())


def on_paper(poses_mm, height_mm: float, shift_mm) -> np.ndarray:
    """Return the TCP's way with the heights and places of paper and sheet that were found."""
    poses = np.array(poses_mm)
    poses[:, :2] += shift_mm
    poses[:, 2] = np.minimum(poses[:, 2] - height_mm, 0.0)
    return poses


def soft_overlap(paint, picture) -> float:
    both = float(np.minimum(paint, picture).sum())
    either = float(paint.sum() + picture.sum()) - both
    return both / either if either > 0 else 1.0


def best_shift(picture, paint, px_mm: float, farthest_mm: float) -> tuple[float, np.ndarray]:
    """Largest overlap when the prediction moves by whole pixels up to farthest_mm; where to [mm], y up."""
    reach = int(farthest_mm / px_mm)
    grown = cv2.copyMakeBorder(np.float32(paint), reach, reach, reach, reach, cv2.BORDER_CONSTANT, value=0)
    found = cv2.matchTemplate(grown, np.float32(picture), cv2.TM_CCORR)
    total = picture.sum() + paint.sum()
    y, x = np.mgrid[-reach : reach + 1, -reach : reach + 1]
    score = np.where(x**2 + y**2 <= reach**2, found / np.maximum(total - found, 1e-9), 0)
    k = np.unravel_index(int(score.argmax()), score.shape)
    return float(score[k]), np.array([x[k], -y[k]]) * px_mm
