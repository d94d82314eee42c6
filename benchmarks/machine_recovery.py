"""Recover random brushes and machines from the sheets that they paint.

    machine_recovery.py [--brushes 12] [--seed 1] [--processes 2] [--parts lean,axes] [--sheet a4]
                        [--planted lean,axes] [--sine 0.5] [--outside all]

The machines lean, and their axes have errors. The slow stepping simulator of tests/laws paints along the ways
that the machine runs; the fit gets the commanded ways. The program prints the error of the lag without
--machine and with it (rms over depths and brushes). It prints how often the 95 % intervals contain each
number of the machine, and the lag.

--planted sets the errors of the machines, if they differ from the fitted ones; all other errors are 0. --sine
adds an error field of this height [mm]: one sine over the sheet, which the fit does not know. --outside uses
brushes whose laws are not the fit's, as in truth_recovery.py. Brushes whose lag is off by more than 3 %
anywhere are listed by their seeds.
"""

from __future__ import annotations

import argparse
import functools
import multiprocessing
import time
from itertools import pairwise

import numpy as np
import truth_recovery

from brushsvg import _core
from brushsvg.calibration.marks import machine_found
from brushsvg.calibration.marks.from_marks import brush_of
from brushsvg.cli.arguments import values
from brushsvg.model.confidence import half_interval_mm, places

painter = truth_recovery.painter


def random_machine(rng, parts) -> dict[str, np.ndarray]:
    """Return a machine with realistic errors.

    These are lean of 0.3 mm per mm, scale and skew of 1 %, and a tilt of 1 mm over a sheet.
    """
    drawn = {
        "lean": rng.normal(0, 0.3, 2),
        "axes": rng.normal(0, 0.01, 3),
        "tilt": rng.normal(0, 0.005, 2),
        "backlash": np.abs(rng.normal(0, 0.2, 2)),
        "field": rng.normal(0, 0.5, (2, 3)),
    }
    return {part: drawn[part] * (part in parts) for part in machine_found.PARTS}


def with_play(strokes, backlash: np.ndarray) -> list:
    """Return the strokes as axes with backlash run them, every 0.4 mm.

    When an axis turns, it stands until the backlash is taken up. Strokes follow each other.
    """
    out, behind = [], np.zeros(2)  # distance behind the commanded place, at most half of the backlash
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


def displacement_by(machine, strokes, sine_mm: float, rng):
    """Return a function from places (n, 2) to displacements (n, 2) [mm].

    The field of the machine covers the box of all strokes.
    """
    places = np.concatenate([poses[:, :2] for _, poses in strokes])
    middle, reach = (places.max(axis=0) + places.min(axis=0)) / 2, np.ptp(places, axis=0) / 2
    phases = rng.uniform(0, 2 * np.pi, 2)

    def displaced(places):
        u, v = ((places - middle) / reach).T
        waves = np.column_stack([np.sin(np.pi * v + phases[0]), np.sin(np.pi * u + phases[1])])
        return np.column_stack([u * u, u * v, v * v]) @ machine["field"].T + sine_mm * waves

    return displaced


def run(machine, poses: np.ndarray, centre: np.ndarray, height: float, displaced) -> np.ndarray:
    """Return the true way of the machine for commanded poses, on paper of a height.

    The machine comes down on the first pose, follows the poses and goes up again.
    """
    up = poses[[0, -1]] * (1, 1, 0) + (0, 0, 1)
    poses = np.vstack([up[:1], poses, up[1:]])
    if np.any(displaced(poses[:, :2])):
        poses = every_mm(poses)  # straight lines become curved
    at = poses[:, :2] - centre
    z = poses[:, 2] - at @ machine["tilt"]
    scale_x, scale_y, skew = machine["axes"]
    off = np.column_stack([scale_x * at[:, 0] + skew * at[:, 1], scale_y * at[:, 1]])
    off += displaced(poses[:, :2])
    return np.column_stack([poses[:, :2] + off + np.outer(height - z, machine["lean"]), z])


def every_mm(poses: np.ndarray) -> np.ndarray:
    """Return the way with a pose every 2 mm."""
    rows = [poses[:1]]
    for a, b in pairwise(poses):
        parts = max(1, int(np.hypot(*(b - a)[:2]) / 2))
        rows.append(a + (np.arange(1, parts + 1) / parts)[:, None] * (b - a))
    return np.vstack(rows)


def recover(
    seed: int,
    parts=("lean", "axes"),
    sheet_mm: tuple[float, float] | None = None,
    planted: tuple[str, ...] | None = None,
    sine_mm: float = 0.0,
    outside: str | None = None,
) -> dict:
    """Fit one brush on one machine.

    Return the relative errors of the lag without and with the machine in the fit, and (error, half interval)
    of each number.
    """
    rng = np.random.default_rng(seed)
    brush, faults = truth_recovery.brush_for(rng, seed, outside), painter.Faults()
    strokes = truth_recovery.strokes_of(rng, brush, sheet_mm)
    machine = random_machine(rng, parts if planted is None else planted)
    displaced = displacement_by(machine, strokes, sine_mm, rng)
    centre = np.concatenate([poses[:, :2] for _, poses in strokes]).mean(axis=0)

    def regions(brush, strokes, height):
        if machine["backlash"].any():
            strokes = with_play(strokes, machine["backlash"])
        return painter.swept(
            brush, [(name, run(machine, poses, centre, height, displaced)) for name, poses in strokes], height
        )

    sheet = painter.paint(rng, brush, strokes, faults, regions)
    # strokes that painted nothing are left out
    marks = [_core.PaintedMark(*mark) for mark in sheet.marks if mark[2]]
    depths = np.linspace(0.2, 1, 9) * brush.deepest
    out = {"seed": seed, "lag": {}, "s": 0.0, "z": {}}
    for with_machine in (False, True):
        options = truth_recovery.options_for(brush, faults)
        if with_machine:
            machine_found.request_machine_parts(options, parts)
        begin = time.perf_counter()
        fit = _core.fit_marks(marks, None, options)
        out["s"] = time.perf_counter() - begin
        lag = np.polynomial.polynomial.polyval(depths, fit.laws.lag)
        out["lag"][with_machine] = lag / brush.law("lag")(depths) - 1
        made = brush_of(fit.laws, "found", (0.0, brush.deepest), np.array(fit.covariance))
        at = places(made)["lag"]
        half = half_interval_mm(np.array(made.covariance)[at, at], depths, None)
        out["z"][with_machine] = (lag - brush.law("lag")(depths)) / half
    found = machine_found.list_machine_numbers(fit, np.array(fit.covariance), options)
    truth = [*machine["lean"]] * ("lean" in parts)
    scale_x, scale_y, skew = machine["axes"]
    truth += [1 + scale_x, 1 + scale_y, skew] * ("axes" in parts)
    truth += [*machine["tilt"]] * ("tilt" in parts) + [*machine["backlash"]] * ("backlash" in parts)
    truth += [*machine["field"].ravel()] * ("field" in parts)
    out["field"] = machine_found.has_field(found)
    out["numbers"] = {one.name: (one.value - true, one.half) for one, true in zip(found, truth, strict=True)}
    return out


def summary(found: list[dict]) -> str:
    lines = [f"{len(found)} brushes on as many machines, {np.median([f['s'] for f in found]):.2f} s each (median)"]
    for with_machine, what in ((False, "without"), (True, "with")):
        off = np.array([f["lag"][with_machine] for f in found])
        lines.append(
            f"  {what} the machine: lag off by {100 * np.sqrt(np.mean(off**2)):.2f} % (rms), "
            f"{100 * np.abs(off).max():.1f} % (worst); its intervals hold "
            f"{100 * np.mean([np.abs(f['z'][with_machine]) < 1 for f in found]):.0f} %"
        )
    astray = {f["seed"]: np.abs(f["lag"][True]).max() for f in found}
    lines.append(
        "  lag off by more than 3 %: "
        + (", ".join(f"{100 * off:.1f} % (seed {seed})" for seed, off in astray.items() if off > 0.03) or "none")
    )
    lines.append(f"  a field is certain in {sum(f['field'] for f in found)}")
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
    arguments.add_argument("--planted", type=lambda text: tuple(text.split(",")))
    arguments.add_argument("--sine", type=float, default=0.0, help="mm")
    arguments.add_argument("--sheet", type=values.sheet, help="the chart of `brushsvg chart` on such a sheet")
    arguments.add_argument("--outside", choices=truth_recovery.OUTSIDE)
    args = arguments.parse_args()
    one = functools.partial(
        recover,
        parts=args.parts,
        sheet_mm=args.sheet,
        planted=args.planted,
        sine_mm=args.sine,
        outside=args.outside,
    )
    with multiprocessing.Pool(args.processes) as pool:
        found = list(pool.imap_unordered(one, range(args.seed, args.seed + args.brushes)))
    print(summary(sorted(found, key=lambda f: f["seed"])))


if __name__ == "__main__":
    main()
