"""Paint a word with hidden brushes, whose files learn from each photograph.

    sheets.py [--count 16] [--starts three one round-6] [--margin auto] [--plain] [--own-mm 0] [--keep FOLDER]

Each brush is random, and the slow stepping simulator of tests/laws paints with it. At first it is known as a
person would know it. A person types lag and width at three depths, each read to 0.5 mm, or one lag and two
widths, or uses the shipped round-6. Every sheet has a new place. --own-mm displaces each stroke by this
length, once constantly and once at random. After each sheet, the brush learns from its photograph (`calibrate
--plan --prior`). `compare` with the new brush writes corrections, and the next sheet is planned with both.

The program prints the overlap of the paint with the word on sheets 1, 2 and 3. It also prints the overlap of
a plan for the true brush on these sheets. The place of the sheet and the strokes in the margin do not count.
"""

from __future__ import annotations

import argparse
import contextlib
import functools
import io
import json
import multiprocessing
import re
import sys
import tempfile
import time
from dataclasses import replace
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1] / "tests" / "laws"))
import painter
import studio
from studios import camera, over

from brushsvg import find_brush
from brushsvg._core import MarkLaws
from brushsvg.calibration.marks.from_marks import brush_of
from brushsvg.cli import main
from brushsvg.comparison.job_page import job_page
from brushsvg.jobs.json_files import read_plan
from brushsvg.jobs.options import Options
from brushsvg.jobs.preparation.margin_strokes import is_margin
from brushsvg.jobs.preparation.preparation import prepare
from brushsvg.model.library import save_brush
from brushsvg.show.evaluation.figures import target_rings

SHEETS, WIDEST_MM = 3, 4.0  # of the word
WORD = re.sub(
    r'stroke-width="([\d.]+)"',
    lambda found: f'stroke-width="{float(found[1]) * WIDEST_MM / 5.5:.2f}"',
    studio.WORD,
)
PLAIN = re.sub(r'stroke-width="[^"]*"', 'stroke-width="2.40"', WORD)  # one width; of its strokes only the loop is alone
PLAIN = re.sub(r'<path id="(line|wave|stem)"[^>]*/>', "", PLAIN).replace("L94 48 L112 24", "L94 48 L104 16")
SHARES = (0.3, 0.6, 0.95)  # depths at which a person measures, as shares of the largest depth


def hidden_brush(number: int):
    """Return the number-th random brush that can paint the word.

    The brush must also allow the depths of round-6 for this word.
    """
    rng = np.random.default_rng(51)
    while True:
        brush = painter.random_brush(rng)
        wide = 2 * float(np.polynomial.polynomial.polyval(0.95 * brush.deepest, brush.half_width))
        if wide > 1.3 * WIDEST_MM and brush.deepest > WIDEST_MM / 2 / 0.42:
            number -= 1
        if not number:
            return brush


def starts_of(brush) -> dict[str, str]:
    """Return the commands for the first brush file as {name of a start: command}."""
    depths = [round(share * brush.deepest, 1) for share in SHARES]

    def read(law, times):
        return [round(2 * times * float(np.polynomial.polynomial.polyval(d, law))) / 2 for d in depths]

    lags, widths = read(brush.lag, 1), read(brush.half_width, 2)
    lag_at = " ".join(f"--lag-at {d}={value}" for d, value in zip(depths, lags, strict=True))
    width_at = [f"--width-at {d}={value}" for d, value in zip(depths, widths, strict=True)]
    return {
        "three": f"brush new -o mine-1.json {lag_at} {' '.join(width_at)}",
        "one": f"brush new -o mine-1.json --lag {lags[1]} {width_at[0]} {width_at[2]}",
        "round-6": "",
    }


def run(line: str, folder: Path) -> None:
    words = [
        str(folder / each) if re.fullmatch(r"[\w-]+\.\w+", each) and "=" not in each and not each[0].isdigit() else each
        for each in line.split()
    ]
    errors, out = io.StringIO(), io.StringIO()
    with contextlib.redirect_stderr(errors), contextlib.redirect_stdout(out):
        status = main([*words, "--quiet", "--force"])
    if status != 0:
        raise RuntimeError(f"{line}: exit {status}: {errors.getvalue()[-300:]}")


def swept(plan, brush) -> dict:
    ways = studio.ran(plan, studio.Faults())
    regions = painter.swept(brush, ways, 0.0, lasts=[np.inf] * len(ways))
    return {name: region for (name, _), region in zip(ways, regions, strict=True) if region is not None}


def overlap(regions: dict, plan, drawn) -> float:
    own = [regions[each.stroke] for each in plan.passes if each.stroke in regions and not is_margin(each)]
    return over(studio.unary_union(own), drawn)


def paint_sheets(job: tuple[int, str], folder: Path, margin: str, own_mm: float, word: str = WORD) -> dict:
    number, start = job
    began, folder = time.process_time(), folder / f"{number}-{start}"
    if (folder / "result.json").exists():
        return json.loads((folder / "result.json").read_text())
    folder.mkdir(parents=True)
    brush = hidden_brush(number)
    (folder / "word.svg").write_text(word)
    laws = MarkLaws(
        brush.lag.tolist(),
        brush.tip_gap.tolist(),
        brush.half_width.tolist(),
        brush.widest_per_half,
        brush.front_per_half,
    )
    save_brush(brush_of(laws, "true", (0.0, brush.deepest)), folder / "true.json")
    if typed := starts_of(brush)[start]:
        run(typed, folder)
    else:
        save_brush(find_brush("round-6"), folder / "mine-1.json")
    run("convert word.svg -o plan-true.json --brush true.json", folder)
    ideal = read_plan(folder / "plan-true.json")
    drawn = studio.as_region(
        target_rings(prepare(folder / "word.svg", Options(brush=find_brush(folder / "true.json"))).strokes)
    )
    perfect = swept(ideal, brush)
    rng = np.random.default_rng([51, number])
    own = {each.stroke: rng.normal(0, own_mm, 2) for each in ideal.passes}
    fault_values = studio.Faults(own=own, random_mm=own_mm)
    result = {"number": number, "start": start, "overlap": [], "true": [], "notes": []}
    corrections = ""
    for sheet in range(1, SHEETS + 1):
        flags = f"--brush mine-{sheet}.json {corrections} --margin-strokes {margin}"
        run(f"convert word.svg -o plan-{sheet}.json {flags} --page page-{sheet}.svg", folder)
        plan = read_plan(folder / f"plan-{sheet}.json")
        here = replace(fault_values, shift=tuple(rng.normal(0, 0.2, 2)), turn=float(rng.normal(0, 0.1)))
        seed = 100 * number + sheet
        regions = swept(plan, brush)
        result["overlap"].append(overlap(studio.laid(regions, plan, fault_values, seed), plan, drawn))
        result["true"].append(overlap(studio.laid(perfect, ideal, fault_values, seed), ideal, drawn))
        result["notes"].append(f"{sum(map(is_margin, plan.passes))} in the margin")
        if sheet == SHEETS:
            break
        real = studio.laid(regions, plan, here, seed)
        photo = studio.photographed(plan, real, "word", camera(rng, job_page(plan).size_mm), seed)
        (folder / f"photo-{sheet}.jpg").write_bytes(photo)
        corrections = learned(sheet, folder, result["notes"])
    result["seconds"] = time.process_time() - began
    (folder / "result.json").write_text(json.dumps(result, indent=1))
    return result


def learned(sheet: int, folder: Path, notes: list[str]) -> str:
    """Learn from a photograph, and return the words for the next plan.

    Refusals are noted and left out.
    """
    photo, plan, now = f"photo-{sheet}.jpg", f"plan-{sheet}.json", f"mine-{sheet + 1}.json"
    try:
        run(f"calibrate {photo} --plan {plan} --prior mine-{sheet}.json -o {now}", folder)
    except RuntimeError as refusal:
        notes.append(str(refusal))
        (folder / now).write_bytes((folder / f"mine-{sheet}.json").read_bytes())
    try:
        run(f"compare {photo} {plan} --brush {now} -o left-{sheet}.json", folder)
        corrections = f"--corrections left-{sheet}.json"
        run(f"convert word.svg -o tried.json --brush {now} {corrections}", folder)
    except RuntimeError as refusal:
        notes.append(str(refusal))
        return ""
    return corrections


def report(rows: list[dict]) -> None:
    print("\nstart     brushes   overlap on sheets 1, 2, 3 (lowest)           true brush   below it on sheet 3")
    for start in dict.fromkeys(row["start"] for row in rows):
        own = np.array([row["overlap"] for row in rows if row["start"] == start])
        true = np.array([row["true"] for row in rows if row["start"] == start])
        each = "   ".join(f"{own[:, k].mean():.3f} ({own[:, k].min():.3f})" for k in range(SHEETS))
        off = (true - own)[:, -1]
        print(f"{start:9} {len(own):4}      {each}   {true.mean():.3f}        {off.mean():.3f} ({off.max():.3f})")


def main_() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--count", type=int, default=16)
    parser.add_argument("--starts", nargs="+", choices=("three", "one", "round-6"), default=["three", "one", "round-6"])
    parser.add_argument("--margin", choices=("auto", "on", "off"), default="auto", help="as convert --margin-strokes")
    parser.add_argument("--plain", action="store_true", help="a word of one width, most of whose strokes touch")
    parser.add_argument("--own-mm", type=float, default=0.0, help="standard deviation of each stroke's own place")
    parser.add_argument("--processes", type=int, default=1)
    parser.add_argument("--keep", type=Path, help="a folder for all files; what is there is not done again")
    args = parser.parse_args()
    jobs = [(number, start) for number in range(1, args.count + 1) for start in args.starts]
    with tempfile.TemporaryDirectory() as made, multiprocessing.Pool(args.processes) as pool:
        one = functools.partial(
            paint_sheets,
            folder=args.keep or Path(made),
            margin=args.margin,
            own_mm=args.own_mm,
            word=PLAIN if args.plain else WORD,
        )
        rows = []
        for row in pool.imap(one, jobs):
            rows.append(row)
            line, true = ("  ".join(f"{each:.3f}" for each in row[key]) for key in ("overlap", "true"))
            print(
                f"brush {row['number']}, {row['start']}: {line}; true brush {true}; {'; '.join(row['notes'])}; "
                f"{row['seconds']:.0f} s",
                flush=True,
            )
    report(rows)


if __name__ == "__main__":
    main_()
