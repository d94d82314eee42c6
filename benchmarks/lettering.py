"""How well other people's lettering is painted, by every compensation: overlap of predicted and wanted mark, stroke by
stroke and whole character by whole character, and milliseconds per stroke.

Chinese characters drawn at random from `hanzi-writer-data`, 100 mm high, and letters of two fonts, all fetched by npm
once into a folder. Widths beyond the brush's are painted at the nearest, and held against the outline as it is.
"""

from __future__ import annotations

import argparse
import sys
import time
from pathlib import Path

import numpy as np

from brushsvg import _core, find_brush
from brushsvg.design import Design
from brushsvg.reach import within_reach
from brushsvg.strokes import strokes

sys.path.insert(0, str(Path(__file__).parents[1] / "tests" / "integration"))
from lettering import CHARACTER_MM, Lettering, letter, outline

RINGS_MM = 0.01
TEXT = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789"
FONTS = (("sans", 100.0), ("script", 60.0))  # at 100 mm the script is wider than round-6 almost everywhere
SEARCHED = 300  # strokes that the best constant lag is searched on


def characters(lettering: Lettering, count: int, seed: int) -> list[Design]:
    sheet = (CHARACTER_MM, CHARACTER_MM)
    return [
        Design(sheet, tuple(outline(f"s{k}", data) for k, data in enumerate(each["strokes"])))
        for _, each in lettering.characters(count, seed)
    ]


def plan_of(some, brush, sheet_mm, method: str, lag_mm=None):
    return _core.compensate(some, brush, sheet_mm, method, 0.05, lag_mm).plan


def marks_of(plan, brush):
    marks = _core.simulate(plan, brush)
    _core.trace_outlines(marks, brush)
    return marks


def by_pixels(stroke, brush, method: str, lag_mm: float, px_per_mm: float = 8.0) -> float:
    """Overlap to 0.001, in a tenth of the rings' time."""
    rings = _core.wanted_outline(stroke, RINGS_MM)
    marks = _core.simulate(plan_of([stroke], brush, (0.0, 0.0), method, lag_mm), brush, tolerance_mm=0.05)
    box = _core.painted_bounds(marks.passes[0], brush)
    low = np.minimum(np.vstack(rings).min(axis=0), box[:2])
    high = np.maximum(np.vstack(rings).max(axis=0), box[2:])
    window = (*low, *(high - low))
    painted, meant = (
        _core.coverage(marks, brush, window, px_per_mm),
        _core.coverage(rings, window, px_per_mm),
    )
    return float(np.minimum(painted, meant).sum() / np.maximum(painted, meant).sum())


def best_constant_mm(some, brush) -> float:
    """The one lag for all strokes whose marks overlap most with what is wanted, to 0.25 mm."""
    few = some[:: max(1, len(some) // SEARCHED)]

    def mean(lag_mm: float) -> float:
        return float(np.mean([by_pixels(stroke, brush, "constant", lag_mm) for stroke in few]))

    coarse = max(np.arange(0.0, 14.0, 1.0).tolist(), key=mean)
    return max((coarse + np.arange(-0.75, 1.0, 0.25)).clip(0.0).tolist(), key=mean)


def spread(values) -> str:
    return f"{np.mean(values):.4f}  {np.median(values):.4f}  {np.percentile(values, 5):.4f}"


def measured(title: str, designs: list[Design], brush) -> None:
    drawings, wide = [], 0
    for design in designs:
        found, _ = strokes(design)
        painted, wanted, _ = within_reach(found, brush)
        wide += sum(max(half for _, half in s.half_width) > brush.half_width_range_mm()[1] for s in found)
        drawings.append((design.sheet_mm, painted, wanted))
    every = [stroke for _, painted, _ in drawings for stroke in painted]
    print(f"{title}: {len(designs)} of them, {len(every)} strokes")
    print(f"  wider than the brush somewhere: {wide / len(every):.1%} of the strokes")
    best_mm = best_constant_mm(every, brush)
    ways = [("none", "none", None), (f"constant {best_mm:g} mm", "constant", best_mm)]
    ways += [("constant, each at its depth", "constant", None), ("closed", "closed", None)]
    ways += [("refined", "refined", None)]
    print(f"  {'':<28}{'per stroke':<24}{'per character':<24}ms per stroke")
    print(f"  {'':<28}" + 2 * f"{'mean    median  5th %':<24}" + "median  mean")
    for name, method, lag_mm in ways:
        alone, whole, times = [], [], []
        for sheet_mm, painted, wanted in drawings:
            marks = _core.Marks()
            passes = []
            for stroke in painted:
                begin = time.thread_time()
                plan = plan_of([stroke], brush, sheet_mm, method, lag_mm)
                times.append(1e3 * (time.thread_time() - begin))
                passes.append(marks_of(plan, brush).passes[0])
            marks.passes = passes
            rings = [_core.wanted_outline(stroke, RINGS_MM) for stroke in wanted]
            alone += [
                _core.overlap(trace.outline_mm, each) for trace, each in zip(passes, rings, strict=True)
            ]
            union, meant = (
                _core.unite([ring for trace in passes for ring in trace.outline_mm]),
                _core.unite([ring for each in rings for ring in each]),
            )
            whole.append(_core.overlap(union, meant))
        print(
            f"  {name:<28}{spread(alone):<24}{spread(whole):<24}{np.median(times):6.1f} {np.mean(times):6.1f}",
            flush=True,
        )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path, help="where npm puts, or has put, the lettering")
    parser.add_argument("--count", type=int, default=500, help="characters, and letters at most")
    parser.add_argument("--seed", type=int, default=20260)
    parser.add_argument("--brush", default="round-6")
    options = parser.parse_args()
    options.folder.mkdir(parents=True, exist_ok=True)
    lettering, brush = Lettering(options.folder), find_brush(options.brush)
    print(f"brush {brush.name}, seed {options.seed}")
    measured("Chinese characters at 100 mm", characters(lettering, options.count, options.seed), brush)
    for kind, em_mm in FONTS:
        font = lettering.font(kind)
        letters = [letter(font, text, em_mm) for text in TEXT[: options.count]]
        measured(f"letters of the {kind} font at {em_mm:g} mm to the em", letters, brush)


if __name__ == "__main__":
    main()
