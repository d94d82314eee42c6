"""Measure how well each compensation paints other people's lettering.

The program prints the overlap of predicted and target mark, by stroke and by whole character, as in the
report. It also prints the number of poses and the milliseconds of processor time.

The lettering is a random choice of Chinese characters of `hanzi-writer-data`, 100 mm high, and letters of two
fonts. npm fetches them once into a folder. Widths beyond the brush's range are painted at the nearest width,
and compared with the true outline. `--limit N` compares N strokes with the best result of a global search
instead.
"""

from __future__ import annotations

import argparse
import sys
import time
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path

import numpy as np

from brushsvg import _core, find_brush
from brushsvg.read.design import Design
from brushsvg.strokes.extraction import strokes
from brushsvg.strokes.wide_shapes import within_reach

sys.path.insert(0, str(Path(__file__).parents[1] / "tests" / "integration"))
from lettering import PACKAGES, Lettering, letter
from npm import fetched

TEXT = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789"
FONTS = (("sans", 100.0), ("script", 60.0))  # at 100 mm, the script is wider than round-6 almost everywhere
SEARCHED = 30  # number of characters for the search of the best constant lag
TOLERANCE_MM = 0.05


def found(design: Design, brush) -> tuple[list, list]:
    """Return the strokes to paint, and the target of each."""
    painted, target, _ = within_reach(strokes(design)[0], brush)
    return painted, target


def overlap(trace, target, brush) -> float:
    return _core.common_area([trace], [target], brush).overlap


@dataclass
class Way:
    """One compensation and its results by stroke and by character."""

    name: str
    method: str
    lag_mm: float | None = None
    alone: list = field(default_factory=list)
    whole: list = field(default_factory=list)
    times_ms: list = field(default_factory=list)
    poses: list = field(default_factory=list)

    def paint(self, stroke, brush, sheet_mm):
        begin = time.thread_time()
        done = _core.compensate([stroke], brush, sheet_mm, self.method, TOLERANCE_MM, self.lag_mm)
        self.times_ms.append(1e3 * (time.thread_time() - begin))
        self.poses.append(len(done.plan.passes[0].poses_mm))
        return _core.simulate(done.plan, brush).passes[0]

    def add(self, other: Way) -> None:
        for mine, theirs in ((getattr(self, k), getattr(other, k)) for k in self.lists):
            mine += theirs

    lists = ("alone", "whole", "times_ms", "poses")

    def row(self) -> str:
        cells = [
            f"{np.mean(each):.3f}  {np.median(each):.3f}  {np.percentile(each, 5):.3f}"
            for each in (self.alone, self.whole)
        ]
        times = f"{np.median(self.times_ms):6.1f} {np.mean(self.times_ms):6.1f}"
        return f"  {self.name:<28}{cells[0]:<24}{cells[1]:<24}{times:<16}{np.mean(self.poses):6.1f}"


def ways(best_mm: float) -> list[Way]:
    return [
        Way("none", "none"),
        Way(f"constant {best_mm:g} mm", "constant", best_mm),
        Way("constant, each at its depth", "constant"),
        Way("closed", "closed"),
        Way("refined", "refined"),
    ]


def painted(design: Design, name: str, best_mm: float) -> tuple[list[Way], int]:
    """Paint one character in all ways, and count strokes wider than the brush."""
    brush = find_brush(name)  # a brush cannot be sent between processes, so each process finds it
    some, target = found(design, brush)
    done = ways(best_mm)
    for way in done:
        traces = [way.paint(stroke, brush, design.sheet_mm) for stroke in some]
        way.alone = [overlap(trace, each, brush) for trace, each in zip(traces, target, strict=True)]
        way.whole = [_core.common_area(traces, target, brush).overlap]
    widest = brush.half_width_range_mm()[1]
    return done, sum(max(half for _, half in each.half_width) > widest for each in target)


def by_lag(design: Design, name: str, lags_mm: list[float]) -> np.ndarray:
    """Return overlaps of a character's strokes, a row per stroke, a column per lag."""
    brush = find_brush(name)
    some, target = found(design, brush)
    return np.array(
        [
            [overlap(Way("", "constant", lag).paint(stroke, brush, (0.0, 0.0)), each, brush) for lag in lags_mm]
            for stroke, each in zip(some, target, strict=True)
        ]
    ).reshape(-1, len(lags_mm))


def best_constant_mm(pool, designs: list[Design], brush) -> tuple[float, int]:
    """Return the constant lag with the largest overlap of all strokes, to 0.25 mm.

    Also return the number of tried strokes.
    """

    def best(lags_mm) -> tuple[float, int]:
        work = partial(by_lag, name=brush.name, lags_mm=lags_mm.tolist())
        rows = np.vstack(list(pool.map(work, designs[:SEARCHED])))
        return float(lags_mm[rows.mean(axis=0).argmax()]), len(rows)

    greatest = max(brush.lag(depth) for depth in np.linspace(*brush.depth_range_mm, 101))
    coarse, _ = best(np.arange(0.0, greatest + 1.0, 1.0))
    return best((coarse + np.arange(-0.75, 1.0, 0.25)).clip(0.0))


def measured(title: str, designs: list[Design], brush, processes: int) -> None:
    begin, wide = time.monotonic(), 0
    with ProcessPoolExecutor(processes) as pool:
        best_mm, tried = best_constant_mm(pool, designs, brush)
        done = ways(best_mm)
        work = partial(painted, name=brush.name, best_mm=best_mm)
        for count, (each, wider) in enumerate(pool.map(work, designs), start=1):
            for way, more in zip(done, each, strict=True):
                way.add(more)
            wide += wider
            print(f"\r{count} of {len(designs)}", end="", file=sys.stderr, flush=True)
    print("\r", end="", file=sys.stderr)
    every = len(done[0].alone)
    print(f"{title}: {len(designs)} of them, {every} strokes, {wide / every:.1%} wider than the brush somewhere")
    print(f"  the best constant lag was searched on {tried} of the strokes")
    print(f"  {'':<28}{'per stroke':<24}{'per character':<24}{'ms per stroke':<16}poses per stroke")
    print(f"  {'':<28}" + 2 * f"{'mean   median 5th %':<24}" + f"{'median  mean':<16}mean")
    for way in done:
        print(way.row())
    print(f"  {time.monotonic() - begin:.0f} s", flush=True)


def one_limit(place: tuple[Design, int], name: str, tries: int, seed: int) -> dict[str, float]:
    from limit import search  # imports packages that only this function needs

    brush, (design, k) = find_brush(name), place
    some, target = found(design, brush)
    return search(some[k % len(some)], target[k % len(some)], brush, tries, seed)


def limits(designs: list[Design], brush, options) -> None:
    """Compare a random stroke of each character with the best of a global search."""
    random = np.random.default_rng(options.seed)
    places = [(design, int(random.integers(100))) for design in designs[: options.limit]]
    work = partial(one_limit, name=brush.name, tries=options.tries, seed=options.seed)
    print(f"one stroke of each of {len(places)} characters, {options.tries} simulations from each beginning")
    with ProcessPoolExecutor(options.processes) as pool:
        rows = []
        for each in pool.map(work, places):
            rows.append(each)
            print("  " + "  ".join(f"{key} {value:.4f}" for key, value in each.items()), flush=True)
    for key in rows[0]:
        print(f"  {key:<8} mean {np.mean([each[key] for each in rows]):.4f}")
    won, there = (sum(each[key] - each["closed"] for each in rows) for key in ("refined", "found"))
    print(f"  refined wins {won / there:.0%} of what the search wins over closed", flush=True)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path, help="where npm puts, or has put, the lettering")
    parser.add_argument("--count", type=int, default=500, help="characters, and letters at most")
    parser.add_argument("--seed", type=int, default=20260)
    parser.add_argument("--brush", default="round-6")
    parser.add_argument("--processes", type=int, default=2)
    parser.add_argument("--limit", type=int, metavar="N", help="a global search on N strokes, instead")
    parser.add_argument("--tries", type=int, default=4000, help="simulations of that search, per stroke and beginning")
    options = parser.parse_args()
    options.folder.mkdir(parents=True, exist_ok=True)
    lettering, brush = Lettering(fetched(options.folder, PACKAGES)), find_brush(options.brush)
    print(f"brush {brush.name}, seed {options.seed}")
    chosen = lettering.drawings(options.count, options.seed)
    if options.limit:
        limits(chosen, brush, options)
        return
    measured("Chinese characters at 100 mm", chosen, brush, options.processes)
    for kind, em_mm in FONTS:
        font = lettering.font(kind)
        letters = [letter(font, text, em_mm) for text in TEXT[: options.count]]
        measured(f"letters of the {kind} font at {em_mm:g} mm to the em", letters, brush, options.processes)


if __name__ == "__main__":
    main()
