"""A painted word updates its brush.

The true brush differs from its file. A separate simulator paints in small steps, and the renderer has its own
camera model.
"""

import json
from dataclasses import replace

import numpy as np
import painter
import photograph
import pytest
from diagnostics import in_json, is_reported
from numpy.polynomial.polynomial import polyfit, polyval
from photograph import BLUE, INK, Camera

core = pytest.importorskip("brushsvg._core")
if not hasattr(core, "fit_marks"):
    pytest.skip("built without Ceres", allow_module_level=True)

from brushsvg import find_brush  # noqa: E402
from brushsvg.calibration.marks.from_marks import brush_of  # noqa: E402
from brushsvg.calibration.prior import update_report  # noqa: E402
from brushsvg.calibration.prior.from_prior import marks_with_prior, update_brush  # noqa: E402
from brushsvg.cli import main  # noqa: E402
from brushsvg.comparison import learned_brush  # noqa: E402
from brushsvg.comparison.job_marks import job_marks  # noqa: E402
from brushsvg.comparison.job_page import job_page  # noqa: E402
from brushsvg.jobs.json_files import read_plan  # noqa: E402
from brushsvg.model.confidence import LAWS, law_band  # noqa: E402
from brushsvg.model.library import brush_like, save_brush  # noqa: E402

HEAD = """<svg xmlns="http://www.w3.org/2000/svg" width="150mm" height="90mm" viewBox="0 0 150 90">
<title>word</title><g fill="none" stroke="#000" stroke-linecap="round">"""
WORD = """<path id="bow" d="M14 34 C24 8 48 8 56 32" stroke-width="5"/>
<path id="line" d="M14 78 L60 74" stroke-width="3"/>
<path id="wave" d="M72 76 C84 56 96 92 110 72 S128 66 132 76" stroke-width="2.5"/>
<path id="hook" d="M70 12 L98 12 C106 12 106 34 92 34 L78 34" stroke-width="4"/>
<path id="loop" d="M34 46 a9 9 0 1 1 -0.01 0" stroke-width="2"/>
<path id="knee" d="M70 48 L94 48 L112 24" stroke-width="5.5"/>"""
ONE_DEPTH = """<path id="bow" d="M14 34 C24 8 48 8 56 32" stroke-width="4"/>
<path id="hook" d="M70 12 L98 12 C106 12 106 34 92 34 L78 34" stroke-width="4"/>
<path id="knee" d="M70 48 L94 48 L112 24" stroke-width="4"/><path id="line" d="M14 78 L60 74" stroke-width="4"/>"""
BARS = "".join(f'<path id="bar-{k}" d="M20 {20 * k} L{80 + 10 * k} {20 * k}" stroke-width="4"/>' for k in (1, 2, 3, 4))
CAMERA = Camera(size_px=(1800, 1170), fill=0.95)
DISPLACED = Camera(size_px=(1800, 1170), tilt_deg=(-6.0, 5.0), fill=0.9)
FAULTS = painter.Faults(noise=0.05, noise_length=0.5, displacement=0.2, placement=0.6, turn=0.006, height=0.15)
LAG, GAP, HALF = np.array([2.6, 1.3, 0.1, -0.009]), np.array([0.0, 0.45]), np.array([0.0, 0.5, -0.005])
WIDEST, FRONT, DEEPEST = 1.6, 0.95, 10.0
DEPTHS = np.linspace(1, DEEPEST, 10)


def known_brush(sure):
    """Return the brush of its file.

    Each number is known to a share `sure` of its value (standard deviation).
    """
    laws = core.MarkLaws(LAG.tolist(), GAP.tolist(), HALF.tolist(), WIDEST, FRONT)
    numbers = np.array([*LAG, GAP[1], *HALF[1:], WIDEST, FRONT, 1e-9, 1e-9, 1e-9, 1e-9])
    covariance = np.diag((sure * numbers) ** 2)
    covariance[0, 5] = covariance[5, 0] = 0.3 * np.sqrt(covariance[0, 0] * covariance[5, 5])
    brush = brush_of(laws, "mine", (0.0, DEEPEST), covariance)
    brush.max_speed_mm_s = 25.0
    return brush


class Studio:
    """A folder with a drawing, a brush file, the plan and a photograph.

    The photograph shows the drawing, painted by another brush.
    """

    def __init__(self, folder, drawing=WORD, sure=0.08):
        self.folder = folder
        save_brush(known_brush(sure), folder / "mine.json")
        (folder / "word.svg").write_text(HEAD + drawing + "</g></svg>")
        self.convert("word.json")

    def convert(self, name, *flags):
        words = [
            "convert",
            self.folder / "word.svg",
            "-o",
            self.folder / name,
            "--brush",
            self.folder / "mine.json",
        ]
        assert main([*map(str, [*words, "--quiet", *flags])]) == 0
        return name

    def paint(self, seed, truth, plan="word.json", photo="photo.jpg", faults=FAULTS):
        plan = read_plan(self.folder / plan)
        strokes = [(one.stroke, painter.dense(np.array(one.poses_mm), one.arcs)) for one in plan.passes]
        painted = painter.paint(np.random.default_rng(seed), truth, strokes, faults)
        page = job_page(plan)
        sheet = photograph.page(page.printed)
        for tick in page.ticks:
            sheet.paint([tick], INK)
        for _, _, rings in painted.marks:
            sheet.paint([ring + page.frame_mm for ring in rings], BLUE)
        for name, camera in ((photo, CAMERA), (f"aside-{photo}", DISPLACED)):
            (self.folder / name).write_bytes(photograph.photograph(sheet, camera))

    def words(self, out="mine-2.json", photo="photo.jpg", plan="word.json", prior="mine.json"):
        files = [self.folder / name for name in (photo, plan, prior, out)]
        words = ("calibrate", "--force", files[0], "--plan", files[1], "--prior", files[2], "-o", files[3])
        return tuple(map(str, words))

    def brush(self, name="mine-2.json"):
        return find_brush(self.folder / name)


def true_brush(lag=1.0, half=1.0):
    return painter.TrueBrush(DEEPEST, lag * LAG, GAP, half * HALF, WIDEST, FRONT)


def deepest(plan):
    return max(float(-np.array(one.poses_mm)[:, 2].min()) for one in plan.passes)


# {seed: (true brush, relative accuracy of the file)}. The second brush is five standard deviations from its
# file.
STUDIOS = {1: (true_brush(1.18, 0.9), 0.08), 2: (true_brush(0.83, 0.86), 0.03)}


@pytest.fixture(scope="module", params=[1, pytest.param(2, marks=pytest.mark.thorough)])
def learnt(request, tmp_path_factory):
    truth, sure = STUDIOS[request.param]
    studio = Studio(tmp_path_factory.mktemp("studio"), sure=sure)
    studio.paint(request.param, truth)
    assert main([*studio.words(), "--quiet"]) == 0
    return studio, truth


def test_a_painted_word_improves_the_brush(learnt):
    studio, truth = learnt
    depths = np.linspace(1, deepest(read_plan(studio.folder / "word.json")), 10)
    before, now = studio.brush("mine.json"), studio.brush()
    for law in ("lag", "half_width"):
        true = truth.law(law)(depths)
        off = [np.abs(np.array([getattr(each, law)(d) for d in depths]) / true - 1).mean() for each in (before, now)]
        assert off[1] < 0.2 * off[0] and off[1] < 0.03, (law, off)
        values = np.array([getattr(now, law)(d) for d in depths])
        band = law_band(now, law, depths)[0]
        assert np.mean(np.abs(values - true) <= band) > 0.7, (law, values - true, band)
        assert np.all(band < 0.1 * true), law


def test_a_photograph_given_twice_is_refused(learnt, capsys):
    studio, _ = learnt
    status, _, reported = in_json(capsys, *studio.words("mine-3.json", prior="mine-2.json"))
    assert status == 1 and is_reported(reported, "photo-learned-twice mine-2"), reported
    assert not (studio.folder / "mine-3.json").exists()


def test_marks_with_less_information_than_the_prior_keep_the_brush(tmp_path, capsys):
    studio = Studio(tmp_path, BARS, 0.004)
    studio.paint(3, true_brush())
    assert in_json(capsys, *studio.words())[0] == 0
    before, now = studio.brush("mine.json"), studio.brush()
    assert np.array_equal(now.covariance, before.covariance)
    for law in LAWS:
        assert getattr(now, law).coefficients == getattr(before, law).coefficients
        assert law_band(now, law, DEPTHS)[0] == pytest.approx(law_band(before, law, DEPTHS)[0])


def test_one_depth_gives_little_information_about_others(tmp_path, capsys):
    """One depth shows little of other depths.

    Marks at one depth and above leave the values far below uncertain. The intervals there still contain the
    truth.
    """
    studio = Studio(tmp_path, ONE_DEPTH, 0.08)
    studio.paint(3, true_brush(1.06, 0.96))
    assert in_json(capsys, *studio.words())[0] == 0
    before, now = studio.brush("mine.json"), studio.brush()
    for law in ("lag", "half_width"):
        was, is_now = (law_band(each, law, DEPTHS)[0] for each in (before, now))
        true = true_brush(1.06, 0.96).law(law)(DEPTHS)
        off = np.abs([getattr(now, law)(d) for d in DEPTHS] - true)
        assert np.all(off < is_now), (law, off, is_now)
        assert is_now[3] < 0.6 * was[3] and is_now[-1] > 2 * is_now[3], (law, was, is_now)


def updated_by_arcs(known, depth, lag, half):
    """Return a brush, updated by arcs and corners down to a depth [mm]. lag, half: true laws [mm], ascending powers."""
    truth = painter.TrueBrush(known.depth_range_mm[1], lag, GAP, half, WIDEST, FRONT)
    strokes = [(name, poses) for name, poses in painter.chart_strokes(depth, 3) if name.startswith(("arc", "angular"))]
    sheet = painter.paint(np.random.default_rng(1), truth, strokes, FAULTS)
    rings = {name: outline for name, _, outline in sheet.marks}
    marks = [core.PaintedMark(name, poses, rings[name]) for name, poses in strokes]
    return update_brush(marks_with_prior(marks), known, "own")


def test_a_width_that_bends_at_shallow_depths_does_not_fall_at_greater_ones():
    """Marks down to 2 mm, whose width bends as strongly as it can, update a brush of 5 mm."""
    known, depth = find_brush("liner-1"), 2.0
    half = known.half_width(depth) * np.array([0.0, 2 / depth, -0.7 / depth**2]) / 1.3
    updated = updated_by_arcs(known, depth, np.array([11.0, 1.0]), half)
    assert updated.is_learned("half_width")
    depths = np.linspace(0.2, 5.0, 25)
    law = np.array([updated.brush.half_width(d) for d in depths])
    assert np.all(np.diff(law) > -1e-9)


def test_a_lag_that_falls_beyond_the_painted_depths_is_a_reservation():
    """Marks down to 3 mm, whose lag bends there, update a brush of 5 mm. Its lag then falls at greater depths."""
    known = find_brush("liner-1")
    half = np.array([0.0, *known.half_width.coefficients[1:]])
    bent = known.lag(3.0) * np.array([0.3, 1.4 / 3.0, -0.7 / 3.0**2])
    updated = updated_by_arcs(known, 3.0, bent, half)
    (remark,) = [each for each in core.remarks(updated.brush) if each.code == "law-falls"]
    depths = np.linspace(*updated.brush.depth_range_mm, 401)
    highest = depths[np.argmax(updated.brush.lag(depths))]
    assert f"{highest:.2f} to 5.00 mm" in remark.sentence
    assert update_report.report(updated).verdict.startswith(f"usable, but {remark.sentence}")
    straight = updated_by_arcs(known, 3.0, np.array(known.lag.coefficients), half)
    assert update_report.report(straight).verdict == "good"


@pytest.mark.parametrize(
    ("kind", "factor", "measured_mm"), [("known", 1.0, (1, 10)), ("known", 1.3, (0, 5)), ("assumed", 1.0, (0, 5))]
)
def test_a_prior_that_was_not_measured_or_is_contradicted_supports_no_depths(kind, factor, measured_mm):
    """Marks down to 5 mm update a brush whose lag was measured from 1 to 10 mm, or only taken from such a brush."""
    known = find_brush("round-6") if kind == "known" else brush_like("own", find_brush("round-6"))
    lag = polyfit(DEPTHS, [known.lag(d) for d in DEPTHS], 3)
    half = np.array([0.0, *polyfit(DEPTHS, [known.half_width(d) / d for d in DEPTHS], 1)])
    updated = updated_by_arcs(known, 5.0, factor * lag, half)
    assert updated.is_learned("lag") and (updated.wider.get("lag", 1.0) > 1.0) == (factor > 1.0)
    assert updated.brush.lag.calibrated_mm == pytest.approx(measured_mm)


def test_a_photograph_of_another_job_is_refused(tmp_path, capsys):
    studio = Studio(tmp_path)
    studio.paint(4, true_brush())
    (tmp_path / "other.svg").write_text((HEAD + WORD + "</g></svg>").replace("M14 34", "M15 34"))
    words = [
        "convert",
        tmp_path / "other.svg",
        "-o",
        tmp_path / "other.json",
        "--brush",
        tmp_path / "mine.json",
    ]
    assert main([*map(str, words), "--quiet"]) == 0
    status, _, reported = in_json(capsys, *studio.words(plan="other.json"))
    assert status == 1 and is_reported(reported, "photo-of-another-chart"), reported
    assert main([*studio.words(), "--chart", "chart.json"]) == 2
    assert main([*studio.words()[:4], "-o", str(tmp_path / "out.json")]) == 2
    assert not (tmp_path / "mine-2.json").exists()


def test_strokes_that_share_paint_are_left_out_and_named(tmp_path, capsys):
    studio = Studio(tmp_path, WORD + '<path id="slash" d="M20 84 L44 66" stroke-width="3"/>')
    studio.paint(5, true_brush(1.05, 0.95))
    status, _, reported = in_json(capsys, *studio.words())
    assert status == 0
    named = sorted(notice.where for _, notice in reported if notice.code == "marks-touch")
    assert named == ["line", "slash"], reported
    brush = studio.brush()
    assert abs(brush.lag(4.0) / (1.05 * polyval(4.0, LAG)) - 1) < 0.03


@pytest.mark.thorough
def test_a_second_pass_without_single_strokes_keeps_the_first_result(tmp_path, capsys, monkeypatch):
    studio = Studio(tmp_path, WORD + '<path id="slash" d="M20 84 L44 66" stroke-width="3"/>')
    studio.paint(5, true_brush(1.05, 0.95))
    looks = []

    def seen_once(*of):
        looks.append(job_marks(*of))
        return replace(looks[0], rings={} if looks[1:] else looks[0].rings)

    monkeypatch.setattr(learned_brush, "job_marks", seen_once)
    assert in_json(capsys, *studio.words())[0] == 0 and len(looks) == 2
    assert abs(studio.brush().lag(4.0) / (1.05 * polyval(4.0, LAG)) - 1) < 0.03


@pytest.mark.thorough
def test_the_plan_of_a_corrected_word_contains_the_tool_path(tmp_path, capsys):
    studio = Studio(tmp_path)
    shift = [
        {
            "stroke": one.stroke,
            "correction": {
                "start_mm": np.array(one.poses_mm)[0, :2].tolist(),
                "middle_mm": [75.0, 45.0],
                "shift_mm": [1.5 * (-1) ** k, 1.0],
                "turn_deg": 0.0,
            },
        }
        for k, one in enumerate(read_plan(tmp_path / "word.json").passes)
    ]
    (tmp_path / "c.json").write_text(json.dumps({"format": "brushsvg/comparison", "version": 1, "strokes": shift}))
    plan = studio.convert("led.json", "--corrections", str(tmp_path / "c.json"))
    truth = true_brush(1.15, 0.9)
    studio.paint(6, truth, plan)
    words = studio.words(plan=plan)
    assert in_json(capsys, *words[:2], tmp_path / "aside-photo.jpg", *words[2:])[0] == 0
    assert abs(studio.brush().lag(4.0) / truth.law("lag")(4.0) - 1) < 0.03
