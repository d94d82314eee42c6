"""The lag, a quartic, from 200 strokes with 20,000 residuals: ours next to scipy.optimize.least_squares.

Each stroke is a wandering line of 50 moves of 1 mm with changing depth; at every pose the centre of friction was
seen, with 0.1 mm of noise. First the five coefficients alone, then with a heading at the start and a displacement
along its first motion for every stroke, 405 unknowns. The peer is the closed form in numpy, all strokes at once,
with the finite differences scipy takes by default. The floor is one pass through the residuals with derivatives:
no fit needs fewer.
"""

from __future__ import annotations

import argparse
import time

import numpy as np

from brushsvg import _core

LAG = np.array([3.1, 0.86, 0.31, -5.0e-2, 2.1e-3])
START = [5.0, 1.0, 0.0, 0.0, 0.0]
STROKES, MOVES = 200, 50
NODES, WEIGHTS = np.polynomial.legendre.leggauss(5)


def strokes(rng):
    """TCP (m, n + 1, 2), depth (m, n + 1), heading at the start (m,)."""
    turn = np.cumsum(rng.normal(0, 0.12, (STROKES, MOVES)), axis=1) + rng.uniform(-3, 3, (STROKES, 1))
    steps = np.stack([np.cos(turn), np.sin(turn)], axis=2)
    tcp = np.concatenate([np.zeros((STROKES, 1, 2)), np.cumsum(steps, axis=1)], axis=1)
    phase, pace = rng.uniform(0, 6, (STROKES, 1)), rng.uniform(0.02, 0.12, (STROKES, 1))
    depth = 5.0 + 3.8 * np.sin(phase + pace * np.arange(MOVES + 1))
    return tcp, depth, turn[:, 0] + rng.normal(0, 0.4, STROKES)


def contacts(lag, tcp, depth, heading):
    """Article (7) as one writes it in numpy: the centre of friction at every pose but the first."""
    move = np.diff(tcp, axis=1)
    length = np.hypot(move[..., 0], move[..., 1])
    along = np.arctan2(move[..., 1], move[..., 0])
    middle, half = (depth[:, 1:] + depth[:, :-1]) / 2, np.diff(depth, axis=1) / 2
    at = middle[..., None] + half[..., None] * NODES
    decay = np.exp(-length * (0.5 * WEIGHTS / np.polynomial.polynomial.polyval(at, lag)).sum(axis=2))
    theta, headings = heading, []
    for k in range(MOVES):
        psi = theta - along[:, k]
        theta = along[:, k] + 2 * np.arctan2(decay[:, k] * np.sin(psi / 2), np.cos(psi / 2))
        headings.append(theta)
    theta = np.stack(headings, axis=1)
    u = np.stack([np.cos(theta), np.sin(theta)], axis=2)
    return tcp[:, 1:] - np.polynomial.polynomial.polyval(depth[:, 1:], lag)[..., None] * u


def median_ms(work, rounds):
    times = []
    for _ in range(rounds):
        begin = time.perf_counter()
        result = work()
        times.append(1e3 * (time.perf_counter() - begin))
    return float(np.median(times)), result


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    arguments.add_argument("--rounds", type=int, default=11)
    arguments.add_argument("--no-peer", action="store_true", help="leave out scipy, which takes a while")
    args = arguments.parse_args()
    rng = np.random.default_rng(4)
    tcp, depth, heading = strokes(rng)
    truth = contacts(LAG, tcp, depth, heading)
    seen = truth + rng.normal(0, 0.1, truth.shape)
    first = tcp[:, 1] - tcp[:, 0]
    moved = seen + (rng.normal(0, 1.0, STROKES)[:, None] * first)[:, None, :]
    poses = np.concatenate([tcp, -depth[..., None]], axis=2)
    at = np.arange(1.0, MOVES + 1)

    def tracks(places):
        return [_core.Track(p, at, s, h) for p, s, h in zip(poses, places, heading, strict=True)]

    known, free = tracks(seen), tracks(moved)
    own = {"free_heading": True, "displaced": _core.Displaced.along}
    print(f"{STROKES} strokes, {seen.size} residuals, ms (medians of {args.rounds})")
    for name, data, options in (("5 unknowns", known, {}), ("405 unknowns", free, own)):

        def fit(most=50, data=data, options=options):
            return _core.fit_tracks(data, START, (0, 10), most_iterations=most, **options)

        ours, found = median_ms(fit, args.rounds)
        floor, _ = median_ms(lambda fit=fit: fit(0), args.rounds)
        depths = np.linspace(1.2, 8.8, 9)
        off = max(abs(found.lag(d) - np.polynomial.polynomial.polyval(d, LAG)) for d in depths)
        line = f"{name}: ours {ours:.1f} in {found.iterations} iterations, floor {floor:.1f}"
        if not args.no_peer:
            peer, lag = peer_fit(name, tcp, depth, heading, seen if not options else moved, first)
            apart = max(abs(found.lag(d) - np.polynomial.polynomial.polyval(d, lag)) for d in depths)
            line += f", scipy {peer:.0f}: {peer / ours:.0f} times ours; both laws within {apart:.1e} mm"
        print(line)
        print(f"  the law is within {off:.3f} mm of the truth; RMSE {found.lag.rmse_mm:.4f} mm, noise 0.1 mm")
        print("  95 % +- " + ", ".join(f"{half:.2g}" for half in found.lag.half_interval_95))


def peer_fit(name, tcp, depth, heading, seen, first):
    from scipy.optimize import least_squares

    if name == "5 unknowns":

        def residuals(x):
            return (contacts(x, tcp, depth, heading) - seen).ravel()

        start = np.array(START)
    else:

        def residuals(x):
            moved = (x[5 + STROKES :, None] * first)[:, None, :]
            return (contacts(x[:5], tcp, depth, x[5 : 5 + STROKES]) + moved - seen).ravel()

        start = np.concatenate([START, heading, np.zeros(STROKES)])
    ms, found = median_ms(lambda: least_squares(residuals, start, x_scale="jac"), 1)
    return ms, found.x[:5]


if __name__ == "__main__":
    main()
