"""hp2xx reads our HP-GL as planned: a word and a page of 1,000 strokes."""

import json
import re
import shutil
import subprocess

import numpy as np
import pytest
from command import brushsvg
from judge.hpgl import UNIT_MM, run_hpgl

pytestmark = pytest.mark.skipif(shutil.which("hp2xx") is None, reason="hp2xx is not installed")

FIRST_MM = 0.05  # hp2xx shifts the start of each line slightly
WORD = (
    '<svg xmlns="http://www.w3.org/2000/svg" width="120mm" height="60mm" viewBox="0 0 120 60"><g fill="none" '
    'stroke="#000"><path id="h" d="M15 10V45M15 28C22 18 32 18 32 30V45"/><path id="a" d="M60 30A9 9 0 1 0 60 '
    '31M60 20V45"/><path id="d" d="M90 28A9 9 0 1 0 90 29M90 8V45"/><path id="dot" d="M105 44L105.3 44"/></g></svg>'
)


def page() -> dict:
    """Return 1,000 waves next to each other, set down and lifted in place."""
    t = np.linspace(0, 1, 20)
    passes = []
    for number in range(1000):
        x, y = 15 + 36 * (number % 10), 10 + 2.4 * (number // 10)
        wave = np.column_stack([x + 30 * t, y + np.sin(6 * t), np.full(len(t), -0.2)])
        poses = np.vstack([wave[:1] * (1, 1, 0), wave, wave[-1:] * (1, 1, 0)])
        passes.append({"stroke": f"s{number}", "poses_mm": np.round(poses, 6).tolist(), "speed_mm_s": 20.0})
    return {
        "format": "brushsvg/plan",
        "version": 1,
        "brush": "rigid",
        "brush_sha256": "",
        "sheet_mm": [400.0, 270.0],
        "passes": passes,
    }


def drawn(program, folder) -> list[np.ndarray]:
    """Return (n, 2) mm of each line that hp2xx draws and writes back as HP-GL."""
    done = subprocess.run(
        ["hp2xx", "-m", "hpgl", "-t", "-f", "out.plt", program.name],
        cwd=folder,
        capture_output=True,
        timeout=120,
        encoding="latin-1",
        check=True,
    )
    output = done.stdout + done.stderr
    assert re.search(r"command\(s\) ignored: *0\b", output) and re.search(r"Unexpected event\(s\): *0\b", output), (
        output
    )
    low = [float(each) for each in re.search(r"Coordinate range: \((.*?), (.*?)\)", output).groups()]
    strokes: list[list] = []
    written = (folder / "out.plt").read_text(encoding="latin-1")
    for word, x, y in re.findall(r"(PU|PD)(-?[\d.]+),(-?[\d.]+);", written):
        place = (float(x) + low[0], float(y) + low[1])
        if word == "PD":
            strokes[-1].append(place)
        elif not strokes or np.abs(np.subtract(place, strokes[-1][-1])).max() > 1e-3:
            strokes.append([place])  # otherwise the line continues in another polygon
    return [UNIT_MM * np.array(stroke) for stroke in strokes if len(stroke) > 1]


@pytest.mark.parametrize("what", ["word", "page"])
def test_hp2xx_draws_the_plan(what, tmp_path):
    source = tmp_path / ("word.svg" if what == "word" else "page.json")
    source.write_text(WORD if what == "word" else json.dumps(page()))
    pen = ("--brush", "rigid", "--cell", "hpgl-plotter")
    brushsvg("convert", source.name, "-o", "plan.json", *pen, cwd=tmp_path, status=0)
    brushsvg("convert", source.name, "-o", "made.hpgl", *pen, cwd=tmp_path, status=0)
    plan = json.loads((tmp_path / "plan.json").read_text())
    strokes = drawn(tmp_path / "made.hpgl", tmp_path)
    ours = _stub(tmp_path / "made.hpgl")
    assert len(strokes) == len(ours) == len(plan["passes"])
    for stroke, own, a_pass in zip(strokes, ours, plan["passes"], strict=True):
        assert stroke[1:].shape == own[1:].shape or stroke.shape == (len(own) + 1, 2)
        assert np.abs(stroke[-len(own) + 1 :] - own[1:]).max() < 1e-6
        assert np.abs(stroke[0] - own[0]).max() < FIRST_MM
        poses = np.array(a_pass["poses_mm"])
        assert np.abs(own[0] - poses[0, :2]).max() <= UNIT_MM / 2 + 1e-9
        assert np.abs(own[-1] - poses[-1, :2]).max() <= UNIT_MM / 2 + 1e-9
        for place in own:  # on the plan's path; circles are chords within 0.01 mm
            assert _away(place, poses[:, :2]) < UNIT_MM / 2 * 2**0.5 + 0.3 * bool(a_pass.get("arcs"))
    if what == "word":
        assert brushsvg("check", "made.hpgl", source.name, cwd=tmp_path, status=0)


def _stub(program) -> list[np.ndarray]:
    run = run_hpgl(program.read_text(), (0.0, 0.0, 1.0), -0.2, 4.0, 380.0)
    assert not run.refused and not run.acts
    strokes: list[list] = []
    for leg in run.legs:
        if leg.kind == "jump" and leg.end[2] < 0:
            strokes.append([leg.end[:2]])
        elif leg.kind == "feed":
            strokes[-1].append(leg.end[:2])
    return [np.array(stroke) for stroke in strokes]


def _away(place: np.ndarray, path: np.ndarray) -> float:
    steps = np.diff(path, axis=0)
    along = ((place - path[:-1]) * steps).sum(axis=1) / np.maximum((steps**2).sum(axis=1), 1e-18)
    return float(np.linalg.norm(place - path[:-1] - np.clip(along, 0, 1)[:, None] * steps, axis=1).min())
