"""A brush from a few numbers paints the typed widths and lists its assumptions.

Numbers that no brush can have are refused.
"""

import csv
import io
import json

import numpy as np
import pytest
from diagnostics import agrees, gives, in_json, refused

from brushsvg import _core, brush_like, compensate, find_brush, read_drawing, strokes
from brushsvg.calibration.numbers.from_widths import lag_of_turn, new_brush
from brushsvg.calibration.numbers.measurements import read_measurements, read_widths
from brushsvg.cli import main


@pytest.mark.parametrize(
    "widths",
    [
        [(3, 2.5), (8, 7)],
        [(3, 5), (8, 7)],  # a parabola through these points and 0 would fall before depth 8
        [(8, 7), (3, 5), (1, 2)],
        [(0.1, 0.3), (0.5, 1.1)],
        [(4, 5)],
    ],
)
def test_the_brush_has_the_typed_widths(widths):
    brush = new_brush("mine", 5.0, widths)
    depths = np.linspace(0, brush.depth_range_mm[1], 500)
    halves = np.array([brush.half_width(d) for d in depths])
    assert halves[0] == 0 and np.all(np.diff(halves) >= -1e-12)
    assert brush.depth_range_mm[1] == max(d for d, _ in widths)
    for depth, width in widths:
        assert 2 * brush.half_width(depth) == pytest.approx(width, abs=0.1)
        seen = _core.footprint_at(brush.footprints, depth, 1.0)
        assert np.ptp(seen[:, 1]) == pytest.approx(width, abs=0.15), "outlines and laws say the same"
    assert brush.lag.coefficients == (5.0,)


def test_assumed_laws_are_marked_as_assumed():
    brush = new_brush("mine", 5.0, [(3, 2.5), (8, 7)], 10)
    assert [getattr(brush, law).assumed for law in ("lag", "tip_gap", "tip_to_widest", "half_width")] == [
        True,
        True,
        True,
        False,
    ]
    assert "5 mm" in brush.lag.source
    assert gives(brush.half_width.source, "2.5 mm", "3 mm", "7 mm", "8 mm")
    assert tuple(brush.half_width.calibrated_mm) == (3, 8)
    assert new_brush("mine", 5.0, [(3, 2.5)]).half_width.assumed
    assert json.loads(brush.extra)["footprints"]["assumed"] is True


@pytest.mark.parametrize(
    ("lags", "at_rest_mm", "terms"),
    [
        ([(2, 5), (8, 14)], 2.0, 2),
        ([(8, 14), (2, 5), (5, 9.6)], 2.0, 2),  # a tenth off the line, which is no reason for a bend
        ([(2, 7), (5, 12), (8, 14)], 2.0, 3),
        ([(2, 1), (8, 13)], None, 3),  # the line through these points is negative at touch depth
    ],
)
def test_typed_lags_that_grow_with_depth_are_kept(lags, at_rest_mm, terms):
    brush = new_brush("mine", lags, [(3, 2.5), (8, 7)])
    for depth, lag in lags:
        assert brush.lag(depth) == pytest.approx(lag, abs=0.3)
    assert min(brush.lag(depth) for depth in np.linspace(0, 8, 200)) >= 0
    assert len(brush.lag.coefficients) == terms
    assert at_rest_mm is None or brush.lag(0.0) == pytest.approx(at_rest_mm, abs=0.15)
    assert not brush.lag.assumed and tuple(brush.lag.calibrated_mm) == (2, 8)
    assert gives(brush.lag.source, f"{lags[-1][1]} mm", "8 mm") or lags[0][0] == 8


def test_one_lag_at_a_depth_is_the_lag_at_all_depths():
    one, other = new_brush("mine", [(4, 5.0)], [(3, 2.5)]), new_brush("mine", 5.0, [(3, 2.5)])
    assert one.lag == other.lag and one.lag.assumed
    twice = new_brush("mine", [(3, 5.0), (3, 5.4)], [(3, 2.5)]).lag
    assert twice.coefficients == pytest.approx((5.2,)) and twice.assumed


@pytest.mark.parametrize(
    ("lags", "expected"),
    [
        ([], "measurement-missing"),
        ([(3, 0)], "out-of-range 0"),
        ([(3, float("inf"))], "out-of-range inf"),
        ([(-1, 5)], "depth-out-of-range -1"),
        ([(3, 5), (9, 8)], "depth-out-of-range 9 8"),
        ([3, 5], "wrong-type"),
        ([(3, "5")], "wrong-type"),
        ([(1, 5), (2, 20), (4, 3), (5, 18), (7, 2)], "law-undetermined"),
    ],
)
def test_impossible_lags_are_refused(lags, expected):
    with refused(expected):
        new_brush("mine", lags, [(3, 2.5), (8, 7)])


def test_a_build_without_fits_names_the_missing_package(monkeypatch):
    monkeypatch.delattr(_core, "fit_law")
    with refused("package-missing Ceres"):
        new_brush("mine", 5.0, [(3, 2.5)])


def test_zero_lag_makes_a_pen():
    pen = new_brush("pen", 0.0, [(0.2, 1.0)])
    assert pen.is_rigid() and pen.kind == "pen" and not pen.width_follows_depth()
    assert pen.half_width(0.01) == 0.5


@pytest.mark.parametrize(
    ("widths", "deepest", "expected"),
    [
        ([], None, "measurement-missing"),
        ([(3, 7), (8, 2)], None, "width-falls"),
        ([(0.2, 0.5), (1, 0.3)], None, "law-falls 0.2 1"),
        ([(3, -1)], None, "out-of-range -1"),
        ([(0, 1)], None, "depth-out-of-range 0"),
        ([(3, float("nan"))], None, "out-of-range nan"),
        ([(3, 2)], 2, "depth-out-of-range 2"),
    ],
)
def test_impossible_widths_and_depths_are_refused(widths, deepest, expected):
    with refused(expected):
        new_brush("mine", 5.0, widths, deepest)


def test_lags_in_the_wrong_order_are_refused():
    """A line meets any two lags, so the distance from the law does not show it. `calibrate` refuses them, too."""
    with refused("law-falls 6 2 5", "lag"):
        new_brush("mine", [(2, 9), (5, 3)], [(2, 2), (5, 5)])
    assert new_brush("mine", [(2, 6), (5, 5)], [(2, 2), (5, 5)]).lag(5) == pytest.approx(5), "read with a ruler"


def test_widths_can_be_read_from_a_table():
    assert read_widths("\ufeffdepth_mm, width_mm,note\n3, 2.5,a\n8,7,b\n") == [(3, 2.5), (8, 7)]
    for text, where, expected in [
        ("3,2.5\n", "", "table-columns depth_mm,width_mm"),
        ("", "", "table-columns depth_mm,width_mm"),
        ("depth_mm,width_mm\n3,wide\n", "line 2, width_mm", "not-a-number wide"),
        ("depth_mm,width_mm\n3\n", "line 2, width_mm", "not-a-number"),
    ]:
        with refused(expected, where):
            read_widths(text)


@pytest.mark.parametrize("ending", ["\n", "\r\n"])
@pytest.mark.parametrize("separator", [",", ";", "\t"])
@pytest.mark.parametrize("mark", [".", ","])
def test_a_table_is_read_in_any_spreadsheet_format(separator, mark, ending):
    """A table is read in any form that a spreadsheet writes.

    Values that contain the separator are in quotes, and the sheet has empty rows and columns.
    """
    cells = [["depth_mm", "note", "width_mm", ""], ["3", "1,5 or 1.5; a", "2.5", ""], ["", "", "", ""]]
    cells += [["+8.25", "", "7e0", ""]]
    for row in cells:
        row[:] = [row[0].replace(".", mark), row[1], row[2].replace(".", mark), row[3]]
    file = io.StringIO()
    csv.writer(file, delimiter=separator, lineterminator=ending).writerows(cells)
    assert read_widths(file.getvalue()) == [(3, 2.5), (8.25, 7)]
    measured = io.StringIO()
    csv.writer(measured, delimiter=separator, lineterminator=ending).writerows(
        [["kind", "depth_mm", "value_mm"], ["lag", f"3{mark}5", f"7{mark}25"]]
    )
    (row,) = read_measurements(measured.getvalue().encode(), ".csv").rows["lag"]
    assert (row.depth_mm, row.numbers["value_mm"], row.where) == (3.5, 7.25, "line 2")


@pytest.mark.parametrize(
    ("table", "where", "expected"),
    [
        (
            "depth_mm;width_mm\n3;2,5\n8;7.1\n",
            "line 2, width_mm",
            "table-separators '2,5' '7.1'",
        ),
        ("depth_mm;width_mm\n3;1.234,5\n", "line 2, width_mm", "not-a-number '1.234,5'"),
        ("depth_mm;width_mm\n3;1,234,567\n", "line 2, width_mm", "not-a-number '1,234,567'"),
        ("depth_mm;width_mm\n3,2.5\n", "line 2, depth_mm", "not-a-number '3,2.5'"),
        ("depth_mm,width_mm\n3;2,5\n", "line 2, depth_mm", "not-a-number '3;2'"),
        (
            "depth_mm;width_mm\n3;2;5\n",
            "line 2",
            "table-columns '5'",
        ),
        ("depth_mm,width_mm\n3,2,5\n", "line 2", "table-columns 5"),
        ("depth_mm,width_mm,a;depth_mm;width_mm\n", "line 1", "table-separators"),
        (
            "depth_mm|width_mm\n3|2\n",
            "",
            "table-columns depth_mm width_mm",
        ),
        ("depth_mm;weight\n3;2\n", "", "table-columns width_mm"),
        ("depth_mm;width_mm\n3;1_0\n", "line 2, width_mm", "not-a-number '1_0'"),
        ("depth_mm;width_mm\n3;\u0663\n", "line 2, width_mm", "not-a-number"),
        ('depth_mm;width_mm\n"3;2\n', "line 2, depth_mm", "not-a-number"),
    ],
)
def test_an_ambiguous_table_is_refused(table, where, expected):
    with refused(expected, where) as refusal:
        read_widths(table)
    assert ("4.6" in str(refusal.value)) == table.endswith("3,2,5\n"), "only commas can be both"


def test_the_command_makes_a_brush_that_paints(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "w.csv").write_text("depth_mm,width_mm\n3,2.5\n8,7\n")
    assert main("brush new -o mine.json --lag 5 --width-at 3=2.5 --width-at 8=7 --depth-max 10".split()) == 0
    reported = capsys.readouterr().out
    assert gives(reported, "lag", "tip_gap", "tip_to_widest", "8 mm", "8.9 mm", "10 mm")
    assert main("brush new -o flat.json --lag 5 --width-at 3=2.5 --width-at 8=7".split()) == 0
    assert not gives(capsys.readouterr().out, "tip_to_widest", "8 mm"), "nothing is beyond what was measured"
    words = "brush new -o deep.json --lag-at 2=5 --lag-at 6=11 --width-at 3=2.5 --width-at 8=7".split()
    assert main(words) == 0
    reported = capsys.readouterr().out
    assert gives(reported, "tip_gap", "tip_to_widest", "6 mm", "14.0 mm", "8 mm")
    assert find_brush("deep.json").lag.coefficients == pytest.approx((2.0, 1.5))
    words = "brush new -o sub/mine.json --lag 5 --widths w.csv --depth-max 10".split()
    status, _, ((_, reported),) = in_json(capsys, *words)
    assert status == 1 and agrees(reported, "file-unwritable")
    assert main("brush new -o ./table.json --lag 5 --widths w.csv --depth-max 10 --speed 12".split()) == 0
    mine, table = (json.loads((tmp_path / f"{name}.json").read_text()) for name in ("mine", "table"))
    assert mine.pop("name") == "mine" and table.pop("name") == "table"
    assert mine.pop("max_speed_mm_s") == 25 and table.pop("max_speed_mm_s") == 12
    assert mine == table
    drawing = tmp_path / "line.svg"
    drawing.write_text(
        '<svg xmlns="http://www.w3.org/2000/svg" width="100mm" height="60mm" viewBox="0 0 100 60">'
        '<path d="M20,30 C40,10 60,50 80,30" fill="none" stroke="#000" stroke-width="4"/></svg>'
    )
    read = read_drawing(drawing)
    done = compensate(strokes(read)[0], find_brush(tmp_path / "mine.json"), read.sheet_mm)
    assert done.tracking_errors[0].largest_mm < 0.05


def test_a_copied_brush_paints_the_same_and_claims_no_measurement(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert main("brush new -o mine.json --like round-6 --speed 12".split()) == 0
    assert "tip_gap" not in capsys.readouterr().out, "all of it is assumed, not some"
    mine, round_6 = find_brush("mine.json"), find_brush("round-6")
    assert (mine.name, mine.max_speed_mm_s, mine.kind) == ("mine", 12, "round")
    assert mine.footprints == round_6.footprints and mine.depth_range_mm == round_6.depth_range_mm
    for law in ("lag", "tip_gap", "tip_to_widest", "half_width"):
        its, others = getattr(mine, law), getattr(round_6, law)
        assert its(np.linspace(0, 10, 21)).tolist() == others(np.linspace(0, 10, 21)).tolist()
        assert its.assumed and gives(its.source, "round-6", others.source)
        assert its.rmse_mm is None and its.half_interval_95 == ()
    assert json.loads(mine.extra)["footprints"]["assumed"] is True
    assert gives(json.loads(mine.extra)["about"], "round-6")
    assert brush_like("mine", round_6).footprints == round_6.footprints and round_6.name == "round-6"


@pytest.mark.parametrize(
    ("typed", "expected"),
    [
        ("brush new -o mine.json --lag 5", "--widths FILE"),
        ("brush new -o mine.json --lag 5 --width-at 3", "3=2.5"),
        ("brush new -o mine.json --like round-6 --lag 5", "--like"),
        ("brush new -o mine.json --like round-6 --width-at 3=2", "--like"),
        ("brush new -o mine.json --like round-6 --depth-max 9", "--like"),
        ("brush new -o mine.json --width-at 3=2", "--lag"),
        ("brush new -o mine.json --lag 5 --lag-at 3=7 --width-at 3=2", "--lag-at"),
        ("brush new -o mine.json --lag-at 3 --width-at 3=2", "3=7.4"),
        ("brush new -o mine.json --like round-6 --lag-at 3=7", "--like"),
        ("brush plot round-6 -o out.pdf", ".png or .svg"),
    ],
)
def test_wrong_usage_is_refused(typed, expected, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert main(typed.split()) == 2
    assert expected in capsys.readouterr().err
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("typed", "file", "expected"),
    [
        ("brush new -o round-6.json --lag 5 --width-at 3=2", "round-6.json", "name-taken round-6"),
        ("brush new -o mine.json --lag 5 --widths none.csv", "none.csv", "file-unreadable"),
        ("brush new -o mine.json --like round-7", "mine.json", "brush-unknown round-7"),
        ("brush new -o rigid.json --like round-6", "rigid.json", "name-taken rigid"),
        ("brush new -o mine.json --lag 5 --width-at 3=7 --width-at 8=2", "mine.json", "width-falls"),
        ("brush new -o odd.json --lag 5 --width-at 0.001=900", "odd.json", "not-millimetres"),
    ],
)
def test_input_that_makes_no_brush_is_refused(typed, file, expected, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    status, _, ((about, reported),) = in_json(capsys, *typed.split())
    assert (status, about) == (1, file) and agrees(reported, expected), reported
    assert not list(tmp_path.iterdir())


def test_an_existing_brush_is_not_overwritten(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "mine.json").write_text("somebody's")
    status, _, ((_, reported),) = in_json(capsys, *"brush new -o mine.json --lag 5 --width-at 3=2".split())
    assert (status, reported.code) == (1, "file-exists")
    assert (tmp_path / "mine.json").read_text() == "somebody's"


def test_a_brush_without_a_name_is_refused(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert main(["brush", "new", "-o", ".json", "--lag", "5", "--width-at", "3=3"]) == 2
    assert gives(capsys.readouterr().err, ".json")
    assert not list(tmp_path.iterdir())


# Three depths ---------------------------------------------------------------------------------------


class Terminal(io.StringIO):
    def isatty(self):
        return True


def answered(monkeypatch, capsys, words, answers):
    """Return the exit status, standard output, and the text that the terminal showed."""
    shown = Terminal()
    monkeypatch.setattr("sys.stdin", Terminal("\n".join(answers)))
    monkeypatch.setattr("sys.stderr", shown)
    return main([*map(str, words)]), capsys.readouterr().out, shown.getvalue()


def test_a_terminal_prompts_for_three_depths_and_shows_equivalent_flags(tmp_path, monkeypatch, capsys):
    requested, typed = tmp_path / "asked.json", tmp_path / "typed.json"
    answers = "2 1.5 4 nonsense 5 3,5 6 8 5 7.5".split()
    status, out, shown = answered(monkeypatch, capsys, ["brush", "new", "-o", requested], answers)
    assert status == 0 and out.startswith(str(requested))
    flags = shown[shown.index("--lag-at 2=") :].splitlines()[0].split()
    lags = {2: 4.45, 5: 7.05, 8: 9.0}  # the turn plus 0.3 of the width
    widths = {2: 1.5, 5: 3.5, 8: 5}
    assert flags == [
        word for d in lags for word in ("--lag-at", f"{d}={lags[d]:g}", "--width-at", f"{d}={widths[d]:g}")
    ]
    status, _, reported = in_json(capsys, "brush", "new", "-o", typed, *flags)
    assert (status, reported) == (0, [])
    one, other = (json.loads(at.read_text()) | {"name": ""} for at in (requested, typed))
    assert one == other


def test_incomplete_answers_write_nothing(tmp_path, monkeypatch, capsys):
    out = tmp_path / "mine.json"
    status, _, _ = answered(monkeypatch, capsys, ["brush", "new", "-o", out], ["2", "1.5"])
    assert status == 1 and not out.exists()


def test_json_messages_disable_prompts(tmp_path, monkeypatch, capsys):
    words = ["--messages", "json", "brush", "new", "-o", tmp_path / "mine.json"]
    assert answered(monkeypatch, capsys, words, "2 1.5 4 5 3.5 6 8 5 7.5".split())[0] == 2


def test_brush_new_without_a_terminal_explains_how_to_measure(tmp_path, capsys):
    out = tmp_path / "mine.json"
    assert main(["brush", "new", "-o", str(out)]) == 2
    reported = capsys.readouterr()
    assert reported.out == "" and not out.exists()
    assert gives(reported.err, "90", "--lag-at", "--width-at", "--like")


@pytest.mark.parametrize(
    ("words", "depths"),
    [
        ("--lag 5 --width-at 3=2.5", 1),
        ("--lag 5 --width-at 2=2 --width-at 3=2.5 --width-at 4=3", 1),
        ("--lag-at 2=5 --lag-at 3=6 --lag-at 4=7 --width-at 2=2 --width-at 4=3", 2),
        ("--lag-at 2=5 --lag-at 3=6 --lag-at 4=7 --width-at 2=2 --width-at 3=2.5 --width-at 4=3", None),
        ("--lag 0 --width-at 3=2.5", None),
        ("--like round-6", None),
    ],
)
def test_fewer_than_three_depths_cause_a_warning(tmp_path, capsys, words, depths):
    status, _, reported = in_json(capsys, "brush", "new", "-o", tmp_path / "mine.json", *words.split())
    assert status == 0
    notices = [notice for _, notice in reported if notice.code == "few-depths"]
    assert len(notices) == (depths is not None)
    assert not depths or agrees(notices[0], f"few-depths {depths}")


def test_the_lag_from_a_turn_is_the_lag_of_the_brush():
    """The lag computed from a turn is the lag of the brush made from it.

    The middle of this brush's mark turns where the ruler read the turn.
    """
    brush = new_brush("mine", [(2, 4.45), (5, 7.05), (8, 9.0)], [(2, 1.5), (5, 3.5), (8, 5)])
    for depth, width, turn in ((2, 1.5, 4.0), (5, 3.5, 6.0), (8, 5.0, 7.5)):
        assert lag_of_turn(turn, width) == pytest.approx(brush.lag(depth), abs=0.3)
        ahead = brush.tip_to_widest(depth) - brush.tip_gap(depth)
        assert brush.lag(depth) - ahead == pytest.approx(turn, abs=0.3)


def test_a_wrong_speed_is_reported_as_a_speed(capsys):
    """Its message was once that of a factor of playback."""
    assert main("brush new -o mine.json --lag 5 --width-at 3=4 --speed fast".split()) == 2
    assert gives(capsys.readouterr().err, "--speed", "'fast'", "mm/s")
