"""Time the fit of a painted chart, and compare the brush with another build.

    fit.py [--sheets 3] [--seed 1] [--rounds 2] [--parts lean,axes,tilt,backlash] [--save a.json] [--against
    b.json]

The slow stepping simulator of tests/laws paints the chart of `brushsvg chart --sheet a4`, 49 strokes. The
program times one fit without a guess (`fit_marks`), and the whole work of `calibrate` on a photograph's
marks. This work includes both tails, and the effect of edges that are moved out. Both run without and with a
machine's numbers. The program prints processor time and time on the clock, each the minimum of the rounds,
and the iterations of one fit. The floor is one evaluation of all marks with derivatives: a fit needs one per
iteration, and the covariance two.

--against prints how far values are from the values of --save, and how much longer their intervals are, in
half intervals.
"""

from __future__ import annotations

import argparse
import json
import time
from pathlib import Path

import numpy as np
import truth_recovery

from brushsvg import _core
from brushsvg.calibration.marks import machine_found
from brushsvg.calibration.marks.from_marks import calibrate_marks
from brushsvg.calibration.marks.mark_input import read_painted

painter = truth_recovery.painter

EDGE_MM = 0.03  # common error of all edges of a photograph


def painted(seed: int):
    """Return the read chart of a random brush."""
    rng = np.random.default_rng(seed)
    brush, faults = painter.random_brush(rng), painter.Faults()
    strokes = truth_recovery.strokes_of(rng, brush, (210.0, 297.0))
    sheet = painter.paint(rng, brush, strokes, faults)
    plan = {"passes": [{"stroke": name, "poses_mm": poses.tolist(), "speed_mm_s": 20} for name, poses in strokes]}
    marks = [{"stroke": name, "outline_mm": [ring.tolist() for ring in rings]} for name, _, rings in sheet.marks]
    return brush, faults, read_painted(plan, marks, None)


def least_time(work, rounds: int):
    """Return the least processor time and time on the clock [s], and the result."""
    used, took = [], []
    for _ in range(rounds):
        begin = time.process_time(), time.perf_counter()
        made = work()
        used.append(time.process_time() - begin[0])
        took.append(time.perf_counter() - begin[1])
    return min(used), min(took), made


def values_of(fit, deepest: float) -> dict[str, tuple[float, float]]:
    """Return {name: (value, half interval)}.

    The values are the laws at depths, the height and the machine's numbers.
    """
    covariance, out, first = np.array(fit.covariance), {}, 0
    for law, skip in (("lag", 0), ("tip_gap", 1), ("half_width", 1)):
        found = np.array(getattr(fit.laws, law))
        block = covariance[first:, first:][: len(found) - skip, : len(found) - skip]
        first += len(found) - skip
        for share in truth_recovery.SHARES:
            powers = (share * deepest) ** np.arange(skip, len(found))
            out[f"{law} at {share:g}"] = (powers @ found[skip:], 1.96 * np.sqrt(powers @ block @ powers))
    out["height"] = (fit.height_mm, 1.96 * np.sqrt(covariance[first + 2, first + 2]))
    return out


def one_sheet(seed: int, parts: tuple[str, ...], rounds: int) -> dict:
    brush, faults, sheet = painted(seed)

    def options(with_machine: bool):
        made = truth_recovery.options_for(brush, faults)
        if with_machine:
            machine_found.request_machine_parts(made, parts)
        return made

    out: dict = {"seed": seed, "marks": len(sheet.marks), "rows": {}, "values": {}}
    for machine in (False, True):
        suffix = " with machine" if machine else ""
        fit_options = options(machine)
        used, took, fit = least_time(lambda options=fit_options: _core.fit_marks(sheet.marks, None, options), rounds)
        out["rows"]["one fit" + suffix] = (used, took, fit.iterations)
        out["values"]["one fit" + suffix] = values_of(fit, brush.deepest)
        used, took, made = least_time(
            lambda machine=machine: calibrate_marks(sheet, "b", options=options(machine), edge_mm=EDGE_MM),
            rounds,
        )
        out["rows"]["calibrate" + suffix] = (used, took, 0)
        out["values"]["calibrate" + suffix] = values_of(made.fit, brush.deepest)
        expected = options(machine)
        expected.deepest_mm, expected.noise_mm = brush.deepest, 0.1
        expected.lag_terms = 4
        used, took, _ = least_time(
            lambda options=expected, laws=fit.laws: _core.fit_marks(sheet.marks, laws, options), rounds
        )
        out["rows"]["floor: four looks" + suffix] = (used, took, 0)
    return out


def table(found: list[dict]) -> str:
    lines = [f"{len(found)} sheets of {found[0]['marks']} marks; s of processors, s on the clock, iterations"]
    for name in found[0]["rows"]:
        rows = np.array([one["rows"][name] for one in found])
        lines.append(f"  {name:34s} {rows[:, 0].mean():7.2f} {rows[:, 1].mean():7.2f} {rows[:, 2].mean():6.0f}")
    return "\n".join(lines)


def apart(found: list[dict], others: list[dict]) -> str:
    lines = ["off by / longer by, in half intervals (worst)"]
    for name in found[0]["values"]:
        off, longer = (0.0, ""), (0.0, "")
        for one, other in zip(found, others, strict=True):
            for what, (value, half) in one["values"][name].items():
                was, half_was = other["values"][name][what]
                where = f"{what}, sheet {one['seed']}"
                off = max(off, (abs(value - was) / half_was, where))
                longer = max(longer, (abs(half / half_was - 1), where))
        lines.append(f"  {name:34s} {off[0]:.4f} ({off[1]}), {longer[0]:.4f} ({longer[1]})")
    return "\n".join(lines)


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    arguments.add_argument("--sheets", type=int, default=3)
    arguments.add_argument("--seed", type=int, default=1)
    arguments.add_argument("--rounds", type=int, default=2)
    arguments.add_argument("--parts", type=lambda text: tuple(text.split(",")), default=tuple(machine_found.PARTS))
    arguments.add_argument("--save", type=Path)
    arguments.add_argument("--against", type=Path)
    args = arguments.parse_args()
    found = [one_sheet(args.seed + k, args.parts, args.rounds) for k in range(args.sheets)]
    print(table(found))
    if args.save:
        args.save.write_text(json.dumps(found), encoding="utf-8")
    if args.against:
        print(apart(found, json.loads(args.against.read_text(encoding="utf-8"))))


if __name__ == "__main__":
    main()
