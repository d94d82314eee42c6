"""The method of section 4 of the article gives back all laws in one fit.

It uses footprints, then angular strokes by their centre lines or pictures, then straight strokes or a video
from the side. The slow stepping simulator makes the marks.
"""

import json
from pathlib import Path

import cv2
import numpy as np
import painter
import pytest
from diagnostics import refused
from test_calibration import DEPTHS, GAP, WIDTHS, corner, from_dict, lag, values, widest

import brushsvg
from brushsvg import find_brush
from brushsvg.calibration.numbers.centre_lines import middle_of_turn, read_turn, read_turn_near
from brushsvg.calibration.numbers.from_measurements import calibrate
from brushsvg.calibration.numbers.measurements import read_measurements
from brushsvg.calibration.numbers.turn_picture import centre_line
from brushsvg.model.confidence import law_band

SHIPPED = Path(brushsvg.__file__).parent / "data" / "brushes"
FOOTPRINTS = {"tip_to_widest": values(DEPTHS, widest(DEPTHS)), "width": WIDTHS}


def middle(depth, widest=widest):
    """Return the middle (n, 2) of the mark around the corner.

    The second line is along +x, the first along +y.
    """
    tcp, contact = corner(depth)
    heading = (tcp - contact) / np.hypot(*(tcp - contact).T)[:, None]
    e = widest(depth) - GAP * depth
    seen = contact + e * heading
    before = [[-lag(depth) - k, 0.0] for k in (3.0, 2.0, 1.0)]
    seen = np.vstack([before, seen])  # the handle moves along +x to the origin, then along +y
    return seen @ np.array([[0.0, 1.0], [1.0, 0.0]])


def lines(depths=DEPTHS, rng=None, noise=0.0, widest=widest):
    exact = [middle(d, widest) for d in depths]
    shaken = [each + (rng.normal(0, noise, each.shape) if rng else 0.0) for each in exact]
    return [{"depth_mm": float(d), "points_mm": points.tolist()} for d, points in zip(depths, shaken, strict=True)]


def test_footprints_and_centre_lines_alone_give_lag_and_tip_gap():
    """Footprints and centre lines alone give lag and tip gap.

    The beginning of the turn shows r - e, and its decay shows r. A single value of either is refused.
    """
    made = calibrate(from_dict(centre_line=lines(), **FOOTPRINTS), "b")
    for depth in np.linspace(1, 10, 19):
        assert made.brush.lag(depth) == pytest.approx(lag(depth), abs=0.03)
        assert made.brush.tip_gap(depth) == pytest.approx(GAP * depth, abs=0.1)
    single = [read_turn(row["points_mm"]).turning_mm for row in lines()]
    with refused("law-undetermined angular centre_line", "angular"):
        calibrate(from_dict(angular=values(DEPTHS, single), **FOOTPRINTS), "b")


def test_the_sign_of_a_shallow_lever_is_decided_by_all_lines():
    """All lines together decide the sign of a shallow lever.

    The article's brush has e < 0 at depth 1. With noise, one line also allows -e, which is 0.7 mm off.
    """

    def of_article(depth):
        return np.maximum(0.0, np.polynomial.polynomial.polyval(depth, [-2.35, 2.75, -0.42, 0.024]))

    rng = np.random.default_rng(4)
    rows = {"tip_to_widest": values(DEPTHS, of_article(DEPTHS) + rng.normal(0, 0.1, 10)), "width": WIDTHS}
    seen = lines(DEPTHS, rng, 0.1, of_article)
    shallow = read_turn(seen[0]["points_mm"])
    assert shallow.other and shallow.turning_mm < lag(1.0) < lag(1.0) + GAP < shallow.other.turning_mm + 0.3
    made = calibrate(from_dict(centre_line=seen, **rows), "b")
    assert made.brush.lag(1.0) == pytest.approx(lag(1.0), abs=0.15)
    assert made.brush.tip_gap(5.0) == pytest.approx(GAP * 5.0, abs=0.15)


@pytest.mark.parametrize("turned", [np.diag([1.0, -1.0]), np.eye(2)])
def test_a_turn_to_either_side_reads_the_same(turned):
    turn = read_turn(middle(6.0) @ turned)
    e = widest(6.0) - GAP * 6.0
    assert (turn.lag_mm, turn.turning_mm) == pytest.approx((lag(6.0), lag(6.0) - e), abs=0.02)


def test_a_centre_line_has_an_uncertainty():
    rng, exact = np.random.default_rng(3), np.array(middle(8.0))
    read = [read_turn(exact + rng.normal(0, 0.05, exact.shape)) for _ in range(60)]
    off = np.array([(turn.lag_mm - lag(8.0), turn.turning_mm - lag(8.0) + widest(8.0) - GAP * 8) for turn in read])
    reported = np.array([np.sqrt(np.diag(turn.covariance_mm2)) for turn in read])
    assert off.std(axis=0) == pytest.approx(np.median(reported, axis=0), rel=0.4)


def test_a_line_with_nearly_correct_lengths_scatters_like_its_points():
    """A line read with nearly right lengths scatters as its points show.

    The lever is short (0.9 mm at a lag of 12.2 mm). Without known lengths, r - e scatters 1.5 times as much.
    """
    rng, lag_mm, turning_mm = np.random.default_rng(1), 12.2, 11.3
    exact = middle_of_turn(lag_mm, turning_mm, np.linspace(0, 2.2 * lag_mm, 30))
    exact = np.vstack([np.column_stack([np.zeros(4), -turning_mm - np.array([6, 4.5, 3, 1.5])]), exact])
    shaken = [exact + rng.normal(0, 0.2, exact.shape) for _ in range(60)]
    near = [read_turn_near(points, lag_mm + 0.05, turning_mm - 0.05) for points in shaken]
    found = np.array([(turn.lag_mm, turn.turning_mm) for turn in near])
    expected = np.sqrt(np.mean([np.diag(turn.covariance_mm2) for turn in near], axis=0))
    assert np.all(found.std(axis=0) < 1.2 * expected)
    assert np.all(np.abs(found.mean(axis=0) - (lag_mm, turning_mm)) < 0.5 * expected)
    alone = np.array([read_turn(points).turning_mm for points in shaken])
    assert alone.std() > 1.3 * expected[1]


@pytest.fixture(scope="module")
def picture() -> bytes:
    """Return the scan of an angular stroke of round-6 at depth 6.

    A pixel is 0.08 mm, and the corner is pixel 900, 800.
    """
    brush = painter.round_6(json.loads((SHIPPED / "round-6.json").read_text()))
    poses = np.array([[-70, 0, 0], [-60, 0, -6], [0, 0, -6], [0, 45, -6], [0, 45, 0.0]])
    exact = painter.Faults(noise=0, displacement=0, placement=0, turn=0, height=0)
    (mark,) = painter.paint(np.random.default_rng(1), brush, [("a", poses)], exact).marks
    grey = np.full((1000, 1100), 235, np.uint8)
    for ring in mark[2]:
        at = np.int32(np.round((ring * [1, -1] / 0.08 + [900, 800]) * 16))
        cv2.fillPoly(grey, [at], 40, lineType=cv2.LINE_AA, shift=4)
    noise = np.random.default_rng(2).normal(0, 4, grey.shape)
    grey = np.clip(cv2.GaussianBlur(grey, (0, 0), 1.2) + noise, 0, 255).astype(np.uint8)
    return cv2.imencode(".png", grey)[1].tobytes()


@pytest.mark.parametrize(
    ("turned", "towards", "corner_px"),
    [
        (None, "up", (900.5, 800.5)),
        (cv2.ROTATE_90_CLOCKWISE, "right", (1000 - 800.5, 900.5)),
        (cv2.ROTATE_180, "down", (1100 - 900.5, 1000 - 800.5)),
    ],
)
def test_skeleton_and_turning_point_are_found_in_a_picture(picture, turned, towards, corner_px):
    grey = cv2.imdecode(np.frombuffer(picture, np.uint8), 0)
    data = picture if turned is None else cv2.imencode(".png", cv2.rotate(grey, turned))[1].tobytes()
    turn = read_turn(centre_line(data, 0.08, corner_px, towards))
    brush = find_brush("round-6")
    e = brush.tip_to_widest(6.0) - brush.tip_gap(6.0)
    assert turn.lag_mm == pytest.approx(brush.lag(6.0), abs=0.1)
    assert turn.turning_mm == pytest.approx(brush.lag(6.0) - e, abs=0.4)
    assert turn.rmse_mm < 0.1


def test_picture_paths_are_relative_to_their_file(picture, tmp_path):
    (tmp_path / "six.png").write_bytes(picture)
    seen = {
        "depth_mm": 6,
        "picture": "six.png",
        "mm_per_px": 0.08,
        "corner_px": [900.5, 800.5],
        "towards": "up",
    }
    rows = FOOTPRINTS | {"centre_line": [*lines([2.0, 4.0, 8.0, 10.0]), seen]}
    head = {"format": "brushsvg/measurements", "version": 1}
    (tmp_path / "m.json").write_text(json.dumps(head | rows))
    made = brushsvg.calibrate(tmp_path / "m.json")
    assert "centre_line[4]" in [point.where for point in made.fit.laws[0].points]
    assert made.brush.lag(6) == pytest.approx(lag(6.0), abs=0.3)
    (tmp_path / "six.png").write_bytes(picture[:2000])
    with refused("photo-damaged"):
        brushsvg.calibrate(tmp_path / "m.json")
    blank = cv2.imencode(".png", np.full((200, 200), 235, np.uint8))[1].tobytes()
    with refused("photo-without-paint", "here"):
        centre_line(blank, 0.08, (10, 10), where="here")


def video(way=1.0, up=120.0, noise=0.0, rng=None):
    """Return ferrule and tip frame by frame.

    Three frames are in the air with a straight brush. After the first touch, each frame is 0.25 mm lower.
    """
    depth = np.concatenate([[-3.0, -2.0, -1.0], np.arange(0, 10.01, 0.25)])
    pressed = np.maximum(depth, 0.0)
    behind = np.where(depth >= 0, lag(pressed) + GAP * pressed, 0.0)
    x = 5.0 + way * np.arange(len(depth)) * 2.0
    tip = x - way * (behind - 0.7)  # the tip is not exactly below the ferrule
    shaken = rng.normal(0, noise, len(depth)) if rng else 0.0
    return {
        "ferrule_mm": np.column_stack([x, up - depth]).tolist(),
        "tip_mm": np.column_stack([tip + shaken, np.full(len(depth), 80.0)]).tolist(),
        "touch": 3,
    }


@pytest.mark.parametrize("way", [1.0, -1.0])
def test_a_video_from_the_side_gives_the_tip_gap(way):
    made = calibrate(from_dict(video=[video(way)], lag=values(DEPTHS, lag(DEPTHS)), **FOOTPRINTS), "b")
    assert made.brush.tip_gap.coefficients == pytest.approx([0, GAP], abs=1e-6)


def whole(rng, n=10):
    """Return data of section 4 with the article's scatter: 0.5 mm and more."""
    shifts = rng.normal(0, 0.3, DEPTHS.size)
    d = DEPTHS
    return {
        "tip_to_widest": values(d, widest(d) + rng.normal(0, 0.3, n)),
        "width": WIDTHS,
        "lag": values(d, lag(d) + rng.normal(0, 0.58, n)),
        "tip_gap": values(d, GAP * d + rng.normal(0, 0.95, n)),
        "angular": values(d, lag(d) + GAP * d - widest(d) + shifts),
        "side_view": values(d, lag(d) + GAP * d - lag(0.0) + rng.normal(0, 0.85, n)),
        "straight": [
            {"depth_mm": x, "path_mm": 60.0, "distance_mm": 60 - v}
            for x, v in zip(d.tolist(), lag(d) + GAP * d - widest(d) + rng.normal(0, 0.5, n), strict=True)
        ],
    }


def test_one_fit_uses_all_measurements():
    """In one fit, all measurements count.

    Measured sums improve laws that were also measured alone. The intervals still contain the truth.
    """
    rng, at = np.random.default_rng(5), np.array([2.0, 5.0, 9.0])
    truth = {"lag": lag, "tip_gap": lambda d: GAP * d, "tip_to_widest": widest}
    held, alone, together, outlying = [], [], [], 0
    for _ in range(100):
        rows = whole(rng)
        without = {kind: rows[kind] for kind in ("width", "tip_to_widest", "lag", "tip_gap")}
        made = calibrate(from_dict(**rows), "b")
        apart, brush = calibrate(from_dict(**without), "b").brush, made.brush
        outlying += sum(len(law.outliers) for law in made.laws)
        for law, exact in truth.items():
            half, _ = law_band(brush, law, at)
            held.append(np.abs(getattr(brush, law)(at) - exact(at)) <= half)
        alone.append(law_band(apart, "lag", at)[0])
        together.append(law_band(brush, "lag", at)[0])
    assert 0.92 <= np.mean(held) <= 0.985
    assert outlying <= 3  # of 6,000 normal values
    assert np.median(together) < 0.6 * np.median(alone)


@pytest.mark.parametrize("absolute", [False, True])
def test_one_fit_resists_an_outlier_and_names_it(absolute):
    rows = whole(np.random.default_rng(8))
    rows["side_view"][6]["value_mm"] += 12.0
    made = calibrate(from_dict(**rows), "b", absolute=absolute)
    assert any("side_view[6]" in reported for law in made.laws for reported in law.list_outliers())
    off = abs(made.brush.tip_gap(7.0) - GAP * 7)
    assert off < (0.8 if absolute else 2.5)


def test_a_dict_is_read_like_a_file(tmp_path):
    rows = {"depth_range_mm": [0, 10], "name": "mine"} | FOOTPRINTS | {"lag": values(DEPTHS, lag(DEPTHS))}
    (tmp_path / "m.json").write_text(json.dumps({"format": "brushsvg/measurements", "version": 1} | rows))
    reported = brushsvg.calibrate(rows | {"lag": [{"depth_mm": np.float64(d), "value_mm": lag(d)} for d in DEPTHS]})
    assert reported.brush == brushsvg.calibrate(tmp_path / "m.json").brush
    with refused("wrong-type"):
        brushsvg.calibrate({"lag": object()})
    with refused("key-unknown", "lags"):
        brushsvg.calibrate({"lags": []})


LINE = lines([6.0])[0]
TURNED = np.array(LINE["points_mm"])


@pytest.mark.parametrize(
    ("kind", "row", "expected", "where"),
    [
        ("centre_line", LINE | {"points_mm": TURNED[:4].tolist()}, "measurement-missing 6", "points_mm"),
        ("centre_line", LINE | {"points_mm": (TURNED - np.array([60, -30])).tolist()}, "not-a-turn", ""),
        ("centre_line", LINE | {"points_mm": (TURNED[::-1, ::-1] * [1, 3]).tolist()}, "not-a-turn", ""),
        ("centre_line", LINE | {"points_mm": [[0.0, 0.0]] * 9}, "not-a-turn", ""),
        ("centre_line", LINE | {"points_mm": TURNED[:7].tolist()}, "law-undetermined", ""),
        ("centre_line", LINE | {"points_mm": [[1, 2], [3]]}, "wrong-type", "points_mm[1]"),
        ("centre_line", LINE | {"points_mm": [[1, 2e4]] * 9}, "out-of-range", "points_mm[0]"),
        ("centre_line", LINE | {"picture": "a.png"}, "options-contradict", ""),
        ("centre_line", {"depth_mm": 3}, "key-missing points_mm picture", ""),
        ("centre_line", {"depth_mm": 3, "picture": "a.png", "mm_per_px": 0.1}, "key-missing corner_px", ""),
        ("centre_line", {"points_mm": LINE["points_mm"]}, "key-missing depth_mm", ""),
        ("centre_line", LINE | {"depth_mm": -3}, "depth-out-of-range", ""),
        ("video", {"ferrule_mm": [[0, 1], [1, 0]]}, "key-missing tip_mm", ""),
        ("video", video() | {"tip_mm": [[0, 1]]}, "sizes-differ", ""),
        ("video", video() | {"touch": 44}, "out-of-range 44", "touch"),
        ("video", video() | {"touch": 0.5}, "wrong-type", "touch"),
        (
            "video",
            {"ferrule_mm": [[0, 1], [1, 2]], "tip_mm": [[0, 1], [1, 2]]},
            "measurement-missing",
            "ferrule_mm",
        ),
    ],
)
def test_unreadable_rows_are_refused_with_their_position(kind, row, expected, where):
    rows = {kind: [row, *(lines([4.0, 8.0]) if kind == "centre_line" else [])]}
    with refused(expected, ".".join(filter(None, [f"{kind}[0]", where]))):
        calibrate(from_dict(**rows, **FOOTPRINTS), "b")


def test_a_table_cannot_contain_centre_lines():
    with refused("measurement-kind", "line 2"):
        read_measurements(b"kind,depth_mm,value_mm\ncentre_line,3,4\n", ".csv")
