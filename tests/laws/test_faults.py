"""Faults of a studio are named and measured on sheets that another simulator paints."""

import json

import numpy as np
import pytest
import studio
from diagnostics import in_json
from sampling import sample

core = pytest.importorskip("brushsvg._core")
if not hasattr(core, "fit_marks"):
    pytest.skip("built without Ceres", allow_module_level=True)

from brushsvg.cli import main  # noqa: E402
from brushsvg.jobs.json_files import read_plan  # noqa: E402
from brushsvg.machine.cells.cell_file import cell_names, read_cell  # noqa: E402
from brushsvg.model.library import save_brush  # noqa: E402

pytestmark = pytest.mark.long

NAMES = ("bow", "line", "wave", "hook", "loop", "slash", "stem", "knee")


@pytest.fixture(scope="module")
def job(tmp_path_factory):
    folder = tmp_path_factory.mktemp("studio")
    save_brush(studio.known_brush(), folder / "mine.json")
    (folder / "word.svg").write_text(studio.WORD)
    words = [
        "convert",
        folder / "word.svg",
        "-o",
        folder / "word.json",
        "--brush",
        folder / "mine.json",
        "--quiet",
    ]
    assert main([*map(str, words)]) == 0
    return folder, read_plan(folder / "word.json")


def compared(job, fault_values, seed=1, *flags):
    folder, plan = job
    (folder / "photo.jpg").write_bytes(studio.photographed(plan, studio.painted(plan, fault_values, seed), "word"))
    words = ["compare", "--force", "photo.jpg", "word.svg", "--brush", "mine.json", "-o", "seen.json"]
    words = [str(folder / word) if "." in word else word for word in words]
    assert main([*words, "--quiet", *flags]) == 0
    return json.loads((folder / "seen.json").read_text())["faults"]


ONE = {
    "place of the sheet": (
        studio.Faults(shift=(0.8, -0.6), turn=0.4),
        {"shift in x": 0.8, "shift in y": -0.6, "turn": 0.4},
    ),
    "machine": (
        studio.Faults(scale=(0.01, -0.008), lean=(0.1, -0.08), backlash=(0.5, 0.3)),
        {"scale in x": 0.01, "scale in y": -0.008, "lean in x": 0.1, "lean in y": -0.08}
        | {"backlash in x": 0.5, "backlash in y": 0.3},
    ),
    "height and tilt of the paper": (
        studio.Faults(height=0.3, tilt=(0.008, -0.01)),
        {"tilt in x": 0.008, "tilt in y": -0.01},
    ),
    "brush": (studio.Faults(lag=1.15, half=0.88), {"lag": 0.15, "width": -0.12}),
    "each stroke's own place": (
        studio.Faults(own={name: np.array([0.6 * (-1) ** k, 0.5 * (-1) ** (k // 2)]) for k, name in enumerate(NAMES)}),
        {},
    ),
    "missing paint": (studio.Faults(lasts_mm=38.0), {}),
}


@sample("cause", ONE, keep=2)
def test_each_fault_is_named_and_measured(job, cause, capsys):
    fault_values, numbers = ONE[cause]
    folder, _ = job
    found = compared(job, fault_values, 1, "--corrected-cell", str(folder / "corrected.toml"))
    assert found["mend_first"] == cause, found["causes"]
    rows = {row["name"]: row for row in found["numbers"]}
    for name, truth in numbers.items():
        row = rows[name]
        assert abs(row["value"] - truth) < max(2 * row["half_95"], 0.12 * abs(truth)), (name, truth, row)
    if cause == "machine":
        seen = json.loads((folder / "seen.json").read_text())
        with_old, with_corrected = (
            np.hypot(*np.transpose([row["correction"]["shift_mm"] for row in rows]))
            for rows in (seen["strokes"], seen["beside_machine"]["strokes"])
        )
        assert with_corrected.mean() < 0.6 * with_old.mean(), "the cell undoes their displacement"
        corrected = read_cell(folder / "corrected.toml")
        assert corrected.name not in cell_names(), "a program that names it is not checked with the cell as it was"
        assert corrected.machine.scale == pytest.approx((1.01, 0.992), abs=0.002)
    gains = {row["cause"]: row["gain"] for row in found["causes"]}
    _, plan = job
    target = studio.painted(plan, studio.Faults())
    gap = 1 - studio.overlap(studio.painted(plan, fault_values, 1), target)
    assert gains[cause] == pytest.approx(gap, abs=0.25 * gap + 0.01)
    assert all(gain < 0.4 * gap + 0.01 for other, gain in gains.items() if other != cause), gains


@sample("number", [104, 105], keep=1)
def test_all_faults_together_are_within_their_intervals(job, number, capsys):
    """Brush, paper and machine have faults; paper height, lag and width look similar."""
    _, plan = job
    rng = np.random.default_rng([24, number])
    fault_values = studio.random_faults(rng, NAMES, plan.sheet_mm)
    found = compared(job, fault_values, number)
    truth = {"lag": fault_values.lag - 1, "width": fault_values.half - 1}
    for name in ("scale", "backlash", "tilt"):
        truth |= {f"{name} in {axis}": value for axis, value in zip("xy", getattr(fault_values, name), strict=True)}
    rows = {row["name"]: row for row in found["numbers"]}
    off = {name: (rows[name]["value"] - value) / rows[name]["half_95"] for name, value in truth.items()}
    assert all(abs(each) < 1.2 for each in off.values()), off
    assert rows["lag"]["half_95"] < 0.06 and rows["width"]["half_95"] < 0.06


def test_a_sheet_without_faults_has_no_certain_cause(job, capsys):
    found = compared(job, studio.Faults())
    assert found["mend_first"] is None, found
    rows = {row["name"]: row for row in found["numbers"]}
    assert abs(rows["scale in x"]["value"]) < 0.001 and abs(rows["lag"]["value"]) < 0.02
    assert found["overlap"] > 0.96


def test_few_strokes_give_no_cause(job, capsys, tmp_path):
    few = studio.WORD[: studio.WORD.index('<path id="wave"')] + "</g></svg>"
    (tmp_path / "few.svg").write_text(few)
    words = ["simulate-photo", str(tmp_path / "few.svg"), "-o", str(tmp_path / "few.jpg"), "--quiet"]
    assert main(words) == 0
    capsys.readouterr()  # drop the printed studio
    status, out, _ = in_json(capsys, "compare", tmp_path / "few.jpg", tmp_path / "few.svg", "--json")
    assert status == 0 and json.loads(out)["faults"] is None
