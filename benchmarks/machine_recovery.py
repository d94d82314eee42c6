"""Random brushes paint a sheet by machines that lean and whose axes are off, and the fit is asked what both are.

    machine_recovery.py [--brushes 12] [--seed 1] [--processes 2] [--parts lean,axes] [--sheet a4]

The slow stepping simulator of tests/laws paints, along the ways that the machine runs; the fit is told the ways that it
was told. Printed: how far the lag is off without --machine and with it (rms over depths and brushes), and how often the
95 % intervals hold each number of the machine.
"""

from __future__ import annotations

import argparse
import functools
import multiprocessing
import time

import numpy as np
import truth_recovery

from brushsvg import _core
from brushsvg.calibration import machine_found
from brushsvg.cli.arguments import values

painter = truth_recovery.painter


def random_machine(rng, parts) -> dict[str, np.ndarray]:
    """As large as machines are: lean 0.3 mm per mm, 1 % of scale and skew, 1 mm of tilt over a sheet."""
    drawn = {
        "lean": rng.normal(0, 0.3, 2),
        "axes": rng.normal(0, 0.01, 3),
        "tilt": rng.normal(0, 0.005, 2),
        "backlash": np.abs(rng.normal(0, 0.2, 2)),
    }
    return {part: drawn[part] * (part in parts) for part in machine_found.PARTS}


def with_play(strokes, backlash: np.ndarray) -> list:
    """The strokes one after the other, every 0.4 mm, as axes run them that stand still for so long where they turn."""
    out, behind = [], np.zeros(2)  # of the place told, at most half of the backlash
    last = strokes[0][1][0]
    for name, poses in strokes:
        run_to = []
        for k, pose in enumerate(poses):
            steps = max(1, int(np.hypot(*(pose - last)[:2]) / 0.4)) if k else 1
            for part in np.arange(1, steps + 1) / steps:
                here = last + part * (pose - last)
                before = run_to[-1][0] if run_to else last
                behind = np.clip(behind + here[:2] - before[:2], -backlash / 2, backlash / 2)
                run_to.append((here, behind))
            last = pose
        out.append((name, np.array([[*(here[:2] - off), here[2]] for here, off in run_to])))
    return out


def run(machine, poses: np.ndarray, centre: np.ndarray, height: float) -> np.ndarray:
    """The way that the machine runs when it is told to come down on the first of these poses, to follow them and to go
    up again, on paper that lies so much higher."""
    up = poses[[0, -1]] * (1, 1, 0) + (0, 0, 1)
    poses = np.vstack([up[:1], poses, up[1:]])
    at = poses[:, :2] - centre
    z = poses[:, 2] - at @ machine["tilt"]
    scale_x, scale_y, skew = machine["axes"]
    off = np.column_stack([scale_x * at[:, 0] + skew * at[:, 1], scale_y * at[:, 1]])
    return np.column_stack([poses[:, :2] + off + np.outer(height - z, machine["lean"]), z])


def recover(seed: int, parts=("lean", "axes"), sheet_mm: tuple[float, float] | None = None) -> dict:
    """One brush on one machine: relative errors of the lag without and with the machine in the fit, and (error, half
    interval) of each number."""
    rng = np.random.default_rng(seed)
    brush, faults = painter.random_brush(rng), painter.Faults()
    strokes = truth_recovery.strokes_of(rng, brush, sheet_mm)
    machine = random_machine(rng, parts)
    centre = np.concatenate([poses[:, :2] for _, poses in strokes]).mean(axis=0)

    def regions(brush, strokes, height):
        if machine["backlash"].any():
            strokes = with_play(strokes, machine["backlash"])
        return painter.swept(
            brush, [(name, run(machine, poses, centre, height)) for name, poses in strokes], height
        )

    sheet = painter.paint(rng, brush, strokes, faults, regions)
    marks = [_core.PaintedMark(*mark) for mark in sheet.marks]
    depths = np.linspace(0.2, 1, 9) * brush.deepest
    out = {"seed": seed, "lag": {}, "s": 0.0}
    for with_machine in (False, True):
        options = truth_recovery.options_for(brush, faults)
        if with_machine:
            machine_found.ask_for(options, parts)
        begin = time.perf_counter()
        fit = _core.fit_marks(marks, None, options)
        out["s"] = time.perf_counter() - begin
        lag = np.polynomial.polynomial.polyval(depths, fit.laws.lag)
        out["lag"][with_machine] = lag / brush.law("lag")(depths) - 1
    found = machine_found.numbers(fit, np.array(fit.covariance), options)
    truth = [*machine["lean"]] * ("lean" in parts)
    scale_x, scale_y, skew = machine["axes"]
    truth += [1 + scale_x, 1 + scale_y, skew] * ("axes" in parts)
    truth += [*machine["tilt"]] * ("tilt" in parts) + [*machine["backlash"]] * ("backlash" in parts)
    out["numbers"] = {one.name: (one.value - true, one.half) for one, true in zip(found, truth, strict=True)}
    return out


def summary(found: list[dict]) -> str:
    lines = [
        f"{len(found)} brushes on as many machines, {np.median([f['s'] for f in found]):.2f} s each (median)"
    ]
    for with_machine, what in ((False, "without"), (True, "with")):
        off = np.array([f["lag"][with_machine] for f in found])
        lines.append(
            f"  {what} the machine: lag off by {100 * np.sqrt(np.mean(off**2)):.2f} % (rms), "
            f"{100 * np.abs(off).max():.1f} % (worst)"
        )
    lines.append("  held by 95 %   error (rms)   half interval (median)")
    inside = []
    for name in found[0]["numbers"]:
        error, half = np.array([f["numbers"][name] for f in found]).T
        inside.append(np.abs(error) < half)
        lines.append(
            f"  {100 * inside[-1].mean():8.0f} %  {np.sqrt(np.mean(error**2)):12.4f}  {np.median(half):15.4f}   {name}"
        )
    lines.append(f"  {100 * np.mean(inside):8.0f} %  pooled")
    return "\n".join(lines)


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    arguments.add_argument("--brushes", type=int, default=12)
    arguments.add_argument("--seed", type=int, default=1)
    arguments.add_argument("--processes", type=int, default=2)
    arguments.add_argument("--parts", type=lambda text: tuple(text.split(",")), default=("lean", "axes"))
    arguments.add_argument("--sheet", type=values.sheet, help="the chart of `brushsvg chart` on such a sheet")
    args = arguments.parse_args()
    one = functools.partial(recover, parts=args.parts, sheet_mm=args.sheet)
    with multiprocessing.Pool(args.processes) as pool:
        found = list(pool.imap_unordered(one, range(args.seed, args.seed + args.brushes)))
    print(summary(sorted(found, key=lambda f: f["seed"])))


if __name__ == "__main__":
    main()
