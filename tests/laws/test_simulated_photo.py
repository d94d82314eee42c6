"""compare finds the faults of the studio in a picture of simulate-photo.

The picture cannot be confused with a photograph.
"""

import json
import re
from pathlib import Path

import cv2
import numpy as np
import pytest
from diagnostics import gives, in_json, is_reported

from brushsvg.cli import main
from brushsvg.model.library import find_brush

pytestmark = pytest.mark.long  # these tests render and read sheets
DRAWING = """<svg xmlns="http://www.w3.org/2000/svg" width="120mm" height="80mm" viewBox="0 0 120 80">
<title>six</title><g fill="none" stroke="#000" stroke-width="3">
<path id="a" d="M20 20 L50 16"/><path id="b" d="M100 20 L70 24"/><path id="c" d="M20 40 C30 60 40 60 50 40"/>
<path id="d" d="M100 60 L70 50"/><path id="e" d="M60 30 L62 66"/><path id="f" d="M14 70 L50 68 L50 60"/></g></svg>"""
EXAMPLE = Path(__file__).parents[2] / "examples/robot.svg"  # letters whose strokes touch
HEAD = 'format = "brushsvg/studio"\nversion = 1\n'


@pytest.fixture
def drawing(tmp_path):
    (tmp_path / "six.svg").write_text(DRAWING)
    return tmp_path / "six.svg"


def shown(drawing, capsys, toml, *flags):
    """Return the result of compare for the photograph of a studio."""
    folder = drawing.parent
    (folder / "studio.toml").write_text(HEAD + toml)
    words = [
        "simulate-photo",
        drawing,
        "-o",
        folder / "p.jpg",
        "--studio",
        folder / "studio.toml",
        "--quiet",
        *("--margin-strokes", "off"),
        *flags,
    ]
    assert main([*map(str, words)]) == 0, capsys.readouterr().err
    assert main(["compare", str(folder / "p.jpg"), str(drawing), "--json", "--quiet"]) == 0
    return json.loads(capsys.readouterr().out)


def test_a_studio_without_faults_paints_the_prediction(drawing, capsys):
    found = shown(drawing, capsys, "")
    assert found["overlap_predicted"] > 0.98 and found["faults"]["mend_first"] is None


def test_each_studio_key_has_its_documented_effect(drawing, capsys):
    found = shown(drawing, capsys, "[sheet]\nshift_mm = [1.5, -1.0]\nturn_deg = 0.6\n")
    assert found["sheet"]["turn_deg"] == pytest.approx(0.6, abs=0.05)
    middle = np.array(found["sheet"]["middle_mm"]) - [60, 40]
    c, s = np.cos(np.radians(0.6)), np.sin(np.radians(0.6))
    near_by = np.array([[c, -s], [s, c]]) @ middle - middle + [1.5, -1.0]
    assert found["sheet"]["shift_mm"] == pytest.approx(near_by, abs=0.05)
    found = shown(drawing, capsys, "[paint]\nlasts_mm = 15\n")
    missing = {row["cause"]: row["gain"] for row in found["faults"]["causes"]}
    assert found["faults"]["mend_first"] == "missing paint" and missing["missing paint"] > 0.1
    found = shown(drawing, capsys, "[brush]\nlag = 1.15\n")
    numbers = {row["name"]: row for row in found["faults"]["numbers"]}
    assert numbers["lag"]["value"] == pytest.approx(0.15, abs=0.03)
    words = ["simulate-photo", str(drawing), "-o", str(drawing.parent / "q.jpg"), "--true-brush", "rigid"]
    assert main(words) == 1, "which cannot be pressed as deep as the plan presses it"


def test_the_same_seed_gives_the_same_photograph_and_reported_studio(drawing, capsys):
    folder = drawing.parent
    for name, seed in (("a", 7), ("b", 7), ("c", 8)):
        assert main(["simulate-photo", str(drawing), "-o", str(folder / f"{name}.jpg"), "--seed", str(seed)]) == 0
    a, b, c = ((folder / f"{name}.jpg").read_bytes() for name in "abc")
    assert a == b != c
    text = capsys.readouterr().out
    (folder / "told.toml").write_text(text[text.rindex("format = ") :])
    words = [
        "simulate-photo",
        drawing,
        "-o",
        folder / "d.jpg",
        "--seed",
        "8",
        "--studio",
        folder / "told.toml",
    ]
    assert main([*map(str, words)]) == 0
    assert (folder / "d.jpg").read_bytes() == c


def test_no_seed_draws_paper_that_a_chart_cannot_be_painted_on(tmp_path, capsys, monkeypatch):
    """No seed gives paper on which a chart cannot be painted.

    A chart presses to the end of the brush's range. Half of the seeds once had paper higher than taught.
    """
    monkeypatch.chdir(tmp_path)
    assert main(["chart", "-o", "c.ngc", "--sheet", "a5", "--chart", "c.json", "--quiet"]) == 0
    for seed in (2, 3):  # seed 2 was once refused, and seed 3 was not
        assert main(["simulate-photo", "c.json", "-o", "p.jpg", "--seed", str(seed)]) == 0, capsys.readouterr().err
    Path("s.toml").write_text(HEAD + "[machine]\nheight_mm = 1.0\n")
    status, _, reported = in_json(capsys, "simulate-photo", "c.json", "-o", "p.jpg", "--studio", "s.toml")
    assert status == 1 and is_reported(reported, "depth-out-of-range 11.000 machine.height_mm")


def test_letters_of_the_page_end_at_their_layout_positions(monkeypatch):
    """Letters of the page end where its layout puts them.

    Bold letters are wider than once measured, and the title of an A5 chart ran into a marker.
    """
    from brushsvg.calibration.chart.layout import chart
    from brushsvg.calibration.chart.page import label_box
    from brushsvg.comparison.job_page import JobPage
    from brushsvg.simulated import photo
    from brushsvg.simulated.camera import Sheet

    page = JobPage(chart(find_brush("round-6"), (148, 210)), 0.0, ())
    for texels in (5.0, 20.0):
        sheet = Sheet(page.size_mm, 1, texels)
        bare = sheet.shown.copy()
        monkeypatch.setattr(sheet, "paint", lambda *_: None)
        photo._print_page(sheet, page)
        dark = np.abs(sheet.shown - bare).max(axis=2) > 0
        for label in page.printed.labels:
            _, bottom, right, top = np.array(label_box(label)) * texels
            rows = slice(round(page.size_mm[1] * texels - top), round(page.size_mm[1] * texels - bottom))
            beyond = dark[rows, round(right + texels) : round(right + 3 * texels)]
            assert not beyond.any(), (label.text, texels)


def test_the_picture_is_labelled_as_simulated(drawing):
    """A strip from edge to edge, white on dark red, says that the picture is simulated."""
    folder = drawing.parent
    assert main(["simulate-photo", str(drawing), "-o", str(folder / "p.jpg"), "--quiet"]) == 0
    strip = cv2.imread(str(folder / "p.jpg"))[-30:].astype(int)
    red = (strip[..., 2] > 80) & (strip[..., :2].max(axis=-1) < 60)
    white = strip.min(axis=-1) > 180
    assert red.mean() > 0.7 and 0.02 < white.mean() < 0.3
    assert red[:, [3, -4]].mean() > 0.9


@pytest.mark.parametrize(
    ("toml", "code"),
    [
        ("[machine]\nbacklash_mm = [4.0, 0.0]\n", "out-of-range 4 0 3"),
        (f"[machine]\nbacklash_mm = [{10**400}, 0.0]\n", "out-of-range 0 3"),
        ("[machine]\nbacklash = 0.1\n", "key-unknown machine.backlash"),
        ("[brush]\nlag = true\n", "wrong-type brush.lag"),
        ("[robot]\n", "key-unknown robot"),
        ("[camera]\ntilt_deg = [25.0, 25.0]\nfocal = 0.5\n", "out-of-range"),
        ("[machine]\nheight_mm = 5.0\n[brush]\n", ""),
        ("[machine\n", "not-toml"),
    ],
)
def test_impossible_studios_are_refused(drawing, capsys, toml, code):
    folder = drawing.parent
    (folder / "studio.toml").write_text(HEAD + toml)
    big = DRAWING.replace('stroke-width="3"', 'stroke-width="7"')
    drawing.write_text(big if not code else DRAWING)
    words = ("simulate-photo", drawing, "-o", folder / "p.jpg", "--studio", folder / "studio.toml")
    status, _, reported = in_json(capsys, *words)
    assert status == 1 and not (folder / "p.jpg").exists(), reported
    assert is_reported(reported, code) if code else len(reported) >= 1, reported


@pytest.mark.thorough
def test_the_advice_for_the_plan_of_a_chart_calibrates_it(tmp_path, capsys):
    """The advice in the refusal calibrates the plan of a chart.

    simulate-photo prints the page of a job around the chart's plan. Its markers are not those of chart.json.
    """
    plan, chart, photo, found = (str(tmp_path / name) for name in ("plan.json", "chart.json", "p.jpg", "mine.json"))
    page = str(tmp_path / "page.svg")
    assert main(["chart", "-o", plan, "--sheet", "a5", "--page", page, "--chart", chart, "--quiet"]) == 0
    assert main(["simulate-photo", plan, "-o", photo, "--quiet"]) == 0
    status, _, reported = in_json(capsys, "calibrate", "--force", photo, "--chart", chart, "-o", found)
    assert status == 1 and is_reported(reported, "photo-of-another-chart"), reported
    assert all(flag in reported[-1][1].advice for flag in ("--plan", "--prior", "--chart"))
    assert main(["calibrate", "--force", photo, "--plan", plan, "--prior", "round-6", "-o", found, "--quiet"]) == 0
    assert json.loads((tmp_path / "mine.json").read_text())["format"] == "brushsvg/brush"


@pytest.fixture(scope="module")
def letters(tmp_path_factory):
    """Return a word with touching strokes, its plan, and two sheets with many faults."""
    folder = tmp_path_factory.mktemp("letters")
    for words in (
        ("convert", EXAMPLE, "-o", folder / "word.json"),
        ("simulate-photo", EXAMPLE, "-o", folder / "3.jpg", "--seed", "3", "--margin-strokes", "off"),
        ("simulate-photo", EXAMPLE, "-o", folder / "4.jpg", "--seed", "4", "--margin-strokes", "off"),
    ):
        assert main([*map(str, words), "--quiet"]) == 0
    return folder


@pytest.mark.thorough
def test_a_chart_is_suggested_if_no_stroke_is_alone(letters, drawing, capsys):
    """If no stroke is alone, a chart is advised.

    compare never advises a step that would be refused: no brush can be learnt from this photograph.
    """
    words = ("--plan", letters / "word.json", "--prior", "round-6", "-o", letters / "u.json")
    status, _, reported = in_json(capsys, "calibrate", letters / "3.jpg", *words)
    assert status == 1 and is_reported(reported, "marks-touch 9 7 2 30"), reported
    assert "calibrate --chart" in reported[-1][1].advice
    status, text, _ = in_json(capsys, "compare", letters / "3.jpg", EXAMPLE)
    assert status == 0 and "--prior" not in text and text.count("calibrate --chart") == 1
    as_painted, placed = (float(each) for each in re.search(r"(0\.\d+); (0\.\d+) ", text).groups())
    assert placed < as_painted
    main(["simulate-photo", str(drawing), "-o", str(letters / "six.jpg"), "--seed", "5", "--quiet"])
    status, text, _ = in_json(capsys, "compare", letters / "six.jpg", drawing)
    as_painted, placed = (float(each) for each in re.search(r"(0\.\d+); (0\.\d+) ", text).groups())
    assert placed > as_painted and "calibrate --chart" not in text


def test_strokes_without_repeats_are_reported(letters, capsys):
    words = ("compare", letters / "3.jpg", letters / "4.jpg", EXAMPLE, "--sheets")
    status, text, _ = in_json(capsys, *words, "--json")
    found = json.loads(text)
    names = {each["stroke"] for each in json.loads((letters / "word.json").read_text())["passes"]}
    seen, unseen = {row["stroke"] for row in found["strokes"]}, set(found["not_seen_twice"])
    assert status == 0 and seen and unseen and seen | unseen == names and not seen & unseen
    text = in_json(capsys, *words)[1]
    last = [line for line in text.splitlines() if all(name in line for name in unseen)]
    assert len(last) == 1 and gives(last[0], str(len(unseen)))


def test_a_photograph_given_twice_is_refused(letters, capsys):
    copy = letters / "copy.jpg"
    copy.write_bytes((letters / "3.jpg").read_bytes())
    for photos in ((letters / "3.jpg", letters / "3.jpg"), (letters / "3.jpg", letters / "4.jpg", copy)):
        for words in (
            ("compare", *photos, EXAMPLE),
            ("compare", *photos, EXAMPLE, "--sheets"),
            (
                "calibrate",
                *photos,
                "--plan",
                letters / "word.json",
                "--prior",
                "round-6",
                "-o",
                letters / "u.json",
            ),
        ):
            status, _, reported = in_json(capsys, *words)
            assert status == 1 and reported[-1][0] == str(photos[-1]), reported
            assert is_reported(reported, "photo-twice 3.jpg"), reported


def test_a_chart_is_photographed_as_its_own_page(tmp_path, capsys):
    """A chart is photographed as its own page.

    A studio without faults gives back the named brush. From the plan alone, the page would be different.
    """
    plan, chart, photo, found = (str(tmp_path / name) for name in ("plan.json", "chart.json", "p.jpg", "own.json"))
    assert main(["chart", "-o", plan, "--brush", "round-6", "--sheet", "a5", "--chart", chart]) == 0
    (tmp_path / "studio.toml").write_text(HEAD)
    assert main(["simulate-photo", chart, "-o", photo, "--studio", str(tmp_path / "studio.toml")]) == 0
    assert main(["calibrate", "--force", photo, "--chart", chart, "-o", found]) == 0
    own, true, depths = find_brush(found), find_brush("round-6"), np.linspace(3, 10, 8)
    for law in ("lag", "half_width"):
        values, truth = (np.array([getattr(each, law)(d) for d in depths]) for each in (own, true))
        assert np.abs(values / truth - 1).max() < 0.05, (law, values / truth)
    capsys.readouterr()
    status, _, reported = in_json(capsys, "calibrate", "--force", photo, "--chart", plan, "-o", found)
    assert status == 1 and is_reported([each for _, each in reported], "format-unknown '--chart FILE'"), reported


def test_a_missing_plan_is_reported(tmp_path, capsys):
    status, _, reported = in_json(capsys, "simulate-photo", tmp_path / "none.json", "-o", tmp_path / "x.jpg")
    assert status == 1 and is_reported(reported, "file-unreadable"), reported
