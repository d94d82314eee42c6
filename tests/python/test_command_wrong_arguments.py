"""Every command refuses nonsense with its own messages and leaves no files."""

from pathlib import Path
from shutil import copytree

import pytest

from brushsvg.cli import main

SOUND = {  # placeholder of a file in a command: the valid file
    "IN": "a.svg",
    "BRUSH": "mine.json",
    "CELL": "mine.toml",
    "PROGRAM": "own.ngc",
    "PLAN": "plan.json",
    "TABLE": "table.csv",
    "WIDTHS": "widths.csv",
    "MEASURED": "marks.json",
    "CHART": "page.json",
    "PHOTO": "photo.jpg",
    "FONT": "font.svg",
    "ZIP": "extension.zip",
}
COMMANDS = [
    "init --cell CELL",
    "init --cell ur5e --brush BRUSH",
    "convert IN -o OUT.ngc",
    "convert IN -o OUT.json",
    "convert PLAN -o OUT.ngc",
    "convert a.svg -o OUT.ngc --brush BRUSH",
    "convert a.svg -o OUT.ngc --cell CELL",
    "preview IN -o OUT.svg",
    "preview PLAN -o OUT.json",
    "preview IN",
    "preview a.svg -o OUT.png --show errors",
    "preview IN -o OUT.html",
    "preview IN -o OUT.png --show strokes",
    "setup border IN -o OUT.ngc",
    "setup first-run CELL -o OUT.ngc",
    "setup first-run linuxcnc-3axis -o OUT.ngc --brush BRUSH",
    "setup height -o OUT.ngc --brush BRUSH",
    "check PROGRAM",
    "check own.ngc IN --picture OUT.svg",
    "check own.ngc PLAN",
    "text T -o OUT.svg --font FONT",
    # Nonsense words and drawings become refused rows: see test_batch.py.
    "batch --words words.txt --font FONT -o new",
    "chart -o OUT.ngc --drawing IN",
    "calibrate TABLE -o OUT.json",
    "calibrate MEASURED -o OUT.json",
    "calibrate PHOTO --scan --chart CHART -o OUT.json",
    "calibrate PHOTO --chart CHART -o OUT.json",
    "calibrate PHOTO --plan plan.json --prior round-6 -o OUT.json",
    "calibrate photo.jpg --plan PLAN --prior mine.json -o OUT.json",
    "calibrate photo.jpg --plan plan.json --prior BRUSH -o OUT.json",
    "compare PHOTO a.svg -o OUT.json",
    "compare PHOTO PLAN",
    "simulate-photo IN -o OUT.jpg",
    "brush new -o OUT.json --lag 5 --widths WIDTHS",
    "brush new -o OUT.json --like BRUSH",
    "brush show BRUSH",
    "brush check BRUSH",
    "brush plot BRUSH -o OUT.svg",
    "cell show CELL",
    "cell check CELL",
    "cell new -o OUT.toml --like CELL",
    "cell place CELL",
    "cell place ur5e IN",
    "setup inkscape ZIP",
]
NONSENSE = {  # None stands for a folder, False for a missing file.
    "missing": False,
    "a folder": None,
    "empty": b"",
    "blank": b"\n \n",
    "binary": bytes(range(256)) * 40,
    "zeros": bytes(3000),
    "braces": b"{}",
    "lists": b"[[[[1]]]]",
    "deep": b"[" * 100_000,
    "half a letter": b"<svg>\xc3",
}
PLACES = {"no folder": "no/out", "below a file": "a.svg/out", "a folder": "folder", "a full device": "full"}


@pytest.fixture(scope="module")
def sound(tmp_path_factory):
    """A folder with one valid file of each kind; each test gets a copy."""
    folder = tmp_path_factory.mktemp("sound")
    (folder / "a.svg").write_text(
        '<svg xmlns="http://www.w3.org/2000/svg" width="120mm" height="60mm" viewBox="0 0 120 60">'
        '<path id="line" d="M20 40 C40 10 60 10 90 30" fill="none" stroke="#203060" stroke-width="3"/></svg>'
    )
    (folder / "font.svg").write_text(
        '<svg xmlns="http://www.w3.org/2000/svg"><font horiz-adv-x="600"><font-face units-per-em="1000"/>'
        '<glyph unicode="T" d="M 0 700 L 500 700 M 250 700 L 250 0"/></font></svg>'
    )
    (folder / "words.txt").write_text("T\n")
    rows = [f"{kind},{depth},{k * depth}" for depth in range(1, 7) for kind, k in (("lag", 2), ("width", 1))]
    (folder / "table.csv").write_text("\n".join(["kind,depth_mm,value_mm", *rows]))
    (folder / "widths.csv").write_text("depth_mm,width_mm\n3,2\n")
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        for words in ("convert a.svg -o own.ngc", "convert a.svg -o plan.json", "cell new -o mine.toml"):
            assert main(words.split()) == 0
        assert main("brush new -o mine.json --lag 5 --width-at 3=2 --width-at 8=7".split()) == 0
        assert main("chart -o strokes.json --sheet a5 --strokes few --chart page.json".split()) == 0
    return folder


@pytest.fixture
def desk(sound, tmp_path, monkeypatch, capsys):
    copytree(sound, tmp_path, dirs_exist_ok=True)
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("INKSCAPE_PROFILE_DIR", str(tmp_path / "profile"))
    return tmp_path


def contents(folder: Path) -> dict:
    return {path.relative_to(folder): path.is_file() and path.read_bytes() for path in folder.rglob("*")}


def refused(desk, capsys, words) -> list[str]:
    before = contents(desk)
    status = main(words)
    printed = capsys.readouterr().err
    assert status in (1, 2), (words, status, printed)
    assert printed and all(line.startswith("brushsvg: ") for line in printed.splitlines()), (words, printed)
    assert "should not happen" not in printed, (words, printed)
    assert contents(desk) == before, words
    return printed.splitlines()


@pytest.mark.parametrize("command", [each for each in COMMANDS if any(word in SOUND for word in each.split())])
@pytest.mark.slow
def test_every_command_refuses_invalid_inputs(desk, capsys, command):
    for word in {*command.split()} & {*SOUND}:
        path = desk / f"bad{Path(SOUND[word]).suffix}"
        for kind, data in NONSENSE.items():
            if data is None:
                path.mkdir()
            elif data is not False:
                path.write_bytes(data)
            words = [path.name if each == word else each.replace("OUT", "out") for each in command.split()]
            (line,) = refused(desk, capsys, [SOUND.get(each, each) for each in words])
            assert path.name in line, (kind, line)
            if data is None:
                path.rmdir()
            elif data is not False:
                path.unlink()


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="needs /dev/full")
@pytest.mark.parametrize(
    "command",
    [each for each in COMMANDS if "OUT" in each and not {"MEASURED", "PHOTO", "photo.jpg"} & {*each.split()}],
)
@pytest.mark.slow
def test_every_command_refuses_unwritable_outputs(desk, capsys, command):
    for kind, place in PLACES.items():
        suffix = next(Path(word).suffix for word in command.split() if word.startswith("OUT"))
        out = desk / f"{place}{suffix}"
        if kind == "a folder":
            out.mkdir()
        elif kind == "a full device":
            out.symlink_to("/dev/full")
        words = [f"{place}{suffix}" if word.startswith("OUT") else word for word in command.split()]
        *_, line = refused(desk, capsys, [SOUND.get(word, word) for word in words])
        assert line.startswith(f"brushsvg: {place}{suffix}: "), (kind, line)


def test_every_command_is_tested():
    from brushsvg.cli.arguments.parser import command_parser

    def names(parser) -> set[str]:
        found = set()
        for action in parser._actions:
            for name, below in (action.choices if hasattr(action, "_name_parser_map") else {}).items():
                found |= {f"{name} {each}".strip() for each in names(below) or {""}}
        return found

    # test_demo.py covers the places that demo writes to.
    reads_nothing = {"brush list", "cell list", "demo", "doctor"}
    assert names(command_parser()) - reads_nothing == {
        next(name for name in names(command_parser()) if f"{command} ".startswith(f"{name} ")) for command in COMMANDS
    }
