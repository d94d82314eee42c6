"""The calibration chart: separate marks, detectable markers, and a readable file."""

import functools
import itertools
import json
import math
import re
import sys
from dataclasses import replace

import cv2
import numpy as np
import pytest
import shapely
from diagnostics import agrees, gives, in_json, refused
from numpy.polynomial.polynomial import polyval
from programs import RUNNABLE
from sampling import sample

from brushsvg import _core, brush_like, find_brush, save_brush
from brushsvg.calibration.chart.file import read_chart, write_chart
from brushsvg.calibration.chart.layout import chart
from brushsvg.calibration.chart.page import MAX_TEXT_MM, chart_page, chart_pdf, chart_svg
from brushsvg.calibration.marks.from_marks import laws_of
from brushsvg.calibration.numbers.from_widths import new_brush
from brushsvg.cli import main
from brushsvg.errors import Error
from brushsvg.machine.cells.cell import Reload, Station
from brushsvg.machine.cells.cell_file import cell_names, find_cell
from brushsvg.machine.paint_reload import list_station_visits, split_into_loads
from brushsvg.machine.posts import POSTS
from brushsvg.model.perturbed import with_lag
from brushsvg.strokes.swept_areas import region

A4, A5, LETTER = (210.0, 297.0), (148.0, 210.0), (215.9, 279.4)
PX_PER_MM = 8


@functools.cache
def small_chart():
    """A small chart for tests that do not change it."""
    return chart(find_brush("round-6"), A5)


def marks_of(made, brush):
    marks = _core.simulate(made.plan, brush)
    _core.trace_outlines(marks, brush)
    return [shapely.unary_union([shapely.Polygon(ring).buffer(0) for ring in each.outline_mm]) for each in marks.passes]


@pytest.mark.parametrize(
    ("sheet", "brush"),
    [
        (A4, find_brush("round-6")),
        (A5, find_brush("round-6")),
        (A5, new_brush("liner", 6.0, [(2, 1.0), (5, 2.0)])),
    ],
    ids=["a4", "a5", "liner"],
)
@sample("share", [0.75, 1.0, 1.25], keep=1)
@pytest.mark.slow
def test_marks_are_separate_and_on_the_sheet(sheet, brush, share):
    """Marks keep apart from each other and stay on the sheet.

    This also holds for a brush whose lag is a quarter larger or smaller than assumed.
    """
    made = chart(brush, sheet)
    marks = marks_of(made, with_lag(brush, (share - 1) * np.array(brush.lag.coefficients)))
    paper = shapely.box(0, 0, *sheet).buffer(-4)
    markers = [shapely.Polygon(marker.corners_mm) for marker in made.markers]
    for stroke, mark in zip(made.strokes, marks, strict=True):
        assert paper.contains(mark) and shapely.box(*stroke.box_mm).contains(mark), stroke.id
        assert min(mark.distance(marker) for marker in markers) > markers[0].length / 24 - 1e-6, stroke.id
    tree = shapely.STRtree(marks)
    pairs = tree.query(marks, "dwithin", 1.0).T
    assert all(a == b for a, b in pairs), [(made.strokes[a].id, made.strokes[b].id) for a, b in pairs if a < b]
    for label in made.labels:
        x, y = label.at_mm
        size = min(MAX_TEXT_MM, label.width_mm / (0.6 * len(label.text)))
        text = shapely.box(x, y - 0.25 * size, x + 0.6 * size * len(label.text), y + size)
        assert size > 1.2 and paper.contains(text)
        assert min(text.distance(mark) for mark in (*marks, *markers)) > 0, label.text


def test_the_chart_has_the_expected_strokes_and_depths():
    brush = find_brush("round-6")
    made = chart(brush, A4, "normal")
    kinds = [stroke.kind for stroke in made.strokes]
    each = ("straight", "angular", "auxiliary", "arc", "reversal")
    assert [kinds.count(kind) for kind in each] == [6] * 5 and kinds.count("reference") == 4
    depths = sorted({stroke.depth_mm for stroke in made.strokes if stroke.kind == "arc"})
    assert depths[0] == 1 and depths[-1] == 10 and len(depths) == 6
    by_id = {a_pass.stroke: a_pass for a_pass in made.plan.passes}
    for stroke in made.strokes:
        poses = by_id[stroke.id].poses_mm
        assert poses[0, 2] == poses[-1, 2] == 0 and -poses[:, 2].min() == pytest.approx(stroke.depth_mm)
    for there, back in (("reference-1", "reference-2"), ("reference-3", "reference-4")):
        ways = [by_id[name].poses_mm[-1, :2] - by_id[name].poses_mm[0, :2] for name in (there, back)]
        np.testing.assert_allclose(ways[0], -ways[1], atol=1e-9)
    straight = by_id["straight-6"].poses_mm
    assert straight[1, 2] / np.hypot(*(straight[1] - straight[0])[:2]) == pytest.approx(-0.25)
    # The auxiliary stroke of an angular stroke is parallel to its second line.
    second = np.diff(by_id["angular-3"].poses_mm[2:4, :2], axis=0)[0]
    near_by = np.diff(by_id["auxiliary-3"].poses_mm[1:3, :2], axis=0)[0]
    assert second @ near_by == pytest.approx(np.hypot(*second) * np.hypot(*near_by))
    # After an arc, the brush is taut.
    marks = _core.simulate(made.plan, brush)
    for trace in marks.passes:
        if trace.stroke.startswith("arc"):
            first = int(np.flatnonzero(trace.taut)[0])
            assert all(taut for taut, depth in zip(trace.taut[first:], trace.depth_mm[first:], strict=True) if depth)


@pytest.mark.slow
def test_a_larger_sheet_has_more_strokes():
    brush = find_brush("round-6")
    counts = [len(chart(brush, sheet).strokes) for sheet in (A5, A4, (297.0, 420.0), (594.0, 841.0))]
    assert counts == sorted(set(counts))


@pytest.mark.slow
@pytest.mark.parametrize("strokes", [None, "few", "normal", "many"])
def test_a_sheet_that_is_too_small_is_refused_with_a_size_that_fits(strokes):
    brush = find_brush("round-6")
    with refused("sheet-too-small 60 90", "sheet") as refusal:
        chart(brush, (60.0, 90.0), strokes)
    needed = re.findall(r"(\d+) x (\d+) mm", str(refusal.value))[-1]
    made = chart(brush, tuple(map(float, needed)), strokes)
    assert len(made.strokes) >= 24
    with refused("lag-not-calibrated rigid"):
        chart(find_brush("rigid"), A4)


def all_but_the_first_slow(names):
    return [*names[:1], *(pytest.param(name, marks=pytest.mark.slow) for name in names[1:])]


SMALL_ARMS = ("irb120", "ur3e")  # A4 is nearly too large for these arms, so their joints are checked, too.


@pytest.mark.slow
@sample(
    "name",
    [
        pytest.param(name, marks=pytest.mark.arm) if name in SMALL_ARMS else name
        for name in cell_names()
        if find_cell(name).language in POSTS and find_cell(name).pen is None  # A pen does not lag.
    ],
    keep=4,
)
def test_the_chart_becomes_a_program_for_every_cell(name, tmp_path, capsys):
    suffix = POSTS[find_cell(name).language].extensions[0]
    out = tmp_path / f"chart{suffix}"
    assert main(["chart", "-o", str(out), "--cell", name]) == 0
    assert gives(capsys.readouterr().out, "210 x 297 mm")
    assert out.stat().st_size > 10_000
    assert main(["check", str(out), "--cell", name]) == 0
    assert RUNNABLE in capsys.readouterr().out


@pytest.mark.parametrize("sheet", all_but_the_first_slow(["a5", "letter", "300x200"]))
def test_the_markers_are_found_on_the_page(sheet, tmp_path):
    page, file = tmp_path / "page.svg", tmp_path / "chart.json"
    out = tmp_path / "plan.json"
    assert main(["chart", "-o", str(out), "--sheet", sheet, "--page", str(page), "--chart", str(file)]) == 0
    made = read_chart(file.read_bytes())
    found = detected(page.read_text(), made.plan.sheet_mm, made.dictionary)
    base = 8 * (int(made.id, 16) % 125)
    # A5 has no room for the two markers at the sides.
    places = {"a5": [0, 1, 2, 3, 4, 6]}.get(sheet, range(8))
    assert sorted(found) == [marker.id for marker in made.markers] == [base + k for k in places]
    height = made.plan.sheet_mm[1]
    for marker in made.markers:
        corners = np.array(marker.corners_mm)
        on_page = np.column_stack([corners[:, 0], height - corners[:, 1]])
        np.testing.assert_allclose(found[marker.id], on_page, atol=0.15)
    assert _core.write_plan(made.plan) == out.read_text()


def detected(svg, sheet_mm, dictionary):
    """Draw the page's shapes and return the corners [mm] that OpenCV detects, by id."""
    size = [round(side * PX_PER_MM) for side in sheet_mm]
    image = np.full((size[1], size[0]), 255, np.uint8)
    for data in re.findall(r'<path data-[^>]* d="([^"]*)"', svg):
        rings = [
            np.array([point.split(",") for point in re.findall(r"[-\d.]+,[-\d.]+", ring)], float)
            for ring in data.split("Z")[:-1]
        ]
        shift = 4
        fixed = [np.round((ring * PX_PER_MM - 0.5) * 2**shift).astype(np.int32) for ring in rings]
        cv2.fillPoly(image, fixed, 0, cv2.LINE_AA, shift)
    dictionary = cv2.aruco.getPredefinedDictionary(getattr(cv2.aruco, dictionary))
    corners, ids, _ = cv2.aruco.ArucoDetector(dictionary).detectMarkers(image)
    return {int(i): (c[0] + 0.5) / PX_PER_MM for i, c in zip(ids.ravel(), corners, strict=True)}


@pytest.mark.slow
def test_a_pen_plots_the_markers_at_their_printed_positions(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    words = "--brush pen.json --wide passes --select [data-marker]"
    assert main("brush new -o pen.json --lag 0 --width-at 1=0.7".split()) == 0
    assert main("chart -o plan.json --sheet a5 --page page.svg --chart chart.json".split()) == 0
    assert main(f"convert page.svg -o markers.ngc {words}".split()) == 0
    assert main(f"preview page.svg -o marks.json {words}".split()) == 0
    made = read_chart((tmp_path / "chart.json").read_bytes())
    passes = json.loads((tmp_path / "marks.json").read_text())["passes"]
    inked = region(_core.unite([np.array(ring) for each in passes for ring in each["outline_mm"]]))
    printed = svg_shapes((tmp_path / "page.svg").read_text(), A5[1])
    assert inked.difference(printed.buffer(0.03)).area < 0.02
    assert printed.difference(inked).area / printed.area < 0.03
    assert len(shapely.get_parts(inked.buffer(0.05))) >= len(made.markers) == 6
    for marker in made.markers:  # The edges fit between the corners, which are as round as the nib.
        corners = np.array(marker.corners_mm)
        for a, b in zip(corners, np.roll(corners, -1, axis=0), strict=True):
            for share in np.linspace(0.1, 0.9, 17):
                assert inked.boundary.distance(shapely.Point(a + share * (b - a))) < 0.015


def svg_shapes(svg, height_mm):
    """Return the page's markers as polygons on the sheet."""
    found = []
    for data in re.findall(r'<path data-marker[^>]* d="([^"]*)"', svg):
        rings = [
            np.array([point.split(",") for point in re.findall(r"[-\d.]+,[-\d.]+", ring)], float)
            for ring in data.split("Z")[:-1]
        ]
        whole = shapely.Polygon()
        for ring in rings:
            polygon = shapely.Polygon(np.column_stack([ring[:, 0], height_mm - ring[:, 1]]))
            whole = whole.symmetric_difference(shapely.make_valid(polygon))
        found.append(whole)
    return shapely.union_all(found)


@pytest.mark.parametrize("sheet", [A5, LETTER, (420.0, 594.0)])
def test_the_scale_bar_is_clear_of_marks_and_has_its_stated_length(sheet):
    made = chart(find_brush("round-6"), sheet, "few")
    (x, y), length = made.bar.at_mm, made.bar.length_mm
    drawn = re.search(r'<path data-bar="([^"]*)"[^>]* d="([^"]*)"', chart_svg(made))
    points = np.array([p.split(",") for p in re.findall(r"[-\d.]+,[-\d.]+", drawn[2])], float)
    assert float(drawn[1]) == length == np.ptp(points[:, 0]) >= 0.7 * sheet[0]
    bar = shapely.box(x, y - 1.1, x + length, y + 1.1)
    for marker in made.markers:
        polygon = shapely.Polygon(marker.corners_mm)
        # The white border is at least one module wide.
        assert bar.distance(polygon) > polygon.length / 4 / 7, marker.id
    for stroke in made.strokes:
        assert bar.distance(shapely.box(*stroke.box_mm)) > 1, stroke.id


@pytest.mark.slow
@pytest.mark.parametrize("sheet", [A5, (420.0, 594.0)])
def test_the_pdf_has_the_size_and_the_shapes_of_the_page(sheet):
    matplotlib = pytest.importorskip("matplotlib")
    made = chart(find_brush("round-6"), sheet, "few")
    assert chart_pdf(made) == chart_pdf(made)
    with matplotlib.rc_context({"pdf.compression": 0}):
        text = chart_pdf(made).decode("latin-1")
    box = re.search(r"/MediaBox \[ 0 0 ([\d.]+) ([\d.]+) \]", text).groups()
    np.testing.assert_allclose(np.array(box, float) * 25.4 / 72, sheet, atol=0.01)
    points = np.array(re.findall(r"(?m)^([-\d.]+) ([-\d.]+) [ml]$", text), float) * 25.4 / 72
    for marker in made.markers:
        for corner in marker.corners_mm:
            assert np.hypot(*(points - corner).T).min() < 0.01, (marker.id, corner)
    bar = made.bar
    assert np.hypot(*(points - bar.at_mm - [bar.length_mm, 1.1]).T).min() < 0.01


@pytest.mark.slow
@pytest.mark.parametrize("command", ["chart -o plan.json --sheet a5", "convert a.svg -o plan.json"])
def test_the_pdf_page_needs_matplotlib_and_the_svg_page_does_not(tmp_path, monkeypatch, capsys, command):
    """Without matplotlib the PDF page is refused, but not the SVG page.

    The missing package was once reported as an internal error of brushsvg.
    """
    monkeypatch.chdir(tmp_path)
    (tmp_path / "a.svg").write_text(
        '<svg xmlns="http://www.w3.org/2000/svg" width="90mm" height="50mm" viewBox="0 0 90 50">'
        '<path d="M20 20h50" stroke="#000" stroke-width="3"/></svg>'
    )
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    status, _, ((file, reported),) = in_json(capsys, *command.split(), "--page", "page.pdf")
    assert (status, file) == (1, "page.pdf") and agrees(reported, "package-missing PDF matplotlib")
    assert [each.name for each in tmp_path.iterdir()] == ["a.svg"]
    assert main([*command.split(), "--page", "page.svg"]) == 0


def test_a_chart_file_of_an_earlier_version_can_be_read():
    """A chart file from an earlier version can be read.

    It has four markers of another dictionary, no id, no bar and no labels.
    """
    content = json.loads(write_chart(small_chart()))
    content = {key: value for key, value in content.items() if key not in ("id", "bar", "labels")}
    content["markers"] = [row | {"id": k} for k, row in enumerate(content["markers"][:4])]
    made = read_chart(json.dumps(content | {"dictionary": "DICT_4X4_50"}).encode())
    assert (made.id, made.bar, made.labels, made.dictionary) == ("", None, (), "DICT_4X4_50")
    assert len(detected(chart_svg(made), A5, "DICT_4X4_50")) == 4


def test_another_chart_has_other_markers():
    one, other = (chart(find_brush("round-6"), A5, deepest_mm=deepest) for deepest in (9.0, 8.0))
    assert one.id != other.id and not {m.id for m in one.markers} & {m.id for m in other.markers}


def test_a_chart_file_is_read_back_unchanged():
    made = chart(find_brush("round-6"), LETTER)
    text = write_chart(made)
    again = read_chart(text.encode())
    assert write_chart(again) == text and again.id in again.labels[-1].text
    assert [stroke.id for stroke in again.strokes] == [each.stroke for each in again.plan.passes]
    assert chart_svg(made).count("<text") == len(made.labels)


@pytest.mark.parametrize(
    ("change", "where", "expected"),
    [
        ({"format": "x"}, "format", "format-unknown"),
        ({"version": 2}, "version", "version-unknown 2 1"),
        ({"version": True}, "version", "version-unknown True"),
        ({"version": "1\n2"}, "version", "version-unknown '1\\n2'"),
        ({"markers": [{"id": True, "corners_mm": [[0, 0]] * 4}]}, "markers[0]", "wrong-type"),
        (
            {"markers": [{"id": 0, "corners_mm": [[0, 0]] * 3 + [[0, 0, 0]]}]},
            "markers[0].corners_mm[3]",
            "wrong-type 2",
        ),
        (
            {"strokes": [{"id": "a", "kind": "arc", "depth_mm": True}]},
            "strokes[0].depth_mm",
            "not-a-number True",
        ),
        ({"dictionary": "DICT_6X6"}, "dictionary", "chart-markers DICT_4X4_50 DICT_5X5_1000"),
        ({"id": "0123abcd"}, "plan", "chart-strokes 0123abcd"),
        ({"bar": {"at_mm": [5, 5], "length_mm": -3}}, "bar.length_mm", "out-of-range -3"),
        ({"labels": [{"text": "a", "at_mm": [1, 2]}]}, "labels[0].width_mm", "not-a-number"),
        ({"labels": [{"text": "", "at_mm": [1, 2], "width_mm": 3}]}, "labels[0]", "wrong-type"),
        (
            {"markers": [{"id": 0, "corners_mm": [[0, 0], [1, 0], [1, 1], [0, 1]]}] * 2},
            "markers",
            "chart-markers",
        ),
        ({"plan": None}, "plan", "key-missing"),
        ({"markers": [{"id": 0}]}, "markers[0]", "wrong-type corners_mm"),
        (
            {"markers": [{"id": 0, "corners_mm": [[0, 0]] * 3 + [[0, None]]}]},
            "markers[0].corners_mm[3][1]",
            "not-a-number None",
        ),
        ({"strokes": []}, "strokes", "chart-strokes"),
        (
            {"strokes": [{"id": "a", "kind": "arc", "depth_mm": "x"}]},
            "strokes[0].depth_mm",
            "not-a-number 'x'",
        ),
    ],
)
def test_a_damaged_file_names_the_key(change, where, expected):
    content = json.loads(write_chart(small_chart()))
    with refused(expected, where):
        read_chart(json.dumps(content | change).encode())
    with pytest.raises(Error):
        read_chart(b"{")
    with refused("key-twice"):
        read_chart(b'{"format": "brushsvg/chart", "format": "brushsvg/chart", "version": 1}')


@pytest.mark.slow
def test_chart_reports_the_expected_accuracy_of_the_brush(tmp_path, capsys):
    """`brushsvg chart` reports how exact the calibrated brush will be.

    A larger sheet makes the brush more exact; uneven edges make it less exact.
    """

    def lag_bands(*flags):
        assert main(["chart", "-o", str(tmp_path / "p.json"), *flags]) == 0
        reported = capsys.readouterr().out
        return np.array([float(half) for half in re.findall(r"(?m)^ +[\d.]+ +[\d.]+ \+- ([\d.]+)", reported)])

    a5, a4 = lag_bands("--sheet", "a5"), lag_bands("--sheet", "a4")
    rough = lag_bands("--sheet", "a5", "--noise", "0.3")
    assert len(a5) == 4 and a4.mean() < a5.mean() < 0.2
    assert rough.mean() > 1.5 * a5.mean()


def test_a_chart_expects_no_negative_lag(tmp_path, capsys):
    """The laws that are fitted to marks have no floor. Those of this brush were once negative at depth 0."""
    brush = find_brush("round-6")
    brush.depth_range_mm, brush.lag = (3.0, 10.0), _core.Profile([-2.0, 1.0], floor=0.0)
    (tmp_path / "deep.json").write_text(_core.write_brush(brush))
    words = ("chart", "-o", str(tmp_path / "chart.json"), "--brush", str(tmp_path / "deep.json"))
    assert main([*words, "--strokes", "few"]) == 0, capsys.readouterr().err
    lags = laws_of(brush).lag
    assert polyval(np.linspace(0, 10, 99), lags).min() > 0
    assert polyval(np.linspace(3, 10, 99), lags) == pytest.approx(np.linspace(1, 8, 99), abs=0.3)


def test_a_chart_is_made_for_a_brush_with_outlines_of_greater_depths(tmp_path, capsys):
    """A brush.json with a smaller depth range keeps its outlines. This was once an unexpected error."""
    brush = find_brush("round-6")
    brush.depth_range_mm = (0.0, 6.0)
    (tmp_path / "short.json").write_text(_core.write_brush(brush))
    words = ("chart", "-o", str(tmp_path / "chart.json"), "--brush", str(tmp_path / "short.json"))
    assert main([*words, "--strokes", "few"]) == 0, capsys.readouterr().err
    assert laws_of(brush).front_per_half == pytest.approx(laws_of(find_brush("round-6")).front_per_half)


def test_wrong_usage_is_refused(tmp_path, capsys):
    out = str(tmp_path / "plan.json")
    for flags, expected in (
        (["--sheet", "a9"], "a9"),
        (["--page", str(tmp_path / "p.png")], ".pdf"),
        (["--chart", out], out),
        (["--strokes", "lots"], "lots"),
    ):
        assert main(["chart", "-o", out, *flags]) == 2
        assert expected in capsys.readouterr().err
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("deepest", [5.566, 9.6583])
@pytest.mark.slow
def test_no_depth_is_rounded_beyond_the_brush_range(deepest):
    made = chart(new_brush("own", 6.0, [(2, 1.0), (4, 2.0)], deepest), A4)
    assert max(stroke.depth_mm for stroke in made.strokes) == pytest.approx(deepest, abs=0.01)


@pytest.mark.parametrize("dabs", [False, True])
def test_a_machine_that_does_not_reach_the_depths_of_the_brush_is_refused(dabs):
    brush = find_brush("round-6")
    for least, reached in ((0, 0), (0.5, 0.3), (0.5, 0.5)):
        brush.depth_range_mm = (least, 10)
        with refused(f"depth-out-of-range {reached} {least} 10 heights.lowest_mm", "brush"):
            chart(brush, A4, deepest_mm=reached, dabs=dabs)


@pytest.mark.parametrize("cell", [name for name in cell_names() if find_cell(name).pen])
def test_a_chart_is_refused_for_a_pen_that_is_up_or_down(cell, tmp_path, capsys):
    """The refusal is the only one, and does not advise the brush rigid, of which there is no chart either."""
    status, _, reported = in_json(capsys, "chart", "-o", tmp_path / "c.json", "--cell", cell)
    assert status == 1 and len(reported) == 1, reported
    assert agrees(reported[0][1], f"pen-depth {cell}") and "rigid" not in reported[0][1].text, reported


@pytest.mark.parametrize("sheet", ["9x9", "1x5000"])
def test_a_sheet_without_room_for_its_markers_is_refused(sheet, tmp_path, capsys):
    status, _, ((_, reported),) = in_json(capsys, "chart", "-o", tmp_path / "c.json", "--sheet", sheet)
    assert status == 1 and agrees(reported, "sheet-too-small markers"), reported


@pytest.mark.parametrize("sheet", [A5, A4, (420.0, 594.0)], ids=["a5", "a4", "a2"])
def test_the_order_of_one_load_separates_depth_from_painted_distance(sheet):
    """With one load, the order of strokes separates depth from distance painted.

    The strokes and their places do not change. The distance painted so far hardly predicts the depth.
    """
    brush = find_brush("round-6")
    usual, made = chart(brush, sheet), chart(brush, sheet, one_load=True)

    def places(of):
        return {one.stroke: np.asarray(one.poses_mm).tolist() for one in of.plan.passes}

    def reported(of):
        """Return the share of the distance's variance that a parabola of depth explains.

        The points are 1 mm apart.
        """
        come, way, depth = 0.0, [], []
        for one, stroke in zip(of.plan.passes, of.strokes, strict=True):
            assert one.stroke == stroke.id
            length = float(np.hypot(*np.diff(np.asarray(one.poses_mm)[:, :2], axis=0).T).sum())
            way += list(come + np.arange(0.0, length))
            depth += [stroke.depth_mm] * math.ceil(length)
            come += length
        left = way - np.polyval(np.polyfit(depth, way, 2), depth)
        return 1 - left.var() / np.var(way)

    assert places(usual) == places(made)
    assert usual.labels[:-1] == made.labels[:-1], "the page is the same, but for the chart's id"
    assert usual.id != made.id
    assert reported(usual) > 0.6 and reported(made) < 0.1
    assert {one.settings.reload for one in made.plan.passes} == {False}


def test_a_chart_for_one_load_fetches_paint_once():
    """A chart for one load fetches paint once.

    The cell otherwise fetches paint before every stroke.
    """
    stations = (Station("any", (-20.0, 10.0), depth_mm=7.0),)
    cell = replace(find_cell(), reload=Reload("stroke"), stations=stations)
    made = chart(find_brush("round-6"), A5, one_load=True)
    fetched = [
        bool(each) for each in list_station_visits(split_into_loads(made.plan, find_brush("round-6"), cell), cell)
    ]
    assert fetched[0] and not any(fetched[1:]) and len(fetched) == len(made.strokes)


@pytest.mark.parametrize(("flags", "advice"), [([], "[reload]"), (["--dabs"], "[reload]"), (["--paint"], "--sheet")])
def test_a_chart_that_needs_more_paint_than_a_load_is_reported(tmp_path, capsys, flags, advice):
    """The chart command wrote programs without the notices on paint that convert gives."""
    brush = brush_like("mine", find_brush("round-6"))
    brush.paint = _core.Paint(0.5, lasts_mm=300, calibrated_mm=(0, 800))
    save_brush(brush, tmp_path / "mine.json")
    words = "chart", "-o", tmp_path / "c.ngc", "--brush", tmp_path / "mine.json", "--sheet", "a5", *flags
    status, _, reported = in_json(capsys, *words)
    assert status == 0
    assert [advice in each.advice for _, each in reported if each.code == "paint-runs-out"] == [True]


@pytest.mark.slow
def test_chart_reports_the_expected_accuracy_of_the_paint(tmp_path, capsys):
    def reported(*flags):
        assert main(["chart", "-o", str(tmp_path / "p.json"), "--sheet", "a5", *flags]) == 0
        return capsys.readouterr().out

    assert int(re.findall(r"(\d+) %", reported())[-1]) > 55
    halves = []
    for noise in ("0.1", "0.2"):
        found = re.search(
            r"\+- ([\d.]+); [a-z ]+ (\d+) %.* (\d+) mm",
            reported("--paint", "--noise", noise),
        )
        half, share, way = map(float, found.groups())
        assert share < 30
        ways = [np.asarray(one.poses_mm)[:, :2] for one in small_chart().plan.passes]
        assert way == pytest.approx(sum(np.hypot(*np.diff(each, axis=0).T).sum() for each in ways), abs=1)
        halves.append(half)
    assert halves[1] == pytest.approx(2 * halves[0], rel=0.1)


def test_a_chart_of_marks_without_flanks_reports_that_they_do_not_show_paint(tmp_path, capsys):
    """A brush far wider than it is pressed leaves marks that are shorter than their own ends."""
    brush = str(tmp_path / "wide.json")
    numbers = ["--lag-at", "3=15", "--lag-at", "8=20", "--width-at", "3=30", "--width-at", "8=40"]
    assert main(["brush", "new", "-o", brush, *numbers]) == 0
    assert main(["chart", "-o", str(tmp_path / "p.json"), "--brush", brush, "--sheet", "a2", "--strokes", "few"]) == 0
    reported = capsys.readouterr()
    assert gives(reported.out.splitlines()[-1], "4", "7") and "error" not in reported.err


def test_dabs_cannot_measure_paint(tmp_path, capsys):
    assert main(["chart", "-o", str(tmp_path / "p.json"), "--dabs", "--paint"]) == 2
    assert gives(capsys.readouterr().err, "--paint")
    with refused("options-contradict"):
        chart(find_brush("round-6"), A5, dabs=True, one_load=True)


def test_the_chart_is_the_same_each_time():
    texts = [write_chart(made) for made in (small_chart(), chart(find_brush("round-6"), A5))]
    assert len(set(texts)) == 1
    assert all(a != b for a, b in itertools.pairwise(read_chart(texts[0].encode()).strokes))


def test_a_page_has_the_requested_rings_and_refuses_anything_else():
    page = chart(find_brush("round-6"), (210, 297))
    ring = np.array([(5.0, 5.0), (9.0, 5.0), (9.0, 9.0)])
    assert len(chart_page(page, ".svg", [ring])) > len(chart_page(page, ".svg"))
    for rings, code in ((3, "wrong-type"), (ring, "wrong-type"), ([ring * np.nan], "out-of-range")):
        with pytest.raises(Error) as reported:
            chart_page(page, ".svg", rings)
        assert reported.value.code == code
