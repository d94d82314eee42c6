"""One photograph gives back the lag of an unknown brush.

A separate simulator paints the chart in small steps, with faults of paint and sheet. The renderer has its own
camera model.
"""

import json
import re
from dataclasses import replace
from functools import cache
from types import SimpleNamespace

import numpy as np
import painter
import photograph
import pytest
from diagnostics import are_reported, gives, in_json, refused
from photograph import BLUE, INK, Camera

core = pytest.importorskip("brushsvg._core")
if not hasattr(core, "fit_marks"):
    pytest.skip("built without Ceres", allow_module_level=True)

import brushsvg  # noqa: E402
from brushsvg import find_brush  # noqa: E402
from brushsvg.calibration.chart.file import write_chart  # noqa: E402
from brushsvg.calibration.chart.layout import chart  # noqa: E402
from brushsvg.calibration.chart.photograph import read_chart_photos  # noqa: E402
from brushsvg.calibration.marks.from_marks import refuse_many  # noqa: E402
from brushsvg.calibration.marks.sheet_scale import SheetScale  # noqa: E402
from brushsvg.calibration.marks.stray_marks import find_strays  # noqa: E402
from brushsvg.cli import main  # noqa: E402
from brushsvg.geometry.polylines import length  # noqa: E402
from brushsvg.model.confidence import law_band  # noqa: E402
from brushsvg.reporting.report_text import GOOD  # noqa: E402

pytestmark = pytest.mark.long

TRUTH = painter.TrueBrush(
    10.0, np.array([2.6, 1.3, 0.1, -0.009]), np.array([0.0, 0.45]), np.array([0.0, 0.5, -0.005]), 1.6, 0.9
)
FAULTS = painter.Faults(noise=0.05, noise_length=0.5, displacement=0.3, placement=0.8, turn=0.008, height=0.1)
DEPTHS = np.linspace(1, 10, 10)


CAMERA = Camera(size_px=(1500, 2050), shadow=0.3)


@cache
def printed():
    return chart(find_brush("round-6"), (148.0, 210.0), "few")


@cache
def marks():
    """Return the rings of each stroke."""
    strokes = [(one.stroke, np.array(one.poses_mm)) for one in printed().plan.passes]
    painted = painter.paint(np.random.default_rng(4), TRUTH, strokes, FAULTS)
    return {stroke: rings for stroke, _, rings in painted.marks}


def photo_of(painted, *things, camera=CAMERA):
    """Photograph painted marks, with things (rings and their colour) on the paint."""
    sheet = photograph.page(printed())
    for rings in painted.values():
        sheet.paint(rings, BLUE)
    for ring, colour in things:
        sheet.paint([ring], colour)
    return photograph.photograph(sheet, camera)


@pytest.fixture(scope="module")
def desk(tmp_path_factory):
    folder = tmp_path_factory.mktemp("desk")
    (folder / "photo.jpg").write_bytes(photo_of(marks()))
    (folder / "chart.json").write_text(write_chart(printed()))
    return folder


def test_python_and_the_command_give_the_same_brush(desk, tmp_path, capsys):
    photo, printed_chart, out = desk / "photo.jpg", desk / "chart.json", tmp_path / "own.json"
    assert main(["calibrate", str(photo), "--chart", str(printed_chart), "-o", str(out)]) == 0
    made = brushsvg.calibrate(photo, "own", chart=printed_chart)
    assert core.write_brush(made.brush) == out.read_text()
    assert made.text == capsys.readouterr().out
    assert made.picture().startswith(b"\x89PNG")


def test_one_photograph_recovers_the_brush(desk, capsys):
    files = [str(desk / name) for name in ("photo.jpg", "chart.json", "own.json", "read.png")]
    assert (
        main(
            [
                "calibrate",
                "--force",
                files[0],
                "--chart",
                files[1],
                "-o",
                files[2],
                "--marks-picture",
                files[3],
            ]
        )
        == 0
    )
    reported = capsys.readouterr()
    assert re.search(r"\b24 .*\b6 [a-z ]+ 0\.0", reported.err)
    assert reported.out.splitlines()[0] == GOOD
    found = find_brush(desk / "own.json")
    off = {}
    for law in ("lag", "half_width"):
        truth = TRUTH.law(law)(DEPTHS)
        values = np.array([getattr(found, law)(depth) for depth in DEPTHS])
        off[law] = np.abs(values / truth - 1).max()
        band = law_band(found, law, DEPTHS)[0]
        assert np.mean(np.abs(values - truth) < band) > 0.7, (law, values - truth, band)
    assert off["lag"] < 0.03 and off["half_width"] < 0.03, off
    assert (desk / "read.png").stat().st_size > 10_000


def calibrating(folder):
    """Return words of the command that reads photo.jpg by chart.json."""
    return [
        "calibrate",
        "--force",
        folder / "photo.jpg",
        "--chart",
        folder / "chart.json",
        "-o",
        folder / "own.json",
    ]


def test_a_chart_on_bulging_paper_gives_the_brush_or_a_warning(tmp_path, capsys):
    """Bulging paper gives the brush or a warning.

    With a bulge of 0.4 mm the brush comes back. With 0.8 mm the markers hardly show the bulge, and the
    displaced marks look like another scale of the sheet. The report says that bulging paper also does this.
    """
    (tmp_path / "chart.json").write_text(write_chart(printed()))
    words = calibrating(tmp_path)
    (tmp_path / "photo.jpg").write_bytes(photo_of(marks(), camera=replace(CAMERA, sag_mm=0.4)))
    assert in_json(capsys, *words)[0] == 0
    found = find_brush(tmp_path / "own.json")
    for law in ("lag", "half_width"):
        truth = TRUTH.law(law)(DEPTHS)
        values = np.array([getattr(found, law)(depth) for depth in DEPTHS])
        band = law_band(found, law, DEPTHS)[0]
        assert np.mean(np.abs(values - truth) < band) >= 0.9, (law, values - truth, band)
        assert np.abs(values / truth - 1).max() < 0.02, (law, values / truth)
    (tmp_path / "photo.jpg").write_bytes(photo_of(marks(), camera=replace(CAMERA, sag_mm=0.8)))
    status, _, reported = in_json(capsys, *words)
    assert status == 1 and are_reported([each for _, each in reported], "photo-not-flat", "marks-scaled"), reported


@pytest.mark.thorough
def test_a_known_height_is_kept_and_outlines_give_the_lag(desk, capsys):
    """A known height is kept, and outlines give the lag.

    Without the height, the fit finds it within 0.03 mm. The outlines then count as measured. They are the
    drops with which this brush paints, so the lag does not change.
    """
    photo = ["calibrate", "--force", str(desk / "photo.jpg"), "--chart", str(desk / "chart.json")]
    assert main([*photo, "-o", str(desk / "surer.json"), "--height", "0.005"]) == 0
    reported = re.search(r"(0\.\d+) \+- (0\.\d+) mm [a-z]", capsys.readouterr().out)
    assert float(reported[1]) < 0.02 and float(reported[2]) <= 0.01, reported[0]
    surer = json.loads((desk / "surer.json").read_text())
    surer["footprints"]["assumed"] = False
    (desk / "own.json").write_text(json.dumps(surer))
    pictures = [str(desk / "lag.png"), str(desk / "over.png")]
    words = [
        *photo,
        "-o",
        str(desk / "lag.json"),
        "--brush",
        str(desk / "own.json"),
        "--picture",
        pictures[0],
    ]
    assert main([*words, "--marks-picture", pictures[1]]) == 0
    assert gives(capsys.readouterr().out, "surer")
    found = find_brush(desk / "lag.json")
    off = [found.lag(depth) / TRUTH.law("lag")(depth) - 1 for depth in DEPTHS]
    assert np.abs(off).max() < 0.03, off
    assert found.footprints == find_brush(desk / "own.json").footprints
    assert all((desk / name).stat().st_size > 10_000 for name in ("lag.png", "over.png"))


def test_a_lag_from_outlines_needs_measured_outlines(desk, capsys):
    words = [
        "calibrate",
        "--force",
        str(desk / "photo.jpg"),
        "--chart",
        str(desk / "chart.json"),
        "--brush",
        "round-6",
    ]
    status, _, reported = in_json(capsys, *words, "-o", str(desk / "none.json"))
    assert status == 1 and reported[-1][1].code == "footprints-assumed", reported
    assert not (desk / "none.json").exists()


def test_covered_or_displaced_marks_are_named_and_left_out(tmp_path, capsys):
    """Marks that are covered or displaced are named and left out.

    The fit masks their points. It once gave the brush without reporting them.
    """
    coin = np.vstack(marks()["straight-3"]).mean(axis=0) + np.array([0.0, 2.5])
    turn = np.linspace(0, 2 * np.pi, 60, endpoint=False)
    disc = coin + 3.0 * np.column_stack([np.cos(turn), np.sin(turn)])
    moved = marks() | {"arc-3": [ring + np.array([2.0, 1.0]) for ring in marks()["arc-3"]]}
    photo, out = tmp_path / "photo.jpg", tmp_path / "own.json"
    photo.write_bytes(photo_of(moved, (disc, INK)))
    (tmp_path / "chart.json").write_text(write_chart(printed()))
    words = ["calibrate", "--force", str(photo), "--chart", str(tmp_path / "chart.json"), "-o", str(out)]
    status, report, reported = in_json(capsys, *words)
    assert status == 0
    named = [notice for _, notice in reported if notice.code == "mark-astray"]
    assert are_reported(named, "mark-astray straight-3", "mark-astray arc-3")
    displaced = re.search(r" (\d\.\d) mm [a-z]* ?\(\+(\d\.\d), \+(\d\.\d)\)", named[1].sentence)
    assert [float(number) for number in displaced.groups()] == pytest.approx([2.2, 2.0, 1.0], abs=0.4)
    for notice, stroke in zip(named, ("straight-3", "arc-3"), strict=True):
        corners = re.findall(r"-?\d+\.\d", notice.text.split(";")[1])
        found, expected = np.array(corners, float).reshape(2, 4)
        assert gives(notice.text, "2")
        assert 1.5 < np.abs(found - expected).max() < 3.5, stroke
    assert re.search(r"^[a-z].*: straight-3, arc-3$", report, re.MULTILINE), report
    off = [abs(find_brush(out).lag(depth) / TRUTH.law("lag")(depth) - 1) for depth in DEPTHS]
    assert max(off) < 0.03, off


def fitted(count, astray):
    """Return a fit of randomly displaced marks; astray moves one mark further."""
    rng = np.random.default_rng(1)
    rows = [
        SimpleNamespace(displacement_mm=rng.normal(0, 0.2, 2), rms_mm=0.05, distance_mm=rng.normal(0, 0.05, 99))
        for _ in range(count)
    ]
    for k, by in astray.items():
        rows[k].displacement_mm = rows[k].displacement_mm + by
    return SimpleNamespace(marks=rows, noise_mm=0.05)


def test_a_mark_is_compared_only_with_the_other_marks():
    fit = fitted(24, {3: np.array([1.9, 0.0]), 9: np.array([0.0, -9.0])})
    found = find_strays(list("abcdefghijklmnopqrstuvwx"), fit)
    assert [stray.mark for stray in found] == ["d", "j"] and all(stray.is_displaced for stray in found)
    assert found[0].spread_mm == pytest.approx(0.2, abs=0.06)
    assert not find_strays(list("abcdefghijklmnopqrstuvwx"), fitted(24, {}))
    fit = fitted(24, {})
    fit.marks[5].rms_mm, fit.marks[5].distance_mm = 0.3, np.append(np.zeros(90), np.full(10, 0.9))
    assert [stray.mark for stray in find_strays(list("abcdefghijklmnopqrstuvwx"), fit)] == ["f"]
    assert not find_strays(list("abcd"), fitted(4, {0: np.array([5.0, 0.0])})), "four do not single out one"


def test_many_outlying_marks_are_refused():
    some = [SimpleNamespace(mark=SimpleNamespace(stroke=f"arc-{k}")) for k in range(6)]
    painted = SimpleNamespace(marks=[None] * 25)
    refuse_many(tuple(some[:5]), painted)
    for scale in (None, SheetScale((0.04, 0.02), (0.04, 0.02), (0.04, 0.015), 44)):
        with refused("marks-outlying 6 25 5 arc-0 arc-1"):
            refuse_many(tuple(some), painted, scale)
    with refused("marks-scaled 4.00 larger"):
        refuse_many(tuple(some), painted, SheetScale((0.04, 0.002), (0.04, 0.002), (0.04, 0.0015), 44))


def test_the_table_around_small_paper_is_not_a_mark(tmp_path, capsys):
    """The table around paper that is smaller than the print is not a mark.

    A page printed at 103 % ends within the span of its markers. The table was once read as the mark of arc-4.
    """
    middle = np.array(printed().plan.sheet_mm) / 2

    def larger(points):
        return tuple(map(tuple, (np.array(points) - middle) * 1.03 + middle))

    markers = tuple(replace(each, corners_mm=larger(each.corners_mm)) for each in printed().markers)
    sheet = photograph.page(replace(printed(), markers=markers, labels=()))
    for rings in marks().values():
        sheet.paint(rings, BLUE)
    (tmp_path / "photo.jpg").write_bytes(photograph.photograph(sheet, CAMERA))
    (tmp_path / "chart.json").write_text(write_chart(printed()))
    words = calibrating(tmp_path)
    status, _, reported = in_json(capsys, *words)
    assert status == 1 and are_reported([reported[-1][1]], "marks-scaled smaller bar"), reported
    assert in_json(capsys, *words, "--bar", f"{1.03 * printed().bar.length_mm:.1f}")[0] == 0


@pytest.mark.parametrize("colour", [BLUE, INK], ids=["blue", "black"])
def test_a_mark_on_a_printed_label_is_read_without_its_letters(colour):
    """Marks that are 1.7 mm too low touch labels.

    A mark inside the box of its label was once no paint, and letters that touch a mark were part of its outline. The
    label of a stroke that was not painted is no paint either.
    """
    brush = find_brush("round-6")
    made = chart(brush, (210.0, 297.0), "few")
    painted = core.simulate(made.plan, brush)
    core.trace_outlines(painted, brush)
    unpainted = "arc-2"
    found = []
    for labels in (made.labels, ()):
        sheet = photograph.page(replace(made, labels=labels))
        for mark in painted.passes:
            if mark.stroke != unpainted:
                sheet.paint([np.array(ring) + np.array([0.6, -1.7]) for ring in mark.outline_mm], colour)
        photo = photograph.photograph(sheet, Camera(size_px=(2000, 2800)))
        found.append(read_chart_photos(replace(made, labels=labels), [("photo.jpg", photo)]).marks)
    with_labels, without = found
    assert with_labels.missing == without.missing == [unpainted]
    for stroke, rings in with_labels.outlines_mm.items():
        true_rings = without.outlines_mm[stroke]
        growth_mm = (core.area(rings) - core.area(true_rings)) / sum(map(length, true_rings))
        assert abs(growth_mm) < 0.02, (stroke, growth_mm)
