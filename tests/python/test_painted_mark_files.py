"""Measurement files with painted marks: the accepted contents and the refusals."""

import json

import numpy as np
import pytest
from diagnostics import refused

from brushsvg import _core
from brushsvg.calibration.marks.mark_input import count_painted_depths, read_painted
from brushsvg.calibration.numbers.measurements import read_measurements
from brushsvg.errors import Error


def strokes():
    """Return a stroke with a corner and a straight stroke for each of two depths."""
    out = []
    for k, depth in enumerate((2.0, 4.0)):
        y = 40.0 * k
        out.append(
            (
                f"corner-{k}",
                [[20, 20 + y, 0], [30, 20 + y, -depth], [50, 20 + y, -depth], [50, 40 + y, -depth]],
            )
        )
        out.append((f"straight-{k}", [[90, 20 + y, 0], [100, 20 + y, -depth], [130, 20 + y, -depth]]))
    return out


def around(poses, grow=2.0):
    """Return a box around the path, as a rough mark."""
    xy = np.array(poses)[:, :2]
    (x0, y0), (x1, y1) = xy.min(axis=0) - grow, xy.max(axis=0) + grow
    return [[x0, y0], [x1, y0], [x1, y1], [x0, y1]]


def plan():
    return {"passes": [{"stroke": name, "poses_mm": poses, "speed_mm_s": 20} for name, poses in strokes()]}


def marks():
    return [{"stroke": name, "outline_mm": [around(poses)]} for name, poses in strokes()]


def scaled(by):
    by = np.array(by, float)
    return [{"stroke": m["stroke"], "outline_mm": [(np.array(m["outline_mm"][0]) * by).tolist()]} for m in marks()]


def test_marks_and_plan_can_be_inline():
    painted = read_painted(plan(), marks(), None)
    assert [mark.stroke for mark in painted.marks] == ["corner-0", "straight-0", "corner-1", "straight-1"]
    assert painted.deepest_mm == 4 and painted.depths >= 2
    np.testing.assert_allclose(_core.area(painted.marks[0].outline_mm), 34 * 24, rtol=1e-6)


def test_marks_and_plan_can_be_file_names():
    brush_less = _core.Plan("", "", (200.0, 200.0), [_core.Pass(n, np.array(p, float)) for n, p in strokes()])
    brush = _core.Brush()
    brush.depth_range_mm = (0.0, 10.0)
    brush.lag = _core.Profile([3.0])
    brush.tip_gap = brush.tip_to_widest = brush.half_width = _core.Profile([0.0, 0.5])
    square = [[0, 0], [4, -2], [4, 2]]
    brush.footprints = _core.FootprintTable([_core.Footprint(4.0, square)])
    done = _core.simulate(brush_less, brush)
    _core.trace_outlines(done, brush)
    files = {
        "plan.json": _core.write_plan(brush_less).encode(),
        "marks.json": _core.write_marks(done).encode(),
    }
    painted = read_painted("plan.json", "marks.json", files.__getitem__)
    assert len(painted.marks) == 4
    assert _core.overlap(painted.marks[2].outline_mm, done.passes[2].outline_mm) > 0.999


def test_depths_are_counted_only_on_painted_marks():
    def at(*depths):
        return np.array([[30.0 * k, 0, -d] for k, d in enumerate(depths)])

    assert count_painted_depths([at(3, 3)]) == 1
    assert count_painted_depths([at(3, 3), at(5, 5)]) == 2
    assert count_painted_depths([at(0, 0)]) == 0
    assert count_painted_depths([np.array([[0, 0, 0], [200, 0, -5.0]])]) > 4


def bent(mark, **changes):
    rows = marks()
    rows[mark] |= changes
    return rows


@pytest.mark.parametrize(
    ("plan_", "marks_", "where", "expected"),
    [
        (plan(), scaled([1e-3, 1e-3]), "marks", "marks-scaled metres"),
        (plan(), scaled([1 / 25.4, 1 / 25.4]), "marks", "marks-scaled inches"),
        (
            plan(),
            [m | {"outline_mm": [(np.array(m["outline_mm"][0]) * [1, -1] + [0, 120]).tolist()]} for m in marks()],
            "marks",
            "marks-displaced",
        ),
        (
            plan(),
            [m | {"outline_mm": marks()[(k + 1) % 4]["outline_mm"]} for k, m in enumerate(marks())],
            "marks[0]",
            "mark-off-stroke",
        ),
        (
            plan(),
            [*scaled([1, 1])[:1], {"stroke": "x", "outline_mm": []}],
            "marks[1]",
            "stroke-unknown 'x'",
        ),
        (
            plan(),
            [*scaled([1, 1])[:1], {"stroke": "x" * 5000, "outline_mm": []}],
            "marks[1]",
            f"stroke-unknown '{'x' * 60}'",
        ),
        (plan(), marks() + marks()[:1], "marks[4]", "stroke-twice"),
        (plan(), bent(1, outline_mm=[]), "marks[1]", "mark-empty"),
        (plan(), bent(1, outline_mm=[[[0, 0], [1, 1]]]), "marks[1].outline_mm[0]", "wrong-type"),
        (
            plan(),
            bent(1, outline_mm=[[[90, 20], [float("nan"), 20], [90, 25]]]),
            "marks[1].outline_mm[0]",
            "not-finite",
        ),
        (
            plan(),
            bent(1, outline_mm=[around(strokes()[1][1]), around(strokes()[1][1], 100.0)]),
            "marks[1].outline_mm[1]",
            "mark-too-large 200 60",
        ),
        (
            plan(),
            bent(1, outline_mm=[[[90, 20], [110, 20], [100, 20]]]),
            "marks[1]",
            "mark-empty 0 0.1",
        ),
        (
            plan(),
            bent(1, outline_mm=[[["90", 20], [110, 20], [100, 25]]]),
            "marks[1].outline_mm[0]",
            "wrong-type",
        ),
        (plan(), bent(1, colour="red"), "marks[1].colour", "key-unknown"),
        (plan(), [], "marks", "measurement-missing"),
        (None, marks(), "plan", "key-missing"),
        ({"passes": plan()["passes"] * 2}, marks(), "plan", "stroke-twice"),
        (
            {"passes": [p | {"settings": {"kind": "dab"}} for p in plan()["passes"]]},
            marks(),
            "plan",
            "dabs-tell-no-lag",
        ),
        (
            {"passes": [p for p in plan()["passes"] if "straight" in p["stroke"]]},
            [m for m in marks() if "straight" in m["stroke"]],
            "plan",
            "law-undetermined",
        ),
        (
            {
                "passes": [
                    {"stroke": n, "poses_mm": [[x, y, -3] for x, y, _ in p], "speed_mm_s": 20} for n, p in strokes()
                ]
            },
            marks(),
            "plan",
            "depths-too-few",
        ),
    ],
)
def test_invalid_painted_marks_are_refused(plan_, marks_, where, expected):
    with refused(expected, where):
        read_painted(plan_, marks_, None)


def test_an_invalid_plan_is_refused():
    with pytest.raises(Error):
        read_painted({"passes": [{"stroke": "a"}]}, marks(), None)


@pytest.mark.parametrize(
    ("keys", "where", "expected"),
    [
        ({"plan": "p.json"}, "plan", "measurements-mixed"),
        ({"marks": [], "lag": [{"depth_mm": 3, "value_mm": 7}]}, "lag", "measurements-mixed"),
        ({"marks": [], "expected": {"weather": 1}}, "expected.weather", "key-unknown placement_mm"),
        ({"marks": [], "expected": {"height_mm": -1}}, "expected.height_mm", "out-of-range 0 30"),
    ],
)
def test_invalid_measurement_files_are_refused(keys, where, expected):
    head = {"format": "brushsvg/measurements", "version": 1}
    with refused(expected, where):
        read_measurements(json.dumps(head | keys).encode(), ".json")


@pytest.mark.parametrize(
    ("moved", "expected"),
    [
        (lambda p: [200, 200] - p, "marks-displaced 180"),
        (lambda p: p[:, ::-1] * [-1, 1] + [200, 0], "marks-displaced 90 counter-clockwise"),
        (lambda p: p[:, ::-1] * [1, -1] + [0, 200], "marks-displaced 90 clockwise"),
        (lambda p: p * [-1, 1] + [200, 0], "marks-displaced"),
        (lambda p: p[:, ::-1], "marks-displaced"),
        (lambda p: p * 96 / 25.4, "marks-scaled 3.78"),
        (lambda p: p - [100, 100], "marks-displaced 141"),
    ],
)
def test_a_displaced_sheet_is_reported_with_its_displacement(moved, expected):
    """A sheet in another place gets one report, with its displacement.

    Instead, each of these sheets was once queried for the ids of its strokes.
    """
    shift = {"far": [0.0, 90.0, 0.0], "right": [40.0, 130.0, 0.0]}
    more = [(name, (np.array(strokes()[0][1]) + by).tolist()) for name, by in shift.items()]
    every = [*strokes(), *more]
    plan_ = {"passes": [{"stroke": name, "poses_mm": poses, "speed_mm_s": 20} for name, poses in every]}
    rows = [{"stroke": name, "outline_mm": [moved(np.array(around(poses))).tolist()]} for name, poses in every]
    with refused(expected, "marks"):
        read_painted(plan_, rows, None)


def test_a_very_long_path_is_shortened_in_the_message():
    def read(path):
        raise Error("the file cannot be read: its name is too long", code="file-unreadable")

    for plan_, marks_ in ((plan(), "a" * 5000), ("a" * 5000, marks())):
        with pytest.raises(Error) as refusal:
            read_painted(plan_, marks_, read)
        assert refusal.value.code == "file-unreadable" and len(str(refusal.value)) < 400
