"""Paint calibration sheets with the slow stepping simulator and realistic faults.

The simulator uses no code of the library. It pulls the patch to within r of the TCP in small steps, and
shapely unites the footprints. The edges get noise, the marks get displacements, the sheet gets a place and
the paper a height. Lengths are in mm.
"""

import itertools
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
import oracle
import shapely
from scipy.interpolate import PchipInterpolator

BRISTLES = (
    ((-1.0, -0.5), 1.1),
    ((-0.5, 0.1), 1.4),
    ((0.1, 0.5), 1.25),
    ((0.5, 1.0), 1.5),
)  # ranges across a brush, in half widths, and the factor by which paint lasts longer there
POSES = 260  # the least number of poses per stroke for the stepping, about one every 0.3 mm
CLOSE = 420  # poses of a second pass, more where the footprint turns; no point of it moves over 0.5 mm per pose


@dataclass
class TrueBrush:
    """A round brush with coefficients in ascending powers of depth.

    Footprints are drops, eggs for round tails, or have their own shape: depths (n,) -> convex outlines (n, m,
    2) from the tip, x towards the tool.
    """

    deepest: float
    lag: np.ndarray
    tip_gap: np.ndarray
    half_width: np.ndarray
    widest_per_half: float
    front_per_half: float
    round_tail: bool = False
    shape: Callable | None = None

    @property
    def tip_to_widest(self):
        return self.widest_per_half * self.half_width

    def law(self, name):
        return oracle.Law(getattr(self, name))


@dataclass
class Faults:
    """The standard deviations of painting and reading a sheet."""

    noise: float = 0.1
    noise_length: float = 1.0
    displacement: float = 0.5
    placement: float = 1.0
    turn: float = 0.01
    height: float = 0.2


@dataclass
class Sheet:
    """The marks as read, and the hidden truth.

    A mark is (stroke id, plan poses (n, 3), outline rings).
    """

    marks: list = field(default_factory=list)
    height: float = 0.0
    displacements: list = field(default_factory=list)


def random_brush(rng):
    """Return a random brush with a cubic lag and a bending width.

    The lag grows from 1 to 4 mm at touch to 6 to 14 mm at the largest depth.
    """
    deepest = rng.uniform(4, 10)
    first, last = rng.uniform(1, 4), rng.uniform(6, 14)
    between = np.sort(rng.uniform(0.15, 1.0, 2)) * (last - first) + first
    controls = np.array([first, *between, last])
    t = np.array([[1, 0, 0, 0], [-3, 3, 0, 0], [3, -6, 3, 0], [-1, 3, -3, 1]])
    lag = t @ controls / deepest ** np.arange(4)
    half, bend = (
        rng.uniform(1.2, 4.0),
        rng.uniform(0.4, 0.8),
    )  # half of the way up at `bend` of the half width
    half_width = np.array([0, 2 * bend * half / deepest, (1 - 2 * bend) * half / deepest**2])
    return TrueBrush(
        deepest,
        lag,
        np.array([0, rng.uniform(0.2, 0.6)]),
        half_width,
        rng.normal(1.8, 0.25),
        rng.normal(1.0, 0.15),
    )


def of_other_functions(brush: TrueBrush, rng) -> TrueBrush:
    """Return a brush of the same depths and sizes with other functions.

    The lag saturates and swings, and the width grows as a root. Polynomials of sixth degree follow these
    functions.
    """
    share = np.linspace(0, 1, 60)
    first, last = (brush.law("lag")(share_ * brush.deepest) for share_ in (0.0, 1.0))
    rise = (1 - np.exp(-rng.uniform(1.5, 3.5) * share)) * (1 + 0.05 * np.sin(2 * np.pi * share))
    lag = first + (last - first) * rise / rise[-1]
    half = brush.law("half_width")(brush.deepest) * share ** rng.uniform(0.65, 0.9)
    gap = brush.law("tip_gap")(brush.deepest) * (share + rng.uniform(-0.3, 0.3) * share * (1 - share))

    def followed(law, from_power):
        powers = np.arange(from_power, 7)
        found = np.zeros(7)
        found[powers] = np.linalg.lstsq(share[:, None] ** powers, law, rcond=None)[0]
        return found / brush.deepest ** np.arange(7)

    laws = followed(lag, 0), followed(gap, 1), followed(half, 1)
    return TrueBrush(brush.deepest, *laws, brush.widest_per_half, brush.front_per_half)


@dataclass
class Curve:
    """A law of any shape: depth -> value. bends are depths where its slope jumps."""

    value: Callable
    bends: tuple = ()

    def __call__(self, depth):
        return self.value(np.maximum(depth, 0.0))

    def kinks(self):
        return list(self.bends)


@dataclass
class Stranger(TrueBrush):
    """A brush whose laws are not polynomials.

    The table of curves includes tip_to_widest. front is a multiple of the half width.
    """

    curves: dict = field(default_factory=dict)

    def law(self, name):
        return self.curves[name]


def outline_of(half, widest, front, vertices=33):
    """Return drops (n, vertices, 2) from half widths, widest sections, fronts (n,)."""
    angle = np.linspace(-np.pi / 2, np.pi / 2, vertices - 1)
    half, widest, front = (np.maximum(np.asarray(each, float), 1e-6)[:, None] for each in (half, widest, front))
    ahead = np.stack([widest + front * np.cos(angle), half * np.sin(angle)], axis=2)
    return np.concatenate([np.zeros((len(half), 1, 2)), ahead], axis=1)


def _saturating(rng):
    rate = rng.uniform(1.5, 4.0)
    return lambda t: (1 - np.exp(-rate * t)) / (1 - np.exp(-rate)), ()


def _kinked(rng):
    at, rise = rng.uniform(0.3, 0.7), rng.uniform(0.2, 0.8)
    return lambda t: np.where(t < at, rise * t / at, rise + (1 - rise) * (t - at) / (1 - at)), (at,)


def _power(rng):
    power = rng.choice([rng.uniform(0.6, 0.85), rng.uniform(1.3, 2.5)])
    return lambda t: t**power, ()


def _logistic(rng):
    steep, middle = rng.uniform(5, 10), rng.uniform(0.35, 0.65)
    low, high = (1 / (1 + np.exp(-steep * (t - middle))) for t in (0.0, 1.0))
    return lambda t: (1 / (1 + np.exp(-steep * (t - middle))) - low) / (high - low), ()


def _floored(rng):
    at = rng.uniform(0.15, 0.4)
    return lambda t: np.maximum(t - at, 0.0) / (1 - at), (at,)


def _wiggling(rng):
    waves, phase = rng.uniform(1.0, 2.0), rng.uniform(0, 2 * np.pi)
    size = rng.uniform(0.3, 0.9) / (2 * np.pi * waves)  # with this size the curve never falls

    def value(t):
        return t + size * (np.sin(2 * np.pi * waves * t + phase) - np.sin(phase))

    return lambda t: value(t) / value(1.0), ()


def _stepped(rng):
    middles, steep = (rng.uniform(0.15, 0.4), rng.uniform(0.6, 0.85)), rng.uniform(10, 20)
    share = rng.uniform(0.3, 0.7)

    def value(t):
        first, second = (1 / (1 + np.exp(-steep * (t - at))) for at in middles)
        return share * first + (1 - share) * second

    return lambda t: (value(t) - value(0.0)) / (value(1.0) - value(0.0)), ()


def _hooked(rng):
    size, length = rng.uniform(0.1, 0.4), rng.uniform(0.06, 0.2)
    return lambda t: (t + size * (1 - np.exp(-t / length))) / (1 + size * (1 - np.exp(-1 / length))), ()


def _capped(rng):
    at, round_ = rng.uniform(0.4, 0.8), rng.uniform(0.03, 0.1)

    def value(t):
        return t - round_ * np.log1p(np.exp((t - at) / round_))

    return lambda t: (value(t) - value(0.0)) / (value(1.0) - value(0.0)), ()


def _drawn(rng):
    """Return a smooth rising curve through five points with different steps."""
    rise = np.concatenate([[0.0], np.cumsum(rng.uniform(0.2, 1.0, 5))])
    return PchipInterpolator(np.linspace(0, 1, 6), rise / rise[-1]), ()


def _polyline(rng):
    """Return a curve of four straight pieces with random depths and random rises."""
    at = np.sort(rng.uniform(0.1, 0.9, 3))
    rise = np.cumsum(rng.uniform(0.1, 1.0, 4))
    corners = np.concatenate([[0.0], at, [1.0]])
    return lambda t: np.interp(t, corners, np.concatenate([[0.0], rise / rise[-1]])), tuple(at)


def _hyperbolic(rng):
    """Return t / (t + c), the saturation of enzymes and adsorption."""
    half_way = rng.uniform(0.2, 1.0)
    return lambda t: t * (1 + half_way) / (t + half_way), ()


def _tanh(rng):
    middle, length = rng.uniform(-0.1, 0.5), rng.uniform(0.25, 0.6)

    def value(t):
        return np.tanh((t - middle) / length)

    return lambda t: (value(t) - value(0.0)) / (value(1.0) - value(0.0)), ()


SHAPES = {
    "saturating": _saturating,
    "kinked": _kinked,
    "power": _power,
    "logistic": _logistic,
    "floored": _floored,
    "wiggling": _wiggling,
}
MORE_SHAPES = {"stepped": _stepped, "hooked": _hooked, "capped": _capped, "drawn": _drawn}
# No choice was ever made with these shapes.
UNSEEN_SHAPES = {"polyline": _polyline, "hyperbolic": _hyperbolic, "tanh": _tanh}


def random_stranger(rng, shape):
    """Return a brush as large as random_brush with random laws of this shape.

    Half width, tip gap and widest section are 0 at the touch. Half of each rises in a straight line.
    """
    deepest = rng.uniform(4, 10)
    first, last, half = rng.uniform(1, 4), rng.uniform(6, 14), rng.uniform(1.2, 4.0)
    gap, widest = rng.uniform(0.2, 0.6) * deepest, rng.normal(1.8, 0.25) * half

    def curve(begin, end, straight):
        rise, bends = (SHAPES | MORE_SHAPES | UNSEEN_SHAPES)[shape](rng)

        def value(depth):
            t = np.asarray(depth / deepest)
            return begin + (end - begin) * (straight * t + (1 - straight) * rise(t))

        return Curve(value, tuple(deepest * at for at in bends))

    curves = {
        "lag": curve(first, last, 0.0),
        "tip_gap": curve(0.0, gap, rng.uniform(0.5, 0.8)),
        "half_width": curve(0.0, half, rng.uniform(0.4, 0.7)),
        "tip_to_widest": curve(0.0, widest, rng.uniform(0.4, 0.7)),
    }
    front = rng.normal(1.0, 0.15)

    def outlines(depth):
        across = curves["half_width"](depth)
        return outline_of(across, curves["tip_to_widest"](depth), front * across)

    steep = max(curves["tip_to_widest"](d) / curves["half_width"](d) for d in np.linspace(0.1, 1, 10) * deepest)
    return Stranger(deepest, None, None, None, float(steep), front, shape=outlines, curves=curves)


def round_6(own):
    """Return the shipped brush with the laws and outlines of its file."""
    curves = {
        name: oracle.Law(own[name]["coefficients"], own[name].get("floor", -np.inf), own[name].get("floor_slope", 0.0))
        for name in ("lag", "tip_gap", "tip_to_widest", "half_width")
    }
    dragged = [(each["depth_mm"], np.array(each["outline_mm"])) for each in own["footprints"]["dragged"]]

    def outlines(depth):
        return np.array([oracle.footprint_at(dragged, [], max(d, 1e-3), 1.0) for d in depth])

    return Stranger(own["depth_range_mm"][1], None, None, None, 2.0, 1.0, shape=outlines, curves=curves)


def chart_strokes(deepest, depths=5):
    """Return the strokes of a chart as [(id, poses (n, 3))].

    Each depth has a straight stroke, a right angle, an arc and a reversal. Two ramps follow.
    """
    out, place = [], 0

    def add(name, points, depth, landing=8.0):
        nonlocal place
        points = np.asarray(points, float)
        at = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(points, axis=0).T))])
        depth = np.minimum(depth, depth * at / landing) if landing else np.full(len(at), float(depth))
        middle = np.array([40.0 + 70 * (place % 4), 40.0 + 50 * (place // 4)])
        out.append((name, np.column_stack([points + middle, -depth])))
        place += 1

    def line(*corners, step=1.0):
        points = [np.asarray(corners[0], float)]
        for a, b in itertools.pairwise(np.asarray(corners, float)):
            n = max(1, int(np.hypot(*(b - a)) / step))
            points += [a + (b - a) * k / n for k in range(1, n + 1)]
        return points

    for k in range(1, depths + 1):
        d = deepest * k / depths
        away = 1 if k % 2 else -1  # both directions, so that the fit does not confuse displacement and lag
        add(f"straight-{k}", line([0, 0], [35 * away, 0]), d)
        add(f"angular-{k}", line([0, 0], [28 * away, 0], [28 * away, 25]), d)
        t = np.linspace(0, 4.2, 60)
        add(f"arc-{k}", np.column_stack([14 * np.sin(t), away * 14 * (1 - np.cos(t))]), d)
        add(f"reversal-{k}", line([0, 0], [0, 28 * away], [1.0, 4 * away]), d, 0 if k % 2 else 8.0)
    add("ramp-up", line([0, 0], [45, 0]), deepest, 45.0)
    add("ramp-back", line([45, 0], [0, 0]), deepest, 45.0)
    return out


def paint(rng, brush, strokes, faults, regions=None):
    """Return a Sheet that this brush paints along the strokes, with random faults.

    regions can hold an earlier result of swept() for these strokes on paper of this height.
    """
    height = rng.normal(0, faults.height)
    shift, turn = rng.normal(0, faults.placement, 2), rng.normal(0, faults.turn)
    centre = np.mean(np.concatenate([poses[:, :2] for _, poses in strokes]), axis=0)
    sheet = Sheet(height=height)
    for (name, poses), region in zip(strokes, (regions or swept)(brush, strokes, height), strict=True):
        if region is None:
            continue
        moved = rng.normal(0, faults.displacement, 2)
        rings = [_noisy(rng, np.array(ring.coords)[:-1], faults) for ring in _rings(region)]
        c, s = np.cos(turn), np.sin(turn)
        rings = [
            (ring + moved - centre) @ np.array([[c, s], [-s, c]]) + centre + shift for ring in rings if len(ring) >= 8
        ]
        sheet.marks.append((name, poses, rings))
        sheet.displacements.append(moved)
    return sheet


def swept(brush, strokes, height, vertices=33, lasts=None, narrows_per_m=0.0, share=None):
    """Return the painted region of each stroke on paper of this height.

    The region is None if the brush does not reach the paper. lasts is the way of each stroke after which its
    paint begins to run out. narrows_per_m is the rate at which the width shrinks from the first stroke to the
    last, with one load of paint. share is another law of the width: ways since the first stroke (n,) ->
    shares (n,).
    """
    share = share or (lambda way: np.exp(-narrows_per_m * way / 1000))
    count = max(POSES, *(len(poses) + 4 for _, poses in strokes))
    plans = np.array([_stepped(poses, height, count) for _, poses in strokes])
    laws = [brush.law("lag")] * len(strokes)
    contacts = oracle.step_all(plans, laws, 20, "rope")
    longest = (brush.widest_per_half + brush.front_per_half) * brush.law("half_width")(brush.deepest)
    plans = np.array([_closer(*both, longest) for both in zip(plans, contacts, strict=True)])
    contacts = oracle.step_all(plans, laws, 20, "rope")
    lasts = np.full(len(strokes), np.inf) if lasts is None else lasts
    ways = [float(np.hypot(*np.diff(poses[:, :2], axis=0).T).sum()) for _, poses in strokes]
    before = np.cumsum([0.0, *ways])
    return [
        _painted(brush, plan, contact, vertices, left, lambda way, come=come: share(come + way))
        if _down(plan, contact).any()
        else None
        for plan, contact, left, come in zip(plans, contacts, lasts, before, strict=False)
    ]


def _stepped(poses, height, count):
    """Return count poses along a stroke, with z from the true paper.

    The tool comes straight down and goes straight up.
    """
    poses = np.vstack([poses[:1], poses, poses[-1:]])
    poses[0, 2] = poses[-1, 2] = 1.0
    poses[:, 2] -= height
    size = np.hypot(*np.diff(poses[:, :2], axis=0).T) + 0.5 * np.abs(np.diff(poses[:, 2]))
    at = np.concatenate([[0.0], np.cumsum(size)])
    places = np.union1d(np.linspace(0, at[-1], count - len(at) + 2), at)
    while len(places) < count:  # some places were equal, so halve the widest gap
        k = int(np.argmax(np.diff(places)))
        places = np.insert(places, k + 1, 0.5 * (places[k] + places[k + 1]))
    return np.column_stack([np.interp(places[:count], at, poses[:, i]) for i in range(3)])


def _closer(plan, contact, longest):
    """Return CLOSE poses, with more poses where the footprint turns.

    A loose footprint turns at once when the TCP passes it.
    """
    lever = np.nan_to_num(plan[:, :2] - contact) @ [1, 1j]
    turn = np.abs(np.angle(lever[1:] * np.conj(lever[:-1]))) * (np.abs(lever[1:] * lever[:-1]) > 1e-12)
    size = np.hypot(*np.diff(plan[:, :2], axis=0).T) + 0.5 * np.abs(np.diff(plan[:, 2])) + longest * turn
    parts = np.ones(len(size), int)
    while parts.sum() < CLOSE - 1:
        parts[np.argmax(size / parts)] += 1
    at = np.concatenate([k + np.arange(n) / n for k, n in enumerate(parts)] + [[len(size)]])
    return np.column_stack([np.interp(at, np.arange(len(plan)), plan[:, i]) for i in range(3)])


def _down(plan, contact):
    return ~np.isnan(contact[:, 0]) & (plan[:, 2] <= 0)


def _united(regions):
    """Return the union of regions.

    GEOS fails on slivers once in a few hundred sheets. On a grid of 1e-7 mm it does not fail.
    """
    try:
        return shapely.union_all(regions)
    except shapely.GEOSException:
        return shapely.union_all(regions, grid_size=1e-7)


def _painted(brush, plan, contact, vertices, lasts=np.inf, share=np.ones_like):
    down = _down(plan, contact)
    tcp, contact, depth = plan[down, :2], contact[down], -plan[down, 2]
    lever = tcp - contact
    reach = np.hypot(*lever.T)
    known = reach > 1e-9
    u = np.where(known[:, None], lever / np.maximum(reach, 1e-12)[:, None], np.nan)
    first = int(np.argmax(known))
    u[:first] = u[first]
    for k in range(first + 1, len(u)):
        if np.isnan(u[k, 0]):
            u[k] = u[k - 1]
    half, gap = brush.law("half_width")(depth), brush.law("tip_gap")(depth)
    angle = np.linspace(-np.pi / 2, np.pi / 2, vertices - 1)
    behind = np.linspace(np.pi / 2, 3 * np.pi / 2, vertices)[1:-1] if brush.round_tail else np.array([np.pi])
    ahead = brush.widest_per_half + brush.front_per_half * np.cos(angle)
    unit = np.column_stack(
        [
            [*ahead, *(brush.widest_per_half * (1 + np.cos(behind)))],
            [*np.sin(angle), *(np.sin(behind) if brush.round_tail else [0.0])],
        ]
    )
    shapes = brush.shape(depth) if brush.shape else np.maximum(half, 1e-6)[:, None, None] * unit
    come = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(tcp, axis=0).T))])
    shapes = shapes * np.stack([np.ones(len(come)), share(come)], axis=1)[:, None]
    outlines = []
    for p, axis, b, shape in zip(contact, u, gap, shapes, strict=True):
        outlines.append(p - b * axis + shape @ np.array([axis, [-axis[1], axis[0]]]))
    if come[-1] <= lasts:
        return oracle.swept(outlines, True, _united)
    wet = max(2, int(np.searchsorted(come, lasts)))
    parts = [oracle.swept(outlines[:wet], True)]
    for (low, high), longer in BRISTLES:  # some bristles hold their paint for longer
        last = min(max(wet + 1, int(np.searchsorted(come, longer * lasts))), len(come))
        strips = []
        for k in range(wet - 1, last):
            shape = shapes[k] * [1.0, 0.0] + np.clip(shapes[k] * [0.0, 1.0], low * half[k], high * half[k])
            axis = u[k]
            strips.append(contact[k] - gap[k] * axis + shape @ np.array([axis, [-axis[1], axis[0]]]))
        parts.append(oracle.swept(strips, True))
    return shapely.union_all(parts)


def _rings(region):
    parts = getattr(region, "geoms", [region])
    for part in parts:
        if isinstance(part, shapely.Polygon) and part.area > 0.2:
            yield shapely.geometry.polygon.orient(part).exterior
            yield from (hole for hole in shapely.geometry.polygon.orient(part).interiors if hole.length > 3)


def _noisy(rng, ring, faults, step=0.25):
    """Return the ring with points every `step`, moved along its normals by noise.

    The noise decorrelates within noise_length.
    """
    closed = np.vstack([ring, ring[:1]])
    at = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(closed, axis=0).T))])
    n = max(8, round(at[-1] / step))
    places = np.linspace(0, at[-1], n, endpoint=False)
    points = np.column_stack([np.interp(places, at, closed[:, i]) for i in range(2)])
    along = np.roll(points, -1, axis=0) - np.roll(points, 1, axis=0)
    along /= np.maximum(np.hypot(*along.T), 1e-9)[:, None]
    distance = np.minimum(np.arange(n), n - np.arange(n)) * at[-1] / n
    spectrum = np.maximum(np.fft.rfft(np.exp(-distance / faults.noise_length)).real, 0.0)
    noise = np.fft.irfft(np.fft.rfft(rng.normal(size=n)) * np.sqrt(spectrum), n) * faults.noise
    return points + noise[:, None] * np.column_stack([along[:, 1], -along[:, 0]])


def dense(poses, arcs):
    """Return the poses of a pass with its arcs in short steps.

    The angle between neighbours, seen from the centre, gives the steps.
    """
    arcs = {k: arc for arc in arcs for k in range(arc.first, arc.last)}
    out = [poses[:1]]
    for k in range(len(poses) - 1):
        angle, count = 0.0, max(2, int(np.hypot(*(poses[k + 1] - poses[k])[:2]) / 0.5) + 1)
        if k in arcs:
            centre, way = np.array(arcs[k].centre_mm), np.sign(arcs[k].direction)
            spoke, last = ((poses[j, :2] - centre) @ [1, 1j] for j in (k, k + 1))
            angle = np.angle(last / spoke)
            angle += 2 * np.pi * way * (np.sign(angle) != way)
            count = 2 + int(abs(angle * spoke) / 0.5)
        share = np.linspace(0, 1, count)[1:, None]
        steps = poses[k] + share * (poses[k + 1] - poses[k])
        if angle:
            place = spoke * np.exp(1j * angle * share[:, 0])
            steps[:, :2] = centre + np.column_stack([place.real, place.imag])
        out.append(steps)
    return np.vstack(out)
