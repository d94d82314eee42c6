"""Simulate studios that paint a word and follow the advice of compare.

    studios.py [--count 60] [--only K] [--processes 2] [--keep FOLDER] [--sheets 3]

Brush, machine, paper and paint of a studio differ from their files. The number of a studio is its random
seed. Lag and width of the brush are up to 20 % off. The machine has a tilt of up to 2 mm over the sheet, up
to 0.5 mm of backlash and 1 % of scale. Each stroke is always displaced by the same 0.1 mm. Paint lasts for
100 to 300 mm. Every sheet has a new place, each stroke another random 0.1 mm, and the camera a new pose. The
slow stepping simulator of tests/laws paints, and the renderer makes the pictures.

The studio paints three sheets. After the first sheet, the brush learns from it (`calibrate --plan --prior
--machine axes,tilt,backlash`). `compare` with this brush writes the cell (`--corrected-cell`) and the
remaining corrections (`convert --corrections`). If paint is missing, the brush is dipped before each stroke,
not before every other stroke. After the second sheet, `compare --corrections` moves the strokes once more.
Machines run the programs' text.

The program prints the overlap of real paint with the drawing. It prints how much of the repeating gap is
closed. The gap is the distance to a studio that knows its brush and has no other faults. It also prints the
strokes that became worse, and whether `compare` names the largest cause, if that cause removes more than half
of the lost overlap. --sheets 1 tests only the attribution.
"""

from __future__ import annotations

import argparse
import contextlib
import functools
import io
import json
import multiprocessing
import sys
import tempfile
import time
from dataclasses import replace
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1] / "tests" / "laws"))
import studio
from numpy.polynomial.polynomial import polyval
from photograph import Camera

from brushsvg import find_brush
from brushsvg.cli import main
from brushsvg.comparison.job_page import job_page
from brushsvg.jobs.json_files import read_plan
from brushsvg.jobs.options import Options
from brushsvg.jobs.preparation.preparation import prepare
from brushsvg.machine.cells.cell_file import find_cell, write_cell
from brushsvg.model.library import save_brush
from brushsvg.show.evaluation.figures import target_rings

STROKES_A_LOAD = 2
SURE_GAIN = 0.005
CAUSES = ("place of the sheet", "machine", "height and tilt of the paper", "brush", "each stroke's own place")
CAUSES += ("missing paint",)
MOVES = ("place of the sheet", "each stroke's own place")  # these causes only move strokes


def run(word: str, folder: Path) -> str:
    """Run a command of brushsvg in a folder and return its output."""
    words = [str(folder / each) if "." in each and not each.startswith("-") else each for each in word.split()]
    errors, out = io.StringIO(), io.StringIO()
    with contextlib.redirect_stderr(errors), contextlib.redirect_stdout(out):
        status = main(words)
    if status != 0:
        raise RuntimeError(f"{word}: exit {status}: {errors.getvalue()[-300:]}")
    return out.getvalue()


def over(region, other) -> float:
    return region.intersection(other).area / region.union(other).area


def all_of(regions: dict):
    return studio.unary_union(list(regions.values()))


def all_target(folder: Path):
    work = prepare(folder / "word.svg", Options(brush=find_brush(folder / "mine-0.json")))
    return studio.as_region(target_rings(work.strokes))


def camera(rng, page_mm) -> Camera:
    wide = int(rng.uniform(1700, 2600))
    return Camera(
        size_px=(wide, round(wide * page_mm[1] / page_mm[0])),
        focal=rng.uniform(0.9, 1.5),
        tilt_deg=tuple(rng.uniform(-5, 5, 2)),
        turn_deg=rng.uniform(-2, 2),
        bend=rng.uniform(-0.03, 0.03),
        fill=0.88,
        blur_px=rng.uniform(0.7, 1.4),
        noise=rng.uniform(0.004, 0.012),
    )


def sheet_laid(fault_values, rng):
    return replace(fault_values, shift=tuple(rng.normal(0, 0.2, 2)), turn=float(rng.normal(0, 0.1)))


def random_studio(number: int, plan):
    rng = np.random.default_rng([24, number])
    fault_values = studio.random_faults(rng, [one.stroke for one in plan.passes], plan.sheet_mm)
    return replace(fault_values, lasts_mm=float(rng.uniform(100, 300))), rng


def paint_a_studio(number: int, folder: Path, sheets: int = 3) -> dict:
    """Simulate a studio and return a table of the results."""
    began = time.process_time()
    folder.mkdir(parents=True, exist_ok=True)
    save_brush(studio.known_brush(), folder / "mine-0.json")
    (folder / "word.svg").write_text(studio.WORD)
    (folder / "cell-0.toml").write_text(write_cell(find_cell()))
    drawn = None
    result = {
        "number": number,
        "overlap": [],
        "gap": [],
        "gap_wanted": [],
        "strokes": [],
        "brush": [],
    }
    corrections, strokes_a_load = "", STROKES_A_LOAD
    for sheet in range(sheets):
        brush, cell = f"mine-{sheet}.json", f"cell-{sheet}.toml"
        flags = f"--brush {brush}"
        corrections_flag = f"--corrections {corrections}" if corrections else ""
        run(f"convert word.svg -o plan-{sheet}.json --cell {cell} {flags} {corrections_flag}", folder)
        plan = read_plan(folder / f"plan-{sheet}.json")
        if sheet == 0:
            fault_values, rng = random_studio(number, plan)
            drawn = all_target(folder)
            # The paint of a studio that knows its brush and has no other faults.
            save_brush(studio.known_brush(lag=fault_values.lag, half=fault_values.half), folder / "true.json")
            run("convert word.svg -o plan-true.json --brush true.json --quiet", folder)
            ideal = studio.Faults(lag=fault_values.lag, half=fault_values.half)
            perfect = studio.swept(read_plan(folder / "plan-true.json"), ideal)
            result["truth"] = truth_of(fault_values)
            result["lasts_mm"] = fault_values.lasts_mm
        run(f"convert word.svg -o commanded-{sheet}.ngc --cell {cell} {flags} {corrections_flag}", folder)
        commanded = studio.commanded_by((folder / f"commanded-{sheet}.ngc").read_text(), plan.sheet_mm)
        swept = studio.swept(commanded, fault_values, strokes_a_load)
        always = studio.laid(swept, commanded, replace(fault_values, random_mm=0.0), 0)
        seed = 100 * number + sheet
        here = sheet_laid(fault_values, rng)
        real = studio.laid(swept, commanded, here, seed)
        result["overlap"].append(over(all_of(real), drawn))
        result["gap"].append(1 - over(all_of(always), all_of(perfect)))
        result["gap_wanted"].append(over(all_of(perfect), drawn) - over(all_of(always), drawn))
        result["strokes"].append(
            {name: over(always[name], perfect[name]) if name in always else 0.0 for name in perfect}
        )
        page = job_page(plan)
        photo = studio.photographed(plan, real, "word", camera(rng, page.size_mm), seed)
        (folder / f"photo-{sheet}.jpg").write_bytes(photo)
        if sheet == 0:
            result["gains"] = gains_of(swept, commanded, here, seed, drawn, result["overlap"][0])
            result["lost"] = over(all_of(perfect), drawn) - result["overlap"][0]
        if sheet and sheet == sheets - 1:
            break
        text = run(
            f"compare photo-{sheet}.jpg word.svg --cell {cell} {flags} {corrections_flag} -o seen-{sheet}.json "
            + ("" if sheet else "--corrected-cell cell-1.toml"),
            folder,
        )
        (folder / f"seen-{sheet}.txt").write_text(text)
        seen = json.loads((folder / f"seen-{sheet}.json").read_text())
        if sheet == 0:
            result["named"] = seen["faults"] and seen["faults"]["mend_first"]
            result["said"] = seen["faults"] and {row["cause"]: row["gain"] for row in seen["faults"]["causes"]}
            result["sheet"] = [*here.shift, here.turn]
            result["numbers"] = seen["faults"] and {
                row["name"]: [row["value"], row["half_95"]] for row in seen["faults"]["numbers"]
            }
        if sheets == 1:
            break
        strokes_a_load, corrections = follow(seen, sheet, folder, strokes_a_load)
        result["brush"].append(brush_off(find_brush(folder / f"mine-{sheet + 1}.json"), fault_values))
    result["seconds"] = time.process_time() - began
    return result


def follow(seen: dict, sheet: int, folder: Path, strokes_a_load: int) -> tuple[int, str]:
    """Follow the advice of compare and write the files for the next sheet.

    Return the number of strokes per load, and the file of corrections.
    """
    faults = seen["faults"] or {"causes": []}
    missing = [row for row in faults["causes"] if row["cause"] == "missing paint"]
    if missing and missing[0]["gain_95"][0] > SURE_GAIN:
        strokes_a_load = 1
    if sheet:
        for name in ("mine", "cell"):
            suffix = "json" if name == "mine" else "toml"
            before = folder / f"{name}-{sheet}.{suffix}"
            (folder / f"{name}-{sheet + 1}.{suffix}").write_bytes(before.read_bytes())
        return strokes_a_load, f"seen-{sheet}.json"
    words = f"calibrate photo-{sheet}.jpg --plan plan-{sheet}.json --prior mine-{sheet}.json -o mine-{sheet + 1}.json"
    try:
        (folder / f"learnt-{sheet}.txt").write_text(run(f"{words} --machine axes,tilt,backlash", folder))
    except RuntimeError as refusal:  # the brush learns nothing, and the cell stays as compare corrected it
        (folder / f"learnt-{sheet}.txt").write_text(str(refusal))
        (folder / f"mine-{sheet + 1}.json").write_bytes((folder / f"mine-{sheet}.json").read_bytes())
        return strokes_a_load, ""
    words = f"compare photo-{sheet}.jpg plan-{sheet}.json --brush mine-{sheet + 1}.json --cell cell-{sheet}.toml"
    text = run(f"{words} --corrected-cell cell-{sheet + 1}.toml -o left-{sheet}.json", folder)
    (folder / f"corrected-{sheet}.txt").write_text(text)
    left = json.loads((folder / f"left-{sheet}.json").read_text())
    rows = left.get("beside_machine", left)["strokes"]
    return strokes_a_load, f"left-{sheet}.json" if any(row["correction"] for row in rows) else ""


def truth_of(fault_values) -> dict[str, float]:
    """Return the true numbers by the names that compare uses."""
    pairs = {
        "scale": fault_values.scale,
        "backlash": fault_values.backlash,
        "tilt": fault_values.tilt,
        "lean": fault_values.lean,
    }
    found = {f"{name} in {axis}": float(pair[k]) for name, pair in pairs.items() for k, axis in enumerate("xy")}
    return found | {"lag": float(fault_values.lag) - 1, "width": float(fault_values.half) - 1}


def brush_off(brush, fault_values) -> list[float]:
    """Return the mean relative errors of lag and half width between 1 and 6 mm."""
    depths = np.linspace(1, 6, 11)
    return [
        float(np.mean(np.abs([law(d) for d in depths] / (off * polyval(depths, truth)) - 1)))
        for law, off, truth in (
            (brush.lag, fault_values.lag, studio.LAG),
            (brush.half_width, fault_values.half, studio.HALF),
        )
    ]


def gains_of(swept, commanded, fault_values, seed: int, drawn, overlap: float) -> dict[str, float]:
    """Return the overlap that each cause takes away.

    For each cause, the sheet is painted again without this cause.
    """
    found = {}
    for cause in CAUSES:
        corrected = fault_values.corrected(cause)
        again = swept if cause in MOVES else studio.swept(commanded, corrected, STROKES_A_LOAD)
        regions = studio.laid(again, commanded, corrected, seed)
        found[cause] = over(all_of(regions), drawn) - overlap
    return found


def report(rows: list[dict]) -> None:
    if (sheets := len(rows[0]["overlap"])) > 1:
        overlap, gap, by_target = (np.array([row[key] for row in rows]) for key in ("overlap", "gap", "gap_wanted"))
        print("\nsheet  overlap with target: mean, 5th percentile   gap to what should be (repeatable): mean, closed")
        for k in range(sheets):
            closed = 1 - gap[:, k].sum() / gap[:, 0].sum()
            less = 1 - by_target[:, k].sum() / by_target[:, 0].sum()
            each = np.quantile(1 - gap[:, k] / gap[:, 0], (0.05, 0.5))
            low = np.quantile(overlap[:, k], 0.05)
            print(
                f"{k + 1}      {overlap[:, k].mean():.3f}  {low:.3f}   {gap[:, k].mean():.4f}  {closed:6.1%} "
                f"(of a studio: median {each[1]:.1%}, 5th percentile {each[0]:.1%}; by overlap with target {less:.1%})"
            )
        for k in range(1, sheets):
            for before in range(k):
                pairs = [(one[k][name], one[before][name]) for one in (r["strokes"] for r in rows) for name in one[0]]
                worse = [b - a for a, b in pairs if a < b]
                print(
                    f"strokes worse on sheet {k + 1} than on sheet {before + 1}: {len(worse)} of {len(pairs)}, by "
                    f"more than 0.01 {sum(each > 0.01 for each in worse)}, by {max(worse, default=0):.3f} at most"
                )
    seen = [row for row in rows if row["numbers"]]
    print("\nnumbers of the first sheet: off (rms), within their 95 % intervals")
    for name in rows[0]["truth"]:
        off = np.array([[row["numbers"][name][0] - row["truth"][name], row["numbers"][name][1]] for row in seen])
        within = int(np.sum(np.abs(off[:, 0]) <= off[:, 1]))
        print(f"  {name}: {np.sqrt(np.mean(off[:, 0] ** 2)):.4f}, {within} of {len(seen)}")
    ruled = [row for row in rows if max(row["gains"].values()) > 0.5 * row["lost"]]
    rightly = [row for row in ruled if row["named"] == max(row["gains"], key=row["gains"].get)]
    most = [row for row in rows if row["named"] == max(row["gains"], key=row["gains"].get)]
    print(
        f"\nlargest cause named first where it makes up more than half: {len(rightly)} of {len(ruled)}; of all "
        f"studios: {len(most)} of {len(rows)}"
    )
    for row in rows:
        if row not in most:
            reported = row["said"] or {}
            words = ", ".join(
                f"{cause} {gain:.3f} (said {reported.get(cause, np.nan):.3f})" for cause, gain in row["gains"].items()
            )
            print(f"  {row['number']}: named {row['named']}; lost {row['lost']:.3f}: {words}")
    print(f"{np.mean([row['seconds'] for row in rows]):.1f} s of processor time a studio")


def main_() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--count", type=int, default=60)
    parser.add_argument("--only", type=int, nargs="*", help="these studios alone")
    parser.add_argument("--processes", type=int, default=2)
    parser.add_argument(
        "--keep", type=Path, help="a folder for photographs and figures; what is there is not done again"
    )
    parser.add_argument("--sheets", type=int, choices=(1, 2, 3), default=3, help="1: attribution alone")
    args = parser.parse_args()
    with tempfile.TemporaryDirectory() as made, multiprocessing.Pool(args.processes) as pool:
        folder = args.keep or Path(made)
        numbers = args.only if args.only else range(1, args.count + 1)
        job = functools.partial(paint_one, folder=folder, sheets=args.sheets)
        rows = []
        for row in pool.imap(job, numbers):
            rows.append(row)
            (folder / f"{row['number']}" / "result.json").write_text(json.dumps(row, indent=1))
            line = "  ".join(f"{each:.3f}" for each in row["overlap"])
            gaps = "  ".join(f"{each:.3f}" for each in row["gap"])
            print(f"studio {row['number']}: overlap {line}; gap {gaps}; {row['seconds']:.0f} s", flush=True)
    report(rows)


def paint_one(number: int, folder: Path, sheets: int) -> dict:
    done = folder / str(number) / "result.json"
    if done.exists():
        return json.loads(done.read_text())
    return paint_a_studio(number, folder / str(number), sheets)


if __name__ == "__main__":
    main_()
