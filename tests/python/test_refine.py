"""`--compensation refined` is wired in and is never worse than closed form.

Strokes refined side by side equal strokes refined alone. The C++ tests measure the quality of the results.
"""

import os
import signal
import threading

import numpy as np
import pytest
import shapely
from diagnostics import refused
from small_drawings import gains, line, overlaps

from brushsvg import _core, cli, find_brush

BRUSH = find_brush("round-6")
SHEET = (120.0, 120.0)


def curves(count: int, seed: int = 3) -> list:
    random = np.random.default_rng(seed)
    made = []
    for k in range(count):
        middle = random.uniform(30, 90, (1, 8))
        widths = [(at, random.uniform(0.8, 3.0)) for at in (0.0, 0.5, 1.0)]
        made.append(_core.Stroke(f"s{k}", middle, False, widths))
    return made


@pytest.mark.slow
def test_refined_plans_are_never_worse_and_better_on_average():
    strokes = curves(10)
    closed, refined = overlaps(strokes, BRUSH, "closed"), overlaps(strokes, BRUSH, "refined")
    assert (refined >= closed).all()
    assert refined.mean() > closed.mean() + 0.005


@pytest.mark.slow
def test_refined_plans_are_never_worse_on_small_drawings():
    won = gains(24, 5, BRUSH)  # tests/integration runs more drawings
    assert won.min() >= 0.0
    assert won.mean() > 0.02


def with_teeth(stroke):
    """Return the stroke with a target that has a zigzag along its edge.

    The target is as ragged as pieces from which other strokes were cut. Every mark turns less than this
    target.
    """
    rim = np.array(shapely.Polygon(_core.target_outline(stroke, 0.01)[0]).exterior.segmentize(0.4).coords)[:-1]
    outwards = np.roll(rim, 1, axis=0) - np.roll(rim, -1, axis=0)
    outwards = outwards[:, ::-1] * (-1, 1) / np.linalg.norm(outwards, axis=1)[:, None]
    ragged = shapely.Polygon(rim + 0.25 * (-1) ** np.arange(len(rim))[:, None] * outwards).buffer(0)
    whole = max(shapely.get_parts(ragged), key=shapely.area)
    return stroke.replaced(target_mm=[np.array(shapely.Polygon(whole.exterior).normalize().exterior.coords)[-2::-1]])


def looks(stroke, method: str) -> tuple[float, float, int]:
    """Return the overlap, the excess turning and the number of thorns of the mark."""
    plan = _core.compensate([stroke], BRUSH, SHEET, method, start="auto", end="auto").plan
    marks = _core.simulate(plan, BRUSH)
    _core.trace_outlines(marks, BRUSH)
    target = _core.target_outline(stroke, 0.01)
    overlap = _core.common_area(marks.passes, [stroke], BRUSH).overlap
    mark = marks.outline_mm
    return overlap, _core.excess_turning(mark, target), _core.thorns(mark, target)


@pytest.mark.slow
@pytest.mark.parametrize("seen", [lambda stroke: stroke, with_teeth])
def test_extra_turning_or_thorns_need_a_gain_of_overlap(seen):
    strokes = [seen(stroke) for stroke in curves(12, 8)]
    closed, refined = (np.array([looks(each, way) for each in strokes]) for way in ("closed", "refined"))
    won = refined - closed
    assert (won[:, 0] >= 0.1 * won[:, 1] + 0.02 * won[:, 2] - 1e-9).all()
    assert (won[:, 0] > 0.0).sum() >= 3


def test_an_exposed_start_may_be_pointed():
    """An exposed beginning may be pointed.

    The point sticks out of the round end and covers it. In closed form, the overlap is 0.964.
    """
    bar = [_core.Stroke("bar", line([(20, 50), (60, 50)]), half_width=[(0.0, 2.5)])]
    closed, refined = overlaps(bar, BRUSH, "closed"), overlaps(bar, BRUSH, "refined")
    assert refined > closed + 0.005


def test_a_corner_with_almost_equal_alternatives_keeps_its_plan():
    """A corner with almost equal alternatives keeps its plan.

    Refinement once used another measure than the report. It kept a plan with 0.971, although the closed form
    has 0.972.
    """
    corner = [_core.Stroke("corner", line([(20, 50), (60, 50), (60, 60)]), half_width=[(0.0, 1.5)])]
    assert overlaps(corner, BRUSH, "refined") >= overlaps(corner, BRUSH, "closed")


@pytest.mark.slow
def test_parallel_refinement_equals_refinement_one_by_one():
    strokes = curves(19)
    together = _core.compensate(strokes, BRUSH, SHEET, "refined")
    for stroke, a_pass, miss in zip(strokes, together.plan.passes, together.tracking_errors, strict=True):
        alone = _core.compensate([stroke], BRUSH, SHEET, "refined")
        assert a_pass.stroke == stroke.id
        assert np.array_equal(a_pass.poses_mm, alone.plan.passes[0].poses_mm)
        assert miss.largest_mm == alone.tracking_errors[0].largest_mm


def test_progress_reports_the_number_of_strokes():
    seen = []
    _core.compensate(curves(9), BRUSH, SHEET, "refined", progress=lambda now, all_: seen.append((now, all_)))
    assert seen == [(8, 9), (9, 9)]


def test_a_refusal_names_the_first_impossible_stroke():
    strokes = curves(6)
    strokes[2].half_width = strokes[4].half_width = [(0.0, 40.0)]
    with refused("width-out-of-reach 80.000", "s2"):
        _core.compensate(strokes, BRUSH, SHEET, "refined")


def test_ctrl_c_interrupts_refinement():
    before = signal.signal(signal.SIGINT, signal.default_int_handler)  # a background job ignores SIGINT
    timer = threading.Timer(0.3, os.kill, (os.getpid(), signal.SIGINT))
    timer.start()
    try:
        with pytest.raises(KeyboardInterrupt):
            _core.compensate(curves(40) * 100, BRUSH, SHEET, "refined")
    finally:
        timer.cancel()
        signal.signal(signal.SIGINT, before)


def test_an_unknown_compensation_is_refused():
    with refused("choice-unknown none constant closed refined"):
        _core.compensate(curves(1), BRUSH, SHEET, "best")


@pytest.mark.slow
def test_the_command_line_refines_reproducibly(tmp_path, capsys):
    drawing = tmp_path / "curve.svg"
    drawing.write_text(
        '<svg xmlns="http://www.w3.org/2000/svg" width="100mm" height="100mm" viewBox="0 0 100 100">'
        '<path d="M20 30C40 20 60 40 70 70" fill="none" stroke="#000" stroke-width="4"/></svg>'
    )
    programs = [tmp_path / f"{k}.ngc" for k in range(2)]
    for program in programs:
        assert cli.main(["convert", str(drawing), "-o", str(program), "--compensation", "refined"]) == 0
    assert programs[0].read_bytes() == programs[1].read_bytes()
    assert b"compensation: refined" in programs[0].read_bytes()
    capsys.readouterr()
    for name in ("p.svg", "a.html"):
        assert cli.main(["preview", str(drawing), "-o", str(tmp_path / name), "--compensation", "refined"]) == 0
    assert cli.main(["preview", str(drawing), "--compensation", "refined", "--details"]) == 0
    assert "compensation refined" in capsys.readouterr().out
    # Check compares the program with the drawing in the same mode.
    assert cli.main(["check", str(programs[0]), str(drawing)]) == 0
