"""brushsvg.convert does the same as the command, in one call from Python."""

import copy
import io
import itertools
import re
import sys
import threading
from concurrent.futures import CancelledError
from contextlib import suppress
from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from xml.etree import ElementTree

import ezdxf
import numpy as np
import pytest
import svgpathtools
from diagnostics import agrees, refused
from sampling import sample

import brushsvg
from brushsvg.cli import main
from brushsvg.cli.arguments import values
from brushsvg.cli.arguments.parser import command_parser
from brushsvg.jobs.choices.choices import CHOICE_RANGES, CHOICE_VALUES, CHOICES, ChoiceKeywords
from brushsvg.jobs.conversion import simulate_and_check
from brushsvg.jobs.options import Options
from brushsvg.jobs.preparation.preparation import prepare
from brushsvg.machine.cells.cell_file import find_cell
from brushsvg.machine.job_program import Job
from brushsvg.reporting.report_text import format_overlap

PAGE = '<svg xmlns="http://www.w3.org/2000/svg" width="120mm" height="60mm" viewBox="0 0 120 60"{}>{}</svg>'
LINE = '<path id="{}" d="M{} 40 C40 10 60 10 {} 30" fill="none" stroke="{}" stroke-width="{}"/>'
TWO = PAGE.format("", LINE.format("a", 20, 90, "#203060", 3) + LINE.format("b", 30, 100, "#a03020", 4))


@pytest.fixture
def desk(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("two.svg").write_text(TWO)
    return tmp_path


@pytest.mark.parametrize(
    ("out", "flags", "choices"),
    [
        ("o.ngc", "", {}),
        ("o.json", "--compensation constant --lag 6", {"compensation": "constant", "lag": 6}),
        ("o.script", "--cell ur5e --tolerance 0.1", {"cell": "ur5e", "tolerance": 0.1}),
        ("o.ngc", "--order nearest --z-offset -0.3 --from-stroke 2", {"z_offset": -0.3}),
        ("o.ngc", "--fit 60x30 --width 2 --speed 9", {"fit": (60, 30), "width": 2, "paint_speed": 9}),
    ],
)
def test_python_convert_gives_the_same_files_as_the_command(desk, out, flags, choices):
    near_by = {"picture": "o.svg", "report": "o.txt", "page": "p.svg"}
    typed = itertools.chain(*((f"--{name}", path) for name, path in near_by.items()))
    assert main(["convert", "two.svg", "-o", out, *typed, *flags.split()]) == 0
    names = [out, *near_by.values()]
    by_command = {name: Path(name).read_bytes() for name in names}
    for name in names:
        Path(name).unlink()
    if "--order" in flags:
        choices = choices | {"order": "nearest", "from_stroke": 2}
    done = brushsvg.convert("two.svg", out, **near_by, **choices)
    assert {name: Path(name).read_bytes() for name in names} == by_command
    assert sorted(done.files) == sorted(names) and done.files[0] == out
    assert list(done.texts) == [Path(out).suffix] and done.text.encode() == by_command[out]
    assert format_overlap(done.figures.total.overlap) in by_command["o.txt"].decode()


@pytest.mark.parametrize(("z_offset", "is_reported"), [(-20, True), (-2, True), (-1, False), (20, False)])
def test_a_tool_commanded_far_below_the_paper_causes_a_warning(desk, z_offset, is_reported):
    """A tool commanded far below the paper causes a warning.

    With --z-offset -3 instead of -0.3, the brush or the table is crushed. There was no warning once.
    """
    reported = [
        notice for notice in brushsvg.convert("two.svg", z_offset=z_offset).notices if notice.where == "z_offset"
    ]
    assert [agrees(each, f"unusual-value {-z_offset} cell") for each in reported] == [True] * is_reported
    assert not brushsvg.convert("two.svg", formats=[".json"]).notices


def test_convert_without_a_path_writes_no_files(desk):
    done = brushsvg.convert("two.svg", cell="ur5e", formats=[".script", ".json"], figures=True)
    assert [path.name for path in desk.iterdir()] == ["two.svg"]
    assert brushsvg.write_plan(brushsvg.read_plan(done.texts[".json"])) == done.texts[".json"]
    assert (done.files, len(done.plan.passes)) == ((), 2)
    assert done.time_s > 5 and done.figures.total.overlap > 0.9
    assert "paper-example" in {notice.code for notice in done.notices}
    assert copy.copy(done) == done and "speedl" not in repr(done) and len(repr(done)) < 2000


def test_a_program_in_several_files_returns_all_files(desk):
    tiny = "".join(LINE.format(f"s{k}", 20, 60 + k / 4, "#203060", 3) for k in range(120))
    Path("many.svg").write_text(PAGE.format("", tiny))
    done = brushsvg.convert("many.svg", "many.ls", cell="lrmate200id")
    assert len(done.files) == len(done.texts) > 1
    assert {Path(name).read_text() for name in done.files} == {
        text.replace("\r\n", "\n") for text in done.texts.values()
    }


def _ezdxf():
    drawing = ezdxf.new(units=4)
    drawing.modelspace().add_line((0, 0), (50, 9), dxfattribs={"lineweight": 200})
    return drawing


@pytest.mark.parametrize("kind", ["Path", "Design", "ElementTree", "svgpathtools", "Plan"])
def test_any_form_of_a_drawing_gives_the_same_program(desk, kind):
    source = {
        "Path": lambda: Path("two.svg"),
        "Design": lambda: brushsvg.read_drawing("two.svg"),
        "ElementTree": lambda: ElementTree.parse("two.svg"),
        "svgpathtools": lambda: svgpathtools.Document("two.svg"),
        "Plan": lambda: brushsvg.convert("two.svg").plan,
    }[kind]()
    texts = [brushsvg.convert(each, formats=[".json"]).text for each in ("two.svg", source)]
    assert texts[0] == texts[1]


def test_a_plan_keeps_its_speed_when_another_one_is_requested(desk):
    plan = brushsvg.convert("two.svg").plan
    text = brushsvg.write_plan(plan)
    assert brushsvg.convert(plan, paint_speed=7).plan.passes[0].speed_mm_s == 7
    assert brushsvg.write_plan(plan) == text


def test_a_plan_does_not_depend_on_the_z_offset_of_the_project(desk):
    choices = {"cell": "grbl-servo", "formats": [".json"]}
    plain = brushsvg.convert("two.svg", **choices)
    assert brushsvg.convert("two.svg", z_offset=-8, from_project=("z_offset",), **choices).text == plain.text
    mixed = brushsvg.convert("two.svg", z_offset=0.5, from_stroke=2, cell="grbl-servo", formats=[".nc", ".json"])
    assert len(mixed.plan.passes) == 2 and "stroke 2 of 2" in mixed.text and "stroke 1 of 2" not in mixed.text


def test_an_open_dxf_document_gives_the_same_program_as_its_file(desk):
    _ezdxf().saveas("line.dxf")
    assert brushsvg.convert(_ezdxf()).text == brushsvg.convert("line.dxf").text


def test_settings_of_a_drawing_apply_as_with_the_command(desk):
    Path("says.svg").write_text(
        PAGE.format(
            ' data-brushsvg-cell="ur5e" data-brushsvg-compensation="none"',
            LINE.format(*"a", 20, 90, "red", 3),
        )
    )
    for source in ("says.svg", ElementTree.parse("says.svg")):
        assert "compensation: none" in brushsvg.convert(source).texts[".script"]


def test_ends_of_a_drawing_need_no_compensation_and_chosen_ones_do(desk):
    """The ends that a drawing asks for hold for other compensations, too."""
    line = LINE.format(*"a", 20, 90, "red", 3)
    Path("ends.svg").write_text(PAGE.format(' data-brushsvg-terminals="butt"', line))
    assert brushsvg.convert("ends.svg", compensation="none", start="auto").plan.passes
    Path("none.svg").write_text(PAGE.format(' data-brushsvg-compensation="none"', line))
    with refused("options-contradict start butt none"):
        brushsvg.convert("none.svg", start="butt")
    assert brushsvg.convert("none.svg", start="butt", compensation="closed").plan.passes


@pytest.mark.parametrize(
    ("choices", "expected"),
    [
        ({"width": 5000}, "out-of-range 5000 0.001 1000"),
        ({"wide": "most"}, "choice-unknown auto clamp"),
        ({"lag": 3}, "options-contradict"),
        *(
            ({name: "butt", "compensation": method}, f"options-contradict {name} butt {method}")
            for name, method in (("terminals", "none"), ("start", "constant"), ("end", "none"))
        ),
        ({"units": "mm"}, "options-contradict"),
        ({"fit": (1, 2), "scale": 2}, "options-contradict"),
        ({"formats": [".txt"]}, "program-format .txt"),
        ({"out": "o.script"}, "program-format .script"),
        ({"picture": "o.bmp"}, "program-format o.bmp"),
        ({"width": 300}, "width-out-of-reach 300 8.4 a"),
        ({"sheet": (50, 50)}, "tool-off-sheet right a"),
        ({"from_stroke": 7}, "stroke-unknown 7 2"),
        ({"from_stroke": 1.5}, "wrong-type 1.5"),
        ({"from_stroke": 2, "out": "o.json"}, "options-contradict from_stroke"),
        ({"z_offset": 1, "out": "o.json"}, "options-contradict z_offset"),
        ({"brush": "none"}, "brush-unknown none"),
        ({"cancel": 5}, "wrong-type 5"),
        ({"progress": 5}, "wrong-type 5"),
        ({"lenient": "no"}, "wrong-type no True lenient"),
        ({"figures": 2}, "wrong-type 2 True figures"),
        ({"join": "false"}, "wrong-type false True join"),
    ],
)
def test_a_refusal_is_one_error_and_writes_nothing(desk, choices, expected):
    with pytest.raises(brushsvg.Error) as reported:
        brushsvg.convert("two.svg", **{"out": "o.ngc", **choices})
    assert [path.name for path in desk.iterdir()] == ["two.svg"]
    code, *numbers = expected.split()
    assert code in reported.value.code and all(
        number in str(reported.value) + reported.value.where for number in numbers
    )


@pytest.mark.parametrize("width", [9, 30, 4000, 40000])
def test_the_advised_scale_makes_a_line_paintable(desk, width):
    line = f'<path d="M50 50h40" fill="none" stroke="black" stroke-width="{width}"/>'
    svg = '<svg xmlns="http://www.w3.org/2000/svg" width="100mm" height="100mm" viewBox="0 0 100 100">'
    Path("wide.svg").write_text(f"{svg}{line}</svg>")
    with pytest.raises(brushsvg.Error) as refused:
        brushsvg.convert("wide.svg", sheet=None)
    factor = float(re.search(r"scale\D+([\d.e-]+)", str(refused.value)).group(1))
    assert 0.9 * 8.4 < factor * width <= 8.4
    assert brushsvg.convert("wide.svg", scale=factor).plan.passes


@pytest.mark.parametrize(
    ("out", "written"),
    [
        ("a.ngc", {"picture": "./a.svg"}),
        ("a.ngc", {"page": Path("link.svg")}),
        ("a.ngc", {"picture": "new.svg", "page": "below/../new.svg"}),
        ("new.json", {"report": "new.json"}),
        ("a.ngc", {"report": "brush.json", "brush": Path("brush.json")}),
    ],
)
def test_a_file_that_is_read_or_written_twice_is_refused(desk, out, written):
    brushsvg.save_brush(brushsvg.find_brush("round-6"), "brush.json")
    Path("a.svg").write_text(TWO)
    Path("link.svg").symlink_to("a.svg")
    before = {path.name: path.read_bytes() for path in Path().iterdir() if path.is_file()}
    with refused("options-contradict"):
        brushsvg.convert("a.svg", out, **written)
    assert before == {path.name: path.read_bytes() for path in Path().iterdir() if path.is_file()}


def test_arrays_are_accepted_like_lists(desk):
    given = {"sheet": (150, 120), "fit": (60, 40), "origin": (30, 35)}
    arrays = {name: np.array(pair) for name, pair in given.items()}
    assert brushsvg.convert("two.svg", **arrays).text == brushsvg.convert("two.svg", **given).text
    with refused("wrong-type 3"):
        brushsvg.convert("two.svg", sheet=np.zeros(3))
    lags, widths = [(2, 4), (8, 9)], [(3, 2.5), (8, 7)]
    assert brushsvg.new_brush("n", np.array(lags), np.array(widths)) == brushsvg.new_brush("n", lags, widths)
    brush = brushsvg.find_brush("round-6")
    assert brushsvg.chart(brush, np.array([210, 297])).plan == brushsvg.chart(brush, (210, 297)).plan


@pytest.mark.parametrize("number", [Fraction, np.float32, np.longdouble])
def test_any_real_number_is_as_a_float(desk, number):
    """The choices are numbers that each of these types represents exactly."""
    given = {"sheet": (150, 120), "origin": (30, 35), "scale": 0.5, "tolerance": 0.0625, "paint_speed": 12.5}
    given |= {"z_offset": 0.25, "compensation": "constant", "lag": 3.5, "width": 2.5}

    def typed(value):
        return value if isinstance(value, str) else tuple(map(number, value)) if np.ndim(value) else number(value)

    others = {name: typed(value) for name, value in given.items()}
    assert brushsvg.convert("two.svg", **others).text == brushsvg.convert("two.svg", **given).text
    widths = [(3, 2.5), (8, 7)]
    made = brushsvg.new_brush("n", number(5.5), [tuple(map(number, pair)) for pair in widths], number(9), number(20))
    assert made == brushsvg.new_brush("n", 5.5, widths, 9, 20)
    lags = [(2, 4), (8, 9)]
    made = brushsvg.new_brush("n", [tuple(map(number, pair)) for pair in lags], widths)
    assert made == brushsvg.new_brush("n", lags, widths)
    made = brushsvg.stroke_from_path("M10 20 L30 25", number(2.5), page_height_mm=number(100))
    assert made == brushsvg.stroke_from_path("M10 20 L30 25", 2.5, page_height_mm=100)
    options = brushsvg.ReadOptions(sheet_mm=typed((150, 120)))
    assert brushsvg.read_drawing("two.svg", options).sheet_mm == (150, 120)


def test_further_reasons_of_a_refusal_are_exception_notes(desk):
    with refused("tool-off-sheet right") as reported:
        brushsvg.convert("two.svg", sheet=(60, 60))
    assert any("b" in note for note in reported.value.__notes__)


@pytest.mark.parametrize("name", [name for name in CHOICES if name != "input"])
def test_every_choice_refuses_invalid_values(desk, name):
    for value in (
        -1,
        1e300,
        float("nan"),
        10**400,
        "x",
        b"x",
        [],
        {},
        (1,),
        (1, "x"),
        [None],
        object(),
        True,
        "\0",
    ):
        with suppress(brushsvg.Error):
            brushsvg.convert("two.svg", **{name: value})


def test_brush_and_cell_objects_are_accepted(desk):
    brush, cell = brushsvg.find_brush("round-6"), brushsvg.find_cell("ur5e")
    assert brushsvg.convert("two.svg", brush=brush, cell=cell).text == brushsvg.convert("two.svg", cell="ur5e").text
    with refused("out-of-range decimals"):
        brushsvg.convert("two.svg", cell=replace(cell, decimals=400))


def test_the_page_has_a_row_for_every_choice():
    """The options page has a row for every choice.

    test_doc_code.py runs the page's code.
    """
    page = (Path(__file__).parents[2] / "docs" / "reference" / "options.md").read_text(encoding="utf-8")
    assert set(re.findall("`([a-z_]+)`", page)) >= {*CHOICES} - {"input"}


def test_type_checkers_know_every_choice():
    assert [*ChoiceKeywords.__annotations__] == [name for name in CHOICES if name != "input"]


def test_an_unknown_choice_is_a_type_error(desk):
    with pytest.raises(TypeError, match="varnish"):
        brushsvg.convert("two.svg", varnish=1)


def test_choices_have_the_ranges_of_the_flags():
    """The Python choices have the same ranges and values as the flags.

    A change of one must be a change of the other.
    """
    flags = {
        action.dest: action for action in command_parser()._subparsers._group_actions[0].choices["convert"]._actions
    }
    assert set(CHOICES) <= set(flags)
    for name, limits in CHOICE_RANGES.items():
        assert [flags[name].type(str(limit)) for limit in limits] == list(limits), name
        for beyond in (limits[0] - 0.001 - abs(limits[0]) / 2, limits[1] * 1.01):
            with pytest.raises(values.argparse.ArgumentTypeError):
                flags[name].type(f"{beyond:.6f}")
    for name, choices in CHOICE_VALUES.items():
        assert tuple(flags[name].choices) == choices, name


def test_cached_results_are_dropped_when_the_plan_changes(desk):
    work = prepare("two.svg", Options(cell=find_cell()))
    cell = work.options.cell
    slow = work.plan.passes[0]
    assert work.marks() == brushsvg.simulate(work.plan, work.brush) and work.walk(cell).problems == []
    assert work.walk(replace(cell, name="another")) is None and work.walk(cell, Job(0.1)) is None
    slow.speed_mm_s = 1000.0
    assert work.marks() is None and work.walk(cell) is None
    assert [each.code for each in simulate_and_check(work, ".ngc").problems] == ["speed-out-of-range"]


def waves(rows, columns=20):
    wave = "c10 -20 25 -20 30 0s10 10 15 -5"
    paths = "".join(
        f'<path d="M{10 + 58 * column} {20 + 20 * row}{wave}" fill="none" stroke="#000" stroke-width="3"/>'
        for row in range(rows)
        for column in range(columns)
    )
    return f'<svg xmlns="http://www.w3.org/2000/svg" width="1200mm" height="1600mm">{paths}</svg>'


def one_long_line():
    return PAGE.format(
        "",
        f'<path d="M20 30{"c3 -20 6 20 9 0c-3 -20 -6 20 -9 0" * 4000}" fill="none" stroke="red" stroke-width="3"/>',
    )


def still_working() -> list[str]:
    return [thread.name for thread in threading.enumerate() if thread.name == "brushsvg"]


@sample("word", ["reading", "finding", "compensated", "simulated", "writing", "drawing"], keep=2)
@pytest.mark.slow
def test_convert_can_be_cancelled_at_any_step(desk, word):
    Path("long.svg").write_text(
        waves({"reading": 200, "finding": 40, "writing": 60, "drawing": 60}.get(word, 10))
        .replace("1200mm", "5000")
        .replace("1600mm", "5000")
    )
    progress_texts = []

    def cancel():
        return any(word in text for text in progress_texts)

    with pytest.raises(CancelledError):
        brushsvg.convert("long.svg", "o.ngc", picture="o.png", progress=progress_texts.append, cancel=cancel)
    assert word in progress_texts[-1] and still_working() == []
    assert sorted(path.name for path in desk.iterdir()) == ["long.svg", "two.svg"]


@pytest.mark.slow
def test_a_loop_of_the_cpp_library_can_be_cancelled(desk):
    Path("long.svg").write_text(one_long_line())
    seen = []

    def cancel():
        """Return whether the library works on the only stroke, which takes a minute."""
        for thread in threading.enumerate():
            if thread.name == "brushsvg" and (frame := sys._current_frames().get(thread.ident)):
                seen.append(frame.f_code.co_name == "compensated")
        return seen[-5:] == [True] * 5

    with pytest.raises(CancelledError):
        brushsvg.convert("long.svg", compensation="refined", cancel=cancel)
    assert still_working() == []


def test_an_event_cancels_only_if_it_is_set(desk):
    event = threading.Event()
    assert brushsvg.convert("two.svg", cancel=event).text == brushsvg.convert("two.svg").text
    event.set()
    with pytest.raises(CancelledError):
        brushsvg.convert("two.svg", cancel=event)


def test_an_exception_in_progress_ends_the_work(desk):
    def progress(text):
        raise io.UnsupportedOperation

    Path("long.svg").write_text(waves(10))
    for cancel in (None, threading.Event()):
        with pytest.raises(io.UnsupportedOperation):
            brushsvg.convert("long.svg", progress=progress, cancel=cancel)
    assert still_working() == []
