"""`brushsvg batch` converts many drawings and repeats no work.

Any number of processes gives the same rows and files.
"""

import csv
import json
import multiprocessing
import os
import re
import signal
import subprocess
import sys
import threading
import time
from concurrent.futures import BrokenExecutor, CancelledError, ProcessPoolExecutor, ThreadPoolExecutor
from contextlib import suppress
from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import pytest
from diagnostics import are_reported, gives, in_json, is_reported, refused
from sampling import sample
from test_conversion import LINE, PAGE

import brushsvg
from brushsvg.cli import main
from brushsvg.jobs.batch import executors, one, run
from brushsvg.jobs.batch.items import list_words
from brushsvg.jobs.batch.manifest import FORMAT, format_row
from brushsvg.machine.cells.cell import RoboDK
from brushsvg.machine.cells.cell_file import find_cell, write_cell
from brushsvg.machine.cells.language_limits import MAX_PROGRAM_LINES, MAX_PROGRAM_POINTS
from brushsvg.show.contact_sheet import ACROSS, CARD_W, DOWN, GAP, PICTURE_H, WORDS_H, Card, contact_sheets

COMMAND = Path(sys.executable).with_name("brushsvg")
FONT = (
    '<svg xmlns="http://www.w3.org/2000/svg"><font horiz-adv-x="600"><font-face units-per-em="1000"/>'
    '<glyph unicode="T" d="M 0 700 L 500 700 M 250 700 L 250 0"/><glyph unicode=" "/></font></svg>'
)


def drawing(k, width=3):
    return PAGE.format("", LINE.format("a", 20 + k, 90, "#203060", width))


@pytest.fixture
def desk(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("in/below").mkdir(parents=True)
    for k in range(3):
        Path(f"in/{k}.svg").write_text(drawing(k))
    Path("in/below/wide.svg").write_text(drawing(0, width=30))
    Path("in/note.txt").write_text("no drawing")
    return tmp_path


def contents(folder="out"):
    files = (path for path in Path(folder).rglob("*") if path.is_file())
    return {path.relative_to(folder).as_posix(): path.read_bytes() for path in files}


def done_again(monkeypatch):
    """Return a list that collects the names of drawings converted from now on."""
    names = []
    kept = run._write_result

    def noted(folder, item, *others):
        names.append(item.name)
        return kept(folder, item, *others)

    monkeypatch.setattr(run, "_write_result", noted)
    return names


def dies(task):
    os._exit(3)


def threads():
    return ThreadPoolExecutor(2)


def test_each_drawing_becomes_the_same_program_as_with_convert(desk):
    with threads() as executor:
        done = brushsvg.batch(["in"], "out", executor=executor, tolerance=0.1)
    assert [row.name for row in done.rows] == ["0", "1", "2", "below/wide"]
    assert [row.code for row in done.rows] == ["", "", "", "width-out-of-reach"]
    assert {row.name for row in done.refused} == {"below/wide"}
    for row in done.rows[:3]:
        alone = brushsvg.convert(row.source, tolerance=0.1, figures=True)
        assert Path("out/programs", f"{row.name}.ngc").read_text() == alone.text
        assert row.figures.time_s == alone.time_s
        assert row.figures.overlap == alone.figures.total.overlap
        assert row.files.keys() == {f"programs/{row.name}.ngc", f"pictures/{row.name}.png"}
    table = list(csv.DictReader(Path("out/table.csv").read_text().splitlines()))
    assert [each["name"] for each in table] == [row.name for row in done.rows]
    assert float(table[1]["overlap"]) == pytest.approx(done.rows[1].figures.overlap, abs=1e-6)
    assert (table[3]["overlap"], table[3]["where"], table[3]["code"]) == ("", "a", "width-out-of-reach")
    assert {*contents()} == {
        *("manifest.jsonl", "table.csv", "contact-1.png"),
        *(f"{kind}/{k}.{end}" for k in range(3) for kind, end in (("programs", "ngc"), ("pictures", "png"))),
    }


@pytest.mark.slow
def test_output_is_the_same_in_threads_and_processes(desk):
    made = {}
    for name, place in {
        "threads": threads(),
        "processes of others": ProcessPoolExecutor(2, executors.multiprocessing.get_context("spawn")),
        "own processes": None,
    }.items():
        done = brushsvg.batch(["in"], name, executor=place, **({} if place else {"jobs": 2}))
        made[name] = done.rows, contents(name)
        if place:
            place.shutdown()
    assert made["threads"] == made["processes of others"] == made["own processes"]


@pytest.mark.slow
def test_a_cluster_gives_the_same_output_and_survives_a_lost_worker(desk, monkeypatch):
    distributed = pytest.importorskip("distributed")
    with threads() as executor:
        known = brushsvg.batch(["in"], "by threads", executor=executor).rows
    with distributed.LocalCluster(2, threads_per_worker=1, processes=True, dashboard_address=None) as cluster:
        pids = list(distributed.Client(cluster).run(os.getpid).values())
        os.kill(pids[0], signal.SIGKILL)
        done = brushsvg.batch(["in"], "by cluster", cluster=cluster.scheduler_address)
    assert done.rows == known and contents("by cluster") == contents("by threads")
    monkeypatch.setattr(executors, "MAX_SCHEDULER_WAIT_S", 0.5)
    with refused("cluster-unreachable"):
        brushsvg.batch(["in"], "out", cluster="tcp://127.0.0.1:9")


CHANGES = {
    "nothing": (lambda: None, {}, ["below/wide"]),  # A refused drawing is always tried again.
    "a drawing": (lambda: Path("in/1.svg").write_text(drawing(9)), {}, ["1", "below/wide"]),
    "a new one": (lambda: Path("in/3.svg").write_text(drawing(9)), {}, ["3", "below/wide"]),
    "a program": (lambda: Path("out/programs/2.ngc").write_text("M2"), {}, ["2", "below/wide"]),
    "a picture that went": (lambda: Path("out/pictures/0.png").unlink(), {}, ["0", "below/wide"]),
    "an option": (lambda: None, {"tolerance": 0.06}, ["0", "1", "2", "below/wide"]),
    "the brush": (lambda: None, {"brush": "rigid"}, ["0", "1", "2", "below/wide"]),
    "the cell": (lambda: None, {"cell": "grbl-3axis"}, ["0", "1", "2", "below/wide"]),
}


@pytest.mark.parametrize("change", CHANGES)
def test_only_changed_drawings_are_converted_again(desk, monkeypatch, change):
    happens, choices, expected = CHANGES[change]
    with threads() as executor:
        brushsvg.batch(["in"], "out", executor=executor)
        before = contents()
        names = done_again(monkeypatch)
        happens()
        done = brushsvg.batch(["in"], "out", executor=executor, **choices)
    assert sorted(names) == expected
    assert done.resumed == len(done.rows) - len(expected)
    if change in ("nothing", "a program", "a picture that went"):
        assert contents() == before


def test_another_version_converts_all_drawings_again(desk, monkeypatch):
    with threads() as executor:
        brushsvg.batch(["in"], "out", executor=executor)
        names = done_again(monkeypatch)
        monkeypatch.setattr(one, "version", lambda: "9.9")
        brushsvg.batch(["in"], "out", executor=executor)
        assert len(names) == 4
        monkeypatch.setattr(run, "convert_task", lambda task: one.TaskResult(None, {}, b"", version="0.0.9"))
        with refused("version-unknown 0.0.9 9.9"):
            brushsvg.batch(["in"], "out", executor=executor, tolerance=0.2)


def test_an_incomplete_manifest_line_repeats_that_drawing(desk, monkeypatch):
    with threads() as executor:
        brushsvg.batch(["in"], "out", executor=executor)
        whole = Path("out/manifest.jsonl").read_bytes()
        Path("out/manifest.jsonl").write_bytes(whole[:-40])
        names = done_again(monkeypatch)
        brushsvg.batch(["in"], "out", executor=executor)
    assert names == ["below/wide"] and Path("out/manifest.jsonl").read_bytes() == whole


def test_a_refused_row_leaves_no_outdated_files(desk, capsys):
    """A refused row leaves no outdated files behind.

    The files of an earlier run are removed, even if the refused drawing is not tried again. A file that the
    user has edited is kept.
    """
    with threads() as executor:
        brushsvg.batch(["in"], "out", executor=executor)
        Path("in/1.svg").write_text(drawing(1, width=30))
        Path("in/2.svg").write_text(drawing(2, width=30))
        Path("out/programs/2.ngc").write_text("mine")
        done = brushsvg.batch(["in"], "out", executor=executor)
        removed = ("pictures/1.png", "pictures/2.png", "programs/1.ngc")
        assert tuple(sorted(done.removed)) == removed
        there = contents()
        assert not there.keys() & set(removed) and there["programs/2.ngc"] == b"mine"
        assert {"programs/0.ngc", "pictures/0.png"} <= there.keys()
        refused_once = Path("out/manifest.jsonl").read_bytes()
        Path("in/1.svg").write_text(drawing(1))
        brushsvg.batch(["in"], "out", executor=executor)
        # An interrupted run leaves the manifest in this state.
        with open("out/manifest.jsonl", "ab") as file:
            file.writelines(refused_once.splitlines(keepends=True)[1:])
    Path("in/1.svg").write_text(drawing(1, width=30))
    status, _, reported = in_json(capsys, "batch", "in", "-o", "out", "--jobs", "1")
    assert status == 1 and is_reported(reported, "outdated-removed") and "programs/1.ngc" not in contents()


def test_drawings_with_the_same_name_do_not_overwrite_each_other(desk, monkeypatch):
    Path("more").mkdir()
    Path("more/1.svg").write_text(drawing(9))
    with threads() as executor:
        brushsvg.batch(["in"], "out", executor=executor)
        before = contents()
        with refused("name-taken in/1.svg more/1.svg programs/1.ngc"):
            brushsvg.batch(["more"], "out", executor=executor)
        assert contents() == before
        monkeypatch.chdir("in")  # A drawing is recognized if its path is given relative to another folder.
        Path("1.svg").write_text(drawing(5))
        assert not brushsvg.batch(["1.svg"], "../out", executor=executor).refused
        Path("1.svg").unlink()
        assert not brushsvg.batch(["../more"], "../out", executor=executor).refused


def test_drawings_with_the_same_name_are_refused_with_a_remedy(desk):
    Path("more/below").mkdir(parents=True)
    Path("more/1.svg").write_text(drawing(9))
    Path("more/below/1.svg").write_text(drawing(9))
    Path("in/1.dxf").write_text("")
    advised = set()
    for items, parts in (
        (["in/1.svg", "more/1.svg"], ["-o"]),
        (["in/1.svg", "in/1.svg"], []),
        (["in/1.svg", "in/1.dxf"], []),
        (["more", "more/below"], ["more/below/1.svg", "below/1", "1"]),
    ):
        with refused("name-taken") as caught:
            brushsvg.batch(items, "out", jobs=1)
        assert gives(caught.value.advice, *parts)
        advised.add(caught.value.advice)
    assert len(advised) == 4 and "" not in advised


@pytest.mark.parametrize("name", ["a\nb.svg", "a\x1bb.svg", "a\udce9b.svg"])
def test_a_name_that_cannot_be_printed_is_reported_in_its_row(desk, capsys, name):
    Path("in", name).write_text(drawing(0))
    status, _, reported = in_json(capsys, "batch", "in", "-o", "out", "--jobs", "1")
    shown = name.encode("unicode_escape", "surrogatepass").decode()
    assert status == 1 and f"in/{shown}" in {notice.where for _, notice in reported}
    assert "programs/1.ngc" in contents()
    table = list(csv.DictReader(Path("out/table.csv").read_text().splitlines()))
    assert [(each["source"], each["code"]) for each in table if each["code"]] == [
        (f"in/{shown}", "name-invalid"),
        ("in/below/wide.svg", "width-out-of-reach"),
    ]


def test_a_second_batch_into_the_folder_keeps_the_rows_of_the_first(desk, monkeypatch):
    """A second batch into the same folder keeps the rows of the first batch.

    These rows were once lost. All drawings were then converted again, and a drawing with the same name
    overwrote another one.
    """
    first, second = ["in/0.svg", "in/below/wide.svg"], ["in/1.svg", "in/2.svg"]
    brushsvg.batch(first, "out", jobs=1, wide="refuse")
    brushsvg.batch(second, "out", jobs=1, wide="refuse")
    rows = [json.loads(line) for line in Path("out/manifest.jsonl").read_text().splitlines()[1:]]
    assert [row["name"] for row in rows] == ["1", "2", "0", "wide"], "its own first"
    assert "0.svg" not in Path("out/table.csv").read_text()
    names = done_again(monkeypatch)
    assert brushsvg.batch(first, "out", jobs=1, wide="refuse").resumed == 1 and names == ["wide"]
    Path("other").mkdir()
    Path("other/1.svg").write_text(drawing(3))
    with refused("name-taken 1.svg -o"):
        brushsvg.batch(["other/1.svg"], "out", jobs=1)
    for name in ("in/below/wide.svg", "out/programs/2.ngc", "out/pictures/2.png"):
        Path(name).unlink()
    brushsvg.batch(["in/1.svg"], "out", jobs=1, wide="refuse")
    rows = [json.loads(line) for line in Path("out/manifest.jsonl").read_text().splitlines()[1:]]
    assert [row["name"] for row in rows] == ["1", "0"], "no row is kept of files that are gone"


def test_equal_drawings_are_each_converted_once(desk, monkeypatch):
    Path("in/also.svg").write_text(drawing(1))
    with threads() as executor:
        brushsvg.batch(["in"], "out", executor=executor)
        names, before = done_again(monkeypatch), contents()
        done = brushsvg.batch(["in"], "out", executor=executor)
    assert names == ["below/wide"] and done.resumed == 4 and contents() == before
    Path("words.txt").write_text("T\nT\nTT\n")
    with threads() as executor:
        for _ in range(2):
            done = brushsvg.batch(list_words("words.txt", FONT.encode()), "set", executor=executor)
    assert done.resumed == 3 and not done.refused


def test_two_runs_do_not_write_to_one_folder(desk):
    first = run.Manifest(Path("out"))
    with refused("file-unwritable"), threads() as executor:
        brushsvg.batch(["in"], "out", executor=executor)
    first.close()
    Path("out/manifest.jsonl").write_text("mine\n")
    with refused("format-unknown brushsvg/batch 1 -o"), threads() as executor:
        brushsvg.batch(["in"], "out", executor=executor)


def test_words_are_set_as_by_the_text_command(desk, capsys):
    Path("font.svg").write_text(FONT)
    Path("words.txt").write_text("TT\n\n T T \nTX\nTT\nT\\nT\n", encoding="utf-8")
    status, _, reported = in_json(capsys, *"batch --words words.txt --font font.svg --size 30 -o out --jobs 1".split())
    assert status == 1
    assert [notice.code for _, notice in reported if notice.code] == ["glyph-missing"]
    rows = [json.loads(line) for line in Path("out/manifest.jsonl").read_text().splitlines()[1:]]
    assert [row["name"] for row in rows] == ["TT", "T_T", "TX", "TT~2", "T_nT"]
    assert main(["text", "T T", "-o", "t.svg", "--font", "font.svg", "--size", "30", "--quiet"]) == 0
    assert main("convert t.svg -o t.ngc --quiet".split()) == 0
    assert Path("out/programs/T_T.ngc").read_bytes() == Path("t.ngc").read_bytes()


def test_warnings_with_one_code_are_summarized(desk, capsys):
    for k in range(6):
        Path(f"in/{k}.svg").write_text(drawing(k).replace("</svg>", "<text>A</text></svg>"))
    status, _, reported = in_json(capsys, "batch", "in", "-o", "out", "--jobs", "1")
    assert status == 1 and are_reported([n for _, n in reported], "text-unread in/0.svg 5", "width-out-of-reach 30.000")
    rows = [json.loads(line) for line in Path("out/manifest.jsonl").read_text().splitlines()[1:]]
    assert [len(row["notices"]) for row in rows if not row["code"]] == [1] * 6


def test_lists_patterns_and_open_documents_are_accepted(desk):
    Path("list.txt").write_text("in/1.svg\nin/2.svg\n")
    with threads() as executor:
        items = ["list.txt", "in/0*.svg", ("mine", drawing(7)), ("bytes", drawing(8).encode())]
        done = brushsvg.batch(items, "out", executor=executor)
    assert [row.name for row in done.rows] == ["1", "2", "0", "mine", "bytes"]
    assert (
        Path("out/programs/mine.ngc").read_text()
        == brushsvg.convert("in/0.svg" if Path("in/0.svg").write_text(drawing(7)) else "").text
    )


def test_a_list_that_contains_itself_is_refused(desk):
    Path("a.txt").write_text("in/1.svg\nin/b.txt\n")
    Path("in/b.txt").write_text("0.svg\n2.svg\n")
    with threads() as executor:
        assert [row.name for row in brushsvg.batch(["a.txt"], "out", executor=executor).rows] == ["1", "0", "2"]
    Path("in/b.txt").write_text("0.svg\n../a.txt\n")
    with refused("file-unreadable") as caught:
        brushsvg.batch(["a.txt"], "out", jobs=1)
    assert Path(caught.value.file) == Path("in/../a.txt") and caught.value.advice


@pytest.mark.parametrize("data", [b"", b" \n\n", b"\xff\xfe\x00", None])
def test_an_empty_list_is_refused_with_its_file_name(desk, capsys, data):
    Path("font.svg").write_text(FONT)
    if data is not None:
        Path("w.txt").write_bytes(data)
    for typed in ("--words w.txt --font font.svg", "w.txt"):
        status, _, ((file, notice),) = in_json(capsys, "batch", *typed.split(), "-o", "out")
        assert (status, file) == (1, "w.txt") and notice.code in ("file-empty", "not-text", "file-unreadable")
    assert not Path("out").exists()


@pytest.mark.parametrize("data", [bytes(range(256)) * 40, bytes(3000), b"<svg>\xc3", b"[" * 100_000])
def test_an_invalid_drawing_is_a_refused_row(desk, data):
    Path("x.svg").write_bytes(data)
    Path("x.dxf").write_bytes(data)
    Path("words.txt").write_bytes(b"T\n" + data.replace(b"\xc3", b"").decode("latin-1").encode())
    with threads() as executor:
        items = [*list_words("words.txt", FONT.encode()), "in/1.svg", "x.svg", ("d", data)]
        done = brushsvg.batch(items, "out", executor=executor)
        assert brushsvg.batch(["x.dxf"], "out", executor=executor).refused
    assert [row.code for row in done.rows if row.name in ("T", "1")] == ["", ""]
    assert all(row.code and row.code != "unexpected" for row in done.rows if row.name not in ("T", "1"))


@pytest.mark.parametrize(
    ("items", "choices", "expected"),
    [
        (["in", "in/1.svg"], {}, "name-taken in/1.svg"),
        (["none*.svg"], {}, "file-unreadable"),
        ([("../x", "<svg/>")], {}, "name-invalid ../x"),
        ([("x", 5)], {}, "wrong-type"),
        ("in", {}, "wrong-type"),
        (5, {}, "wrong-type"),
        ([""], {}, "name-invalid"),
        (["in"], {"brush": "none"}, "brush-unknown none"),
        (["in"], {"cell": "none"}, "cell-unknown none"),
        (["in"], {"format": ".txt"}, "program-format .txt"),
        (["in"], {"jobs": 0}, "out-of-range 0"),
        (["in"], {"corrections": "x.json"}, "options-contradict"),
        (["in"], {"jobs": 2, "cluster": "x"}, "options-contradict"),
        (["in"], {"executor": 5, "jobs": None}, "wrong-type 5"),
        (["in"], {"progress": 5}, "wrong-type 5"),
        (["in"], {"cancel": 5}, "wrong-type 5"),
        (["in"], {"width": -1}, "out-of-range"),
    ],
)
def test_a_problem_of_the_whole_batch_is_one_refusal(desk, items, choices, expected):
    choices = {"jobs": 1} | choices
    with refused(expected):
        brushsvg.batch(items, "out", **choices)
    assert not Path("out/table.csv").exists()


def test_linked_folders_are_read_once_and_broken_links_are_rows(desk, monkeypatch):
    Path("customer/signs").mkdir(parents=True)
    Path("customer/signs/5.svg").write_text(drawing(5))
    Path("in/a").symlink_to(desk / "customer")
    Path("in/customer").symlink_to(desk / "customer")  # again
    Path("in/alias").symlink_to("below")
    Path("customer/loop").symlink_to(desk / "in")
    Path("in/gone.svg").symlink_to("nowhere.svg")
    with threads() as executor:
        done = brushsvg.batch(["in"], "out", executor=executor)
    names = {row.name: row.code for row in done.rows}
    (linked,) = names.keys() & {"a/signs/5", "customer/signs/5"}
    assert names == dict.fromkeys(["0", "1", "2", linked], "") | {
        "below/wide": "width-out-of-reach",
        "gone": "file-unreadable",
    }

    def refuse_below(path):
        if path.name == "below":
            raise PermissionError(13, "Permission denied")
        return read_folder(path)

    read_folder = Path.iterdir
    monkeypatch.setattr(Path, "iterdir", refuse_below)
    with refused("file-unreadable") as caught:
        brushsvg.batch(["in"], "out", jobs=1)
    assert caught.value.file == "in/below"


def test_a_refused_row_has_the_advice_of_convert(desk, capsys):
    line = '<path id="a" d="M20 20 H90 V" fill="none" stroke="#000" stroke-width="3"/>'
    Path("damaged.svg").write_text(PAGE.format("", line))
    _, _, reported = in_json(capsys, "convert", "damaged.svg", "-o", "x.ngc")
    (advice,) = {notice.advice for _, notice in reported if notice.refused}
    status, _, ((_, notice),) = in_json(capsys, "batch", "damaged.svg", "-o", "out", "--jobs", "1")
    assert status == 1 and "--lenient" in advice and gives(notice.text, advice)


def test_a_missing_drawing_is_a_row_and_tried_again(desk, monkeypatch):
    with threads() as executor:
        done = brushsvg.batch(["in/1.svg", "gone.svg", "odd.pdf", "folder"], "out", executor=executor)
        missing = ["", "file-unreadable", "drawing-format", "file-unreadable"]
        assert [row.code for row in done.rows] == missing
        Path("gone.svg").write_text(drawing(4))
        names = done_again(monkeypatch)
        done = brushsvg.batch(["in/1.svg", "gone.svg", "odd.pdf"], "out", executor=executor)
    assert [row.code for row in done.rows] == ["", "", "drawing-format"] and "1" not in names


def test_a_refused_drawing_is_tried_again_once_its_cause_is_gone(desk, monkeypatch):
    """A refused drawing is tried again once the cause of its refusal is gone.

    The cause may be a missing package of a worker, or a bug of ours that is fixed now. The drawing itself did
    not change.
    """
    with threads() as executor, monkeypatch.context() as broken:
        broken.setattr(one.outputs, "overlap_picture", lambda *_: 1 / 0)
        assert brushsvg.batch(["in/1.svg"], "out", executor=executor).refused
    with threads() as executor:
        assert not brushsvg.batch(["in/1.svg"], "out", executor=executor).refused
    assert Path("out/programs/1.ngc").exists()


@pytest.mark.parametrize("edited", ["post.py", "helper.py"])
def test_an_edited_post_converts_all_drawings_again(desk, edited):
    Path("helper.py").write_text("WORD = 'first'\n")
    post = Path(__file__).with_name("robodk_post.py").read_text()
    Path("post.py").write_text(f"import helper\n{post}")
    cell = replace(find_cell("kr6-r900"), name="mine", language="robodk", robodk=RoboDK("post.py"), arm=None)
    Path("mine.toml").write_text(write_cell(cell))
    with threads() as executor:
        assert brushsvg.batch(["in/1.svg"], "out", executor=executor, cell="mine.toml").resumed == 0
        assert brushsvg.batch(["in/1.svg"], "out", executor=executor, cell="mine.toml").resumed == 1
        Path(edited).write_text(Path(edited).read_text() + "# edited\n")
        assert brushsvg.batch(["in/1.svg"], "out", executor=executor, cell="mine.toml").resumed == 0
        assert brushsvg.batch(["in/1.svg"], "out", executor=executor, cell="mine.toml").resumed == 1


@pytest.mark.parametrize("small", ["a/a.svg", "A/a.svg", "a/A.svg"])
def test_a_program_in_several_files_does_not_replace_that_of_another_drawing(desk, monkeypatch, small):
    """A program in several files does not replace the program of another drawing.

    a.svg becomes programs/a/a.ls and the programs that it calls; a/a.svg becomes programs/a/a.ls, too.
    """
    Path("two", small).parent.mkdir(parents=True)
    many = "".join(LINE.format(f"s{k}", 20 + 5 * k, 90, "#203060", 3) for k in range(3))
    Path("two/a.svg").write_text(PAGE.format("", many))
    Path("two", small).write_text(drawing(0))
    monkeypatch.setitem(MAX_PROGRAM_POINTS, "fanuc", 40)
    with threads() as executor:
        done = brushsvg.batch(["two"], "out", executor=executor, cell="lrmate200id", width=3)
        (row,) = done.refused
        assert (row.name, row.code) == ("a", "name-taken")
        assert contents().keys() >= {f"programs/{small[:-4]}.ls"}
        alone = brushsvg.convert(Path("two", small), cell="lrmate200id", width=3)
        assert Path("out/programs", f"{small[:-4]}.ls").read_bytes() == alone.text.encode()
        assert not brushsvg.batch(["two/a.svg"], "own", executor=executor, cell="lrmate200id", width=3).refused
        again = brushsvg.batch([("a/a", drawing(0))], "own", executor=executor, cell="lrmate200id", width=3)
    assert [each.code for each in again.refused] == ["name-taken"]


@pytest.mark.parametrize("cell", ["ur5e", "kr6-r900"])
def test_outdated_program_parts_are_removed_when_a_job_gets_shorter(desk, monkeypatch, cell, capsys):
    many = "".join(LINE.format(f"s{k}", 20 + 5 * k, 90, "#203060", 3) for k in range(6))
    Path("word.svg").write_text(PAGE.format("", many))
    monkeypatch.setitem(MAX_PROGRAM_LINES, find_cell(cell).language, 60)
    with threads() as executor:
        first = brushsvg.batch(["word.svg"], "out", executor=executor, cell=cell, width=3)
        (main,) = Path("out/programs/word").glob("word.s*[!0-9]")
        assert not first.refused and len(list(main.parent.iterdir())) > 2
        assert not brushsvg.check(main, "word.svg", width=3).problems
        Path("word.svg").write_text(PAGE.format("", LINE.format("s", 20, 90, "#203060", 3)))
        second = brushsvg.batch(["word.svg"], "out", executor=executor, cell=cell, width=3)
    assert list(Path("out/programs").rglob("*.s*")) == [Path("out/programs") / main.name]
    assert len(second.removed) > 2


def test_a_program_is_not_written_over_the_folder_of_another_drawing(desk):
    Path("in/1.ngc").mkdir()
    Path("in/1.ngc/x.svg").write_text(drawing(4))
    with threads() as executor:
        done = brushsvg.batch(["in/1.svg", ("1.ngc/x", drawing(4))], "out", executor=executor)
    assert [(row.name, row.code) for row in done.rows] == [("1", "name-taken"), ("1.ngc/x", "")]


def test_names_that_are_equal_on_macos_are_refused(desk):
    with refused("name-taken"):
        brushsvg.batch([("\u00e9", drawing(0)), ("e\u0301", drawing(1))], "out", jobs=1)


@pytest.mark.parametrize("way", ["../victim.txt", "below/../../victim.txt", "{}/victim.txt", "link/victim.txt"])
def test_a_foreign_manifest_cannot_name_a_file_outside_its_folder(desk, way):
    """A manifest from elsewhere cannot name a file outside its folder.

    The files of outdated rows are deleted, so a foreign manifest could have deleted any file.
    """
    Path("victim.txt").write_text("mine")
    Path("out").mkdir()
    Path("out/link").symlink_to(desk)
    files = {way.format(desk): one.sha256(b"mine")}
    row = run.Row("wide", "in/below/wide.svg", "", None, "not-xml", files=files)
    Path("out/manifest.jsonl").write_text(json.dumps(FORMAT) + "\n" + format_row(row))
    with refused("path-outside wide"), threads() as executor:
        brushsvg.batch(["in/below"], "out", executor=executor)
    assert Path("victim.txt").read_text() == "mine"


def test_a_manifest_with_an_impossible_file_name_is_accepted(desk):
    Path("out").mkdir()
    row = run.Row("other", "in/other.svg", "", None, "", files={"a" * 300 + ".ngc": "0", "kept.ngc": "0"})
    Path("out/kept.ngc").write_text("")
    Path("out/manifest.jsonl").write_text(json.dumps(FORMAT) + "\n" + format_row(row))
    with threads() as executor:
        done = brushsvg.batch(["in/1.svg"], "out", executor=executor, tolerance=0.1)
    assert [each.name for each in done.rows] == ["1"] and not done.refused
    assert format_row(row) in Path("out/manifest.jsonl").read_text(), "its other file exists"


def test_an_internal_error_is_a_refused_row(desk, monkeypatch):
    monkeypatch.setattr(one.outputs, "overlap_picture", lambda *_: 1 / 0)
    with threads() as executor:
        done = brushsvg.batch(["in/1.svg"], "out", executor=executor)
    assert [row.code for row in done.rows] == ["unexpected"]


def test_a_lost_worker_is_reported_and_finished_rows_are_kept(desk, monkeypatch):
    with threads() as executor:
        brushsvg.batch(["in/1.svg"], "out", executor=executor)
    monkeypatch.setattr(run, "convert_task", dies)
    with refused("worker-lost"):
        brushsvg.batch(["in/1.svg", "in/2.svg"], "out", jobs=1)
    assert Path("out/programs/1.ngc").exists()


class Breaks(ThreadPoolExecutor):
    """An executor that breaks after the first task, as a pool does whose process dies between two tasks."""

    submitted = 0

    def submit(self, *task):
        self.submitted += 1
        if self.submitted > 1:
            raise BrokenExecutor("broken")
        return super().submit(*task)


def test_a_worker_lost_between_two_drawings_is_reported(desk):
    with refused("worker-lost in/2.svg"), Breaks(1) as executor:
        brushsvg.batch(["in/1.svg", "in/2.svg"], "out", executor=executor)


@pytest.mark.parametrize("is_file", [True, False])
def test_a_script_that_runs_again_in_each_worker_gets_one_sentence(desk, is_file):
    """The script has no `if __name__ == "__main__":`, or comes from the standard input."""
    script = 'import brushsvg\nbrushsvg.batch(["in/1.svg", "in/2.svg"], "out", jobs=2)\n'
    Path("script.py").write_text(script)
    command = [sys.executable, "script.py" if is_file else "-"]
    done = subprocess.run(command, input=script, capture_output=True, text=True, check=False)
    assert done.returncode == 1 and done.stderr.count("Traceback") == 1, "none of a worker"
    assert "ThreadPoolExecutor" in done.stderr.splitlines()[-1] and "__main__" in done.stderr.splitlines()[-1]


def run_batch(_):
    try:
        brushsvg.batch(["in/1.svg"], "out", jobs=1)
    except brushsvg.Error as refusal:
        return refusal.code, str(refusal)


def test_a_process_of_a_pool_cannot_start_workers(desk):
    with multiprocessing.get_context("spawn").Pool(1) as pool:
        code, sentence = pool.map(run_batch, [0])[0]
    assert code == "worker-lost" and gives(sentence, "daemonic", "ThreadPoolExecutor")


def test_parquet_contains_the_same_table_as_csv(desk, monkeypatch):
    pyarrow = pytest.importorskip("pyarrow.parquet")
    with threads() as executor:
        brushsvg.batch(["in"], "out", executor=executor, parquet=True)
    rows = pyarrow.read_table("out/table.parquet").to_pylist()
    table = list(csv.DictReader(Path("out/table.csv").read_text().splitlines()))
    for row, reported in zip(rows, table, strict=True):
        assert row.keys() == reported.keys()
        for name, value in row.items():
            assert value == (type(value)(reported[name]) if value is not None else reported[name] or None), name
    monkeypatch.setitem(sys.modules, "pyarrow", None)
    with refused("package-missing pyarrow"):
        brushsvg.batch(["in"], "out", jobs=1, parquet=True)


def test_progress_shows_rate_and_remaining_time_and_cancel_works(desk):
    progress_texts, is_over = [], threading.Event()

    def progress(text):
        progress_texts.append(text)
        is_over.set()

    with threads() as executor, pytest.raises(CancelledError):
        brushsvg.batch(["in"], "out", executor=executor, progress=progress, cancel=is_over)
    assert gives(progress_texts[0], "4") and len(re.findall(r"\d+(?:\.\d+)?", progress_texts[0])) >= 3, (
        "how many, how fast, how long"
    )
    rows = Path("out/manifest.jsonl").read_text().splitlines()[1:]
    assert 1 <= len(rows) < 4 or len(progress_texts) == len(rows)
    assert not Path("out/table.csv").exists()


def started(*words):
    return subprocess.Popen(
        [COMMAND, *words],
        stderr=open("said.txt", "w"),  # A worker that survives would keep a pipe open.
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.default_int_handler),
        start_new_session=True,
    )


def rows_there():
    with suppress(FileNotFoundError):
        return Path("out/manifest.jsonl").read_text().splitlines()[1:]
    return []


def processes_of(group) -> list[int]:
    found = []
    for place in Path("/proc").glob("[0-9]*"):
        with suppress(OSError):
            if os.getpgid(int(place.name)) == group and "State:\tZ" not in (place / "status").read_text():
                found.append(int(place.name))
    return found


@pytest.mark.skipif(not Path("/proc/self/status").exists(), reason="needs /proc")
@sample("by", [signal.SIGKILL, signal.SIGINT], keep=1)
@pytest.mark.slow
def test_an_interrupted_batch_continues(desk, monkeypatch, by):
    for k in range(24):
        Path(f"in/{k}.svg").write_text(drawing(k / 4))
    with threads() as executor:
        brushsvg.batch(["in"], "whole", executor=executor)
    process = started("batch", "in", "-o", "out", "--jobs", "2")
    while len(rows_there()) < 5 and process.poll() is None:
        time.sleep(0.01)
    process.send_signal(by)
    status, printed = process.wait(20), Path("said.txt").read_text()
    assert status == (-by if by == signal.SIGKILL else 130), printed
    assert by == signal.SIGKILL or printed == "brushsvg: interrupted\n"
    end = time.monotonic() + 10
    while (left := processes_of(process.pid)) and time.monotonic() < end:
        time.sleep(0.05)
    for each in left:  # These processes are in the session that this test started.
        os.kill(each, signal.SIGKILL)
    assert left == []
    kept = rows_there()
    assert 5 <= len(kept) < 25
    for line in kept:
        with suppress(ValueError):  # The last line may be incomplete.
            for name in json.loads(line)["files"]:
                assert contents()[name] == contents("whole")[name]
    assert not Path("out/table.csv").exists()
    names = done_again(monkeypatch)
    with threads() as executor:
        done = brushsvg.batch(["in"], "out", executor=executor)
    assert len(names) == 25 - done.resumed and done.resumed >= len(kept) - 1
    assert contents() == contents("whole")


def test_a_contact_sheet_shows_the_accents_of_names_from_macos():
    composed, decomposed, bare = (
        list(contact_sheets([Card(name, "", "", None)]))
        for name in ("Gr\u00f6\u00dfe", "Gro\u0308\u00dfe", "Gro\u00dfe")
    )
    assert composed == decomposed != bare


def test_a_contact_sheet_shows_every_drawing(tmp_path):
    picture = tmp_path / "a.png"
    cv2.imwrite(str(picture), np.full((60, 120, 3), (0, 0, 255), np.uint8))
    why = "a long sentence of 12.000 mm that goes on " * 12
    cards = [Card(f"drawing {k}" * 4, "overlap 0.990", why, None if k == 1 else picture.read_bytes) for k in range(31)]
    pages = [cv2.imdecode(np.frombuffer(each, np.uint8), 1) for each in contact_sheets(cards)]
    assert len(pages) == 2 and ACROSS * DOWN == 30
    assert pages[0].shape[1] == pages[1].shape[1] > ACROSS * CARD_W
    red = (pages[0] == (0, 0, 255)).all(axis=2)
    x, y = 40 + CARD_W // 2, 110 + PICTURE_H // 2
    assert red[y, x] and not red[y, x + CARD_W + GAP] and red[y + PICTURE_H + WORDS_H + GAP, x]
    assert pages[1].shape[0] < pages[0].shape[0]


def test_flags_that_have_no_effect_on_a_drawing_are_notices_of_its_row(desk):
    """convert gives the same notices."""
    items, options = [("line", drawing(0))], {"executor": threads(), "pen": "z"}
    (row,) = brushsvg.batch(items, "out", **options).rows
    converted = brushsvg.convert("in/0.svg", pen="z")
    assert [notice.code for notice in row.notices] == [notice.code for notice in converted.notices]
    assert "flag-without-effect" in {notice.code for notice in row.notices}
