"""A typed brush improves over three sheets without a chart.

Each sheet is compared, and the brush is calibrated with it, with any plan. The next brush, corrections and cell
fit together.
"""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from diagnostics import in_json, is_reported

from brushsvg.cli import main

WORD = """<svg xmlns="http://www.w3.org/2000/svg" width="110mm" height="70mm" viewBox="0 0 110 70">
<g fill="none" stroke="#000" stroke-linecap="round">
<path id="bow" d="M14 24 C24 2 44 2 52 22" stroke-width="4"/>
<path id="hook" d="M62 12 L88 12 C96 12 96 30 82 30 L68 30" stroke-width="3.4"/>
<path id="wave" d="M58 56 C66 44 76 66 86 52 S96 50 100 56" stroke-width="2.6"/>
<path id="line" d="M46 50 L14 44" stroke-width="3"/></g></svg>"""
STUDIO = """format = "brushsvg/studio"
version = 1
[brush]
lag = 1.1
half_width = 0.92
[machine]
own_mm = 0.15
tilt_mm_per_mm = [0.003, 0.0]
[sheet]
shift_mm = [0.3, -0.2]
"""
MACHINE = """
[machine]
tilt_mm_per_mm = [0.002, 0.0]
height_mm = -0.1
"""


class Desk:
    """Run commands in one folder, as a user types them."""

    def __init__(self, at: Path):
        self.at = at
        (at / "word.svg").write_text(WORD)
        (at / "studio.toml").write_text(STUDIO)

    def run(self, line: str) -> None:
        words = [str(self.at / each) if "." in each and not each[0].isdigit() else each for each in line.split()]
        assert main([*words, "--quiet"]) == 0, line

    def overlap(self, name: str) -> float:
        return json.loads((self.at / name).read_text())["overlap_wanted"]


@pytest.fixture
def desk(tmp_path):
    return Desk(tmp_path)


def paint_three_sheets(desk: Desk) -> list[float]:
    """Return the overlap with the drawing on each sheet.

    The brush learns from each sheet. The next sheet is planned with the remaining corrections.
    """
    overlaps, moved = [], ""
    for sheet in (1, 2, 3):
        planned = f"--brush mine-{sheet}.json --cell cell-{sheet}.toml {moved}"
        desk.run(f"convert word.svg -o plan-{sheet}.json {planned} --page page-{sheet}.svg")
        desk.run(f"convert word.svg -o job-{sheet}.ngc {planned} --page page.svg --force")
        desk.run(f"check job-{sheet}.ngc word.svg {planned}")
        desk.run(f"check job-{sheet}.ngc plan-{sheet}.json --brush mine-{sheet}.json --cell cell-{sheet}.toml")
        desk.run(
            f"simulate-photo plan-{sheet}.json -o photo-{sheet}.jpg --brush mine-{sheet}.json --cell cell-{sheet}.toml "
            f"--true-brush round-6 --studio studio.toml --seed {sheet}"
        )
        desk.run(f"compare photo-{sheet}.jpg word.svg {planned} -o seen-{sheet}.json")
        overlaps.append(desk.overlap(f"seen-{sheet}.json"))
        desk.run(
            f"calibrate photo-{sheet}.jpg --plan plan-{sheet}.json --prior mine-{sheet}.json "
            f"-o mine-{sheet + 1}.json --machine tilt"
        )
        desk.run(
            f"compare photo-{sheet}.jpg plan-{sheet}.json --brush mine-{sheet + 1}.json --cell cell-{sheet}.toml "
            f"--corrected-cell cell-{sheet + 1}.toml -o left-{sheet}.json"
        )
        moved = f"--corrections left-{sheet}.json"
    return overlaps


@pytest.mark.parametrize("machine", ["", MACHINE], ids=["plain cell", "cell with a machine"])
def test_three_sheets_calibrate_a_brush_without_a_chart(desk, machine):
    desk.run("brush new -o mine-1.json --lag-at 1=5 --lag-at 4=8 --lag-at 8=11 --width-at 3=2.4 --width-at 8=5.8")
    desk.run("cell new -o cell-1.toml")
    cell = desk.at / "cell-1.toml"
    cell.write_text(cell.read_text() + machine)
    first, second, third = paint_three_sheets(desk)
    assert second > first + 0.03 and third > second - 0.02, (first, second, third)


def test_a_sheet_planned_for_another_brush_calibrates_with_a_warning(desk, capsys):
    """A sheet planned for another brush calibrates a brush, with a warning.

    The default brush painted the sheet. A brush that is typed later is calibrated with it.
    """
    desk.run("convert word.svg -o plan.json --page page.svg")
    desk.run("simulate-photo plan.json -o photo.jpg --studio studio.toml")
    desk.run("brush new -o mine.json --lag-at 1=5 --lag-at 4=8 --lag-at 8=11 --width-at 3=2.4 --width-at 8=5.8")
    words = "calibrate photo.jpg --plan plan.json --prior mine.json -o mine-2.json".split()
    words = [str(desk.at / each) if "." in each else each for each in words]
    status, _, reported = in_json(capsys, *words)
    assert status == 0 and is_reported(reported, "plan-of-other-brush round-6"), reported
