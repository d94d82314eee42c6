"""Corrections from a painted sheet improve the next sheets.

The machine paints each stroke at a wrong place.
"""

import json
import os
from dataclasses import replace

import numpy as np
import photograph
import pytest
from diagnostics import in_json, is_reported
from photograph import BLUE, INK, Camera
from sampling import sample
from scipy.spatial.transform import Rotation
from shapely import transform
from shapely.geometry import Polygon
from shapely.geometry.polygon import orient
from shapely.ops import unary_union

from brushsvg import _core
from brushsvg.cli import main
from brushsvg.comparison.corrections import Correction, apply_corrections
from brushsvg.comparison.job_page import job_page
from brushsvg.jobs.json_files import read_plan
from brushsvg.machine.cells.cell_file import find_cell, parse_cell, write_cell
from brushsvg.machine.realised.arc_chords import with_chords
from brushsvg.machine.realised.distortion import commanded_pass
from brushsvg.model.library import find_brush, save_brush

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
    """A machine that is out of square and displaces each stroke.

    The displacement of a stroke is constant. Every sheet has a new place.
    """

    def __init__(self, folder, seed):
        self.folder, self.rng = folder, np.random.default_rng(seed)
        (folder / "five.svg").write_text(DRAWING)
        self.axes = np.eye(2) + self.rng.normal(0, 0.002, (2, 2))
        self.own, self.sheets, self.brush = {}, 0, BRUSH
        self.grown, self.cut = (
            {},
            {},
        )  # for each stroke: how far its edges move outwards, and where its paint ends

    def plan(self, *flags):
        path = self.folder / "plan.json"
        words = ["convert", str(self.folder / "five.svg"), "-o", str(path), "--quiet", *map(str, flags)]
        assert main(words) == 0
        return read_plan(path)

    def rings(self, plan):
        marks = _core.simulate(plan, self.brush)
        _core.trace_outlines(marks, self.brush)
        return {mark.stroke: [np.array(ring) for ring in mark.outline_mm] for mark in marks.passes}

    def painted(self, plan):
        """Return the rings of each stroke on a straight sheet.

        The tool's own error displaces the strokes.
        """
        found = {}
        for name, rings in self.rings(plan).items():
            own = self.own.setdefault(name, self.rng.normal(0, 0.35, 2))
            shape = area(rings).buffer(self.grown.get(name, 0.0))
            if name in self.cut:  # its paint ends this many mm before its tip, along a direction
                way, mm = self.cut[name]
                far = np.array(shape.exterior.coords) @ way
                displaced = 90 * np.array([-way[1], way[0]])
                low = way * (far.min() + mm)
                shape = shape.intersection(
                    Polygon(
                        [
                            low - displaced,
                            low + displaced,
                            low + displaced + 200 * way,
                            low - displaced + 200 * way,
                        ]
                    )
                )
            found[name] = [np.array(ring) @ self.axes.T + own for ring in outlines(shape)]
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

    def reported(self, plan, cell):
        """Return the commands of a machine that corrects the errors of this cell."""
        passes = [commanded_pass(with_chords(each), find_cell(cell)) for each in plan.passes]
        return _core.Plan("", "", plan.sheet_mm, passes)

    def compared(self, photo, *flags):
        out = self.folder / f"{photo.stem}.json"
        words = ["compare", "--force", photo, self.folder / "five.svg", "-o", out, "--quiet", *flags]
        assert main([*map(str, words)]) == 0
        return out


def area(rings):
    rings = [Polygon(ring) for ring in rings]
    outer, holes = ([ring for ring in rings if ring.exterior.is_ccw == side] for side in (True, False))
    return unary_union(outer).difference(unary_union(holes))


def outlines(shape):
    """Return the rings of a shape: outer rings counter-clockwise, holes clockwise."""
    parts = [orient(part) for part in getattr(shape, "geoms", [shape])]
    return [np.array(ring.coords)[:-1] for part in parts for ring in (part.exterior, *part.interiors)]


def apart(painted, target):
    """Return 1 - intersection over union of each stroke, by shapely.

    The sheet is shifted and turned so that its strokes fit best.
    """
    ours, theirs = ([area(rings[name]) for name in target] for rings in (painted, target))
    a, b = (np.array([each.centroid.coords[0] for each in some]) for some in (ours, theirs))
    turn = Rotation.align_vectors(*(np.column_stack([c - c.mean(axis=0), 0 * c[:, 0]]) for c in (b, a)))[0]
    matrix, found = turn.as_matrix()[:2, :2], {}
    for name, one, other in zip(target, ours, theirs, strict=True):
        laid = transform(one, lambda points: (points - a.mean(axis=0)) @ matrix.T + b.mean(axis=0))
        found[name] = 1 - laid.intersection(other).area / laid.union(other).area
    return found


@sample("seed", [1, 2], keep=1)
def test_each_round_of_corrections_reduces_the_error(tmp_path, capsys, seed):
    studio = Studio(tmp_path, seed)
    plan = studio.plan()
    target = studio.rings(plan)
    before = apart(studio.painted(plan), target)
    first = studio.compared(studio.photographed(plan))
    plan_2 = studio.plan("--corrections", first)
    after_one = apart(studio.painted(plan_2), target)
    second = studio.compared(studio.photographed(plan_2), "--corrections", first)
    plan_3 = studio.plan("--corrections", second)
    after_two = apart(studio.painted(plan_3), target)
    means = [np.mean([*each.values()]) for each in (before, after_one, after_two)]
    assert means[1] < 0.4 * means[0] and means[2] < 0.2 * means[0], means
    assert all(after_two[name] < before[name] for name in before)


def test_corrections_of_another_job_are_refused(tmp_path, capsys):
    studio = Studio(tmp_path, 3)
    found = studio.compared(studio.photographed(studio.plan()))
    drawing = tmp_path / "five.svg"
    (tmp_path / "moved.svg").write_text(DRAWING.replace("M14 30", "M14.5 30"))
    (tmp_path / "other.svg").write_text(DRAWING.replace('id="bow"', 'id="bough"'))
    for name in ("moved.svg", "other.svg"):
        status, _, reported = in_json(
            capsys, "convert", tmp_path / name, "-o", tmp_path / "a.ngc", "--corrections", found
        )
        assert status == 1 and is_reported(reported, "corrections-of-another-job", "bow"), reported
    (tmp_path / "wider.svg").write_text(
        DRAWING.replace('M16 58 L70 54" stroke-width="3"', 'M16 58 L70 54" stroke-width="4"')
    )
    (tmp_path / "bent.svg").write_text(DRAWING.replace("C24 6 48 6 56 28", "C24 7 48 5 56 28"))
    for name, stroke, flags in (
        ("wider.svg", "line", ()),
        ("bent.svg", "bow", ()),
        ("five.svg", "line", ("--width", "4")),
        ("five.svg", "bow", ("--width", "3")),
        ("five.svg", "bow", ("--compensation", "constant")),
    ):
        words = ("convert", tmp_path / name, "-o", tmp_path / "a.ngc", "--corrections", found, *flags)
        status, _, reported = in_json(capsys, *words)
        assert status == 1 and is_reported(reported, "corrections-of-another-job", stroke), (
            name,
            flags,
            reported,
        )
    words = ("convert", drawing, "-o", tmp_path / "a.ngc", "--corrections", found)
    assert in_json(capsys, *words)[0] == 0
    status, _, reported = in_json(capsys, "check", tmp_path / "a.ngc", drawing)
    assert status == 1 and is_reported(reported, "corrections-missing"), reported
    assert in_json(capsys, "check", tmp_path / "a.ngc", drawing, "--corrections", found)[0] == 0
    text = (tmp_path / "a.ngc").read_text()
    (tmp_path / "b.ngc").write_text(text.replace("(corrections: 5", "(corrections: 4"))
    assert in_json(capsys, "check", tmp_path / "b.ngc", drawing, "--corrections", found)[0] == 1


def sheet_with_the_bar_elsewhere(folder):
    """Return the corrections of a first sheet, and a second photograph.

    The second sheet is painted with these corrections. On it, the machine paints the bar at another place.
    """
    studio = Studio(folder, 7)
    first = studio.compared(studio.photographed(studio.plan()))
    plan = studio.plan("--corrections", first)
    studio.own["bar"] = studio.own["bar"] + np.array([0.9, -1.2])
    return first, studio.photographed(plan)


@pytest.mark.thorough
def test_strokes_that_are_displaced_more_are_reported(tmp_path, capsys):
    """A stroke with a larger displacement is reported.

    The machine moves one stroke on the second sheet. No other stroke is reported.
    """
    first, photo = sheet_with_the_bar_elsewhere(tmp_path)
    out = tmp_path / "second.json"
    words = ("compare", "--force", photo, tmp_path / "five.svg", "--corrections", first, "-o", out)
    status, _, reported = in_json(capsys, *words)
    assert status == 0 and is_reported(reported, "stroke-farther", "bar"), reported
    before, now = (
        {row["stroke"]: row["aside_mm"] for row in json.loads(path.read_text())["strokes"]} for path in (first, out)
    )
    farther = {name for name in now if now[name] > before[name] + 0.1}
    assert {notice.where for _, notice in reported if notice.code == "stroke-farther"} == farther
    assert now["bar"] > 0.8 and len(farther) < 4, (before, now)


def test_corrections_are_read_once(tmp_path, capsys):
    """Corrections are read once, because they may come from a pipe.

    A row without a name gives no displacement of a stroke.
    """
    first, photo = sheet_with_the_bar_elsewhere(tmp_path)
    made = json.loads(first.read_text())
    made["strokes"].append({"stroke": ["bow"], "aside_mm": 1.0, "correction": None})
    out, into = os.pipe()
    os.write(into, json.dumps(made).encode())
    os.close(into)
    (tmp_path / "pipe.json").symlink_to(f"/dev/fd/{out}")
    words = ("compare", photo, tmp_path / "five.svg", "--corrections", tmp_path / "pipe.json")
    status, _, reported = in_json(capsys, *words)
    os.close(out)
    assert status == 0 and is_reported(reported, "stroke-farther", "bar"), reported


def test_a_corrected_plan_contains_its_corrections_and_the_original_plan(tmp_path, capsys):
    """A corrected plan holds its corrections and the original plan.

    A second correction moves its strokes no further. compare treats the plan like the drawing with these
    corrections.
    """
    studio = Studio(tmp_path, 6)
    found = studio.compared(studio.photographed(studio.plan()))
    photo = studio.photographed(studio.plan("--corrections", found))  # writes plan.json
    plan, again = tmp_path / "plan.json", tmp_path / "again.json"
    assert in_json(capsys, "convert", plan, "-o", again, "--corrections", found)[0] == 0
    for one, other in zip(read_plan(plan).passes, read_plan(again).passes, strict=True):
        np.testing.assert_allclose(one.poses_mm, other.poses_mm, atol=1e-5)
    seen = []
    for of in ((tmp_path / "five.svg", "--corrections", found), (plan,)):
        out = tmp_path / f"seen-{len(seen)}.json"
        assert in_json(capsys, "compare", photo, *of, "-o", out)[0] == 0
        seen.append([each.get("correction") for each in json.loads(out.read_text())["strokes"]])
    for one, other in zip(*seen, strict=True):
        np.testing.assert_allclose(one["shift_mm"], other["shift_mm"], atol=0.005)
        assert one["turn_deg"] == pytest.approx(other["turn_deg"], abs=0.05)
    status, _, reported = in_json(capsys, "compare", photo, plan, "--corrections", found)
    assert status == 1 and is_reported(reported, "corrections-twice"), reported
    assert in_json(capsys, "convert", plan, "-o", tmp_path / "a.ngc")[0] == 0
    # check does not know of which drawing the corrections are
    assert main(["check", str(tmp_path / "a.ngc"), "--corrections", str(found)]) == 2


@pytest.mark.parametrize(
    ("change", "code"),
    [
        (lambda extra: extra.update(corrections=5), "corrections-twice"),
        (lambda extra: extra.update(corrections=[]), "wrong-type"),
        (lambda extra: extra["corrections"].pop("plan"), "wrong-type"),
        (lambda extra: extra["corrections"]["plan"]["passes"].pop(), "wrong-type"),
        (lambda extra: extra["corrections"].pop("strokes"), "wrong-type"),
        (lambda extra: extra["corrections"]["strokes"][0]["correction"].pop("start_mm"), "wrong-type"),
        (lambda extra: extra["corrections"]["strokes"][0].update(stroke="nobody"), "corrections-of-another-job"),
    ],
)
def test_damaged_corrections_in_a_plan_are_refused(tmp_path, capsys, change, code):
    """Damaged corrections in a plan are refused.

    Old plans held only the number of corrected strokes, such as 5.
    """
    studio = Studio(tmp_path, 6)
    photo = studio.photographed(studio.plan())
    found = studio.compared(photo)
    plan = tmp_path / "plan.json"
    studio.plan("--corrections", found)
    extra = json.loads(plan.read_text())
    change(extra)
    plan.write_text(json.dumps(extra))
    for words in (
        ("compare", photo, plan),
        ("convert", plan, "-o", tmp_path / "a.ngc", "--corrections", found),
    ):
        status, _, reported = in_json(capsys, *words)
        assert status == 1 and is_reported(reported, code), reported


@pytest.mark.parametrize(
    ("change", "code"),
    [
        (lambda row: row.update(shift_mm=[3.0, 1.0]), "out-of-range"),
        (lambda row: row.update(turn_deg="2"), "not-a-number"),
        (lambda row: row.pop("middle_mm"), "wrong-type"),
        (lambda row: row.update(start_mm=[1.0]), "wrong-type"),
        (lambda row: row.update(way_mm=[[1.0, 1.0, 0.0]]), "wrong-type"),
        (lambda row: row.update(way_mm=[[1.0, "1", 0.0]] * 9), "not-a-number"),
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
    words = ("convert", tmp_path / "five.svg", "-o", tmp_path / "a.ngc", "--corrections", tmp_path / "c.json")
    status, _, reported = in_json(capsys, *words)
    assert status == 1 and is_reported(reported, code), reported
    assert not (tmp_path / "a.ngc").exists() and studio.sheets == 0


def longer_lag(folder):
    """Write round-6 with a lag 12 % longer, and return its file."""
    brush = _core.read_brush(_core.write_brush(BRUSH))
    law = brush.lag
    brush.lag = _core.Profile([1.12 * each for each in law.coefficients], source="a test")
    save_brush(brush, folder / "longer.json")
    return folder / "longer.json"


def test_a_new_brush_and_corrections_do_not_correct_an_error_twice(tmp_path, capsys):
    """A new brush and corrections in one round do not correct an error twice.

    The photograph is compared again with the new brush, by the painted plan.
    """
    studio = Studio(tmp_path, 8)
    studio.axes = np.eye(2)
    plan = studio.plan()
    (tmp_path / "plan.json").rename(tmp_path / "first.json")
    longer = longer_lag(tmp_path)
    studio.brush = find_brush(longer)
    photo = studio.photographed(plan)
    with_the_old = studio.compared(photo)
    drawing, out = tmp_path / "five.svg", tmp_path / "out.json"
    words = ("convert", drawing, "-o", out, "--brush", longer, "--corrections", with_the_old)
    status, _, reported = in_json(capsys, *words)
    assert status == 1 and is_reported(reported, "corrections-of-another-brush"), reported
    again = tmp_path / "again.json"
    words = ("compare", "--force", photo, tmp_path / "first.json", "--brush", longer, "-o", again)
    assert in_json(capsys, *words)[0] == 0
    plan_1 = studio.plan("--brush", longer)
    plan_2 = studio.plan("--brush", longer, "--corrections", again)
    target = studio.rings(plan_1)
    gaps = [np.mean([*apart(studio.painted(each), target).values()]) for each in (plan, plan_1, plan_2)]
    assert gaps[1] < 0.8 * gaps[0] and gaps[2] < 0.4 * gaps[1], gaps


@pytest.mark.parametrize(("planned", "status"), [("0" * 64, 0), (BRUSH.sha256, 1)])
def test_the_plan_for_another_brush_may_start_elsewhere(tmp_path, capsys, planned, status):
    studio = Studio(tmp_path, 9)
    x, y, _ = studio.plan().passes[0].poses_mm[0]
    row = {"start_mm": [x + 2.0, y], "middle_mm": [30.0, 40.0], "shift_mm": [0.1, 0.2], "turn_deg": 0.1}
    made = {"format": "brushsvg/comparison", "version": 1, "strokes": [{"stroke": "bow", "correction": row}]}
    made |= {"brush_sha256": BRUSH.sha256, "plan_brush_sha256": planned}
    (tmp_path / "c.json").write_text(json.dumps(made))
    words = ("convert", tmp_path / "five.svg", "-o", tmp_path / "a.ngc", "--corrections", tmp_path / "c.json")
    found, _, reported = in_json(capsys, *words)
    assert found == status and (status == 0 or is_reported(reported, "corrections-of-another-job")), reported


def test_two_strokes_determine_no_corrections(tmp_path, capsys):
    """Two strokes show no corrections.

    Their places cannot be separated from the place of the sheet.
    """
    few = DRAWING[: DRAWING.index('<path id="cross"')] + "</g></svg>"
    studio = Studio(tmp_path, 5)
    (tmp_path / "five.svg").write_text(few)
    found = studio.compared(studio.photographed(studio.plan()))
    assert [row["correction"] for row in json.loads(found.read_text())["strokes"]] == [None, None]
    words = ("convert", tmp_path / "five.svg", "-o", tmp_path / "a.ngc", "--corrections", found)
    status, _, reported = in_json(capsys, *words)
    assert status == 1 and is_reported(reported, "corrections-missing 2 3", "strokes"), reported
    rows = json.loads(found.read_text())
    rows["strokes"] += [{**rows["strokes"][0], "stroke": "third"}]
    found.write_text(json.dumps(rows))
    status, _, reported = in_json(capsys, *words)
    assert status == 1 and is_reported(reported, "corrections-missing 3", "strokes"), reported


@pytest.fixture(scope="module")
def stretched(tmp_path_factory):
    """Compare the sheet of a machine that goes 2 % too far.

    Return the studio, the target rings, the file of corrections and the corrected cell.
    """
    studio = Studio(tmp_path_factory.mktemp("stretched"), 12)
    studio.axes = np.diag([1.02, 0.985])
    plan = studio.plan()
    studio.own = {a_pass.stroke: studio.rng.normal(0, 0.12, 2) for a_pass in plan.passes}
    corrected_cell = studio.folder / "corrected.toml"
    found = studio.compared(studio.photographed(plan), "--corrected-cell", corrected_cell)
    return studio, studio.rings(plan), found, corrected_cell


def test_a_corrected_cell_and_corrections_work_together(stretched):
    """A corrected cell and corrections work in one round.

    With the corrected cell, strokes move only by the errors that the cell leaves. Each file alone is right
    for its cell.
    """
    studio, target, found, corrected_cell = stretched
    plan = studio.plan()
    with_both = studio.plan("--cell", corrected_cell, "--corrections", found)
    with_the_old = studio.plan("--corrections", found)
    gap, cell_alone, both, old_alone, twice = (
        float(np.mean([*apart(studio.painted(each), target).values()]))
        for each in (
            plan,
            studio.reported(plan, corrected_cell),
            studio.reported(with_both, corrected_cell),
            with_the_old,
            studio.reported(with_the_old, corrected_cell),
        )
    )
    assert cell_alone < 0.9 * gap and both < 0.75 * cell_alone and old_alone < 0.4 * gap, (
        gap,
        cell_alone,
        both,
    )
    assert both < 0.8 * twice, (both, twice)


def test_corrections_of_another_cell_are_refused(stretched, capsys):
    studio, _, found, corrected_cell = stretched
    other = studio.folder / "other.toml"
    cell = parse_cell(corrected_cell.read_text())
    other.write_text(write_cell(replace(cell, machine=replace(cell.machine, skew=0.003))))
    words = (
        "convert",
        studio.folder / "five.svg",
        "-o",
        studio.folder / "a.ngc",
        "--corrections",
        found,
        "--cell",
    )
    assert in_json(capsys, *words, corrected_cell)[0] == 0
    status, _, reported = in_json(capsys, *words, other)
    assert status == 1 and is_reported(reported, "corrections-of-another-cell"), reported


@pytest.mark.parametrize("by_mm", [-0.4, 0.3])
def test_a_width_is_corrected_where_it_is_wrong(tmp_path, by_mm):
    """A width is corrected where it is wrong.

    shapely moves each edge away from the middle. The middle line and the ends stay.
    """
    studio = Studio(tmp_path, 13)
    plan = studio.plan()
    before = studio.rings(plan)
    requested = tuple(
        Correction(a_pass.stroke, tuple(a_pass.poses_mm[0][:2]), (50.0, 30.0), (0.0, 0.0), 0.0, wider_mm=by_mm)
        for a_pass in plan.passes
    )
    after = studio.rings(apply_corrections(plan, requested, BRUSH))
    for name, rings in before.items():
        expected, moved = area(rings).buffer(by_mm), area(after[name])
        apart_mm2 = expected.symmetric_difference(moved).area
        assert apart_mm2 < 0.25 * expected.symmetric_difference(area(rings)).area, (name, apart_mm2)


def test_widths_are_corrected_from_a_photograph(tmp_path, capsys):
    """Widths are corrected from a photograph.

    The brush paints one stroke wider than another. A stroke that is wider than any depth paints is reported.
    """
    studio = Studio(tmp_path, 14)
    plan = studio.plan()
    rings = studio.rings(plan)
    studio.own = {name: np.zeros(2) for name in rings}
    studio.grown = {"bar": 0.4, "bow": -0.3, "line": 0.03}
    out = studio.compared(studio.photographed(plan))
    wider_mm = {row["stroke"]: row["correction"]["wider_mm"] for row in json.loads(out.read_text())["strokes"]}
    assert -0.34 < wider_mm["bar"] < -0.28 and 0.18 < wider_mm["bow"] < 0.26, wider_mm
    assert wider_mm["line"] == wider_mm["cross"] == wider_mm["loop"] == 0, wider_mm
    again = studio.rings(studio.plan("--corrections", out))
    sizes = {name: area(again[name]).area - area(rings[name]).area for name in rings}
    assert sizes["bar"] < -10 and sizes["bow"] > 5 and abs(sizes["loop"]) < 1, sizes


def test_a_width_that_no_depth_paints_is_refused(tmp_path, capsys):
    studio = Studio(tmp_path, 15)
    brush = measured_between(tmp_path, 3.0, 8.0)
    plan = studio.plan("--brush", brush)
    row = {"middle_mm": [1.0, 1.0], "shift_mm": [0.0, 0.0], "turn_deg": 0.0, "wider_mm": -0.4}
    row["start_mm"] = list(plan.passes[1].poses_mm[0][:2])
    made = {"format": "brushsvg/comparison", "version": 1}
    made["strokes"] = [{"stroke": plan.passes[1].stroke, "correction": row}]
    (tmp_path / "c.json").write_text(json.dumps(made))
    words = ("convert", tmp_path / "five.svg", "-o", tmp_path / "a.ngc", "--corrections", tmp_path / "c.json")
    assert in_json(capsys, *words)[0] == 0
    status, _, reported = in_json(capsys, *words, "--brush", brush)
    assert status == 1 and is_reported(reported, "width-correction-refused", "line"), reported
    studio.own = {each.stroke: np.zeros(2) for each in plan.passes}
    studio.grown = {"line": 0.5}
    photo = studio.photographed(studio.plan("--brush", brush))
    words = (
        "compare",
        "--force",
        photo,
        tmp_path / "five.svg",
        "--brush",
        brush,
        "-o",
        tmp_path / "seen.json",
    )
    status, _, reported = in_json(capsys, *words)
    assert status == 0 and is_reported(reported, "width-correction-refused", "line"), reported
    rows = {row["stroke"]: row for row in json.loads((tmp_path / "seen.json").read_text())["strokes"]}
    assert rows["line"]["correction"]["wider_mm"] == 0 and rows["line"]["wider_mm"] > 0.4


def measured_between(folder, least_mm, deepest_mm):
    """Write round-6, known only at these depths, and return its file."""
    brush = _core.read_brush(_core.write_brush(BRUSH))
    law = brush.half_width
    brush.half_width = _core.Profile(
        law.coefficients, floor=law.floor, calibrated_mm=(least_mm, deepest_mm), source="a test"
    )
    save_brush(brush, folder / "measured.json")
    return folder / "measured.json"


def test_start_and_end_errors_of_strokes_are_reported(tmp_path, capsys):
    """The places where strokes begin and end are reported.

    Strokes begin 1.5 mm late, end 1 mm late, or end 2 mm early at the place of the sheet.
    """
    studio = Studio(tmp_path, 16)
    plan = studio.plan()
    rings = studio.rings(plan)
    studio.own = {name: np.zeros(2) for name in rings}
    studio.axes = np.eye(2)
    along = {"line": (16.0, 58.0, 70.0, 54.0), "bar": (66.0, 34.0, 98.0, 30.0)}  # in the drawing, y down
    studio.cut = {}
    for name, mm in (("line", 1.5), ("bar", 2.0)):
        x0, y0, x1, y1 = along[name]
        way = np.array([x1 - x0, y0 - y1]) / np.hypot(x1 - x0, y1 - y0)
        studio.cut[name] = (way, mm) if name == "line" else (-way, mm)
    out = studio.compared(studio.photographed(plan))
    rows = {row["stroke"]: row for row in json.loads(out.read_text())["strokes"]}
    studio.cut = {}
    as_it_was = studio.compared(studio.photographed(plan))
    before = {row["stroke"]: row for row in json.loads(as_it_was.read_text())["strokes"]}

    def later(name, key):
        return rows[name][key] - before[name][key]

    assert all(abs(before[name][key]) < 0.6 for name in along for key in ("began_mm", "ended_mm")), before
    assert later("line", "began_mm") == pytest.approx(1.5, abs=0.25), rows
    assert later("bar", "ended_mm") == pytest.approx(-2.0, abs=0.25), rows
    assert abs(later("line", "ended_mm")) < 0.25 and abs(later("bar", "began_mm")) < 0.25


@pytest.mark.thorough
def test_a_stroke_that_ran_dry_does_not_move_others(tmp_path, capsys):
    """A stroke that runs out of paint moves no other stroke.

    If half of a stroke has no paint, the sheet's place comes from the other strokes.
    """
    studio = Studio(tmp_path, 17)
    plan = studio.plan()
    studio.own = {each.stroke: np.zeros(2) for each in plan.passes}
    studio.axes = np.eye(2)
    studio.cut = {"bow": (np.array([-1.0, 0.0]), 12.0)}
    out = studio.compared(studio.photographed(plan))
    rows = {row["stroke"]: row for row in json.loads(out.read_text())["strokes"]}
    assert rows["bow"]["missing"] > 0.15 and rows["bow"]["aside_mm"] > 0.1, rows["bow"]
    assert max(row["aside_mm"] for name, row in rows.items() if name != "bow") < 0.03, rows
