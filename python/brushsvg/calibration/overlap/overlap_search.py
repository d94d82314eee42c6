"""Search for the brush whose marks overlap most with painted marks.

The search changes a few numbers of the fit by edges. They are the lag (as values at depths), the tip gap, the half
width, the two lengths of the footprint, the height of the paper and the displacement of the sheet. On request it also
changes lean and a map of the paths. It uses the simplex method of Nelder and Mead, at first on a part of the marks.

If marks are displaced by chance, a wider brush overlaps more than the true brush, because its mark reaches all places
with paint. Half of the objective is therefore the overlap if each mark may move within the expected displacements.
The true width maximises this part. See docs/reference/measurements.md.

Errors of the machine are changed together with the laws, in one search. If they were found before or after the laws,
the lag would bias the lean. A simplex with that many numbers stops too early. Pictures of predicted and painted marks
are therefore registered first, by least squares. The laws without a machine are one more start.

Lag and footprint are hard to separate if the brush hardly turns. A footprint that is not round therefore has a cost, as
in the fit by edges. The cost is the squared deviation, weighted against overlaps as if they scattered normally.
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

# Share of the overlap with moved marks in the objective. With 0 the brush gets too wide. With 1 the places of marks
# have no effect.
MOVED_SHARE = 0.5
MAX_MOVE_SIGMAS = 2.0  # largest move of a mark, in standard deviations of the expected displacements
FIRST_MARK_COUNT = 30  # number of marks on which the search begins
# Standard deviation of the overlaps of single marks. Deviations of a round footprint, in half widths: length behind the
# widest section, length in front of it, and from there to the centre of friction.
OVERLAP_SIGMA, ROUNDNESS_SIGMAS = 0.1, (0.4, 0.3, 0.4)
ROW_SPACING_MM = 0.2  # spacing of the rows of a mark during the search; the area changes by 0.05 %
# Numbers by which the laws change. The half width has at most as many as in the fit by edges. Even with a single depth,
# the lag at first touch differs from the lag at that depth, because a lifted brush pulls its mark behind it. The lag at
# touch starts as this share.
LAG_TERMS, HALF_TERMS, TOUCH_LAG_SHARE = 2, 2, 0.5
# Standard deviation of scale, skew and turn of the paths, per mm. Robot and camera have different frames.
MAP_SIGMA = 0.03
SIMPLEX_STEPS = {  # size of the first simplex, for each group of numbers
    "lag": 0.8,
    "tip_gap": 0.4,
    "half_width": 0.4,
    "shape": 0.2,
    "height": 0.4,
    "shift": 0.4,
    "lean": 0.2,
    "map": MAP_SIGMA,
}
# Evaluations: for a disc; from each start on few marks; from the better start; and on all marks.
DISC_EVALUATIONS, START_EVALUATIONS, CONTINUED_EVALUATIONS, FINAL_EVALUATIONS = 120, 100, 160, 200
# Registration of pictures, for the numbers of the machine: blurs, steps per blur, differences as shares of
# SIMPLEX_STEPS.
BLURS_PX, REGISTRATION_STEPS, DIFFERENCE_SHARE = (6, 2), 6, 0.1
# Limits of the paper height, the half width, the lag and the lengths of the footprint. No brush or paper is outside.
MAX_HEIGHT_MM, MAX_HALF_WIDTH_MM, MIN_LAG_MM, MIN_SHAPE = 6.0, 20.0, 0.02, 0.1
MACHINE_NUMBERS = ("lean", "map")
# Kinds of search, by what they may change: nothing; a dragged disc; laws and footprint; laws, footprint and machine.
KINDS = ("edges", "disc", "laws", "machine")
# Numbers that a kind of search does not change.
FIXED_NUMBERS = {"disc": ("tip_gap", "shape", *MACHINE_NUMBERS), "laws": MACHINE_NUMBERS, "machine": ()}


@dataclass(frozen=True, eq=False)
class Target:
    """A painted mark that the search predicts.

    poses_mm: poses of the TCP in the plan. paint: painted share of each pixel, row 0 at the top. window_mm: lower left
    corner and size of the picture.
    """

    poses_mm: np.ndarray
    paint: np.ndarray
    window_mm: tuple[float, float, float, float]
    px_per_mm: float


@dataclass(frozen=True, eq=False)
class MachineOffsets:
    """Errors of a machine in addition to the fit by edges.

    A path is displaced by the depth times lean_mm_per_mm (2,). It is also displaced by map (2, 2) [mm/mm] times the
    vector from centre_mm (2,).
    """

    lean_mm_per_mm: np.ndarray
    map: np.ndarray
    centre_mm: np.ndarray

    def displace_path(self, poses_mm: np.ndarray, height_mm: float) -> np.ndarray:
        """Return the poses (n, 3) as the machine executes them over paper of this height."""
        poses = np.array(poses_mm)
        depth = np.maximum(height_mm - poses[:, 2:], 0.0)
        poses[:, :2] += (poses[:, :2] - self.centre_mm) @ self.map.T + depth * self.lean_mm_per_mm
        return poses


@dataclass(frozen=True, eq=False)
class SearchStart:
    """The fit by edges, at which the search starts.

    shift_mm: shift of the marks, if their frame does not include it.
    """

    laws: _core.MarkLaws
    height_mm: float
    shift_mm: tuple[float, float] = (0.0, 0.0)


class Search:
    """The numbers that the search changes, as one vector, and the objective."""

    def __init__(self, begin: SearchStart, options: _core.MarkOptions, targets: list[Target], centre_mm):
        laws, height_mm = begin.laws, begin.height_mm
        self.laws, self.height_mm, self.count = laws, height_mm, len(targets)
        self.deepest_mm = deepest = options.deepest_mm
        self.max_move_mm = MAX_MOVE_SIGMAS * options.displacement_mm
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
        # With a single depth, lean is equivalent to a shift.
        parts["lean"] = np.zeros(2 if options.lean_mm_per_mm > 0 and self.has_height else 0)
        parts["map"] = np.zeros(4 if options.axes > 0 else 0)
        self.begin = np.concatenate([np.asarray(numbers, float) for numbers in parts.values()])
        ends = np.cumsum([len(numbers) for numbers in parts.values()])
        self.at = {
            name: slice(end - len(numbers), end) for (name, numbers), end in zip(parts.items(), ends, strict=True)
        }
        self.steps = np.concatenate([np.full(len(numbers), SIMPLEX_STEPS[name]) for name, numbers in parts.items()])
        self.has_machine = bool(len(parts["lean"]) + len(parts["map"]))
        self.lean_sigma = options.lean_mm_per_mm
        self.centre_mm = centre_mm
        # A round tail is as long as the tail of a disc, in half widths; a pointed tail has its usual length.
        self.usual_shape = np.array([1.0 if laws.round_tail else options.widest_per_half.value, 1.0])

    def make_disc_start(self) -> np.ndarray:
        """Return the vector at which the search for a dragged disc starts."""
        x = self.restrict_to_disc(self.begin)
        if self.one_depth:
            x[self.at["lag"]][0] = max(TOUCH_LAG_SHARE * x[self.at["lag"]][0], MIN_LAG_MM)
        return x

    def restrict_to_disc(self, x) -> np.ndarray:
        """Return the vector with a disc as footprint, centred on the centre of friction."""
        x = np.array(x)
        x[self.at["tip_gap"]], x[self.at["shape"]] = x[self.at["half_width"]].sum(), 1.0
        return x

    def count_changed(self, kind: str) -> int:
        """Return how many numbers a kind of search changes."""
        return 0 if kind == "edges" else int(self.free_numbers(*FIXED_NUMBERS[kind]).sum())

    def free_numbers(self, *names: str) -> np.ndarray:
        """Return a mask of the numbers that are changed if the named ones are fixed."""
        free = np.ones(len(self.begin), bool)
        for name in names:
            free[self.at[name]] = False
        return free

    def read(self, x) -> tuple[_core.MarkLaws, float, np.ndarray, MachineOffsets]:
        """Return the laws, paper height, displacement and machine of a vector."""
        change, deepest, old = x - self.begin, self.deepest_mm, self.laws
        half = np.cumsum(change[self.at["half_width"]])
        behind, front = change[self.at["shape"]]
        laws = _core.MarkLaws(
            _add_polynomials(old.lag, _interpolate_law(self.lag_at, change[self.at["lag"]], 0)),
            _add_polynomials(old.tip_gap, [0.0, float(change[self.at["tip_gap"]][0]) / deepest]),
            _add_polynomials(old.half_width, [0.0, *_interpolate_law(self.half_at[1:], half, 1)]),
            old.widest_per_half + behind,
            old.front_per_half + front,
            old.round_tail,
            _add_polynomials(old.widest_by_depth, [behind]) if old.widest_by_depth else [],
            _add_polynomials(old.front_by_depth, [front]) if old.front_by_depth else [],
        )
        height = float(x[self.at["height"]][0]) if self.has_height else self.height_mm
        lean, by_map = (x[self.at[name]] for name in MACHINE_NUMBERS)
        machine = MachineOffsets(
            lean if len(lean) else np.zeros(2),
            by_map.reshape(2, 2) if len(by_map) else np.zeros((2, 2)),
            self.centre_mm,
        )
        return laws, height, x[self.at["shift"]], machine

    def loss(self, x, targets: list[Target]) -> float:
        laws, height, shift, machine = self.read(x)
        if self._is_impossible(x, laws, height):
            return 1.0
        aim = self._overlaps(targets, laws, height, shift, machine) @ (1 - MOVED_SHARE, MOVED_SHARE)
        return 1 - float(aim.mean()) + float(self._cost_terms(x) @ self._cost_terms(x)) / self.count

    def differences(self, x, targets: list[Target], blur_px: int) -> np.ndarray | None:
        """Return the blurred differences of pixels, and the cost terms.

        The differences are predicted minus painted. Their squares are shares of the paint of each mark. Return None if
        the brush is impossible.
        """
        laws, height, shift, machine = self.read(x)
        if self._is_impossible(x, laws, height):
            return None
        pictures = predict_pictures(_move_targets(targets, machine, height), laws, height, shift, self.deepest_mm)
        out = [
            blur_px / np.sqrt(target.paint.sum()) * _blur(picture - target.paint, blur_px).ravel()
            for target, picture in zip(targets, pictures, strict=True)
        ]
        return np.concatenate([*out, self._cost_terms(x)])

    def overlaps(self, x, targets: list[Target]) -> np.ndarray:
        """Return the overlaps (n, 2) of the marks: in place, and moved."""
        laws, height, shift, machine = self.read(x)
        return self._overlaps(targets, laws, height, shift, machine)

    def _overlaps(self, targets: list[Target], laws, height: float, shift, machine: MachineOffsets) -> np.ndarray:
        def compared(target: Target, picture: np.ndarray) -> tuple[float, float]:
            moved, _ = best_shift(picture, target.paint, 1 / target.px_per_mm, self.max_move_mm)
            return soft_overlap(target.paint, picture), moved

        moved_targets = _move_targets(targets, machine, height)
        return np.array(map_predicted(compared, moved_targets, laws, height, shift, self.deepest_mm))

    def _cost_terms(self, x) -> np.ndarray:
        """Return the terms whose squares are the cost of an unusual footprint and of machine errors, for all marks."""
        behind, front = x[self.at["shape"]]
        friction = x[self.at["tip_gap"]][0] / max(0.1, x[self.at["half_width"]].sum()) - behind
        if not self.laws.round_tail:
            friction = 0.0  # a drop contains no disc
        off = np.array([behind - self.usual_shape[0], front - self.usual_shape[1], friction]) / ROUNDNESS_SIGMAS
        lean, by_map = x[self.at["lean"]] / (self.lean_sigma or 1.0), x[self.at["map"]] / MAP_SIGMA
        return np.sqrt(OVERLAP_SIGMA / 2) * np.concatenate([off, lean, by_map])

    def _is_impossible(self, x, laws, height: float) -> bool:
        """Return whether no brush has these laws.

        The lag must be positive and the width must not fall at all depths that the paper height causes. With a single
        depth, the lag at first touch must not exceed the lag at that depth, because no mark would show it.
        """
        if (
            abs(height) > MAX_HEIGHT_MM
            or x[self.at["shape"]].min() < MIN_SHAPE
            or x[self.at["half_width"]][0] <= 0
            or (self.one_depth and np.diff(x[self.at["lag"]])[0] < 0)
        ):
            return True
        depths = np.linspace(0, self.deepest_mm + max(0.0, height), 12)
        half, lag = polyval(depths, laws.half_width), polyval(depths, laws.lag)
        return bool(lag.min() < MIN_LAG_MM or np.diff(half).min() < 0 or half[-1] > MAX_HALF_WIDTH_MM)


def search_each_kind(
    search: Search, subset: list[Target], count_evaluation: Callable[[], None] = lambda: None
) -> Iterator[tuple[str, np.ndarray]]:
    """Yield each possible kind of search with its best vector for a subset of the marks.

    Each kind starts where the earlier kinds ended. count_evaluation is called before each evaluation.
    """

    def loss(x) -> float:
        count_evaluation()
        return search.loss(x, subset)

    yield "edges", search.begin
    starts, steps = [search.begin], search.steps
    free = search.free_numbers(*FIXED_NUMBERS["laws"])
    if search.laws.round_tail:
        disc = _minimise(
            lambda x: loss(search.restrict_to_disc(x)),
            search.make_disc_start(),
            steps,
            search.free_numbers(*FIXED_NUMBERS["disc"]),
            DISC_EVALUATIONS,
        )
        starts.append(search.restrict_to_disc(disc.all_x))
        yield "disc", starts[-1]
    x = _search_from_starts(loss, starts, steps, free)
    yield "laws", x
    if search.has_machine:
        machine = search.free_numbers(*FIXED_NUMBERS["machine"])
        x = _search_from_starts(
            loss,
            [_register_pictures(search, search.begin, machine, subset, count_evaluation), x],
            0.4 * steps,
            machine,
        )
        yield "machine", x


def _search_from_starts(loss, starts: list[np.ndarray], steps, free) -> np.ndarray:
    """Search from several starts, and continue only the best search. Return its vector."""
    searches = [_minimise(loss, start, steps, free, START_EVALUATIONS) for start in starts]
    best = min(searches, key=lambda search_result: search_result.fun)
    return _minimise(loss, best.all_x, steps, free, CONTINUED_EVALUATIONS, best.final_simplex[0]).all_x


def refine_with_all(
    search: Search, kind: str, x, targets: list[Target], count_evaluation: Callable[[], None]
) -> np.ndarray:
    """Continue a search that used a subset of the marks, now with all marks."""
    if kind == "edges":
        return x

    def loss(x) -> float:
        count_evaluation()
        return search.loss(search.restrict_to_disc(x) if kind == "disc" else x, targets)

    refined = _minimise(loss, x, 0.4 * search.steps, search.free_numbers(*FIXED_NUMBERS[kind]), FINAL_EVALUATIONS).all_x
    return search.restrict_to_disc(refined) if kind == "disc" else refined


def mean_place(targets: list[Target]) -> np.ndarray:
    """Return the point that a map of the paths leaves unchanged."""
    return np.vstack([target.poses_mm[:, :2] for target in targets]).mean(axis=0)


def find_best_vector(
    search: Search,
    kind: str,
    starts: list[np.ndarray],
    subset: list[Target],
    count_evaluation: Callable[[], None],
):
    """Return the vector of one kind that overlaps most.

    starts: results of searches of this kind with parts of the marks.
    """

    def loss(x) -> float:
        count_evaluation()
        return search.loss(search.restrict_to_disc(x) if kind == "disc" else x, subset)

    if kind == "edges":
        return search.begin
    return _search_from_starts(loss, starts, 0.4 * search.steps, search.free_numbers(*FIXED_NUMBERS[kind]))


def choose_subset(targets: list[Target]) -> list[Target]:
    return targets[:: max(1, len(targets) // FIRST_MARK_COUNT)]


def _move_targets(targets: list[Target], machine: MachineOffsets, height_mm: float) -> list[Target]:
    if not (machine.lean_mm_per_mm.any() or machine.map.any()):
        return targets
    return [replace(target, poses_mm=machine.displace_path(target.poses_mm, height_mm)) for target in targets]


def _register_pictures(
    search: Search, x, free, targets: list[Target], count_evaluation: Callable[[], None]
) -> np.ndarray:
    """Register predicted and painted pictures, blurred ones first, by least squares; free: numbers that change."""
    from scipy.optimize import least_squares

    steps, x = search.steps[free], np.array(x)

    def fill_free(changed) -> np.ndarray:
        out = x.copy()
        out[free] = changed
        return out

    for blur_px in BLURS_PX:

        def differences(changed, blur_px=blur_px):
            count_evaluation()
            return search.differences(fill_free(changed), targets, blur_px)

        begin = differences(x[free])
        if begin is None:
            return x

        def differences_or_ones(changed, begin=begin, differences=differences):
            residuals = differences(changed)
            return np.ones(len(begin)) if residuals is None else residuals

        def slopes(changed, differences=differences):
            now, out = differences(changed), []
            for d in np.diag(DIFFERENCE_SHARE * steps):
                there, sign = differences(changed + d), 1.0
                if there is None:
                    there, sign = differences(changed - d), -1.0
                out.append(np.zeros(len(now)) if there is None else sign * (there - now) / d.sum())
            return np.column_stack(out)

        x = fill_free(
            least_squares(differences_or_ones, x[free], slopes, x_scale=steps, max_nfev=REGISTRATION_STEPS, ftol=1e-3).x
        )
    return x


def _blur(picture, blur_px: int) -> np.ndarray:
    return cv2.GaussianBlur(np.float64(picture), (0, 0), blur_px)[::blur_px, ::blur_px]


def _minimise(loss, x, steps, free, max_evaluations: int, corners=None):
    """Minimise the loss over the free numbers by Nelder and Mead, from x or an earlier search's corners."""
    from scipy.optimize import minimize

    def fill_free(changed) -> np.ndarray:
        out = np.array(x)
        out[free] = changed
        return out

    if corners is None:
        corners = np.vstack([x[free], *(x[free] + d for d in np.diag(steps[free]))])
    simplex = {"initial_simplex": corners, "maxfev": max_evaluations, "adaptive": True, "xatol": 0.01, "fatol": 1e-5}
    result = minimize(lambda changed: loss(fill_free(changed)), x[free], method="Nelder-Mead", options=simplex)
    result.all_x = fill_free(result.x)
    return result


def _interpolate_law(depths, values, first: int) -> list[float]:
    """Return the coefficients, from power `first` on, of the law with these values at as many depths."""
    powers = np.arange(first, first + len(values))
    return np.linalg.solve(np.asarray(depths)[:, None] ** powers, values).tolist()


def _add_polynomials(law, change) -> list[float]:
    out = np.zeros(max(len(law), len(change)))
    out[: len(law)] += law
    out[: len(change)] += change
    return out.tolist()


def predict_pictures(targets: list[Target], laws, height_mm: float, shift_mm, deepest_mm: float) -> list[np.ndarray]:
    """Return anti-aliased pictures of the marks of a brush.

    They change smoothly with its laws. For speed, the footprints have half as many vertices.
    """
    return map_predicted(lambda target, picture: picture, targets, laws, height_mm, shift_mm, deepest_mm)


def map_predicted(
    evaluate: Callable, targets: list[Target], laws, height_mm: float, shift_mm, deepest_mm: float
) -> list:
    """Call evaluate(target, picture) with the predicted picture of each target.

    Return the results. All processors are used.
    """
    deepest = max(deepest_mm, *(-target.poses_mm[:, 2].min() for target in targets))
    brush = brush_of(laws, "fitted", (0.0, deepest + max(0.0, height_mm)))
    outlines = [(footprint.depth_mm, np.array(footprint.outline_mm)[::2]) for footprint in brush.footprints.dragged]
    brush.footprints = _core.FootprintTable([_core.Footprint(depth, ring) for depth, ring in outlines])

    def predict(target: Target):
        stroke_pass = _core.Pass("mark", move_to_fitted_paper(target.poses_mm, height_mm, shift_mm))
        marks = _core.simulate(_core.Plan("fitted", "", (1.0, 1.0), [stroke_pass]), brush, ROW_SPACING_MM)
        return evaluate(target, _core.coverage(marks, brush, target.window_mm, target.px_per_mm))

    return list(_workers().map(predict, targets))


@cache
def _workers() -> ThreadPoolExecutor:
    return ThreadPoolExecutor(os.cpu_count())


def move_to_fitted_paper(poses_mm, height_mm: float, shift_mm) -> np.ndarray:
    """Return the poses of the TCP relative to the fitted paper. The paper has the given height and shift."""
    poses = np.array(poses_mm)
    poses[:, :2] += shift_mm
    poses[:, 2] = np.minimum(poses[:, 2] - height_mm, 0.0)
    return poses


def soft_overlap(paint, picture) -> float:
    both = float(np.minimum(paint, picture).sum())
    either = float(paint.sum() + picture.sum()) - both
    return both / either if either > 0 else 1.0


def best_shift(picture, paint, px_mm: float, max_move_mm: float) -> tuple[float, np.ndarray]:
    """Return the largest overlap of a moved prediction, and the move [mm].

    The prediction moves by whole pixels. The move has y up.
    """
    reach = int(max_move_mm / px_mm)
    padded = cv2.copyMakeBorder(np.float32(paint), reach, reach, reach, reach, cv2.BORDER_CONSTANT, value=0)
    common = cv2.matchTemplate(padded, np.float32(picture), cv2.TM_CCORR)
    total = picture.sum() + paint.sum()
    y, x = np.mgrid[-reach : reach + 1, -reach : reach + 1]
    score = np.where(x**2 + y**2 <= reach**2, common / np.maximum(total - common, 1e-9), 0)
    k = np.unravel_index(int(score.argmax()), score.shape)
    return float(score[k]), np.array([x[k], -y[k]]) * px_mm
