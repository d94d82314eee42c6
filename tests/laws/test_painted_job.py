"""The marks of a painted job are found in a rendered photograph.

Other pictures are refused.
"""

import copy
import json
import pickle

import cv2
import numpy as np
import photograph
import pytest
from diagnostics import in_json, is_reported
from photograph import BLUE, INK, Camera
from sampling import sample
from shapely import affinity
from shapely.geometry import Polygon
from shapely.ops import unary_union

import brushsvg
from brushsvg import _core
from brushsvg.calibration.chart.layout import chart
from brushsvg.cli import main
from brushsvg.comparison.job_page import job_page
from brushsvg.errors import Error
from brushsvg.jobs.preparation.preparation import prepare
from brushsvg.jobs.prepared_drawing import order_nearest_first

DRAWING = """<svg xmlns="http://www.w3.org/2000/svg" width="110mm" height="70mm" viewBox="0 0 110 70">
<title>four</title><g fill="none" stroke="#000" stroke-linecap="round">
<path id="bow" d="M14 30 C24 6 48 6 56 28" stroke-width="4"/>
<path id="line" d="M16 58 L70 54" stroke-width="3"/>
<path id="cross" d="M78 16 L82 50" stroke-width="4"/>
<path id="bar" d="M66 34 L98 30" stroke-width="3"/></g></svg>"""
CAMERA = Camera(size_px=(1500, 1050), fill=0.95)
SHIFT_MM, TURN_DEG, MIDDLE = np.array([0.7, -0.9]), 0.5, np.array([55.0, 35.0])


def turned(points):
    c, s = np.cos(np.radians(TURN_DEG)), np.sin(np.radians(TURN_DEG))
    return (points - MIDDLE) @ np.array([[c, s], [-s, c]]) + MIDDLE + SHIFT_MM


@pytest.fixture(scope="module")
def job(tmp_path_factory):
    """Return folder, page, and the predicted and painted rings of each stroke."""
    folder = tmp_path_factory.mktemp("job")
    (folder / "four.svg").write_text(DRAWING)
    work = prepare(folder / "four.svg")
    marks = _core.simulate(work.plan, work.brush)
    _core.trace_outlines(marks, work.brush)
    rng = np.random.default_rng(5)
    own = {mark.stroke: rng.normal(0, 0.2, 2) for mark in marks.passes}
    rings = {mark.stroke: [np.array(ring) for ring in mark.outline_mm] for mark in marks.passes}
    painted = {name: [turned(ring) + own[name] for ring in each] for name, each in rings.items()}
    page = job_page(work.plan, work.title)
    (folder / "photo.jpg").write_bytes(shown(page, painted))
    return folder, page, rings, painted


def shown(page, painted, camera=CAMERA):
    sheet = photograph.page(page.printed)
    for tick in page.ticks:
        sheet.paint([tick], INK)
    for rings in painted.values():
        sheet.paint([ring + page.frame_mm for ring in rings], BLUE)
    return photograph.photograph(sheet, camera)


def centre(rings):
    """Return the overlap of strokes without holes, by shapely."""
    return unary_union([Polygon(ring) for ring in rings]).centroid.coords[0]


def compare(folder, capsys, photo="photo.jpg", *flags):
    status = main(["compare", str(folder / photo), str(folder / "four.svg"), *flags])
    return status, capsys.readouterr()


def test_every_mark_is_found_where_it_was_painted(job, capsys):
    folder, _, rings, painted = job
    status, reported = compare(folder, capsys, "photo.jpg", "--json", "--picture", str(folder / "seen.png"))
    assert status == 0
    found = json.loads(reported.out)
    assert [row["stroke"] for row in found["strokes"]] == ["bow", "line", "cross", "bar"]
    for row in found["strokes"]:
        before, after = (np.array(centre(each[row["stroke"]])) for each in (rings, painted))
        assert row["shift_mm"] == pytest.approx(after - before, abs=0.03), row["stroke"]
        assert row["turn_deg"] == pytest.approx(TURN_DEG, abs=0.15)
        assert row["wider_mm"] == pytest.approx(0, abs=0.02)
        assert row["missing"] < 0.02
        ours, theirs = (unary_union([Polygon(r) for r in each[row["stroke"]]]) for each in (rings, painted))
        by_shapely = ours.intersection(theirs).area / ours.union(theirs).area
        assert row["overlap_predicted"] == pytest.approx(by_shapely, abs=0.03)
    assert found["overlap_sheet_placed"] > found["overlap_wanted"] + 0.1
    assert found["overlap_strokes_placed"] > found["overlap_sheet_placed"] + 0.01
    assert found["sheet"]["turn_deg"] == pytest.approx(TURN_DEG, abs=0.4)
    assert found["elsewhere_mm2"] == 0
    assert (folder / "seen.png").stat().st_size > 10_000


def test_wider_paint_and_a_missing_stroke_are_reported(job, capsys):
    folder, page, _, painted = job
    wider = {
        name: [np.array(Polygon(ring).buffer(0.3).exterior.coords)[::-1] for ring in rings]
        for name, rings in painted.items()
        if name != "line"
    }
    (folder / "wide.jpg").write_bytes(shown(page, wider))
    words = ("compare", folder / "wide.jpg", folder / "four.svg", "--json")
    status, out, reported = in_json(capsys, *words)
    rows = {row["stroke"]: row for row in json.loads(out)["strokes"]}
    assert status == 0 and is_reported(reported, "mark-missing", "line"), reported
    assert not rows["line"]["found"] and rows["line"]["missing"] == 1
    for name in ("bow", "cross", "bar"):
        assert rows[name]["wider_mm"] == pytest.approx(0.3, abs=0.05)


@sample("by_mm", [-0.5, 0.8, 2.0], keep=1)
def test_wider_paint_is_reported_for_any_width(job, capsys, by_mm):
    folder, page, _, painted = job
    wide = {
        name: [np.array(Polygon(ring).buffer(by_mm).exterior.coords)[::-1] for ring in rings]
        for name, rings in painted.items()
        if name in ("bow", "line")
    }
    (folder / "wide.jpg").write_bytes(shown(page, wide))
    rows = json.loads(compare(folder, capsys, "wide.jpg", "--json")[1].out)["strokes"][:2]
    assert [row["wider_mm"] for row in rows] == pytest.approx([by_mm, by_mm], abs=0.05)


def test_a_pure_rotation_leaves_no_displacement_of_strokes(job, capsys):
    folder, page, rings, _ = job
    (folder / "rot.jpg").write_bytes(shown(page, {name: list(map(turned, each)) for name, each in rings.items()}))
    found = json.loads(compare(folder, capsys, "rot.jpg", "--json")[1].out)
    assert found["sheet"]["turn_deg"] == pytest.approx(TURN_DEG, abs=0.02)
    assert found["sheet"]["strokes_aside_mm"] < 0.02
    assert found["overlap_sheet_placed"] == pytest.approx(found["overlap_strokes_placed"], abs=0.003)


def test_a_displaced_stroke_is_not_reported_as_missing(job, capsys):
    folder, page, rings, _ = job
    moved = dict(rings) | {"line": [ring + np.array([0.0, 3.5]) for ring in rings["line"]]}
    (folder / "moved.jpg").write_bytes(shown(page, moved))
    status, reported = compare(folder, capsys, "moved.jpg", "--json")
    row = next(row for row in json.loads(reported.out)["strokes"] if row["stroke"] == "line")
    assert status == 0 and reported.err == "" and row["shift_mm"] == pytest.approx([0, 3.5], abs=0.05)


def test_paler_paint_counts_as_paint(job, capsys):
    folder, page, rings, _ = job
    sheet = photograph.page(page.printed)
    for name, each in rings.items():
        sheet.paint([ring + page.frame_mm for ring in each], BLUE, 0.3 if name == "bow" else 1.0)
    (folder / "pale.jpg").write_bytes(photograph.photograph(sheet, CAMERA))
    found = json.loads(compare(folder, capsys, "pale.jpg", "--json")[1].out)
    assert all(row["found"] and row["missing"] < 0.05 for row in found["strokes"])
    assert found["strokes"][0]["wider_mm"] == pytest.approx(0, abs=0.05)


def test_photographs_of_two_sheets_are_refused(job, capsys):
    folder, page, _, painted = job
    moved = {name: [ring + np.array([1.5, 0.0]) for ring in rings] for name, rings in painted.items()}
    (folder / "two.jpg").write_bytes(shown(page, moved))
    words = ["compare", *(str(folder / name) for name in ("photo.jpg", "two.jpg", "four.svg"))]
    status, _, reported = in_json(capsys, *words, "--quiet")
    assert status == 1 and is_reported(reported, "photos-differ"), reported
    (folder / "aside.jpg").write_bytes(shown(page, painted, Camera((1500, 1050), tilt_deg=(-8.0, 6.0), fill=0.9)))
    words[2] = str(folder / "aside.jpg")
    assert main([*words, "--quiet"]) == 0


def test_a_blot_is_reported(job, capsys):
    folder, page, _, painted = job
    blot = np.array(Polygon([(30, 21), (36, 21), (36, 16), (30, 16)]).exterior.coords)[:-1]
    (folder / "blot.jpg").write_bytes(shown(page, painted | {"blot": [blot]}))
    found = json.loads(compare(folder, capsys, "blot.jpg", "--json")[1].out)
    assert found["elsewhere_mm2"] == pytest.approx(30, abs=2)
    assert all(row["found"] for row in found["strokes"])


def test_compare_fails_below_the_requested_overlap(job, capsys):
    folder = job[0]
    assert compare(folder, capsys, "photo.jpg", "--at-least", "0.2")[0] == 0
    words = ("compare", folder / "photo.jpg", folder / "four.svg", "--at-least", "0.99")
    status, _, reported = in_json(capsys, *words)
    assert status == 1 and is_reported(reported, "overlap-low 0.99"), reported


def test_pictures_that_do_not_show_the_job_are_refused(job, capsys):
    folder, page, _, painted = job
    (folder / "bare.jpg").write_bytes(shown(page, {}))
    line = affinity.rotate(Polygon(painted["line"][0]), 75, origin=(35, 30))
    elsewhere = {"line": [np.array(line.exterior.coords)[:-1]]}
    (folder / "elsewhere.jpg").write_bytes(shown(page, elsewhere))
    work = prepare(folder / "four.svg")
    of_a_chart = chart(work.brush, (148.0, 210.0), "few")
    sheet = photograph.page(of_a_chart)
    (folder / "chart.jpg").write_bytes(photograph.photograph(sheet, Camera(size_px=(1050, 1500))))
    (folder / "none.jpg").write_bytes(photograph.encoded(np.full((600, 800, 3), 200, np.uint8)))
    for name, code in (
        ("bare.jpg", "photo-without-paint"),
        ("elsewhere.jpg", "photo-of-another-job"),
        ("chart.jpg", "photo-of-another-chart"),
        ("none.jpg", "photo-markers-missing"),
    ):
        status, _, ((_, reported),) = in_json(capsys, "compare", folder / name, folder / "four.svg")
        assert (status, reported.code) == (1, code), (name, reported)


SKIN = np.array([0.55, 0.36, 0.26])


def with_a_thing(page, painted, ring):
    sheet = photograph.page(page.printed)
    for tick in page.ticks:
        sheet.paint([tick], INK)
    for rings in painted.values():
        sheet.paint([each + page.frame_mm for each in rings], BLUE)
    sheet.paint([np.array(ring) + page.frame_mm], SKIN)
    return photograph.photograph(sheet, CAMERA)


def seen(job, capsys, photo):
    """Return status, messages, and for each stroke whether it is found and corrected."""
    folder, out = job[0], job[0] / "bad.json"
    out.unlink(missing_ok=True)
    status, _, reported = in_json(capsys, "compare", "--force", folder / photo, folder / "four.svg", "-o", out)
    rows = json.loads(out.read_text())["strokes"] if out.exists() else []
    return status, reported, {row["stroke"]: (row["found"], row["correction"] is not None) for row in rows}


def test_a_finger_in_the_picture_is_reported_and_corrects_nothing_it_covers(job, capsys):
    folder, page, _, painted = job
    finger = Polygon([(31, -30), (49, -30), (49, 55), (40, 62), (31, 55)]).exterior.coords[:-1]
    (folder / "finger.jpg").write_bytes(with_a_thing(page, painted, finger))
    status, reported, rows = seen(job, capsys, "finger.jpg")
    assert status == 0 and is_reported(reported, "photo-covered", "sheet"), reported
    assert rows["bow"] == rows["line"] == (False, False), rows
    assert rows["cross"][0] and rows["bar"][0]
    hand = Polygon([(20, -40), (115, -40), (115, 50), (60, 75), (15, 50)]).exterior.coords[:-1]
    (folder / "hand.jpg").write_bytes(with_a_thing(page, painted, hand))
    status, ((_, reported),), rows = seen(job, capsys, "hand.jpg")
    assert status == 1 and reported.code in ("photo-of-another-job", "photo-without-paint") and not rows, reported


@pytest.mark.parametrize("half", ["left", "right", "upper", "lower", "two thirds"])
def test_half_a_sheet_is_refused(job, capsys, half):
    folder = job[0]
    pixels = cv2.imdecode(np.frombuffer((folder / "photo.jpg").read_bytes(), np.uint8), cv2.IMREAD_COLOR)
    rows, columns = pixels.shape[0] // 2, pixels.shape[1] // 2
    part = {
        "left": pixels[:, :columns],
        "right": pixels[:, columns:],
        "upper": pixels[:rows],
        "lower": pixels[rows:],
        "two thirds": pixels[:, : 4 * columns // 3],
    }[half]
    (folder / "half.jpg").write_bytes(photograph.encoded(part))
    status, ((_, reported),), found = seen(job, capsys, "half.jpg")
    assert status == 1 and reported.code == "photo-cropped" and not found, reported


def test_another_plan_on_the_same_page_is_refused(job, capsys):
    folder, page, rings, _ = job
    names = list(rings)
    middles = {name: np.array(centre(each)) for name, each in rings.items()}
    elsewhere = {
        "turned": {name: [np.array([110, 70]) - ring for ring in each] for name, each in rings.items()},
        "mixed up": {
            name: [ring - middles[name] + middles[other] for ring in rings[name]]
            for name, other in zip(names, names[1:] + names[:1], strict=True)
        },
    }
    for kind, painted in elsewhere.items():
        (folder / "wrong.jpg").write_bytes(shown(page, painted))
        status, ((_, reported),), found = seen(job, capsys, "wrong.jpg")
        assert status == 1 and reported.code == "photo-of-another-job" and not found, (kind, reported)


def test_paint_unlike_its_mark_gives_no_correction(job, capsys):
    """There is a comb instead of a line, so its paint may belong to anything."""
    folder, page, _, painted = job
    line = Polygon(painted["line"][0])
    teeth = [Polygon([(x, 9), (x + 5, 9), (x + 5, 20), (x, 20)]) for x in (18, 32, 46, 60)]
    comb = unary_union([line, *teeth])
    near = {"line": [np.array(comb.exterior.coords)[:-1][::-1]]}
    (folder / "unlike.jpg").write_bytes(shown(page, painted | near))
    status, reported, rows = seen(job, capsys, "unlike.jpg")
    assert status == 0 and is_reported(reported, "mark-unlike", "line"), (reported, rows)
    assert rows["line"] == (True, False)
    assert rows["bow"][1] and rows["bar"][1] and rows["cross"][1], rows


def test_the_page_names_its_plan(job, tmp_path, capsys):
    folder, page, *_ = job
    for name in ("page.svg", "page.pdf"):
        words = [
            "convert",
            str(folder / "four.svg"),
            "-o",
            str(tmp_path / "a.ngc"),
            "--page",
            str(tmp_path / name),
        ]
        words += ["--margin-strokes", "off"]
        made = main([*words, "--quiet"])
        assert made == 0, capsys.readouterr().err
    text = (tmp_path / "page.svg").read_text()
    assert f"brushsvg job {page.printed.id}" in text and text.count("data-marker") == len(page.printed.markers) == 8
    assert (tmp_path / "page.pdf").read_bytes().startswith(b"%PDF")
    work = prepare(folder / "four.svg")
    assert job_page(order_nearest_first(work).plan).printed.id == page.printed.id, "in any order"


def test_python_reports_what_the_command_shows(job, capsys, tmp_path):
    folder, page, _, painted = job
    named = tmp_path / "told.json", tmp_path / "told.png", tmp_path / "corrected.toml"
    flags = [f"--{flag}={path}" for flag, path in zip(("picture", "corrected-cell"), named[1:], strict=True)]
    status, reported = compare(folder, capsys, "photo.jpg", "-o", str(named[0]), *flags)
    stages = []
    found = brushsvg.compare(folder / "four.svg", folder / "photo.jpg", progress=stages.append)
    assert (
        status == 0 and found.report.text(picture=str(named[1])) == reported.out and found.json == named[0].read_text()
    )
    assert found.picture() == named[1].read_bytes()
    assert brushsvg.write_cell(found.cell) == named[2].read_text() and not found.is_corrected
    assert round(found.overlap, 4) == json.loads(found.json)["overlap_wanted"] < 0.7
    assert [each.stroke for each in found.strokes] == list(painted) == list(found.corrections)
    assert len(set(stages)) > 3 and all(isinstance(words, str) for words in stages)
    for again in (copy.deepcopy(found), pickle.loads(pickle.dumps(found))):
        assert again == found and again.picture() == found.picture()
    (folder / "three.jpg").write_bytes(shown(page, {name: each for name, each in painted.items() if name != "bow"}))
    notices = brushsvg.compare(folder / "four.svg", [str(folder / "three.jpg")]).notices
    assert [(each.where, each.code) for each in notices if each.code == "mark-missing"] == [("bow", "mark-missing")]


def test_invalid_comparisons_from_python_raise_one_error(job, tmp_path):
    folder = job[0]
    drawing, photo = folder / "four.svg", str(folder / "photo.jpg")
    (tmp_path / "other.svg").write_text(DRAWING.replace("M16 58 L70 54", "M16 50 L70 44"))
    for photos, code, file in (
        ([], "wrong-type", None),
        (7, "wrong-type", None),
        ([photo, photo], "photo-twice", photo),
        (tmp_path / "none.jpg", "file-unreadable", str(tmp_path / "none.jpg")),
    ):
        with pytest.raises(Error) as refused:
            brushsvg.compare(drawing, photos)
        assert (refused.value.code, refused.value.file) == (code, file)
    with pytest.raises(Error) as refused:
        brushsvg.compare(tmp_path / "other.svg", photo)
    assert (refused.value.code, refused.value.file) == ("photo-of-another-chart", photo)
