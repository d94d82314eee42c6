"""Recover random brushes from the calibration sheets that they paint.

    truth_recovery.py [--brushes 300] [--seed 1] [--processes 2] [--sheet a4] [--outside all]

With --sheet, the strokes are those of `brushsvg chart` on a sheet of this size. Its user knows lag and width
of the brush to 15 %. Without --sheet, there are 22 strokes at five depths.

The slow stepping simulator of tests/laws paints the sheet, not the library. Edges have noise, marks and sheet
are displaced and turned, and the paper has a wrong height. The program prints how often the 95 % intervals
contain the truth, for the values of each law at five depths, pooled and separately. It also prints the error
of the lag over the range.

With --outside, the laws are not the fit's polynomials. They are saturating, kinked, power, logistic, floored
or wiggling, with random numbers; `all` uses them in turn. `more` uses four other shapes: stepped, hooked at
the touch, capped, and drawn through random points. `unseen` uses three shapes on which no choice was based:
polyline, hyperbolic, tanh. round-6 is the shipped brush, identical each time. --noise 0 paints clean edges;
--family fits without departures from the family.
"""

from __future__ import annotations

import argparse
import functools
import json
import multiprocessing
import sys
import time
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1] / "tests" / "laws"))
import painter

import brushsvg
from brushsvg import _core
from brushsvg.calibration.chart.layout import chart
from brushsvg.calibration.marks.from_marks import brush_of, height_at
from brushsvg.cli.arguments import values
from brushsvg.model.confidence import half_interval_mm, places

KNOWN_TO = 0.15
SHARES = (0.2, 0.4, 0.6, 0.8, 1.0)  # shares of the largest depth
LAWS = {"lag": SHARES, "tip_gap": (1.0,), "half_width": SHARES, "tip_to_widest": (0.6, 1.0)}
OUTSIDE = [
    *("all", "more", "unseen", "round-6"),
    *painter.SHAPES,
    *painter.MORE_SHAPES,
    *painter.UNSEEN_SHAPES,
]


def options_for(brush, faults) -> _core.MarkOptions:
    options = _core.MarkOptions()
    options.deepest_mm = brush.deepest
    options.widest_per_half = _core.Prior(1.8, 0.25)
    options.front_per_half = _core.Prior(1.0, 0.15)
    options.height_mm = _core.Prior(0.0, faults.height)
    options.placement_mm, options.turn_rad = faults.placement, faults.turn
    options.displacement_mm = faults.displacement
    return options


def strokes_of(rng, brush, sheet_mm: tuple[float, float] | None):
    """Return the strokes of the chart as [(id, poses (n, 3))]."""
    if sheet_mm is None:
        return painter.chart_strokes(brush.deepest)
    lag, width = rng.uniform(1 - KNOWN_TO, 1 + KNOWN_TO, 2)
    depths = np.linspace(0, brush.deepest, 21)[1:]
    known = [np.polynomial.polynomial.polyfit(depths, brush.law(law)(depths), 3) for law in ("lag", "half_width")]
    known[1][0] = 0.0
    laws = _core.MarkLaws(list(lag * known[0]), [0.0, 0.4], list(width * known[1]), 1.8, 1.0)
    made = chart(brush_of(laws, "known roughly", (0.0, brush.deepest)), sheet_mm)
    return [(one.stroke, np.array(one.poses_mm)) for one in made.plan.passes]


def brush_for(rng, seed: int, outside: str | None):
    if outside is None:
        return painter.random_brush(rng)
    if outside == "round-6":
        return painter.round_6(json.loads((Path(brushsvg.__file__).parent / "data/brushes/round-6.json").read_text()))
    groups = {"all": painter.SHAPES, "more": painter.MORE_SHAPES, "unseen": painter.UNSEEN_SHAPES}
    taken = list(groups.get(outside, [outside]))
    return painter.random_stranger(rng, taken[seed % len(taken)])


def true_value(brush, law: str, depth: float) -> float:
    if law == "tip_to_widest" and not isinstance(brush, painter.Stranger):
        return brush.widest_per_half * brush.law("half_width")(depth)
    return float(brush.law(law)(depth))


def recover(
    seed: int,
    sheet_mm: tuple[float, float] | None = None,
    outside: str | None = None,
    noise: float | None = None,
    departing: bool = True,
) -> dict:
    """Fit one brush.

    Return error and standard deviation of each value, and the lag's largest relative error.
    """
    rng = np.random.default_rng(seed)
    brush, faults = brush_for(rng, seed, outside), painter.Faults()
    if noise is not None:
        faults.noise = noise
    sheet = painter.paint(rng, brush, strokes_of(rng, brush, sheet_mm), faults)
    marks = [_core.PaintedMark(*mark) for mark in sheet.marks]
    options = options_for(brush, faults)
    options.departing = departing
    begin = time.perf_counter()
    fit = _core.fit_marks(marks, None, options)
    took = time.perf_counter() - begin
    covariance = np.array(fit.covariance)
    found = brush_of(fit.laws, "found", (0.0, brush.deepest), covariance)
    out = {}
    for law, shares in LAWS.items():
        at = places(found)[law]
        depths = np.array(shares) * brush.deepest
        half = half_interval_mm(np.array(found.covariance)[at, at], depths, None)
        for share, depth, interval in zip(shares, depths, half, strict=True):
            error = getattr(found, law)(depth) - true_value(brush, law, depth)
            out[f"{law} at {share:g}"] = (error, interval / 1.96)
    height = height_at(fit)
    out["height"] = (fit.height_mm - sheet.height, np.sqrt(covariance[height, height]))
    depths = np.linspace(0.15, 1, 18) * brush.deepest
    lag = np.polynomial.polynomial.polyval(depths, fit.laws.lag)
    worst = float(np.max(np.abs(lag / brush.law("lag")(depths) - 1)))
    repeats = fit.samples / max(fit.effective_samples, 1)
    return {
        "seed": seed,
        "values": out,
        "worst": worst,
        "s": took,
        "noise": fit.noise_mm,
        "repeats": repeats,
        "converged": fit.converged,
        "remarks": fit.remarks,
    }


def summary(found: list[dict]) -> str:
    lines = [f"{len(found)} brushes, {np.median([f['s'] for f in found]):.2f} s each (median)"]
    pooled = []
    lines.append("                      held by 95 %   error / sd   sd, mm (median)")
    for name in found[0]["values"]:
        z = np.array([f["values"][name][0] / f["values"][name][1] for f in found])
        sd = np.median([f["values"][name][1] for f in found])
        pooled.append(np.abs(z) < 1.96)
        lines.append(f"  {name:20s} {100 * pooled[-1].mean():8.1f} %  {np.sqrt(np.mean(z**2)):10.2f}  {sd:12.4f}")
    lines.append(f"  pooled               {100 * np.mean(pooled):8.1f} %")
    worst = np.array([f["worst"] for f in found])
    lines.append(
        f"lag off by at most {100 * np.median(worst):.2f} % over the range (median), "
        f"{100 * np.quantile(worst, 0.95):.2f} % (95th percentile), {100 * worst.max():.2f} % (worst)"
    )
    lines.append(
        f"noise found {np.median([f['noise'] for f in found]):.3f} mm; {np.median([f['repeats'] for f in found]):.1f} "
        f"neighbours count as one; {sum(not f['converged'] for f in found)} not converged"
    )
    return "\n".join(lines)


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    arguments.add_argument("--brushes", type=int, default=300)
    arguments.add_argument("--seed", type=int, default=1)
    arguments.add_argument("--processes", type=int, default=2)
    arguments.add_argument("--sheet", type=values.sheet, help="a4, a3, 210x297: the chart that brushsvg lays out on it")
    arguments.add_argument("--outside", choices=OUTSIDE)
    arguments.add_argument("--noise", type=float, help="of the edges, mm (0.1)")
    arguments.add_argument("--family", action="store_true", help="laws that do not depart from their few numbers")
    args = arguments.parse_args()
    recovered = functools.partial(
        recover,
        sheet_mm=args.sheet,
        outside=args.outside,
        noise=args.noise,
        departing=not args.family,
    )
    found = []
    with multiprocessing.Pool(args.processes) as pool:
        for one in pool.imap_unordered(recovered, range(args.seed, args.seed + args.brushes)):
            found.append(one)
            if len(found) % 20 == 0:
                print(summary(sorted(found, key=lambda f: f["seed"])), flush=True)
    print("\n" + summary(sorted(found, key=lambda f: f["seed"])))


if __name__ == "__main__":
    main()
