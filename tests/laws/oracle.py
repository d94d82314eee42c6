"""Slow reference implementations in plain numpy, scipy and shapely.

The tests compare the library with these. Nothing here uses the closed form. The taut law is integrated as a
differential equation, and events are bracketed on dense samples. The stepping simulators walk in small steps.
Marks are unions of many footprints. Lengths are in mm, angles in radians, places in the paper frame. A law is
any callable depth -> value with `.slope(depth)` and `.kinks()`, see Law.
"""

import itertools

import numpy as np
import shapely
from scipy.integrate import solve_ivp
from scipy.optimize import brentq, minimize_scalar
from scipy.spatial import cKDTree


class Law:
    """The law max(floor + floor_slope d, c0 + c1 d + ...) with its derivative.

    The depth d is a scalar or an array.
    """

    def __init__(self, coefficients, floor=-np.inf, floor_slope=0.0):
        self.coefficients = np.asarray(coefficients, float)
        self.floor, self.floor_slope = floor, floor_slope
        self._poly = np.polynomial.Polynomial(self.coefficients)
        self._down = [float(c) for c in self.coefficients[::-1]]
        self._down_slope = [float(c) for c in self._poly.deriv().coef[::-1]]

    def __call__(self, depth):
        value = 0.0 * depth
        for c in self._down:
            value = value * depth + c
        return value if self.floor == -np.inf else np.maximum(value, self.floor + self.floor_slope * depth)

    def slope(self, depth):
        """Return d(value)/d(depth) at one depth."""
        value = slope = 0.0
        for c in self._down_slope:
            slope = slope * depth + c
        for c in self._down:
            value = value * depth + c
        return slope if value >= self.floor + self.floor_slope * depth else self.floor_slope

    def kinks(self):
        """Return the depths where the law reaches its floor."""
        if not np.isfinite(self.floor):
            return []
        roots = (self._poly - np.polynomial.Polynomial([self.floor, self.floor_slope])).roots()
        return [float(x.real) for x in roots if abs(x.imag) < 1e-9]


def taut(law, poses, theta0, at=None):
    """Integrate the taut law along a straight move (2, 3) x y depth from theta0.

    Return (contact (n, 2), heading (n,)) at the fractions `at` of the move (default its end).
    """
    at = np.array([1.0]) if at is None else np.asarray(at, float)
    velocity, rise = poses[1, :2] - poses[0, :2], poses[1, 2] - poses[0, 2]

    def rate(t, y):
        across = -np.sin(y[0]) * velocity[0] + np.cos(y[0]) * velocity[1]
        return [across / law(poses[0, 2] + t * rise)]

    path = solve_ivp(
        rate, (0, 1), [theta0], method="DOP853", rtol=1e-12, atol=1e-13, max_step=1 / 32, dense_output=True
    )
    heading = path.sol(at)[0]
    tcp = poses[0, :2] + at[:, None] * velocity
    return tcp - law(poses[0, 2] + at * rise)[:, None] * unit(heading), heading


def unit(angle):
    return np.stack([np.cos(angle), np.sin(angle)], axis=-1)


class Reference:
    """Event-driven simulation of one pass of poses (n, 3), x y z.

    It uses solve_ivp while the brush is taut, and finds roots for the events.

    `at(pose)` gives (contact, heading, taut, pull) at a fractional pose; contact is nan while lifted and
    heading nan before the first motion.
    """

    def __init__(self, poses, law):
        self.poses, self.law = np.array(poses, float), law
        self.poses[:, 2] *= -1.0  # z becomes depth
        self.phases = []  # (pose from, pose to, kind, contact or solution)
        self.contact, self.heading, self.is_taut = None, np.nan, False
        for i in range(len(self.poses) - 1):
            self._move(i)
        self.starts = np.array([p[0] for p in self.phases])

    def _tcp(self, i, t):
        return self.poses[i, :2] + np.multiply.outer(t, self.poses[i + 1, :2] - self.poses[i, :2])

    def _depth(self, i, t):
        return self.poses[i, 2] + t * (self.poses[i + 1, 2] - self.poses[i, 2])

    def _move(self, i):
        """Split a move where the depth crosses 0 or the law has a kink; run the parts."""
        d0, d1 = self.poses[i, 2], self.poses[i + 1, 2]
        cuts = [0.0, 1.0]
        if d1 != d0:
            cuts += [t for t in ((k - d0) / (d1 - d0) for k in [0.0, *self.law.kinks()]) if 1e-12 < t < 1 - 1e-12]
        cuts = sorted(cuts)
        for t0, t1 in itertools.pairwise(cuts):
            if self._depth(i, 0.5 * (t0 + t1)) < 0:
                self.contact, self.is_taut = None, False
                self.phases.append((i + t0, i + t1, "lifted", None))
                continue
            if self.contact is None:
                self.contact = self._tcp(i, t0)
            for _ in range(50):
                if t0 < t1:
                    t0 = self._taut(i, t0, t1) if self.is_taut else self._loose(i, t0, t1)
            assert t0 == t1, f"no end of events in move {i}"

    def _slack(self, i, t):
        return np.hypot(*(self._tcp(i, t) - self.contact).T) - self.law(self._depth(i, t))

    def _loose(self, i, t0, t1):
        step = (t1 - t0) / 2000
        times = t0 + np.concatenate([step * np.geomspace(1e-4, 0.9, 12), step * np.arange(1, 2001)])
        times[-1] = t1
        above = max(0.0, self._slack(i, t0))  # rounding error of the last integration
        slack = self._slack(i, times) - above
        end = t1
        for k in range(len(times)):
            if slack[k] > 1e-13:
                lo = times[k - 1] if k else t0
                end = (
                    brentq(lambda t: self._slack(i, t) - above, lo, times[k], xtol=1e-15)
                    if k and slack[k - 1] < 0
                    else lo
                )
                self.is_taut = True
                break
            if 0 < k < len(times) - 1 and slack[k] >= slack[k - 1] and slack[k] >= slack[k + 1] and slack[k] > -1e-4:
                top = minimize_scalar(
                    lambda t: above - self._slack(i, t),
                    bounds=(times[k - 1], times[k + 1]),
                    method="bounded",
                    options={"xatol": 1e-14},
                )
                if -top.fun > 1e-13:
                    end = brentq(lambda t: self._slack(i, t) - above, times[k - 1], top.x, xtol=1e-15)
                    self.is_taut = True
                    break
        self.phases.append((i + t0, i + end, "loose", self.contact))
        lever = self._tcp(i, end) - self.contact
        if self.is_taut and np.hypot(*lever) <= 1e-12:  # r = 0 at touch-down: dragged at once
            lever = self.poses[i + 1, :2] - self.poses[i, :2]
        if np.hypot(*lever) > 1e-12:
            self.heading = np.arctan2(lever[1], lever[0])
        return end

    def _taut(self, i, t0, t1):
        velocity = self.poses[i + 1, :2] - self.poses[i, :2]
        rise = self.poses[i + 1, 2] - self.poses[i, 2]

        def pull(t, theta):  # g: how fast the patch is dragged along the lever
            return velocity @ unit(theta) - self.law.slope(self._depth(i, t)) * rise

        tiny = 1e-9 * (t1 - t0)
        g = pull(t0 + tiny, self.heading)
        if g < -1e-9 or (abs(g) <= 1e-9 and self._slack(i, t0 + 1e-5 * (t1 - t0)) < -1e-14):
            self.is_taut = False
            return t0

        def rate(t, y):
            r = self.law(self._depth(i, t))
            across = -np.sin(y[0]) * velocity[0] + np.cos(y[0]) * velocity[1]
            return [across / r if r > 1e-12 else 0.0]

        def loosens(t, y):
            return pull(t, y[0])

        loosens.terminal, loosens.direction = True, -1
        end = t1 - 1e-10 * (t1 - t0) if self.law(self._depth(i, t1)) < 1e-9 else t1
        path = solve_ivp(
            rate,
            (t0, end),
            [self.heading],
            method="DOP853",
            rtol=1e-12,
            atol=1e-13,
            max_step=(t1 - t0) / 32,
            events=loosens,
            dense_output=True,
        )
        stopped = len(path.t_events[0]) > 0 and path.t[-1] > t0
        end = path.t[-1] if stopped else t1
        self.phases.append((i + t0, i + end, "taut", path.sol))
        self.heading = path.y[0, -1]
        self.contact = self._tcp(i, end) - self.law(self._depth(i, end)) * unit(self.heading)
        self.is_taut = not stopped
        return end

    def at(self, pose):
        k = max(0, np.searchsorted(self.starts, pose, side="right") - 1)
        start, _, kind, data = self.phases[k]
        i = min(int(np.floor(start + 1e-13)), len(self.poses) - 2)
        t = pose - i
        tcp, r = self._tcp(i, t), float(self.law(self._depth(i, t)))
        if kind == "lifted":
            return np.full(2, np.nan), np.nan, False, np.nan
        if kind == "taut":
            heading = float(data(t)[0])
            return tcp - r * unit(heading), heading, True, 1.0
        lever = tcp - data
        length = np.hypot(*lever)
        heading = np.arctan2(lever[1], lever[0]) if length > 1e-9 else np.nan
        return data.copy(), heading, False, length / r if r > 0 else np.nan

    def events(self):
        """Return fractional poses where the brush loosens, tightens, touches or lifts."""
        return [b[0] for a, b in zip(self.phases[:-1], self.phases[1:], strict=True) if a[2] != b[2]]


def follow(tcp, velocity, lag, contact, heading, is_taut):
    """Carry (contact, heading, taut) along any smooth motion at constant lag.

    The motion is tcp(t) and velocity(t), t from 0 to 1. The taut law is integrated directly, and events are
    bracketed. Return the state at the end and [t] of events.
    """
    at, events = 0.0, []

    def pull(t, theta):
        return velocity(t) @ unit(theta)

    def rate(t, y):
        v = velocity(t)
        return [(np.cos(y[0]) * v[1] - np.sin(y[0]) * v[0]) / lag]

    def loosens(t, y):
        return pull(t, y[0])

    loosens.terminal, loosens.direction = True, -1
    for _ in range(50):
        if at >= 1.0:
            break
        if is_taut and pull(at, heading) < -1e-9:
            is_taut = False
            events.append(at)
        elif is_taut:
            path = solve_ivp(
                rate,
                (at, 1),
                [heading],
                method="DOP853",
                rtol=1e-12,
                atol=1e-13,
                max_step=0.02,
                events=loosens,
            )
            stopped = len(path.t_events[0]) > 0 and path.t[-1] > at and path.t[-1] < 1
            at, heading = path.t[-1], path.y[0, -1]
            contact = tcp(at) - lag * unit(heading)
            if stopped:
                is_taut = False
                events.append(at)
        else:
            times = at + (1 - at) * np.concatenate([np.geomspace(1e-6, 4e-4, 20), np.arange(1, 2001) / 2000])
            slack = np.array([np.hypot(*(tcp(t) - contact)) - lag for t in times])
            above = np.flatnonzero(slack > 1e-12)
            if len(above) == 0:
                at = 1.0
            elif above[0] == 0:
                is_taut = True
            else:
                k = above[0]
                at = brentq(lambda t, p=contact: np.hypot(*(tcp(t) - p)) - lag, times[k - 1], times[k], xtol=1e-15)
                is_taut = True
                events.append(at)
            reach = tcp(at) - contact
            if np.hypot(*reach) > 1e-12:
                heading = np.arctan2(reach[1], reach[0])
    assert at >= 1.0, "no end of events"
    return contact, heading, is_taut, events


def step_all(plans, laws, steps, method="article", epsilon=1e-9):
    """Step through many passes at once.

    plans (m, n, 3) x y z have m laws. The result is contacts (m, n, 2), nan while lifted. The method
    "article" is section 2.3 of the article with its epsilon far below the step. The patch rests while the TCP
    is nearer than r - epsilon; otherwise equation (7) holds over the step. The method "rope" only pulls the
    patch to within r of the TCP. It uses no angle and converges in first order.
    """
    plans = np.asarray(plans, float)
    cuts = _cuts_at_kinks(plans, laws)
    radius = laws[0] if all(law is laws[0] for law in laws) else _all_at_once(laws)

    tcp, depth = plans[:, 0, 0] + 1j * plans[:, 0, 1], -plans[:, 0, 2]
    contact, down = tcp.copy(), depth >= 0
    result = np.full((*plans.shape[:2], 2), np.nan)
    result[down, 0] = plans[down, 0, :2]
    with np.errstate(all="ignore"):
        for k in range(plans.shape[1] - 1):
            start, velocity = plans[:, k, 0] + 1j * plans[:, k, 1], np.diff(plans[:, k : k + 2], axis=1)[:, 0]
            rise, velocity = -velocity[:, 2], velocity[:, 0] + 1j * velocity[:, 1]
            along = np.where(velocity != 0, velocity / np.abs(velocity), 1.0)
            for t0, t1 in zip(cuts[k, :-1], cuts[k, 1:], strict=True):
                part = (t1 - t0) / steps
                for j in range(1, steps + 1):
                    t = t0 + j * part
                    new, above, depth = start + t * velocity, depth, -plans[:, k, 2] + t * rise
                    landed = (depth >= 0) & ~down
                    down = depth >= 0
                    contact = np.where(landed, new - part * velocity * depth / (depth - above), contact)
                    r, lever = radius(depth), new - contact
                    reach = np.abs(lever)
                    if method == "rope":
                        contact = np.where(reach <= r, contact, new - r * lever / reach)
                        continue
                    old = tcp - contact
                    old = np.where(np.abs(old) > 0, old / np.abs(old), along)
                    half = np.sqrt(old * np.conj(along))  # e^(i psi / 2), psi in (-pi, pi]
                    shrink = np.exp(-part * np.abs(velocity) / radius(depth - 0.5 * part * rise))
                    half = half.real + 1j * half.imag * shrink
                    rests = (reach < r - epsilon) | (reach == 0)
                    contact = np.where(rests, contact, new - r * half * half / np.abs(half) ** 2 * along)
                    tcp = new
            result[down, k + 1, 0], result[down, k + 1, 1] = contact.real[down], contact.imag[down]
    return result


def _all_at_once(laws):
    """Return a function of m polynomials with floors: depths (m,) -> values (m,)."""
    width = max(len(law.coefficients) for law in laws)
    coefficients = np.array([np.pad(law.coefficients, (0, width - len(law.coefficients))) for law in laws]).T[::-1]
    floor, floor_slope = np.array([law.floor for law in laws]), np.array([law.floor_slope for law in laws])

    def radius(depth):
        value = coefficients[0]
        for c in coefficients[1:]:
            value = value * depth + c
        return np.maximum(value, floor + floor_slope * depth)

    return radius


def _cuts_at_kinks(plans, laws):
    """Return the fractions (moves, cuts, plans) at which to cut moves.

    After the cuts, no step crosses a kink of the law.
    """
    count = max(len(law.kinks()) for law in laws)
    cuts = np.zeros((plans.shape[1] - 1, count + 2, len(plans)))
    cuts[:, -1] = 1.0
    for m, law in enumerate(laws):
        for j, kink in enumerate(law.kinks()):
            d0, d1 = -plans[m, :-1, 2], -plans[m, 1:, 2]
            with np.errstate(all="ignore"):
                t = (kink - d0) / (d1 - d0)
            cuts[:, 1 + j, m] = np.where((t > 0) & (t < 1), t, 0.0)
    return np.sort(cuts, axis=1)


# Middle lines -------------------------------------------------------------------------------------


def bezier(cubic, t, order=0):
    """Return the point or derivative (n, 2) of one cubic (8,) at parameters t."""
    p = np.asarray(cubic, float).reshape(4, 2)
    t = np.asarray(t, float)[:, None]
    if order == 0:
        return p[0] * (1 - t) ** 3 + 3 * p[1] * t * (1 - t) ** 2 + 3 * p[2] * t**2 * (1 - t) + p[3] * t**3
    d = 3 * np.diff(p, axis=0)
    if order == 1:
        return d[0] * (1 - t) ** 2 + 2 * d[1] * t * (1 - t) + d[2] * t**2
    return 2 * ((d[1] - d[0]) * (1 - t) + (d[2] - d[1]) * t)


class Middle:
    """A middle line of cubics (n, 8): nearest points and arc lengths."""

    def __init__(self, cubics, samples=400):
        self.cubics = np.asarray(cubics, float)
        nodes, weights = np.polynomial.legendre.leggauss(6)
        self.t = np.linspace(0, 1, samples + 1)
        width = 1 / samples
        self.s, points, total = [], [], 0.0
        for c in self.cubics:
            at = (self.t[:-1, None] + 0.5 * width * (nodes + 1)).ravel()
            speed = np.hypot(*bezier(c, at, 1).T).reshape(samples, -1)
            s = total + np.concatenate([[0.0], np.cumsum(speed @ weights * 0.5 * width)])
            total = s[-1]
            self.s.append(s)
            points.append(bezier(c, self.t))
        self.length = total
        self.tree = cKDTree(np.concatenate(points))
        self.samples = samples

    def nearest(self, points, neighbours=4):
        """Return distance and arc length (n,) [mm] of the nearest place, to rounding."""
        points = np.atleast_2d(points)
        _, near = self.tree.query(points, k=neighbours)
        best, where = np.full(len(points), np.inf), np.zeros(len(points))
        for k in range(neighbours):
            piece, t = np.divmod(near[:, k], self.samples + 1)
            for c in np.unique(piece):
                rows = piece == c
                x = self.t[t[rows]]
                for _ in range(8):
                    offset = bezier(self.cubics[c], x) - points[rows]
                    first, second = bezier(self.cubics[c], x, 1), bezier(self.cubics[c], x, 2)
                    slope = (offset * first).sum(1)
                    bend = np.maximum((first * first).sum(1) + (offset * second).sum(1), 1e-3 * (first * first).sum(1))
                    x = np.clip(x - slope / np.maximum(bend, 1e-300), 0, 1)
                distance = np.hypot(*(bezier(self.cubics[c], x) - points[rows]).T)
                s = np.interp(x, self.t, self.s[c])
                index = np.flatnonzero(rows)
                closer = distance < best[index]
                best[index[closer]], where[index[closer]] = distance[closer], s[closer]
        return best, where

    def at(self, s):
        """Return the point (n, 2) and unit tangent (n, 2) at arc lengths s [mm]."""
        s = np.clip(np.atleast_1d(np.asarray(s, float)), 0, self.length)
        points, tangents = np.empty((len(s), 2)), np.empty((len(s), 2))
        piece = np.minimum(np.searchsorted([a[-1] for a in self.s], s), len(self.cubics) - 1)
        for c in np.unique(piece):
            rows = piece == c
            x = np.interp(s[rows], self.s[c], self.t)
            for _ in range(6):  # arc length is close to linear between samples: few Newton steps
                speed = np.hypot(*bezier(self.cubics[c], x, 1).T)
                x = np.clip(x + (s[rows] - self._length(c, x)) / speed, 0, 1)
            points[rows] = bezier(self.cubics[c], x)
            d = bezier(self.cubics[c], x, 1)
            tangents[rows] = d / np.hypot(*d.T)[:, None]
        return points, tangents

    def _length(self, c, x):
        k = np.minimum((x * self.samples).astype(int), self.samples - 1)
        nodes, weights = np.polynomial.legendre.leggauss(6)
        width = x - self.t[k]
        out = self.s[c][k].copy()
        for node, weight in zip(nodes, weights, strict=True):
            speed = np.hypot(*bezier(self.cubics[c], self.t[k] + 0.5 * width * (node + 1), 1).T)
            out += 0.5 * width * weight * speed
        return out


def chords(poses, arcs, step=0.02):
    """Return the pass (n, 3) with chords of at most `step` mm instead of arcs."""
    poses, out = np.asarray(poses, float), []
    on_arc = {k: arc for arc in arcs for k in range(arc.first, arc.last)}
    for k, pose in enumerate(poses):
        out.append(pose[None])
        if k not in on_arc:
            continue
        centre = np.asarray(on_arc[k].centre_mm)
        (a, b), (c, d) = pose[:2] - centre, poses[k + 1, :2] - centre
        turn, radius = np.arctan2(a * d - b * c, a * c + b * d), np.hypot(a, b)
        angle = np.arctan2(b, a) + turn * np.linspace(0, 1, 2 + int(abs(turn) * radius / step))[1:-1]
        between = centre + radius * unit(angle)
        out.append(np.column_stack([between, np.full(len(between), pose[2])]))
    return np.concatenate(out)


def subdivide(poses, parts, step=np.inf):
    """Return the pass (n, 3) with every move cut into equal parts.

    There are at least `parts` parts, of at most `step` mm.
    """
    poses = np.asarray(poses, float)
    length = np.linalg.norm(np.diff(poses, axis=0), axis=1)
    cuts = [np.arange(n) / n for n in np.maximum(parts, np.ceil(length / step).astype(int))]
    at = np.concatenate([k + c for k, c in enumerate(cuts)] + [[len(poses) - 1.0]])
    return np.stack([np.interp(at, np.arange(len(poses)), poses[:, k]) for k in range(3)], axis=1)


# Footprints and marks -----------------------------------------------------------------------------


def section_6_outline(widest, half_width, vertices=65):
    """Return the footprint of section 6 as a counter-clockwise outline (n, 2).

    The tip is at 0. Straight flanks run to the widest section, and the front is half an ellipse.
    """
    along = min(half_width, max(7 - widest, 0.25 * half_width))
    angle = np.linspace(-np.pi / 2, np.pi / 2, vertices - 1)
    front = np.stack([widest + along * np.cos(angle), half_width * np.sin(angle)], axis=1)
    return np.concatenate([[[0.0, 0.0]], front])


def footprint_at(dragged, pressed, depth, pull):
    """Return the outline (n, 2) by tables [(depth, outline), ...], tip at the origin."""

    def blend(table):
        depths = [d for d, _ in table]
        if depth <= depths[0]:
            return table[0][1] * (max(depth, 0.0) / depths[0])
        if depth >= depths[-1]:
            return table[-1][1]
        k = int(np.searchsorted(depths, depth)) - 1
        c = (depth - depths[k]) / (depths[k + 1] - depths[k])
        return (1 - c) * table[k][1] + c * table[k + 1][1]

    shape = blend(dragged)
    return shape if not pressed else (1 - pull) * blend(pressed) + pull * shape


def placed(outline, contact, heading, tip_gap):
    """Return the footprint on the paper, with its tip at contact - tip_gap u."""
    u = unit(heading)
    return contact - tip_gap * u + outline @ np.array([u, [-u[1], u[0]]])


def union_of(outlines):
    """Return the shapely union of polygons (list of (n, 2)) that have an area."""
    polygons = shapely.polygons([np.vstack([o, o[:1]]) for o in outlines])
    polygons = shapely.make_valid(polygons)
    return united(polygons[shapely.area(polygons) > 1e-12])


def united(regions):
    """Return the union of regions.

    Neighbours are united in pairs, then these results in pairs. For overlapping neighbours this is a third
    quicker than one union of all.
    """
    while len(regions) > 1:
        even = len(regions) // 2 * 2
        regions = np.concatenate([shapely.union(regions[0:even:2], regions[1:even:2]), regions[even:]])
    return regions[0] if len(regions) else shapely.Polygon()


def swept(outlines, convex, unite=shapely.union_all):
    """Return the region swept by a moving outline, given at close samples (n, 2).

    unite also decides at which of its vertices a ring begins. The region is the union of hulls of neighbours
    if the outline is convex and hardly turns, or turns about a point outside. A turn about a point of its
    flank leaves a waist that a hull would fill. In this case the region is the union of the outlines and the
    regions swept by their edges.
    """
    outlines = np.asarray(outlines)
    axis = (outlines.mean(axis=1) - outlines[:, 0]) @ [1, 1j]
    turn = np.abs(np.angle(axis[1:] * np.conj(axis[:-1])))
    middle = outlines.mean(axis=1)
    reach = np.hypot(*(outlines - middle[:, None]).transpose(2, 0, 1)).max(axis=1)
    by_hull = convex & ((turn < 1e-3) | (np.hypot(*np.diff(middle, axis=0).T) > 1.5 * reach[1:] * turn))
    pairs = np.concatenate([outlines[:-1], outlines[1:]], axis=1)[by_hull]
    first, second = outlines[:-1][~by_hull], outlines[1:][~by_hull]
    quads = [first, np.roll(first, -1, axis=1), np.roll(second, -1, axis=1), second]
    # An edge that turns about its own point sweeps two triangles, not their hull.
    quads = shapely.make_valid(shapely.polygons(np.stack(quads, axis=2).reshape(-1, 4, 2)))
    points = shapely.multipoints(pairs.reshape(-1, 2), indices=np.repeat(np.arange(len(pairs)), pairs.shape[1]))
    regions = [
        shapely.convex_hull(points),
        quads,
        shapely.make_valid(shapely.polygons(np.vstack([first, second]))),
    ]
    regions = np.concatenate(regions)
    return unite(regions[shapely.area(regions) > 1e-12])
