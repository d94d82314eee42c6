"""All texts for users are compared word for word with tests/golden/wording.txt.

All other tests check codes and numbers. After a change of words, write the file again with `make wording` and
read its changes.
"""

import argparse
import contextlib
import io
import os
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

import pytest

from brushsvg.cli import main
from brushsvg.cli.arguments.parser import command_parser
from brushsvg.errors import Notice
from brushsvg.show.evaluation.figures import Figures, Group, Worst
from brushsvg.show.evaluation.places import Place
from brushsvg.show.evaluation.report import Report, comparison_text, to_text

WORDING = Path(__file__).parents[1] / "golden" / "wording.txt"
TITLE = "==== "

SVG = '<svg xmlns="http://www.w3.org/2000/svg" width="90mm" height="60mm" viewBox="0 0 90 60">{}</svg>'
LINE = '<path id="line" d="M20 30H60" fill="none" stroke="#203060" stroke-width="3"/>'
FILES = {
    "line.svg": SVG.format(LINE),
    "thin.svg": SVG.format(LINE.replace('"3"', '"0.3"')),
    "wide.svg": SVG.format(LINE.replace('"3"', '"30"')),
    "damaged.svg": SVG.format(LINE.replace("H60", "H60 X")),
    "text.svg": SVG.format('<text id="t" x="20" y="30">A</text>'),
    "off.svg": SVG.format(LINE.replace("M20", "M-3")),
    "not.svg": "moo",
    "empty.svg": SVG.format(""),
    "plan.json": '{"format": "brushsvg/plan", "version": 99}',
}
TYPED = (  # commands that work, warn or fail; commands that list, show and check
    *(f"convert {name} -o {Path(name).stem}.ngc" for name in FILES),
    "convert none.svg -o out.ngc",
    "convert line.svg -o out.ngc --brush broom",
    "convert line.svg -o out.pdf",
    "convert line.svg -o out.ngc --lag 5",
    "convert line.svg -o out.ngc --speed 26",
    "check line.ngc line.svg",
    "setup border line.svg -o border.ngc",
    "check border.ngc",
    "setup height -o height.ngc",
    "check height.ngc",
    "brush list",
    "brush show round-6",
    "brush new -o mine.json --lag 5 --width-at 3=2",
    "cell list",
    "cell show ur5e",
    "cell check ur5e",
)


def helps(parser: argparse.ArgumentParser) -> Iterator[tuple[str, str]]:
    """Yield each command with the help texts of the command and its flags.

    The result does not depend on how this version of Python breaks lines.
    """
    lines, below = [parser.description or ""], []
    for action in parser._actions:
        if isinstance(action, argparse._SubParsersAction):
            summaries = {choice.dest: choice.help for choice in action._choices_actions}
            lines += [f"{name}: {summaries.get(name, '')}" for name in action.choices]
            below += action.choices.values()
        elif not isinstance(action, argparse._HelpAction):
            lines.append(f"{' '.join(action.option_strings) or action.metavar or action.dest}: {action.help}")
    yield f"{parser.prog} --help", "\n".join(lines)
    for each in below:
        yield from helps(each)


def reports() -> Iterator[tuple[str, str]]:
    """Yield the name and the text of reports that contain all possible parts."""
    row = Figures("line", 0.95, 0.01, 0.04, 0.12, 1, 60.0, 81.5, 42, excess_turning=0.1)
    worst = Worst((12.34, 5.67), True, 0.5, "REASON", "shorter-than-footprint")
    odd = Figures("dab", None, None, None, None, None, None, 12.0, 7, worst)
    reported = (Notice("line", "SENTENCE", advice="ADVICE"),)
    place = Place(1, "dab", (12.34, 5.67), 0.5, 0.0, 0.3, "REASON", "shape-corner", "REMEDY", "SIZE")
    made = Report("T", "round-6", "closed", 0.05, (row, odd), row, 75.0, reported, reported, places=(place,))
    yield "a report", to_text(made, picture="picture.png")
    yield "a report with details", to_text(made, details=True)
    made = Report("", "round-6", "", None, (row,), row, 5.0, groups=(Group(("line", "dab"), 0.9),))
    yield "a report of strokes that touch", to_text(made, details=True)
    yield "compensations compared", comparison_text([("none", row), ("closed", row)])


def typed() -> Iterator[tuple[str, str]]:
    """Yield each command and its output, run one after the other in a new folder."""
    before = Path.cwd()
    with tempfile.TemporaryDirectory() as folder:
        for name, content in FILES.items():
            Path(folder, name).write_text(content)
        os.chdir(folder)
        try:
            for words in TYPED:
                with contextlib.redirect_stdout(io.StringIO()) as out, contextlib.redirect_stderr(out):
                    status = main(words.split())
                yield f"brushsvg {words}", f"{out.getvalue()}exit status {status}"
        finally:
            os.chdir(before)


def wording() -> str:
    sections = [*helps(command_parser()), *reports(), *typed()]
    return "\n".join(f"{TITLE}{title}\n{text.strip()}\n" for title, text in sections)


@pytest.mark.wording
def test_wording_equals_the_golden_file():
    reported, read = (text.split(TITLE) for text in (wording(), WORDING.read_text(encoding="utf-8")))
    assert reported == read, "if it is intended: make wording, and read what git says of the file"


if __name__ == "__main__":
    WORDING.write_text(wording(), encoding="utf-8")
    sys.exit()
