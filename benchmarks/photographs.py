"""Recover random brushes from photographs of charts with `calibrate`.

The brushes paint printed charts, and random cameras photograph the charts.

    photographs.py FOLDER [--count 200] [--brushes 40] [--seed 1] [--sheet a4] [--strokes few] [--again]
                          [--height MM] [--half inside|outside]

FOLDER keeps each photograph and its result. A stopped run continues where it stopped. `--again` reads and
fits existing photographs once more. `--count 0` only shows existing results. `--height` is the standard
deviation to which the paper's height is known. `brushsvg setup height` finds this height, and `calibrate
--height` uses it.

The slow stepping simulator of tests/laws paints. The renderer of tests/laws makes the pictures, with a tilt,
a lens with another formula, blur, noise, uneven light, shadows and JPEG. Every sixth sheet of each half
bulges by a millimetre. Every other brush has laws outside of the fitted family: a lag that saturates and
swings, a width that grows as a root, and a bent tip gap. The results of the two halves are printed
separately. They are the errors of places on the sheet (rms), the error of the lag over the range, how often
the 95 % intervals contain the truth, the refusals, and the marks that were left out.
"""

from __future__ import annotations

import argparse
import json
import sys
import time
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1] / "tests" / "laws"))
import painter
import photograph
from numpy.polynomial import polynomial

from brushsvg import _core
from brushsvg.calibration.chart.layout import chart
from brushsvg.calibration.chart.photograph import (
    edge_mm,
    list_measured_marks,
    read_chart_photos,
    report_reading_notices,
)
from brushsvg.calibration.marks.from_marks import brush_of, calibrate_marks, options_for
from brushsvg.calibration.marks.mark_input import read_painted
from brushsvg.cli.arguments import values
from brushsvg.errors import Error
from brushsvg.model.confidence import law_band

KNOWN_TO = 0.15  # relative accuracy to which a person knows the brush before
SHARES = (0.2, 0.4, 0.6, 0.8, 1.0)  # shares of the largest depth
FAULTS = painter.Faults(noise=0.05, noise_length=0.5, displacement=0.3, placement=0.8, turn=0.008, height=0.1)
COLOURS = (
    photograph.BLUE,
    np.array([0.05, 0.05, 0.05]),
    np.array([0.7, 0.1, 0.08]),
    np.array([0.1, 0.35, 0.15]),
)
BULGING = 6  # one in this many sheets of each half bulges
TEXELS = 16.0  # per mm of the sheet; more would need a gigabyte for A4


def camera_of(rng, sheet_mm, is_bulging: bool) -> photograph.Camera:
    wide = int(sheet_mm[0] * rng.uniform(7.5, 11))
    return photograph.Camera(
        size_px=(wide, int(wide * sheet_mm[1] / sheet_mm[0])),
        focal=rng.uniform(0.9, 1.5),
        tilt_deg=tuple(rng.uniform(-8, 8, 2)),
        turn_deg=rng.uniform(-2, 2) + rng.choice([0.0, 180.0]),
        bend=rng.uniform(-0.04, 0.03),
        fill=0.88,
        displacement_mm=tuple(rng.uniform(-3, 3, 2)),
        blur_px=rng.uniform(0.6, 1.2),
        noise=rng.uniform(0.004, 0.015),
        light=tuple(rng.uniform(-0.3, 0.3, 2)),
        shadow=rng.choice([0.0, 0.3]),
        quality=int(rng.integers(75, 96)),
        sag_mm=1.0 if is_bulging else 0.0,
    )


class Case:
    """One photograph; brushes inside and outside the family alternate."""

    def __init__(self, number: int, seed: int, brushes: int, sheet_mm, strokes: str | None):
        which = number % brushes
        rng = np.random.default_rng([seed, which])
        self.number, self.inside, self.sheet_mm = number, which % 2 == 0, sheet_mm
        self.brush = painter.random_brush(rng)
        if not self.inside:
            self.brush = painter.of_other_functions(self.brush, rng)
        self.bulging = number // 2 % BULGING == BULGING - 1
        self.colour = COLOURS[(number // 2 + number // brushes) % len(COLOURS)]
        lag, width = rng.uniform(1 - KNOWN_TO, 1 + KNOWN_TO, 2)
        laws = _core.MarkLaws(list(lag * self.brush.lag), [0.0, 0.4], list(width * self.brush.half_width), 1.8, 1.0)
        self.chart = chart(brush_of(laws, "roughly", (0.0, self.brush.deepest)), sheet_mm, strokes)
        self.camera = camera_of(np.random.default_rng([seed, number, 1]), sheet_mm, self.bulging)
        self.paint_rng = np.random.default_rng([seed, number, 2])

    def taken(self) -> tuple[bytes, float]:
        """Return the JPEG, and the paper's height."""
        photograph.TEXELS = TEXELS
        ways = [(one.stroke, np.array(one.poses_mm)) for one in self.chart.plan.passes]
        painted = painter.paint(self.paint_rng, self.brush, ways, FAULTS)
        sheet = photograph.page(self.chart, self.number)
        for _, _, rings in painted.marks:
            sheet.paint(rings, self.colour)
        return photograph.photograph(sheet, self.camera, self.number), painted.height


def kept(case: Case, folder: Path) -> tuple[bytes, float]:
    """Return an existing photograph, or take it now."""
    photo, height = folder / f"{case.number}.jpg", folder / f"{case.number}.height"
    if not height.exists():
        jpeg, true_height = case.taken()
        photo.write_bytes(jpeg)
        height.write_text(f"{true_height}")
    return photo.read_bytes(), float(height.read_text())


def outcome(case: Case, jpeg: bytes, true_height: float, height_known: float | None = None) -> dict:
    """Return the result of a photograph as JSON values.

    height_known is the standard deviation to which the studio knows the paper's height.
    """
    out = {"number": case.number, "inside": case.inside, "bulging": case.bulging}
    brush, made = case.brush, case.chart
    try:
        begin = time.process_time()
        read = read_chart_photos(made, [("", jpeg)])
        out["read_s"] = time.process_time() - begin
        shares = [(x, y) for x in np.linspace(0.05, 0.95, 12) for y in np.linspace(0.05, 0.95, 16)]
        at = np.array(shares) * case.sheet_mm
        off = read.view.to_px(at) - photograph.corners_seen(case.camera, case.sheet_mm, at)
        out["geometry"] = float(np.sqrt(np.mean(np.sum(off**2, axis=1)))) / read.view.px_per_mm
        out["remarks"] = [notice.code for notice in report_reading_notices(read)]
        begin = time.process_time()
        plan = json.loads(_core.write_plan(made.plan))
        marks = read_painted(plan, list_measured_marks(read), None)
        options = options_for({})
        if height_known:
            seen = true_height + np.random.default_rng([case.number, 3]).normal(0, height_known)
            options.height_mm = _core.Prior(seen, height_known)
        fitted = calibrate_marks(marks, "found", options=options, edge_mm=edge_mm(read), leave_out_strays=True)
        out["fit_s"] = time.process_time() - begin
    except Error as refusal:
        return out | {"refused": refusal.code, "sentence": refusal.sentence}
    out["strays"] = [stray.mark.stroke for stray in fitted.strays]
    found, deepest = fitted.brush, fitted.brush.depth_range_mm[1]
    values = {}
    for law in ("lag", "tip_gap", "half_width"):
        for share in SHARES if law != "tip_gap" else (1.0,):
            depth = share * deepest
            error = getattr(found, law)(depth) - brush.law(law)(depth)
            values[f"{law} at {share:g}"] = (error, law_band(found, law, np.array([depth]))[0][0])
    half = _core.interval_factor_95() * np.sqrt(fitted.covariance[-4, -4])
    values["height"] = (fitted.fit.height_mm - true_height, half)
    out["values"] = {name: [float(value) for value in both] for name, both in values.items()}
    depths = np.linspace(0.15, 1, 18) * deepest
    lag = polynomial.polyval(depths, fitted.fit.laws.lag)
    off = lag / brush.law("lag")(depths) - 1
    out["lag"], out["lag_worst_at"] = float(np.abs(off).max()), float(depths[np.abs(off).argmax()] / deepest)
    out["strokes"] = len(made.strokes)
    return out


def summary(found: list[dict]) -> str:
    lines = [f"{len(found)} photographs"]
    for words, chosen in (
        ("brushes of the family that is fitted", [each for each in found if each["inside"]]),
        ("brushes outside of it", [each for each in found if not each["inside"]]),
    ):
        lines += ["", f"{words}: {len(chosen)} photographs", *_half(chosen)]
    reads = [each["read_s"] for each in found if "read_s" in each]
    fits = [each["fit_s"] for each in found if "fit_s" in each]
    if fits:
        lines += [
            "",
            f"processor time: {np.median(reads):.1f} s to read, {np.median(fits):.1f} s to fit (median)",
        ]
    return "\n".join(lines)


def _half(found: list[dict]) -> list[str]:
    lines = []
    for words, bulging in (("flat", False), ("bulging by 1 mm", True)):
        places = [each["geometry"] for each in found if each["bulging"] == bulging and "geometry" in each]
        refused = sum("geometry" not in each for each in found if each["bulging"] == bulging)
        worst = f", {np.median(places):.3f} median, {max(places):.3f} mm worst" if places else ""
        lines.append(f"  places on {words} sheets: {len(places)} read{worst} (rms); {refused} refused")
    for each in found:
        if "refused" in each:
            lines.append(f"  {each['number']}: refused, {each['refused']}: {each['sentence'][:90]}")
        elif each["strays"] or each["remarks"]:
            lines.append(f"  {each['number']}: {', '.join(each['remarks'])}; left out: {', '.join(each['strays'])}")
    made = [each for each in found if "values" in each]
    if not made:
        return lines
    worst = np.array([each["lag"] for each in made])
    lines.append(
        f"  lag within 3 % over the range: {np.sum(worst < 0.03)} of {len(made)}; off by "
        f"{100 * np.median(worst):.2f} % (median), {100 * worst.max():.2f} % (worst)"
    )
    held = {
        name: np.array([abs(each["values"][name][0]) < each["values"][name][1] for each in made])
        for name in made[0]["values"]
    }
    for name, each in held.items():
        half = np.median([one["values"][name][1] for one in made])
        off = np.median([abs(one["values"][name][0]) for one in made])
        lines.append(
            f"    {name:18s} held by {100 * each.mean():5.1f} %, +- {half:.3f} mm, off by {off:.3f} mm (medians)"
        )
    lines.append(f"    pooled             held by {100 * np.mean(list(held.values())):5.1f} %")
    return lines


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    arguments.add_argument("folder", type=Path)
    arguments.add_argument("--count", type=int, default=200)
    arguments.add_argument("--brushes", type=int, default=40)
    arguments.add_argument("--seed", type=int, default=1)
    arguments.add_argument("--sheet", type=values.sheet, default=(210.0, 297.0), help="a4, a3, 210x297")
    arguments.add_argument("--strokes", choices=("few", "normal", "many"))
    arguments.add_argument("--again", action="store_true", help="read and fit known photographs once more")
    arguments.add_argument("--height", type=float, help="standard deviation to which the paper's height is known")
    arguments.add_argument("--half", choices=("inside", "outside"), help="only brushes of that half")
    args = arguments.parse_args()
    args.folder.mkdir(parents=True, exist_ok=True)
    for number in range(args.count):
        result = args.folder / f"{number}.json"
        if result.exists() and not args.again:
            continue
        case = Case(number, args.seed, args.brushes, args.sheet, args.strokes)
        if args.half and case.inside != (args.half == "inside"):
            continue
        came = outcome(case, *kept(case, args.folder), args.height)
        result.write_text(json.dumps(came))
        print(number, came.get("refused") or f"lag within {100 * came['lag']:.2f} %", flush=True)
    found = [json.loads(path.read_text()) for path in args.folder.glob("*.json")]
    print(summary(sorted(found, key=lambda each: each["number"])))


if __name__ == "__main__":
    main()
