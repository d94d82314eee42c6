"""The commands of the docs run as they are written.

A shell runs each block in a separate folder. Files that a block uses and does not make itself are made when
it first names them. The camera of the package takes the photographs, and tests/laws paints.
"""

import json
import os
import re
import shlex
import shutil
import subprocess
import sys
from functools import cache
from itertools import pairwise
from pathlib import Path

import cv2
import ezdxf
from command import COMMAND
from sampling import sample
from shown_code import FOLLOWED, PAGES, REPOSITORY, Block, blocks, name_of, why_not_run

for place in ("tools", "tests/laws"):
    sys.path.insert(0, str(REPOSITORY / place))
import test_flatbed  # noqa: E402
import test_paint_found  # noqa: E402
from painted_chart import photo_of  # noqa: E402

from brushsvg.calibration.chart.file import write_chart  # noqa: E402
from brushsvg.cli.arguments.parser import parse  # noqa: E402

# tests/python/test_doc_code.py; FOLLOWED: test_pages_followed.py
ELSEWHERE = ("README.md",)
LONGEST_S = 900
ROBOT = (REPOSITORY / "examples" / "robot.svg").read_text()
FOREIGN = "G21\nG90\nG0 Z5\nG0 X30 Y40\nG1 Z-3 F600\nG1 X80 Y60 F1200\nG1 X120 Y30\nG0 Z5\nG0 X0 Y0\nM2\n"
TABLE = [
    "kind,depth_mm,value_mm",
    *(f"lag,{d},{3 + 0.9 * d:.1f}\nwidth,{d},{0.8 * d:.1f}" for d in range(1, 9)),
]
chart_photo = cache(photo_of)


def to_run() -> list[Block]:
    """Return the blocks whose commands are tested here, in the pages' order."""
    pages = [page for page in PAGES if page not in FOLLOWED and name_of(page) not in ELSEWHERE]
    found = [block for page in pages for block in blocks(page)]
    found = [block for block in found if block.kind == "commands"]
    return [block for block in found if not all(why_not_run(block.page, line) for line in block.code.splitlines())]


class Desk:
    """The folder in which a user types a block."""

    def __init__(self, folder: Path):
        self.folder = folder
        programs = folder.parent / "programs"
        programs.mkdir()
        (programs / "brushsvg").symlink_to(COMMAND)
        self.env = os.environ | {
            "HOME": str(folder.parent),
            "INKSCAPE_PROFILE_DIR": str(folder.parent / "profile"),
            "PATH": f"{programs}:/usr/bin:/bin",
        }
        for name in ("DISPLAY", "VIRTUAL_ENV", "PYTHONPATH"):
            self.env.pop(name, None)

    def type(self, line: str) -> None:
        """Run a line in a shell; it must succeed."""
        done = subprocess.run(
            ["bash", "-c", line],
            cwd=self.folder,
            env=self.env,
            capture_output=True,
            text=True,
            timeout=LONGEST_S,
        )
        assert done.returncode == 0, (line, done.stderr)

    def make(self, name: str) -> None:
        """Make a file that a command uses, unless it exists."""
        path = self.folder / name
        if name not in MADE or any(self.folder.glob(name)):
            return
        made = MADE[name]
        if callable(made):
            made(self)
        elif made.startswith("brushsvg "):
            self.make_all(made)
            self.type(made)
        else:
            path.write_text(made)
        assert any(self.folder.glob(name)), name

    def make_all(self, line: str, *, replace: bool = True) -> None:
        """Make the files that the commands of a line read.

        With replace, the files that they write are removed first.
        """
        for command in re.split(r" \| ", line):
            words = shlex.split(re.sub(" > .*", "", command), comments=True)
            if words and words[0] == "brushsvg":
                written = _written(words[1:])
                # Commands do not replace a file that may belong to the user.
                for name in filter(None, written if replace else ()):
                    if (self.folder / name).is_file():
                        (self.folder / name).unlink()
                for word in words:
                    if word not in written:
                        self.make(word)
                for word in words:
                    if word.endswith(".jpg") and word not in written and not (self.folder / word).exists():
                        self.type(_photographing(word, words))
            elif words[0] in ("inkscape", "xvfb-run"):
                self.make("word.svg")


def _written(words: list[str]) -> set[str | None]:
    """Return the files that a command writes."""
    args = parse(words)
    names = ["output", "picture", "marks_picture", "page", "report", "corrected_cell"]
    names += ["chart"] if words[0] == "chart" else []
    return {getattr(args, name, None) for name in names}


def _photographing(photo: str, words: list[str]) -> str:
    """Return the command that takes a photograph for a command.

    The photograph shows the painted job that this command reads.
    """
    flags = dict(pair for pair in pairwise(words) if pair[0].startswith("--"))
    job = flags.get("--plan") or next(word for word in words[2:] if word.endswith((".svg", ".json")))
    painted = {"--brush": flags.get("--brush") or flags.get("--prior")}
    painted |= {name: flags.get(name) for name in ("--cell", "--corrections")}
    reported = [word for name, value in painted.items() if value for word in (name, value)]
    seed = re.sub(r"\D", "", photo) or "9"
    return shlex.join(["brushsvg", "simulate-photo", job, "-o", photo, "--seed", seed, *reported])


def _letters(desk: Desk, *names: str) -> None:
    for name in names:
        (desk.folder / name).parent.mkdir(exist_ok=True)
        (desk.folder / name).write_text(ROBOT)


def _dxf(desk: Desk) -> None:
    drawing = ezdxf.new(units=4)  # mm
    drawing.modelspace().add_line((10, 10), (60, 40), dxfattribs={"lineweight": 200})
    drawing.saveas(desk.folder / "b.dxf")


def _chart_photo(name: str, of: str = "chart.json"):
    def make(desk: Desk) -> None:
        desk.make(of)
        (desk.folder / name).write_bytes(chart_photo((desk.folder / of).read_bytes()))

    return make


def _scan(desk: Desk) -> None:
    (desk.folder / "chart.json").write_text(write_chart(test_flatbed.a5()))
    cv2.imwrite(str(desk.folder / "scan.png"), test_flatbed.scanned(300)[..., ::-1])


def _one_load(desk: Desk) -> None:
    _, sheet = test_paint_found.sheet(6, 0.8, True)
    reported = {"format": "brushsvg/measurements", "version": 1, **sheet}
    (desk.folder / "one-load.json").write_text(json.dumps(reported))


DEJAVU = "/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf"
# Name of a file -> its text, the command that makes it, or a function of the desk.
MADE = {
    "word.svg": ROBOT,
    "a.svg": ROBOT,
    "letters/": lambda desk: _letters(desk, "letters/one.svg"),
    "more/*.svg": lambda desk: _letters(desk, "more/two.svg", "more/three.svg"),
    "list.txt": lambda desk: (
        _letters(desk, "four.svg"),
        (desk.folder / "list.txt").write_text("four.svg\n"),
    ),
    "names.txt": "Ada\nGrace\n",
    "b.dxf": _dxf,
    "foreign.gcode": FOREIGN,
    "mine.csv": "\n".join(TABLE) + "\n",
    "Lora.ttf": lambda desk: shutil.copy(DEJAVU, desk.folder / "Lora.ttf"),
    "DejaVuSans.ttf": lambda desk: shutil.copy(DEJAVU, desk.folder),
    "robot.svg": ROBOT,
    "letters.svg": "brushsvg text Ro -o letters.svg --font Lora.ttf --size 60",
    "word.ngc": "brushsvg convert word.svg -o word.ngc",
    "mine.json": "brushsvg brush new -o mine.json --like round-6",
    "my-brush.json": "brushsvg brush new -o my-brush.json --like round-6",
    "mine.toml": "brushsvg cell new -o mine.toml",
    "my-machine.toml": "brushsvg cell new -o my-machine.toml",
    "plan.json": "brushsvg convert word.svg -o plan.json --brush my-brush.json",
    "word.json": "brushsvg convert word.svg -o word.json --brush mine.json",
    "mine-2.json": "brushsvg calibrate sheet-1.jpg --plan word.json --prior mine.json -o mine-2.json",
    "left.json": "brushsvg compare sheet-1.jpg word.json --brush mine-2.json -o left.json",
    "chart.json": "brushsvg chart -o chart.ngc --page page.pdf --chart chart.json",
    "strokes.jpg": _chart_photo("strokes.jpg"),
    "IMG_2041.jpg": _chart_photo("IMG_2041.jpg"),
    "dabs.jpg": _chart_photo("dabs.jpg", "dabs.json"),
    "scan.png": _scan,
    "one-load.json": _one_load,
}


@sample("block", to_run(), ids=lambda block: f"{block.page}:{block.line}", keep=8)
def test_a_block_of_commands_on_a_page_runs(block, tmp_path):
    (tmp_path / "desk").mkdir()
    desk = Desk(tmp_path / "desk")
    if block.kind == "shell":
        desk.type("brushsvg setup inkscape")
    for line in block.code.splitlines():
        if not why_not_run(block.page, line):
            desk.make_all(line)
            desk.type(line)
            for name in re.findall(r"(?:-o|--picture|--marks-picture|--page|--chart|>) +(\S+\.\w+)", line):
                path = Path(name)
                pattern = f"{path.stem}-*{path.suffix}" if f"-o {name}" in line and "--per-colour" in line else name
                written = [*desk.folder.glob(pattern)]
                assert written and all(file.stat().st_size > 0 for file in written), line
            if edit := re.search(r"-o (\S+) .*# in the file, set (\w+) = (\S+)", line):
                file = desk.folder / edit[1]
                text, count = re.subn(rf"(?m)^{edit[2]} = \S+", f"{edit[2]} = {edit[3]}", file.read_text())
                assert count == 1, line
                file.write_text(text)
