"""The repeatability of a studio is recovered from rendered sheets."""

import json

import cv2
import numpy as np
import photograph
import pytest
from diagnostics import in_json, is_reported
from photograph import BLUE, INK, Camera

from brushsvg import _core
from brushsvg.cli import main
from brushsvg.comparison.job_page import job_page
from brushsvg.jobs.preparation.preparation import prepare

pytestmark = pytest.mark.long  # sheets are rendered and read
HEAD = '<svg xmlns="http://www.w3.org/2000/svg" width="150mm" height="100mm" viewBox="0 0 150 100">'
LINES = "".join(
    f'<path id="s{k}" fill="none" stroke="#000" stroke-width="3" d="M{x} {y} l24 4 l0 10"/>'
    for k, (x, y) in enumerate([(20, 20), (100, 20), (60, 20), (100, 50), (20, 50), (60, 50), (20, 75), (60, 75)])
)
CAMERA = Camera(size_px=(1400, 950), fill=0.95)
TO_THE_RIGHT = ("s1", "s3", "s5", "s7")  # effect of the end of the previous stroke
PLAY = 0.4


class Sheets:
    def __init__(self, folder):
        self.folder = folder
        (folder / "eight.svg").write_text(f"{HEAD}<title>eight</title>{LINES}</svg>")
        self.work = prepare(folder / "eight.svg")
        marks = _core.simulate(self.work.plan, self.work.brush)
        _core.trace_outlines(marks, self.work.brush)
        self.rings = {one.stroke: [np.array(ring) for ring in one.outline_mm] for one in marks.passes}

    def photographed(self, name, displaced, shift=(0.0, 0.0)):
        page = job_page(self.work.plan, "eight")
        sheet = photograph.page(page.printed)
        for tick in page.ticks:
            sheet.paint([tick], INK)
        for stroke, rings in self.rings.items():
            sheet.paint([ring + displaced[stroke] + shift + page.frame_mm for ring in rings], BLUE)
        (self.folder / name).write_bytes(photograph.photograph(sheet, CAMERA))
        return str(self.folder / name)

    def words(self, photos, *flags):
        return ["compare", *photos, str(self.folder / "eight.svg"), "--sheets", "--json", "--quiet", *flags]


@pytest.fixture(scope="module")
def sheets(tmp_path_factory):
    return Sheets(tmp_path_factory.mktemp("sheets"))


@pytest.fixture(scope="module")
def painted(sheets):
    """Return photographs of three sheets, and the displacement of each stroke on its sheet."""
    rng = np.random.default_rng(4)
    always = {name: np.array([PLAY / 2 if name in TO_THE_RIGHT else -PLAY / 2, 0.0]) for name in sheets.rings}
    displaced = [{name: always[name] + rng.normal(0, 0.15, 2) for name in sheets.rings} for _ in range(3)]
    places = [(0.8, -0.5), (0.0, 0.0), (-0.6, 0.9)]
    return [
        sheets.photographed(f"{k}.jpg", *each) for k, each in enumerate(zip(displaced, places, strict=True))
    ], displaced


def test_spread_and_hysteresis_are_recovered(sheets, painted, capsys):
    photos, displaced = painted
    out = sheets.folder / "spread.json"
    picture = sheets.folder / "spread.png"
    assert main(sheets.words(photos, "-o", str(out), "--picture", str(picture))) == 0
    shown = cv2.imread(str(picture))
    assert shown.shape[0] > 1000 and len(np.unique(shown[: len(shown) // 2].reshape(-1, 3), axis=0)) > 100
    found = json.loads(out.read_text())
    at = np.array([[each[name] for name in sheets.rings] for each in displaced])
    at -= at.mean(axis=1, keepdims=True)  # this is the place of the sheet
    off = at - at.mean(axis=0)
    truth = np.sqrt(np.square(off).sum() / (2 * 7 * 2 - 2))  # a turn of each sheet in addition
    assert found["displacement_mm"] == pytest.approx(truth, rel=0.12)
    assert found["displacement_95_mm"][0] < 0.15 < found["displacement_95_mm"][1]
    value, half = found["hysteresis_mm"]["x"]
    assert abs(value - PLAY) < half < 0.4 * PLAY
    rows = {row["stroke"]: row for row in found["strokes"]}
    for k, name in enumerate(sheets.rings):
        assert rows[name]["seen"] == 3
        assert rows[name]["farthest_mm"] == pytest.approx(np.hypot(*off[:, k].T).max(), abs=0.12)
        assert rows[name]["wider_mm"] < 0.02
    assert sum(each["count"] for each in found["histogram"]) == 24


def test_copies_on_one_sheet_are_sufficient(sheets, painted, capsys):
    photos, displaced = painted
    assert main(sheets.words(photos[:1])) == 0
    found = json.loads(capsys.readouterr().out)
    at = np.array([displaced[0][name] for name in sheets.rings])
    (row,) = found["strokes"]
    assert row["seen"] == 8 and row["spread_mm"] == pytest.approx(
        np.sqrt(np.square(at - at.mean(axis=0)).sum() / 14), rel=0.2
    )


def test_the_next_calibration_uses_the_spread(sheets, painted, tmp_path, capsys):
    photos, _ = painted
    out = sheets.folder / "again.json"
    assert main(sheets.words(photos, "-o", str(out))) == 0
    plan = str(tmp_path / "eight.json")
    assert main(["convert", str(sheets.folder / "eight.svg"), "-o", plan, "--quiet"]) == 0
    laws = []
    for k, flags in enumerate(((), ("--spread", str(out)))):
        made = str(tmp_path / f"brush-{k}.json")
        words = [
            "calibrate",
            "--force",
            photos[0],
            "--plan",
            plan,
            "--prior",
            "round-6",
            "-o",
            made,
            "--quiet",
            *flags,
        ]
        assert main(words) == 0, capsys.readouterr().err
        laws.append(json.loads((tmp_path / f"brush-{k}.json").read_text())["lag"]["coefficients"])
    assert laws[1] != laws[0], "the fit used it"
    damaged = json.loads(out.read_text()) | {"displacement_mm": -1}
    (tmp_path / "bad.json").write_text(json.dumps(damaged))
    words = [
        "calibrate",
        "--force",
        photos[0],
        "--plan",
        plan,
        "--prior",
        "round-6",
        "-o",
        str(tmp_path / "no.json"),
    ]
    status, _, reported = in_json(capsys, *words, "--spread", tmp_path / "bad.json")
    assert status == 1 and is_reported(reported, "out-of-range"), reported


def test_strokes_that_are_painted_once_show_no_spread(tmp_path, capsys):
    drawing = f"{HEAD}" + "".join(
        f'<path id="t{k}" fill="none" stroke="#000" stroke-width="3" d="M{20 + 30 * k} 30 l{18 + k} 4 l0 {9 + k}"/>'
        for k in range(4)
    )
    (tmp_path / "four.svg").write_text(drawing + "</svg>")
    words = ["simulate-photo", str(tmp_path / "four.svg"), "-o", str(tmp_path / "a.jpg"), "--quiet"]
    assert main(words) == 0
    status, _, reported = in_json(capsys, "compare", tmp_path / "a.jpg", tmp_path / "four.svg", "--sheets")
    assert status == 1 and is_reported(reported, "too-few-repeats"), reported
    twice = (tmp_path / "a.jpg", tmp_path / "a.png", tmp_path / "four.svg")
    cv2.imwrite(str(twice[1]), cv2.imread(str(twice[0])))  # other bytes, the same pixels
    status, _, reported = in_json(capsys, "compare", *twice, "--sheets")
    assert status == 1 and is_reported(reported, "too-few-repeats"), reported
    assert main(["compare", str(tmp_path / "a.jpg"), str(tmp_path / "four.svg"), "--sheets", "--at-least", "0.5"]) == 2
