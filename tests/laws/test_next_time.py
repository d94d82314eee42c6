"""Corrections from a painted sheet: on a machine that leads each stroke elsewhere, the next sheets come nearer."""

import json

import numpy as np
import photograph
import pytest
from diagnostics import in_json, is_told
from photograph import BLUE, INK, Camera
from scipy.spatial.transform import Rotation
from shapely import transform
from shapely.geometry import Polygon
from shapely.ops import unary_union

from brushsvg import _core
from brushsvg.brush.library import save_brush
from brushsvg.cli import main
from brushsvg.painted.job_page import job_page
from brushsvg.pipeline.json_files import read_plan
from brushsvg.pipeline.preparation import find_brush

DRAWING = """<svg xmlns="http://www.w3.org/2000/svg" width="110mm" height="70mm" viewBox="0 0 110 70">
<title>five</title><g fill="none" stroke="#000" stroke-linecap="round">
<path id="bow" d="M14 30 C24 6 48 6 56 28" stroke-width="4"/>
<path id="line" d="M16 58 L70 54" stroke-width="3"/>
<path id="cross" d="M78 16 L82 50" stroke-width="4"/>
<path id="bar" d="M66 34 L98 30" stroke-width="3"/>
<path id="loop" d="M30 34 a8 8 0 1 1 0.01 0" stroke-width="3"/></g></svg>"""
CAMERA = Camera(size_px=(1500, 1050), fill=0.95)
BRUSH = find_brush("round-6")


class Studio:
    """A machine that is out of square and leads each stroke elsewhere, always alike; every sheet is laid anew."""

    def __init__(self, folder, seed):
        self.folder, self.rng = folder, np.random.default_rng(seed)
        (folder / "five.svg").write_text(DRAWING)
        self.axes = np.eye(2) + self.rng.normal(0, 0.002, (2, 2))
        self.own, self.sheets, self.brush = {}, 0, BRUSH

    def plan(self, *flags):
        path = self.folder / "plan.json"
        words = ["convert", str(self.folder / "five.svg"), str(path), "--quiet", *map(str, flags)]
        assert main(words) == 0
        return read_plan(path)

    def rings(self, plan):
        marks = _core.simulate(plan, self.brush)
        _core.trace_outlines(marks, self.brush)
        return {mark.stroke: [np.array(ring) for ring in mark.outline_mm] for mark in marks.passes}

    def painted(self, plan):
        """The rings of each stroke on the sheet that was laid straight: where the tool went by its own error."""
        found = {}
        for name, rings in self.rings(plan).items():
            own = self.own.setdefault(name, self.rng.normal(0, 0.35, 2))
            found[name] = [ring @ self.axes.T + own for ring in rings]
        return found

    def photographed(self, plan):
        turn, shift = self.rng.normal(0, 0.004), self.rng.normal(0, 0.5, 2)
        c, s = np.cos(turn), np.sin(turn)
        page = job_page(plan, "five")
        sheet = photograph.page(page.printed)
        for tick in page.ticks:
            sheet.paint([tick], INK)
        for rings in self.painted(plan).values():
            laid = [ring @ np.array([[c, s], [-s, c]]) + shift for ring in rings]
            sheet.paint([ring + page.frame_mm for ring in laid], BLUE)
        self.sheets += 1
        path = self.folder / f"sheet-{self.sheets}.jpg"
        path.write_bytes(photograph.photograph(sheet, CAMERA))
        return path

    def compared(self, photo, *flags):
        out = self.folder / f"{photo.stem}.json"
        words = ["compare", photo, self.folder / "five.svg", "-o", out, "--quiet", *flags]
        assert main([*map(str, words)]) == 0
        return out


def area(rings):
    rings = [Polygon(ring) for ring in rings]
    outer, holes = ([ring for ring in rings if ring.exterior.is_ccw == side] for side in (True, False))
    return unary_union(outer).difference(unary_union(holes))


def apart(painted, wanted):
    """Of each stroke 1 - intersection over union, by shapely; the sheet shifted and turned as its strokes lie best."""
    ours, theirs = ([area(rings[name]) for name in wanted] for rings in (painted, wanted))
    a, b = (np.array([each.centroid.coords[0] for each in some]) for some in (ours, theirs))
    turn = Rotation.align_vectors(*(np.column_stack([c - c.mean(axis=0), 0 * c[:, 0]]) for c in (b, a)))[0]
    matrix, found = turn.as_matrix()[:2, :2], {}
    for name, one, other in zip(wanted, ours, theirs, strict=True):
        laid = transform(one, lambda points: (points - a.mean(axis=0)) @ matrix.T + b.mean(axis=0))
        found[name] = 1 - laid.intersection(other).area / laid.union(other).area
    return found


@pytest.mark.parametrize("seed", [1, 2])
def test_each_round_comes_nearer(tmp_path, capsys, seed):
    studio = Studio(tmp_path, seed)
    plan = studio.plan()
    wanted = studio.rings(plan)
    before = apart(studio.painted(plan), wanted)
    first = studio.compared(studio.photographed(plan))
    plan_2 = studio.plan("--corrections", first)
    after_one = apart(studio.painted(plan_2), wanted)
    second = studio.compared(studio.photographed(plan_2), "--corrections", first)
    plan_3 = studio.plan("--corrections", second)
    after_two = apart(studio.painted(plan_3), wanted)
    means = [np.mean([*each.values()]) for each in (before, after_one, after_two)]
    assert means[1] < 0.4 * means[0] and means[2] < 0.2 * means[0], means
    assert all(after_two[name] < before[name] for name in before)


def test_corrections_are_those_of_this_job(tmp_path, capsys):
    studio = Studio(tmp_path, 3)
    found = studio.compared(studio.photographed(studio.plan()))
    drawing = tmp_path / "five.svg"
    (tmp_path / "moved.svg").write_text(DRAWING.replace("M14 30", "M14.5 30"))
    (tmp_path / "other.svg").write_text(DRAWING.replace('id="bow"', 'id="bough"'))
    for name in ("moved.svg", "other.svg"):
        status, _, told = in_json(
            capsys, "convert", tmp_path / name, tmp_path / "a.ngc", "--corrections", found
        )
        assert status == 1 and is_told(told, "corrections-of-another-job", "bow"), told
    words = ("convert", drawing, tmp_path / "a.ngc", "--corrections", found)
    assert in_json(capsys, *words)[0] == 0
    status, _, told = in_json(capsys, "check", tmp_path / "a.ngc", drawing)
    assert status == 1 and is_told(told, "corrections-missing"), told
    assert in_json(capsys, "check", tmp_path / "a.ngc", drawing, "--corrections", found)[0] == 0
    text = (tmp_path / "a.ngc").read_text()
    (tmp_path / "b.ngc").write_text(text.replace("(corrections: 5", "(corrections: 4"))
    assert in_json(capsys, "check", tmp_path / "b.ngc", drawing, "--corrections", found)[0] == 1


def test_strokes_that_lie_farther_aside_are_told(tmp_path, capsys):
    """A stroke that the machine leads elsewhere on the second sheet, and no other."""
    studio = Studio(tmp_path, 7)
    first = studio.compared(studio.photographed(studio.plan()))
    plan = studio.plan("--corrections", first)
    studio.own["bar"] = studio.own["bar"] + np.array([0.9, -1.2])
    photo = studio.photographed(plan)
    out = tmp_path / "second.json"
    words = ("compare", photo, tmp_path / "five.svg", "--corrections", first, "-o", out)
    status, _, told = in_json(capsys, *words)
    assert status == 0 and is_told(told, "stroke-farther", "bar"), told
    before, now = (
        {row["stroke"]: row["aside_mm"] for row in json.loads(path.read_text())["strokes"]}
        for path in (first, out)
    )
    farther = {name for name in now if now[name] > before[name] + 0.1}
    assert {notice.where for _, notice in told if notice.code == "stroke-farther"} == farther
    assert now["bar"] > 0.8 and len(farther) < 4, (before, now)


def test_corrections_are_taken_back_once(tmp_path, capsys):
    """A corrected plan does not say where its strokes should be painted: again, they would go twice as far."""
    studio = Studio(tmp_path, 6)
    found = studio.compared(studio.photographed(studio.plan()))
    photo = studio.photographed(studio.plan("--corrections", found))  # leaves plan.json
    plan = tmp_path / "plan.json"
    for words in (("convert", plan, tmp_path / "a.ngc", "--corrections", found), ("compare", photo, plan)):
        status, _, told = in_json(capsys, *words)
        assert status == 1 and is_told(told, "corrections-twice"), told
    assert in_json(capsys, "convert", plan, tmp_path / "a.ngc")[0] == 0
    assert main(["check", str(tmp_path / "a.ngc"), "--corrections", str(found)]) == 2  # of which drawing?


@pytest.mark.parametrize(
    ("change", "code"),
    [
        (lambda row: row.update(shift_mm=[3.0, 1.0]), "out-of-range"),
        (lambda row: row.update(turn_deg="2"), "not-a-number"),
        (lambda row: row.pop("middle_mm"), "wrong-type"),
        (lambda row: row.update(start_mm=[1.0]), "wrong-type"),
        (lambda row: None, "stroke-twice"),
    ],
)
def test_damaged_corrections_are_refused(tmp_path, capsys, change, code):
    studio = Studio(tmp_path, 4)
    row = {"start_mm": [0.0, 0.0], "middle_mm": [1.0, 1.0], "shift_mm": [0.1, 0.2], "turn_deg": 0.1}
    change(row)
    rows = [{"stroke": "bow", "correction": row}] * (2 if code == "stroke-twice" else 1)
    made = {"format": "brushsvg/comparison", "version": 1, "strokes": rows}
    (tmp_path / "c.json").write_text(json.dumps(made))
    words = ("convert", tmp_path / "five.svg", tmp_path / "a.ngc", "--corrections", tmp_path / "c.json")
    status, _, told = in_json(capsys, *words)
    assert status == 1 and is_told(told, code), told
    assert not (tmp_path / "a.ngc").exists() and studio.sheets == 0


def longer_lag(folder):
    """round-6 with a lag 12 % longer, as a file."""
    brush = _core.read_brush(_core.write_brush(BRUSH))
    law = brush.lag
    brush.lag = _core.Profile([1.12 * each for each in law.coefficients], source="a test")
    save_brush(brush, folder / "longer.json")
    return folder / "longer.json"


def test_a_new_brush_and_corrections_in_one_round(tmp_path, capsys):
    """What the brush explains is not corrected as well: the photograph is compared again with it, by the plan that was
    painted."""
    studio = Studio(tmp_path, 8)
    studio.axes = np.eye(2)
    plan = studio.plan()
    (tmp_path / "plan.json").rename(tmp_path / "first.json")
    longer = longer_lag(tmp_path)
    studio.brush = find_brush(longer)
    photo = studio.photographed(plan)
    beside_the_old = studio.compared(photo)
    drawing, out = tmp_path / "five.svg", tmp_path / "out.json"
    words = ("convert", drawing, out, "--brush", longer, "--corrections", beside_the_old)
    status, _, told = in_json(capsys, *words)
    assert status == 1 and is_told(told, "corrections-of-another-brush"), told
    again = tmp_path / "again.json"
    words = ("compare", photo, tmp_path / "first.json", "--brush", longer, "-o", again)
    assert in_json(capsys, *words)[0] == 0
    plan_1 = studio.plan("--brush", longer)
    plan_2 = studio.plan("--brush", longer, "--corrections", again)
    wanted = studio.rings(plan_1)
    gaps = [np.mean([*apart(studio.painted(each), wanted).values()]) for each in (plan, plan_1, plan_2)]
    assert gaps[1] < 0.8 * gaps[0] and gaps[2] < 0.4 * gaps[1], gaps


@pytest.mark.parametrize(("planned", "status"), [("0" * 64, 0), (BRUSH.sha256, 1)])
def test_the_plan_for_another_brush_may_begin_elsewhere(tmp_path, capsys, planned, status):
    studio = Studio(tmp_path, 9)
    x, y, _ = studio.plan().passes[0].poses_mm[0]
    row = {"start_mm": [x + 2.0, y], "middle_mm": [30.0, 40.0], "shift_mm": [0.1, 0.2], "turn_deg": 0.1}
    made = {"format": "brushsvg/comparison", "version": 1, "strokes": [{"stroke": "bow", "correction": row}]}
    made |= {"brush_sha256": BRUSH.sha256, "plan_brush_sha256": planned}
    (tmp_path / "c.json").write_text(json.dumps(made))
    words = ("convert", tmp_path / "five.svg", tmp_path / "a.ngc", "--corrections", tmp_path / "c.json")
    found, _, told = in_json(capsys, *words)
    assert found == status and (status == 0 or is_told(told, "corrections-of-another-job")), told


def test_two_strokes_tell_no_corrections(tmp_path, capsys):
    """Their places are not told from the sheet's."""
    few = DRAWING[: DRAWING.index('<path id="cross"')] + "</g></svg>"
    studio = Studio(tmp_path, 5)
    (tmp_path / "five.svg").write_text(few)
    found = studio.compared(studio.photographed(studio.plan()))
    assert [row["correction"] for row in json.loads(found.read_text())["strokes"]] == [None, None]
    words = ("convert", tmp_path / "five.svg", tmp_path / "a.ngc", "--corrections", found)
    status, _, told = in_json(capsys, *words)
    assert status == 1 and is_told(told, "corrections-missing"), told
