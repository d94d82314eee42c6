"""Shipped brush files contain correct values, and invalid ones are refused."""

import hashlib
import importlib.util
import json
import math
import os
import re
from pathlib import Path

import numpy as np
import pytest
from diagnostics import in_json, refused

import brushsvg
from brushsvg import _core
from brushsvg.calibration.overlap.lag_by_outlines import refuse_assumed
from brushsvg.cli import main
from brushsvg.errors import Error
from brushsvg.model.confidence import learned_of
from brushsvg.model.describe import one_line
from brushsvg.model.library import SHIPPED, brush_like, brush_names, find_brush, save_brush
from brushsvg.model.unknown_keys import unknown_keys

ROOT = Path(__file__).parents[2]
LAWS = ("lag", "tip_gap", "tip_to_widest", "half_width")


def shipped_json(name: str) -> dict:
    return json.loads((SHIPPED / f"{name}.json").read_text(encoding="utf-8"))


@pytest.fixture
def changed(tmp_path):
    """Return a function that writes a changed round-6 and returns its path."""

    def write(change) -> Path:
        content = shipped_json("round-6")
        change(content)
        path = tmp_path / "changed.json"
        path.write_text(json.dumps(content), encoding="utf-8")
        return path

    return write


@pytest.fixture(scope="module")
def make_brushes():
    spec = importlib.util.spec_from_file_location("make_brushes", ROOT / "tools" / "make_brushes.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_shipped_brush_names():
    assert brush_names() == ["liner-1", "rigid", "round-6", "round-6-angles"]


@pytest.mark.parametrize("path", sorted(SHIPPED.glob("*")), ids=lambda path: path.name)
def test_every_shipped_file_is_a_valid_brush(path):
    brush = find_brush(path.stem)
    assert path.suffix == ".json"
    assert brush.name == path.stem
    assert brush.sha256 == hashlib.sha256(path.read_bytes()).hexdigest()
    assert find_brush(path).sha256 == brush.sha256 == find_brush(str(path)).sha256
    assert _core.write_brush(brush).encode() == path.read_bytes()
    for law in LAWS:
        profile = getattr(brush, law)
        assert profile.source, f"{law} does not say where it comes from"


def test_shipped_files_equal_the_output_of_the_tool(make_brushes, tmp_path, monkeypatch):
    made = make_brushes.brush_files()
    assert sorted(made) == sorted(path.name for path in SHIPPED.iterdir())
    monkeypatch.setattr("sys.argv", ["make_brushes.py", str(tmp_path)])
    make_brushes.main()
    for name, text in made.items():
        assert (SHIPPED / name).read_bytes() == text.encode() == (tmp_path / name).read_bytes()


def test_laws_of_round_6():
    brush = find_brush("round-6")
    assert tuple(brush.depth_range_mm) == (0, 10)
    assert brush.kind == "round"
    assert brush.max_speed_mm_s == 25
    assert brush.paint_depth_mm == 5
    assert list(brush.lag.coefficients) == [3.1, 0.86, 0.31, -0.05, 0.0021]
    assert list(brush.lag.half_interval_95) == [0.9, 1.57, 0.68, 0.103, 0.0051]
    assert list(brush.tip_gap.half_interval_95) == [0, 0.09]
    assert [getattr(brush, law).rmse_mm for law in LAWS] == [0.58, 0.85, 0.51, None]
    assert [getattr(brush, law).assumed for law in LAWS] == [False, False, False, True]
    assert [tuple(getattr(brush, law).calibrated_mm or ()) for law in LAWS] == [(1, 10)] * 3 + [()]
    assert json.loads(brush.extra)["footprints"]["assumed"] is True
    assert "2.1e-4" in brush.lag.source and "2.1e-3" in brush.lag.source
    # These values are calculated by hand from the printed polynomials. The tails of plain vertical lifts are
    # r(d) - r(0).
    for depth, lag, gap, widest, half in [
        (0, 3.1, 0, 0, 0),
        (0.5, 3.60138125, 0.26, 0.063, 0.21),
        (1, 4.2221, 0.52, 0.126, 0.42),
        (2, 5.6936, 1.04, 1.662, 0.84),
        (5, 10.2125, 2.6, 3.9, 2.1),
        (10, 13.7, 5.2, 7.15, 4.2),
    ]:
        assert brush.lag(depth) == pytest.approx(lag, abs=1e-12)
        assert brush.tip_gap(depth) == pytest.approx(gap, abs=1e-12)
        assert brush.tip_to_widest(depth) == pytest.approx(widest, abs=1e-12)
        assert brush.half_width(depth) == pytest.approx(half, abs=1e-12)
    assert [round(brush.lag(d) - brush.lag(0), 1) for d in (3, 6, 10)] == [4.2, 8.2, 10.6]


def test_outlines_of_round_6():
    brush = find_brush("round-6")
    table = shipped_json("round-6")["footprints"]
    assert [shape["depth_mm"] for shape in table["dragged"]] == list(range(1, 11))
    assert table["pressed"] == []
    for shape in table["dragged"]:
        depth = shape["depth_mm"]
        outline = np.array(shape["outline_mm"])
        widest, half = brush.tip_to_widest(depth), brush.half_width(depth)
        front = min(half, max(7 - widest, 0.25 * half))
        assert outline.shape == (65, 2)
        assert outline[0].tolist() == [0, 0]
        np.testing.assert_allclose(outline[[1, -1]], [[widest, -half], [widest, half]], atol=0.6e-4)
        np.testing.assert_array_equal(outline[1:], outline[:0:-1] * [1, -1])
        x, y = outline[1:].T
        on_ellipse = np.hypot((x - widest) / front, y / half)
        np.testing.assert_allclose(on_ellipse, 1, atol=1e-4 / min(front, half))
        assert np.all(x >= widest - 0.6e-4)
        assert x.max() == pytest.approx(widest + front, abs=2e-3)
        edges = np.roll(outline, -1, axis=0) - outline
        turns = np.cross(np.c_[edges, 0 * x[:1].repeat(65)], np.c_[np.roll(edges, -1, axis=0), np.zeros(65)])
        assert np.all(turns[:, 2] > 0), "convex and counter-clockwise"
        assert np.hypot(*edges[1:-1].T).max() < 0.06 * half + 0.06 * front, "spread along the ellipse"


def test_rigid_brush_is_a_disc_without_lag():
    brush = find_brush("rigid")
    assert brush.is_rigid() and not brush.width_follows_depth()
    assert 0 < brush.paint_depth_mm < brush.depth_range_mm[1]
    for shape in shipped_json("rigid")["footprints"]["dragged"]:
        outline = np.array(shape["outline_mm"])
        assert outline.shape == (64, 2) and outline[0].tolist() == [0, 0]
        centre = [brush.tip_gap(shape["depth_mm"]), 0]  # the contact with the paper, where the TCP is
        np.testing.assert_allclose(np.hypot(*(outline - centre).T), 0.5, atol=1e-4)
        x, y = outline.T
        assert 0.5 * np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y) == pytest.approx(math.pi / 4, rel=2e-3)


def test_unknown_name_lists_the_known_names():
    with refused("brush-unknown round-7 rigid round-6"):
        find_brush("round-7")


@pytest.mark.parametrize("name", ["none.json", "folder/none", Path("none")])
def test_missing_file_is_refused(name, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with refused("file-unreadable") as refusal:
        find_brush(name)
    assert refusal.value.file == str(name)


def test_a_file_does_not_hide_a_shipped_brush(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "rigid").write_text("{}")
    assert find_brush("rigid").name == "rigid"


def test_the_printed_laws_of_the_article_are_refused(changed):
    def printed(content):
        content["lag"]["coefficients"][4] = 2.1e-4

    path = changed(printed)
    with refused("law-negative", "lag") as refusal:
        find_brush(path)
    assert refusal.value.value == pytest.approx(-5.2)
    assert refusal.value.file == str(path)


def _set(*keys, to):
    def change(content):
        for key in keys[:-1]:
            content = content[key]
        content[keys[-1]] = to

    return change


def _drop(*keys):
    def change(content):
        for key in keys[:-1]:
            content = content[key]
        del content[keys[-1]]

    return change


@pytest.mark.parametrize(
    ("change", "where", "expected"),
    [
        (_set("version", to=2), "version", "version-unknown 2 brushsvg/brush"),
        (_set("format", to="brushsvg/plan"), "format", "format-unknown brushsvg/plan"),
        *[(_drop(key), key, f"key-missing {key}") for key in ("format", "version", "name", *LAWS)],
        (_drop("depth_range_mm"), "depth_range_mm", "key-missing"),
        (_drop("footprints"), "footprints", "key-missing"),
        (_drop("footprints", "dragged"), "footprints.dragged", "key-missing"),
        (_drop("tip_gap", "coefficients"), "tip_gap.coefficients", "key-missing"),
        (_set("lag", "coefficients", 2, to="0.31"), "lag.coefficients[2]", "wrong-type number"),
        (_set("lag", "coefficients", 2, to=math.nan), "lag.coefficients[2]", "not-json 'line 1'"),
        (_set("lag", "coefficients", 2, to=-math.inf), "lag.coefficients[2]", "not-json"),
        (
            _set("footprints", "dragged", 3, "outline_mm", 5, to=[1]),
            "footprints.dragged[3].outline_mm[5]",
            "wrong-type '[x, y]'",
        ),
        (
            _drop("footprints", "dragged", 3, "outline_mm", 5),
            "footprints.dragged[3].outline_mm",
            "footprint-invalid 64 65",
        ),
        (_set("half_width", "coefficients", to=[4.2, -0.42]), "half_width", "width-falls"),
        (_set("kind", to="flat"), "kind", "choice-unknown flat"),
        (_set("paint", to={}), "paint.narrows_per_m", "key-missing"),
        (_set("paint", to={"narrows_per_m": 30}), "paint.narrows_per_m", "out-of-range 0 20"),
        (_set("paint", to={"narrows_per_m": 0.3, "lasts_mm": 0}), "paint.lasts_mm", "out-of-range 1 1e+06"),
        (
            _set("paint", to={"narrows_per_m": 0.3, "covariance": [[1, 0], [0, 1]]}),
            "paint.covariance",
            "covariance-invalid 1 narrows_per_m",
        ),
        (
            _set("half_width", "coefficients", to=[0, 1.5]),
            "footprints.dragged[0]",
            "footprint-against-law 0.5",
        ),
    ],
)
def test_errors_name_their_key(changed, change, where, expected):
    with refused(expected, where):
        find_brush(changed(change))


PAINT = {
    "narrows_per_m": 0.4,
    "lasts_mm": 600,
    "calibrated_mm": [0, 700],
    "source": "By eye.",
    "assumed": True,
    "covariance": [[0.0004, 0.1], [0.1, 900]],
    "degrees_of_freedom": 10,
    "medium": "ink",
}


def test_paint_keys_are_kept_shown_and_checked(changed, capsys, tmp_path):
    path = changed(_set("paint", to=PAINT))
    brush = find_brush(path)
    assert brush.paint.width_share(500) == pytest.approx(math.exp(-0.2))
    assert json.loads(_core.write_brush(brush))["paint"] == PAINT
    assert [notice.where for notice in unknown_keys(brush)] == ["paint.medium"]
    assert "law-assumed" in {each.code for each in _core.remarks(brush) if each.where == "paint"}
    main(["brush", "show", str(path)])
    reported = capsys.readouterr().out
    # 2.228 comes from a table of Student's t with 10 degrees of freedom; 0.02 is the standard error.
    for part in (
        "exp(-0.4 s / 1000)",
        "dry after 600 mm",
        "0.4 +- 0.045 per metre",
        "0 to 700 mm",
        "By eye.",
    ):
        assert part in reported
    like = brushsvg.brush_like("mine", brush)
    assert like.paint.assumed and not like.paint.covariance and like.paint.narrows_per_m == 0.4


def test_a_brush_like_a_learned_one_has_learned_nothing(changed):
    """The new brush kept the photographs of the known one, and was refused an update from them."""
    learned = {"brushes": ["a" * 64], "photos": ["b" * 64], "deepest_mm": {"lag": 4.0}}
    brush = find_brush(changed(_set("learned", to=learned)))
    assert learned_of(brush) == learned and learned_of(brush_like("mine", brush)) == {}


def test_a_brush_without_paint_has_no_paint_key():
    for name in brush_names():
        assert find_brush(name).paint is None
        assert "paint" not in shipped_json(name)


def test_broken_files_are_refused(tmp_path):
    whole = (SHIPPED / "round-6.json").read_bytes()
    path = tmp_path / "broken.json"
    not_utf8 = whole.replace(b"round", b"\xff", 1)
    for data in (b"", whole[:-3], whole[: len(whole) // 2], b"\x89PNG\r\n", b"[]", not_utf8):
        path.write_bytes(data)
        with pytest.raises(Error) as refusal:
            find_brush(path)
        assert refusal.value.file == str(path)


def test_unknown_keys_are_kept(changed, tmp_path):
    def add(content):
        content["maker"] = {"name": "Atelier", "year": 1889}
        content["lag"]["camera"] = "M200"
        content["footprints"]["glass"] = "matte"
        content["footprints"]["dragged"][2]["photo"] = "3.jpg"

    brush = find_brush(changed(add))
    save_brush(brush, tmp_path / "again.json")
    again = json.loads((tmp_path / "again.json").read_text())
    assert again == json.loads((tmp_path / "changed.json").read_text())


def test_save_writes_the_whole_file_or_nothing(tmp_path, monkeypatch):
    brush = find_brush("round-6")
    path = tmp_path / "mine.json"
    save_brush(brush, path)
    before = path.read_bytes()
    assert before == (SHIPPED / "round-6.json").read_bytes()

    lag = brush.lag
    for speed, law in [(math.inf, lag), (10, _core.Profile([-1.0] * 5))]:
        brush.max_speed_mm_s, brush.lag = speed, law
        with pytest.raises(Error):
            save_brush(brush, path)
    brush.lag = lag
    with monkeypatch.context() as patch:
        patch.setattr(os, "replace", lambda *_: (_ for _ in ()).throw(OSError(28, os.strerror(28))))
        with refused("file-unwritable") as refusal:
            save_brush(brush, path)
        assert refusal.value.file == str(path)
    assert path.read_bytes() == before
    assert os.listdir(tmp_path) == ["mine.json"]

    save_brush(brush, path)
    assert find_brush(path).max_speed_mm_s == 10


def mistyped(tmp_path):
    content = shipped_json("round-6")
    content["max_sped_mm_s"] = content.pop("max_speed_mm_s")
    content["lag"]["rmse"] = content["lag"].pop("rmse_mm")
    content["footprints"]["sources"] = "glass"
    content["comment"] = "of our studio"
    path = tmp_path / "own.json"
    path.write_text(json.dumps(content))
    return path


def test_an_unknown_key_is_reported_with_a_similar_known_key(tmp_path, capsys):
    status, _, reported = in_json(capsys, "brush", "check", mistyped(tmp_path))
    unknown = {one.where: one.sentence for _, one in reported if one.code == "key-unknown"}
    expected = {
        where: re.findall(r"[\w.]+_mm_s|lag\.\w+|footprints\.\w+", sentence) for where, sentence in unknown.items()
    }
    assert status == 0 and expected == {
        "max_sped_mm_s": ["max_speed_mm_s"],
        "lag.rmse": ["lag.rmse_mm"],
        "footprints.sources": ["footprints.source"],
        "comment": [],
    }


@pytest.mark.parametrize("name", brush_names())
def test_a_shipped_brush_has_no_unknown_key(name):
    assert not unknown_keys(find_brush(name))


def test_mistyped_keys_are_reported_but_not_notes(tmp_path, capsys):
    done = brushsvg.convert(ROOT / "examples" / "robot.svg", brush=mistyped(tmp_path))
    reported = [one for one in done.notices if one.code == "key-unknown"]
    assert {one.where for one in reported} == {"brush round-6"} and len(reported) == 3
    again = brushsvg.convert(done.plan, brush=mistyped(tmp_path))
    assert sum(one.code == "key-unknown" for one in again.notices) == 3
    status, _, by_chart = in_json(capsys, "chart", "-o", tmp_path / "chart.ngc", "--brush", mistyped(tmp_path))
    assert status == 0 and sum(notice.code == "key-unknown" for _, notice in by_chart) == 3


@pytest.mark.parametrize("extra", ["", "[", "[]", "[" * 100_000, '{"footprints": 3}'])
def test_a_hand_written_brush_may_have_extra_keys(extra):
    brush = find_brush("round-6")
    brush.extra = extra
    assert unknown_keys(brush) == []
    assert one_line(brush).startswith("round, lines")
    assert learned_of(brush) == {}
    assert json.loads(brush_like("own", brush).extra)["footprints"]["assumed"] is True
    with refused("footprints-assumed", "footprints"):
        refuse_assumed(brush)


def test_a_name_without_extension_suggests_the_existing_file(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    save_brush(find_brush("round-6"), "own.json")
    with refused("brush-unknown own.json"):
        find_brush("own")
    with refused("brush-unknown") as caught:
        find_brush("other")
    assert caught.value.advice == ""


@pytest.mark.parametrize("kind", ["round", "liner", "pen", "", "flat", "Round"])
def test_a_brush_of_an_unknown_kind_is_not_simulated(kind):
    brush = find_brush("round-6")
    brush.kind = kind
    plan = _core.Plan(passes=[_core.Pass("a", np.array([[0, 0, 0], [20, 0, -4], [60, 0, -4.0]]))])
    if kind in ("flat", "Round"):
        for use in (lambda: _core.simulate(plan, brush), lambda: _core.check(brush)):
            with refused(f"choice-unknown {kind} round liner pen", "kind"):
                use()
    else:
        assert _core.simulate(plan, brush).passes[0].pose[-1] == 2


@pytest.mark.parametrize("law", [*LAWS, "lever_to_widest"])
def test_a_law_refuses_depths_outside_the_brush_range(law):
    brush = find_brush("round-6")
    for depth in (50, -1, 10.001, math.nan):
        with refused("depth-out-of-range 10") as caught:
            getattr(brush, law)(depth)
        assert caught.value.range == (0.0, 10.0)
    value = getattr(brush, law)
    assert value(10 + 1e-9) == pytest.approx(value(10))
    assert value(0.0) == pytest.approx(value(-1e-9), abs=1e-6)
    if law != "lever_to_widest":
        with refused("depth-out-of-range 50"):
            value([1.0, 50.0])
        assert value.extrapolated(50) > 10 and value.depth_range_mm == (0.0, 10.0)
        brush.depth_range_mm = (0.0, 60.0)  # The law follows the brush's current depth range.
        assert getattr(brush, law)(50) == value.extrapolated(50)
        alone = brushsvg.Profile(value.coefficients)
        assert alone.depth_range_mm is None and alone(50) == pytest.approx(alone.extrapolated(50))


def test_a_negative_painting_depth_is_refused():
    brush = find_brush("round-6")
    stroke = _core.Stroke.from_points([(20, 20), (50, 20)], 4.0)
    plan = _core.compensate([stroke], brush, None).plan
    brush.paint_depth_mm = -5.0
    with pytest.raises(Error, match="painting depth") as refusal:
        _core.simulate(plan, brush)
    assert (refusal.value.value, refusal.value.range) == (-5.0, (0.0, 1000.0))
