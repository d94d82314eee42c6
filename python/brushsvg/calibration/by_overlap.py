"""A brush fitted to painted marks, changed so that it predicts further marks best: to the largest overlap.

Edges say what the usual mark is; overlap (intersection over union of painted and predicted area) says what to predict
where marks vary and lie off. What is changed are few numbers on top of what edges told: lag (as values at depths), tip
gap, half width, the footprint's two lengths, the height of the paper and the displacement of the sheet. A simplex
search by Nelder and Mead, from the edges' fit, and from a disc where tails are round; on a part of the marks first.

Where marks lie aside by chance, a wider brush overlaps more than the true one: its mark reaches all places at which
paint may be. So half of the aim is the overlap where each mark may move by what displacements are expected to be: there
the true width overlaps most. See docs/calibration.md.

What the machine does besides is changed with the laws, in one search, where it is asked for (lean, axes): found before
or after them, lean is what lag makes of it. A simplex of so many numbers stops too early: pictures of predicted and
painted marks are registered first, by least squares.

Lag and footprint tell little apart where the brush hardly turns, so that a footprint that is not round has its price,
as for the edges: squares of what it is off, weighed against overlaps as if those scattered normally.
"""

from __future__ import annotations

from collections.abc import Callable
from copy import copy
from dataclasses import dataclass, replace

import cv2
import numpy as np
from numpy.polynomial.polynomial import polyval

from .. import _core
from ..array_values import ArrayValue
from ..geometry.rotation import rotation
from .from_marks import MarkCalibration, brush_of, front_ratio, widest_ratio
from .lag_by_outlines import Placed, PlacedMark

# Share of the overlap with each mark moved: 0 paints too wide, 1 says nothing of where marks lie
SHIFTED = 0.5
FARTHEST = 2.0  # how far, in standard deviations of what displacements are expected to be
PIXEL, MARGIN_MM = 1 / 6, 8.0  # of the pictures: half widths of the deepest mark, around way and paint
FEW = 30  # marks on which the search begins
# How far overlaps of single marks scatter, and beyond what a footprint is not called round, in half widths: length
# behind the widest section, in front of it, from there to the centre of friction
SCATTER, ROUND = 0.1, (0.4, 0.3, 0.4)
ROUGHLY_MM = 0.2  # rows of a mark while searching; the area changes by 0.05 %
LAG_TERMS, HALF_TERMS = 2, 2  # numbers by which laws change, where the edges' have as many
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
FIRST, LAST = 260, 200  # overlaps looked at, from each start on few marks, and from the best on all
# With the machine's numbers pictures are registered first: blurs, steps at each, differences as shares of STEPS
BLURS_PX, ROUNDS, NEAR = (6, 2), 6, 0.1
HIGHEST_MM, WIDEST_MM, LEAST_LAG_MM, LEAST_SHAPE = 6.0, 20.0, 0.02, 0.1  # outside: no brush, no paper
EVERY = 20  # looks between two words on how far it is


@dataclass(frozen=True, eq=False)
class Target:
    """A mark to be predicted. poses_mm: of the TCP on the plan; paint: share of each pixel that is painted, row 0 at
    the top; window_mm: lower left corner and size."""

    poses_mm: np.ndarray
    paint: np.ndarray
    window_mm: tuple[float, float, float, float]
    px_per_mm: float


@dataclass(frozen=True, eq=False)
class Led:
    """How a machine runs a way besides what edges told of it: aside by lean_mm_per_mm (2,) of depth, and by map
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


@dataclass(frozen=True, eq=False, repr=False)
class OverlapCalibration(ArrayValue):
    """made: the marks with the brush that predicts best, lying where it has them (Placed); by_edges: what it was made
    of, the brush with intervals; found: what was changed."""

    made: MarkCalibration
    by_edges: MarkCalibration
    found: Predicting

    @property
    def brush(self) -> _core.Brush:
        """Without intervals: those of the edges are not its own."""
        return self.made.brush

    def __repr__(self) -> str:
        return f"<OverlapCalibration of {self.brush!r} from {len(self.made.painted.marks)} marks>"


def by_overlap(
    made: MarkCalibration, progress: Callable[[str], object] = lambda text: None
) -> OverlapCalibration:
    """made: what edges told of the marks. Those that are outliers as a whole have no say here, either. progress: is
    told in words how far it is."""
    fit, options = made.fit, copy(made.expected)
    options.deepest_mm = made.brush.depth_range_mm[1]
    targets = [
        _target(mark, miss, made)
        for mark, miss in zip(made.painted.marks, fit.marks, strict=True)
        if not miss.outlier
    ]

    def say(now: int, most: int) -> None:
        progress(f"looked at {now} of {most} overlaps")

    found = largest_overlap(targets, fit.laws, fit.height_mm, options, progress=say)
    brush = brush_of(found.laws, made.brush.name, made.brush.depth_range_mm)
    brush.max_speed_mm_s = made.brush.max_speed_mm_s
    for law in ("lag", "tip_gap", "tip_to_widest", "half_width"):
        was = getattr(brush, law)
        told = _core.Profile(
            was.coefficients,
            calibrated_mm=(0.0, made.painted.deepest_mm),
            source=f"Fitted to {len(targets)} painted marks, to the largest overlap; without intervals.",
            floor=was.floor,
            floor_slope=was.floor_slope,
        )
        setattr(brush, law, told)
    _core.check(brush)
    placed = Placed(
        fit.turn_rad,
        tuple((np.array(fit.shift_mm) + found.shift_mm @ rotation(fit.turn_rad)).tolist()),
        fit.centre_mm,
        found.height_mm,
        tuple(
            PlacedMark(
                found.led.way(np.array(miss.way_mm), found.height_mm),
                tuple((miss.displacement_mm - found.shift_mm).tolist()),
            )
            for miss in fit.marks
        ),
    )
    return OverlapCalibration(replace(made, brush=brush, fit=placed, covariance=None), made, found)


def _target(mark, miss, made: MarkCalibration) -> Target:
    """A painted mark in the plan's frame."""
    fit = made.fit
    centre, back = np.array(fit.centre_mm), rotation(-fit.turn_rad)
    rings = [(np.array(ring) - fit.shift_mm - centre) @ back + centre for ring in mark.outline_mm]
    poses = np.array(miss.way_mm)
    pixel = PIXEL * polyval(made.brush.depth_range_mm[1], fit.laws.half_width)
    seen = np.vstack([poses[:, :2], *rings])
    low, high = seen.min(axis=0) - MARGIN_MM, seen.max(axis=0) + MARGIN_MM
    size = np.ceil((high - low) / pixel) * pixel
    window = (*low.tolist(), *size.tolist())
    return Target(poses, _core.coverage(rings, window, 1 / pixel), window, 1 / pixel)


@dataclass(frozen=True, eq=False)
class Predicting:
    """What overlaps most: laws as a fit of marks has them, height of the paper, displacement of all marks, what the
    machine does besides; the overlap by edges and now, and how many numbers were changed."""

    laws: _core.MarkLaws
    height_mm: float
    shift_mm: np.ndarray
    led: Led
    before: float
    overlap: float
    numbers: int


def largest_overlap(
    targets: list[Target],
    laws: _core.MarkLaws,
    height_mm: float,
    options: _core.MarkOptions,
    shift_mm=(0.0, 0.0),
    progress: Callable[[int, int], object] = lambda now, most: None,
) -> Predicting:
    """laws, height_mm, shift_mm: what edges told, which the search starts at. progress: is told how many of how many
    overlaps were looked at."""
    search = _Search(laws, height_mm, shift_mm, options, targets)
    starts = [search.begin, search.disc()] if laws.round_tail else [search.begin]
    registering = len(BLURS_PX) * ROUNDS * (1 + len(search.steps)) if search.has_machine else 0
    most, looks = len(starts) * (registering + FIRST) + LAST, 0

    def look() -> None:
        nonlocal looks
        looks += 1
        if looks % EVERY == 0:
            progress(min(looks, most), most)

    def loss_on(chosen: list[Target]):
        def loss(x) -> float:
            look()
            return search.loss(x, chosen)

        return loss

    few = targets[:: max(1, len(targets) // FEW)]
    steps = search.steps
    if search.has_machine:
        starts, steps = [_registered(search, start, few, look) for start in starts], 0.4 * search.steps
    found = [_simplex(loss_on(few), start, steps, FIRST) for start in starts]
    best = min(found, key=lambda one: one.fun)
    best = _simplex(loss_on(targets), best.x, 0.4 * search.steps, LAST)
    return Predicting(
        *search.read(best.x),
        search.overlap(search.begin, targets),
        search.overlap(best.x, targets),
        len(best.x),
    )


class _Search:
    """The numbers that are changed, as one vector, and what it costs."""

    def __init__(self, laws, height_mm: float, shift_mm, options, targets: list[Target]):
        self.laws, self.height_mm, self.count = laws, height_mm, len(targets)
        self.deepest_mm = deepest = options.deepest_mm
        self.farthest_mm = FARTHEST * options.displacement_mm
        lag, half = min(LAG_TERMS, len(laws.lag)), min(HALF_TERMS, len(laws.half_width) - 1)
        self.lag_at = np.linspace(0, deepest, lag) if lag > 1 else np.array([deepest / 2])
        self.half_at = np.linspace(0, deepest, half + 1)
        self.has_height = options.height_mm.sigma > 0
        parts = {
            "lag": polyval(self.lag_at, laws.lag),
            "tip_gap": [polyval(deepest, laws.tip_gap)],
            "half_width": np.diff(polyval(self.half_at, laws.half_width)),
            "shape": [polyval(deepest, widest_ratio(laws)), polyval(deepest, front_ratio(laws))],
            "height": [height_mm] if self.has_height else [],
            "shift": shift_mm,
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
        self.centre_mm = np.vstack([target.poses_mm[:, :2] for target in targets]).mean(axis=0)
        # a round tail's length in half widths is that of a disc, a pointed one's what it usually is
        self.usual_shape = np.array([1.0 if laws.round_tail else options.widest_per_half.value, 1.0])

    def disc(self) -> np.ndarray:
        x = self.begin.copy()
        x[self.at["tip_gap"]], x[self.at["shape"]] = x[self.at["half_width"]].sum(), 1.0
        return x

    def read(self, x) -> tuple[_core.MarkLaws, float, np.ndarray, Led]:
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
        lean, by_map = x[self.at["lean"]], x[self.at["map"]]
        led = Led(
            lean if len(lean) else np.zeros(2),
            by_map.reshape(2, 2) if len(by_map) else np.zeros((2, 2)),
            self.centre_mm,
        )
        return laws, height, x[self.at["shift"]], led

    def loss(self, x, targets: list[Target]) -> float:
        laws, height, shift, led = self.read(x)
        if self._impossible(x, laws, height):
            return 1.0
        pictures = predicted(_led(targets, led, height), laws, height, shift, self.deepest_mm)
        return 1 - self._aim(targets, pictures) + float(self._price(x) @ self._price(x)) / self.count

    def differences(self, x, targets: list[Target], blur_px: int) -> np.ndarray | None:
        """Of predicted and painted pixels, blurred; squares are shares of each mark's paint, and the price. None where
        there is no such brush."""
        laws, height, shift, led = self.read(x)
        if self._impossible(x, laws, height):
            return None
        pictures = predicted(_led(targets, led, height), laws, height, shift, self.deepest_mm)
        out = [
            blur_px / np.sqrt(target.paint.sum()) * _blurred(picture - target.paint, blur_px).ravel()
            for target, picture in zip(targets, pictures, strict=True)
        ]
        return np.concatenate([*out, self._price(x)])

    def _aim(self, targets: list[Target], pictures) -> float:
        """Mean overlap, where marks lie and where each may move, in shares."""
        lying, moved = 0.0, 0.0
        for target, picture in zip(targets, pictures, strict=True):
            lying += soft_overlap(target.paint, picture)
            moved += best_shift(picture, target.paint, 1 / target.px_per_mm, self.farthest_mm)[0]
        return ((1 - SHIFTED) * lying + SHIFTED * moved) / len(targets)

    def overlap(self, x, targets: list[Target]) -> float:
        laws, height, shift, led = self.read(x)
        pictures = predicted(_led(targets, led, height), laws, height, shift, self.deepest_mm)
        return float(np.mean([soft_overlap(a.paint, b) for a, b in zip(targets, pictures, strict=True)]))

    def _price(self, x) -> np.ndarray:
        """Of a footprint that is not round, and of a machine that does not as it is told: its squares over all marks
        are what it costs."""
        behind, front = x[self.at["shape"]]
        friction = x[self.at["tip_gap"]][0] / max(0.1, x[self.at["half_width"]].sum()) - behind
        if not self.laws.round_tail:
            friction = 0.0  # drops hold no disc
        off = np.array([behind - self.usual_shape[0], front - self.usual_shape[1], friction]) / ROUND
        lean, by_map = x[self.at["lean"]] / (self.lean_sigma or 1.0), x[self.at["map"]] / MAP
        return np.sqrt(SCATTER / 2) * np.concatenate([off, lean, by_map])

    def _impossible(self, x, laws, height: float) -> bool:
        """Laws that no brush has: a lag below 0, a width that falls, on all depths that the paper's height makes."""
        if (
            abs(height) > HIGHEST_MM
            or x[self.at["shape"]].min() < LEAST_SHAPE
            or x[self.at["half_width"]][0] <= 0
        ):
            return True
        depths = np.linspace(0, self.deepest_mm + max(0.0, height), 12)
        half, lag = polyval(depths, laws.half_width), polyval(depths, laws.lag)
        return bool(lag.min() < LEAST_LAG_MM or np.diff(half).min() < 0 or half[-1] > WIDEST_MM)


def _led(targets: list[Target], led: Led, height_mm: float) -> list[Target]:
    if not (led.lean_mm_per_mm.any() or led.map.any()):
        return targets
    return [replace(target, poses_mm=led.way(target.poses_mm, height_mm)) for target in targets]


def _registered(search: _Search, x, targets: list[Target], look: Callable[[], None]) -> np.ndarray:
    """Least squares of predicted less painted pixels, blurred pictures first, by forward differences, as
    pictures are registered."""
    from scipy.optimize import least_squares

    for blur_px in BLURS_PX:

        def differences(x, blur_px=blur_px):
            look()
            return search.differences(x, targets, blur_px)

        begin = differences(x)
        if begin is None:
            return x

        def or_far(x, begin=begin, differences=differences):
            found = differences(x)
            return np.ones(len(begin)) if found is None else found

        def slopes(x, differences=differences):
            now, out = differences(x), []
            for d in np.diag(NEAR * search.steps):
                there, sign = differences(x + d), 1.0
                if there is None:
                    there, sign = differences(x - d), -1.0
                out.append(np.zeros(len(now)) if there is None else sign * (there - now) / d.sum())
            return np.column_stack(out)

        x = least_squares(or_far, x, slopes, x_scale=search.steps, max_nfev=ROUNDS, ftol=1e-3).x
    return x


def _blurred(picture, blur_px: int) -> np.ndarray:
    return cv2.GaussianBlur(np.float64(picture), (0, 0), blur_px)[::blur_px, ::blur_px]


def _simplex(loss, x, steps, most: int):
    from scipy.optimize import minimize

    simplex = np.vstack([x, *(x + d for d in np.diag(steps))])
    told = {"initial_simplex": simplex, "maxfev": most, "adaptive": True, "xatol": 0.01, "fatol": 1e-5}
    return minimize(loss, x, method="Nelder-Mead", options=told)


def _through(depths, values, first: int) -> list[float]:
    """Coefficients from the power `first` on of the law with these values at as many depths."""
    powers = np.arange(first, first + len(values))
    return np.linalg.solve(np.asarray(depths)[:, None] ** powers, values).tolist()


def _added(law, change) -> list[float]:
    out = np.zeros(max(len(law), len(change)))
    out[: len(law)] += law
    out[: len(change)] += change
    return out.tolist()


def predicted(targets: list[Target], laws, height_mm: float, shift_mm, deepest_mm: float):
    """Anti-aliased pictures of what such a brush paints, which change smoothly; footprints of half as many vertices."""
    deepest = max(deepest_mm, *(-target.poses_mm[:, 2].min() for target in targets))
    brush = brush_of(laws, "fitted", (0.0, deepest + max(0.0, height_mm)))
    outlines = [(one.depth_mm, np.array(one.outline_mm)[::2]) for one in brush.footprints.dragged]
    brush.footprints = _core.FootprintTable([_core.Footprint(depth, ring) for depth, ring in outlines])
    plan = _core.Plan("fitted", "", (1.0, 1.0), [])
    for target in targets:
        plan.passes = [_core.Pass("mark", on_paper(target.poses_mm, height_mm, shift_mm))]
        marks = _core.simulate(plan, brush, ROUGHLY_MM)
        yield _core.coverage(marks, brush, target.window_mm, target.px_per_mm)


def on_paper(poses_mm, height_mm: float, shift_mm) -> np.ndarray:
    """The TCP's way where paper and sheet were found to lie."""
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
