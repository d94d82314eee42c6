"""Every number of every measurement file is replaced by an impossible value.

Each time, the result must be a message with file, element and number, and no brush.
"""

import json
import re
import warnings

import numpy as np
import pytest
from sampling import sample

from brushsvg import _core, find_brush
from brushsvg.calibration.chart.file import read_chart, write_chart
from brushsvg.calibration.chart.layout import chart
from brushsvg.cli import main
from brushsvg.errors import Error

HEAD = {"format": "brushsvg/measurements", "version": 1}
DEPTHS = (2.0, 4.0, 6.0, 8.0, 10.0)
ROUND = find_brush("round-6")
GONE = object()  # the key or the item is missing
# Values that no number of these files can have. Python's json reads and writes NaN and Infinity.
NEVER = {
    "1e9": 1e9,
    "1e308": 1e308,
    "NaN": float("nan"),
    "Infinity": float("inf"),
    "10**400": 10**400,
    "text": "7",
    "null": None,
    "true": True,
    "[]": [],
    "{}": {},
    "many": [1.0] * 20000,
}
SENTENCE = re.compile(r"brushsvg: \S+: [^\n]{20,300}\n")


def rows(law, times=1.0):
    return [{"depth_mm": d, "value_mm": times * float(law(d))} for d in DEPTHS]


def drag(depth):
    s = np.array([2.0, 4.0, 7.0])
    alpha = np.degrees(2 * np.arctan(np.exp(-s / float(ROUND.lag(depth)))))
    beta = [137.8, 120.0, 89.1]
    return {
        "depth_mm": depth,
        "alpha0_deg": 90.0,
        "s_mm": s.tolist(),
        "alpha_deg": alpha.tolist(),
        "beta_deg": beta,
    }


def line(depth):
    s = np.linspace(0, 2.5, 12) * float(ROUND.lag(depth))
    turning = float(ROUND.lag(depth) - ROUND.tip_to_widest(depth) + ROUND.tip_gap(depth))
    after = s / float(ROUND.lag(depth))
    points = np.column_stack([s - turning * np.tanh(after), -turning / np.cosh(after)])
    return {"depth_mm": depth, "points_mm": points.tolist()}


FERRULE = np.array([[0.0, 100.0], *([10.0 * d, 100.0 - d] for d in DEPTHS)])
TIP = FERRULE * [1.0, 0.0] - np.array([[0.0, 0.0], *([ROUND.lag(d) + 0.52 * d - 3.1, 0.0] for d in DEPTHS)])
WIDTHS = {"width": rows(ROUND.half_width, 2.0)}
LAG = {"lag": rows(ROUND.lag)}
ABOUT = {"depth_range_mm": [0.0, 10.0], "max_speed_mm_s": 25.0}
MEASURED = {
    "values": HEAD | ABOUT | LAG | WIDTHS,
    "angles": HEAD | {"angles": [drag(d) for d in DEPTHS]} | WIDTHS,
    "sums": HEAD
    | WIDTHS
    | {"tip_gap": rows(ROUND.tip_gap), "tip_to_widest": rows(ROUND.tip_to_widest)}
    | {"straight": [{"depth_mm": d, "path_mm": 60.0, "distance_mm": 60.0 - float(ROUND.lag(d))} for d in DEPTHS]},
    "lines": HEAD
    | WIDTHS
    | {"tip_to_widest": rows(ROUND.tip_to_widest), "centre_line": [line(d) for d in DEPTHS]}
    | {"video": [{"ferrule_mm": FERRULE.tolist(), "tip_mm": TIP.tolist(), "touch": 0}]},
}


def painted():
    """Return marks of two depths, each with a corner and a straight stroke.

    The outline of each mark is a box around the stroke.
    """
    passes, marks = [], []
    for k, depth in enumerate((2.0, 4.0)):
        y = 40.0 * k
        for name, points in (
            ("corner", [[20, 20, 0], [30, 20, -depth], [50, 20, -depth], [50, 40, -depth]]),
            ("straight", [[90, 20, 0], [100, 20, -depth], [130, 20, -depth]]),
        ):
            poses = np.add(points, [0.0, y, 0.0])
            (x0, y0), (x1, y1) = poses[:, :2].min(axis=0) - 2, poses[:, :2].max(axis=0) + 2
            passes.append({"stroke": f"{name}-{k}", "poses_mm": poses.tolist(), "speed_mm_s": 20.0})
            marks.append({"stroke": f"{name}-{k}", "outline_mm": [[[x0, y0], [x1, y0], [x1, y1], [x0, y1]]]})
    return HEAD | {
        "depth_range_mm": [0.0, 4.0],
        "max_speed_mm_s": 25.0,
        "plan": {"passes": passes, "sheet_mm": [210.0, 297.0]},
        "marks": marks,
        "expected": {"placement_mm": 2.0, "turn_deg": 1.0, "displacement_mm": 1.0, "height_mm": 0.3},
    }


def places(value, path=()):
    """Yield the paths of all numbers.

    In a list, the first two items and the last one stand for the others.
    """
    if isinstance(value, dict):
        for key, each in value.items():
            yield from places(each, (*path, key))
    elif isinstance(value, list):
        for k in sorted({0, 1, len(value) - 1} & set(range(len(value)))):
            yield from places(value[k], (*path, k))
    elif isinstance(value, int | float):
        yield path


def changed(content, path, value):
    key, *rest = path
    out = content.copy()
    if rest:
        out[key] = changed(content[key], rest, value)
    elif value is GONE:
        del out[key]
    else:
        out[key] = value
    return out


def reported(path):
    return "".join(f"[{key}]" if isinstance(key, int) else f".{key}" for key in path).lstrip(".")


@pytest.fixture
def calibrated(tmp_path, capsys, monkeypatch):
    """Return a function for the refusal that `brushsvg calibrate` prints for a file.

    The function takes the content and the suffix of a file. It returns None if calibrate accepts the content.
    Fitting marks would take seconds, so content that gets as far as the fit counts as accepted.
    """

    def fitted(*_):
        raise Error("so far, so good")

    monkeypatch.setattr(_core, "fit_marks", fitted)

    def run(text, suffix="json"):
        (tmp_path / f"m.{suffix}").write_text(text)
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            status = main(["calibrate", str(tmp_path / f"m.{suffix}"), "-o", str(tmp_path / "b.json")])
        message = capsys.readouterr().err
        if status == 0 or "so far, so good" in message:
            (tmp_path / "b.json").unlink(missing_ok=True)
            return None
        assert status == 1 and SENTENCE.fullmatch(message) and f"m.{suffix}: " in message, message
        assert not (tmp_path / "b.json").exists()
        return message

    return run


@sample(
    ("name", "path"),
    [(name, path) for name, content in MEASURED.items() for path in places(content)]
    + [("painted", path) for path in places(painted())],
    ids=lambda each: reported(each) if isinstance(each, tuple) else each,
    keep=45,
)
def test_each_measurement_value_has_a_physical_range(name, path, calibrated):
    content = painted() if name == "painted" else MEASURED[name]
    assert calibrated(json.dumps(content)) is None
    taken = [words for words, value in NEVER.items() if not calibrated(json.dumps(changed(content, path, value)))]
    assert taken == []


@pytest.mark.parametrize(
    ("path", "value"),
    [
        (("max_speed_mm_s",), 0),
        (("max_speed_mm_s",), -1),
        (("depth_range_mm", 0), -1),
        (("depth_range_mm", 1), 0),
        (("plan", "passes", 0, "speed_mm_s"), 0),
        (("plan", "passes", 0, "poses_mm", 0, 2), 1),
        (("plan", "passes", 0, "poses_mm", 0, 1), GONE),
        (("plan", "sheet_mm", 0), 0),
        (("marks", 0, "outline_mm", 0, 0, 1), GONE),
        (("expected", "turn_deg"), -1),
    ],
    ids=lambda each: reported(each) if isinstance(each, tuple) else "gone" if each is GONE else None,
)
def test_values_just_out_of_range_are_refused_before_marks_are_fitted(path, value, calibrated):
    assert calibrated(json.dumps(changed(painted(), path, value)))


@pytest.mark.parametrize(
    ("name", "path", "value"),
    [
        *(("values", ("lag", 1, key), value) for key in ("depth_mm", "value_mm") for value in (0, -1, GONE)),
        *(("values", ("width", 0, "depth_mm"), value) for value in (0, -1, GONE)),
        *(("values", ("width", 0, "value_mm"), value) for value in (-1, GONE)),
        *(("angles", ("angles", 1, "s_mm", 0), value) for value in (-1, GONE)),
        *(("angles", ("angles", 1, "beta_deg", 0), value) for value in (0, -1, 180, GONE)),
        *(("angles", ("angles", 1, "alpha_deg", 0), value) for value in (361, GONE)),
        *(("angles", ("angles", 1, "alpha0_deg"), value) for value in (0, -1, 180, GONE)),
        *(("sums", ("straight", 1, "path_mm"), value) for value in (0, -1, GONE)),
        *(("sums", ("straight", 1, "distance_mm"), value) for value in (-1000, GONE)),
    ],
    ids=lambda each: reported(each) if isinstance(each, tuple) else "gone" if each is GONE else str(each),
)
def test_values_just_out_of_range_are_refused(name, path, value, calibrated):
    assert calibrated(json.dumps(changed(MEASURED[name], path, value)))


CELLS = ["1e9", "1e308", "1e400", "nan", "inf", "", "null", "seven", "--", "0x10", "1_0", "[]", "9" * 5000]


@pytest.mark.parametrize("column", ["depth_mm", "value_mm"])
def test_each_table_value_has_a_physical_range(column, calibrated):
    def table(cell):
        lines = [("lag", d, f"{ROUND.lag(d):.3f}") for d in DEPTHS]
        lines += [("width", d, f"{2 * ROUND.half_width(d):.3f}") for d in DEPTHS]
        kind, depth, value = lines[1]
        lines[1] = (kind, cell or depth, value) if column == "depth_mm" else (kind, depth, cell or value)
        return "kind,depth_mm,value_mm\n" + "".join(f"{a},{b},{c}\n" for a, b, c in lines)

    assert calibrated(table(None), "csv") is None
    cells = [*CELLS, "0", "-1"]
    assert [cell for cell in cells if not calibrated(table(cell or " "), "csv")] == []


# The chart ------------------------------------------------------------------------------------------

CHART = json.loads(write_chart(chart(ROUND, (148.0, 210.0), "few")))


@pytest.mark.slow
@sample(
    "path",
    [
        path
        for path in places({key: value for key, value in CHART.items() if key != "plan"})
        if not {2, 3} & set(path[:-1])
    ]
    + [("plan", "sheet_mm", 0), ("plan", "passes", 0, "poses_mm", 0, 2), ("plan", "passes", 0, "speed_mm_s")],
    ids=reported,
    keep=15,
)
def test_each_chart_value_has_a_physical_range(path):
    read_chart(json.dumps(CHART).encode())
    taken = []
    for words, value in [*NEVER.items(), ("-1", -1), ("gone", GONE)]:
        if path[-1] == "speed_mm_s" and value is GONE:
            continue  # a missing speed has a default
        try:
            read_chart(json.dumps(changed(CHART, path, value)).encode())
        except Error as refusal:
            reported_where = refusal.where.split("[")[0].split(".")[0]
            assert reported_where in (str(path[0]), "sheet_mm"), (words, refusal.where)
            assert 10 < len(str(refusal)) < 200
        else:
            if not (path[0] == "plan" and path[-1] == 2 and value == -1):
                taken.append(words)
    assert taken == []


def test_a_chart_given_as_a_plan_is_refused_with_its_name(calibrated, tmp_path):
    (tmp_path / "chart.json").write_text(json.dumps(CHART))
    for given in ("chart.json", CHART):
        message = calibrated(json.dumps(painted() | {"plan": given}))
        assert "plan" in message and "brushsvg/chart" in message, message
    assert "brushsvg/chart" in calibrated(json.dumps(CHART))
