"""The commands work in a real vpype, in a separate environment.

Its installation is slow; -m "not slow" leaves these tests out.
"""

import json
import os
import re
import shutil
import subprocess
import sys
import sysconfig
from pathlib import Path

import numpy as np
import pytest
from command import OPEN, brushsvg

from brushsvg import _core, area, find_brush, read_drawing, read_plan, simulate

pytestmark = pytest.mark.slow
SOURCE = Path(__file__).parents[2] / "plugins" / "vpype"
DRAWING = f"""{OPEN.replace("<svg", '<svg xmlns:inkscape="http://www.inkscape.org/namespaces/inkscape"')}
 <g inkscape:groupmode="layer" inkscape:label="Ink" id="layer1" fill="none" stroke="#203060" stroke-width="3">
  <path id="line" d="M20 40 C40 10 60 10 90 30"/><path id="corner" d="M20 50 H60 V40"/></g>
 <g inkscape:groupmode="layer" inkscape:label="Red" id="layer2" fill="none" stroke="#ff0000" stroke-width="2">
  <circle id="ring" cx="90" cy="42" r="8"/></g></svg>"""


@pytest.fixture(scope="session")
def vpype(tmp_path_factory):
    """Return a function that runs vpype with the tested brushsvg next to its packages."""
    folder = tmp_path_factory.mktemp("vpype")
    environment = folder / "env"
    python = environment / "bin" / "python"
    shutil.copytree(SOURCE, folder / "source")
    subprocess.run([sys.executable, "-m", "venv", environment], check=True)
    for words in (["vpype"], ["--no-deps", folder / "source"]):
        done = subprocess.run([python, "-m", "pip", "install", "-q", *words], capture_output=True, text=True)
        if done.returncode:
            pytest.skip(f"vpype cannot be installed here: {done.stderr.splitlines()[-1]}")
    near_by = f"import site; site.addsitedir({sysconfig.get_path('purelib')!r})\n"
    (next(environment.glob("lib/python*/site-packages")) / "brushsvg.pth").write_text(near_by)

    def run(*words, cwd, status=0):
        done = subprocess.run(
            [environment / "bin" / "vpype", *map(str, words)],
            cwd=cwd,
            env={**os.environ, "HOME": str(folder)},
            capture_output=True,
            text=True,
            timeout=120,
        )
        assert done.returncode == status, done.stderr
        assert "Traceback" not in done.stderr
        return done.stderr

    return run


@pytest.fixture
def desk(tmp_path):
    (tmp_path / "x.svg").write_text(DRAWING)
    return tmp_path


def test_brush_shows_the_marks_of_preview(vpype, desk):
    vpype("read", "x.svg", "brush", "--brush", "round-6", "write", "marks.svg", cwd=desk)
    brushsvg("preview", "x.svg", "-o", "predicted.svg", cwd=desk, status=0)

    def inked(name):
        parts = (part for each in read_drawing(desk / name).elements for part in each.subpaths)
        return sum(abs(area([part.cubics[:, 0]])) for part in parts), np.vstack(
            [part.cubics[:, 0] for each in read_drawing(desk / name).elements for part in each.subpaths]
        )

    (area_mm2, corners), (expected_mm2, expected) = inked("marks.svg"), inked("predicted.svg")
    assert area_mm2 == pytest.approx(expected_mm2, rel=0.01)
    assert np.abs(corners.min(axis=0) - expected.min(axis=0)).max() < 0.1  # vpype reads curves to 0.1 mm
    assert np.abs(corners.max(axis=0) - expected.max(axis=0)).max() < 0.1


def test_refined_strokes_equal_the_command_line_output(vpype, desk):
    """The lines are straight, because vpype flattens curves, and start pointed.

    Refined marks differ most at pointed starts.
    """
    pointed = ("--start", "pointed")
    words = ("--compensation", "refined", *pointed)
    straight = re.sub('<path id="line".*?/>|<circle.*?/>', "", DRAWING).replace('width="3"', 'width="5"')
    straight = straight.replace("H60 V40", "H40")
    (desk / "x.svg").write_text(straight)
    vpype("read", "x.svg", "brushwrite", *words, "out.json", "brushwrite", *pointed, "closed.json", cwd=desk)
    brushsvg("convert", "x.svg", "-o", "typed.json", *words, cwd=desk, status=0)

    def painted(name):
        brush = find_brush("round-6")
        marks = simulate(read_plan(desk / name), brush)
        _core.trace_outlines(marks, brush)
        return marks.outline_mm

    typed = painted("typed.json")
    assert _core.overlap(painted("out.json"), typed) > 0.995  # poses differ because vpype rounds paths
    assert _core.overlap(painted("closed.json"), typed) < 0.97


def test_layers_keep_their_settings(vpype, desk):
    vpype("read", "x.svg", "brush", "write", "marks.svg", cwd=desk)
    text = (desk / "marks.svg").read_text()
    for reported in ('inkscape:label="Ink"', 'inkscape:label="Red"', 'stroke="#203060"', 'stroke="#f00"'):
        assert reported in text or reported.replace("#f00", "#ff0000") in text, reported
    design = read_drawing(desk / "marks.svg")
    widths = {each.layer: round(each.stroke_width_mm, 3) for each in design.elements}
    assert widths == {"Ink": 3, "Red": 2}


def test_brushwrite_paints_each_layer_with_its_own_width(vpype, desk):
    vpype("read", "x.svg", "brushwrite", "out.json", "brushwrite", "--width", "1mm", "thin.json", cwd=desk)
    brushsvg("convert", "x.svg", "-o", "typed.json", cwd=desk, status=0)
    plan, thin, typed = (json.loads((desk / f"{name}.json").read_text()) for name in ("out", "thin", "typed"))
    depths = [[min(z for _, _, z in each["poses_mm"]) for each in some["passes"]] for some in (plan, thin, typed)]
    assert depths[0] == pytest.approx(depths[2], abs=0.02)
    assert max(depths[1]) == pytest.approx(min(depths[1]), abs=0.02) and min(depths[1]) > max(depths[0])
    assert [each["layer"] for each in plan["passes"]] == ["Ink", "Ink", "Red"]
    assert [each["colour"] for each in plan["passes"]] == ["#203060", "#203060", "#ff0000"]


@pytest.mark.parametrize(
    ("words", "reported"),
    [
        (("line", "0", "0", "5cm", "5cm", "brushwrite", "o.ngc"), "layer 1"),
        (("read", "x.svg", "brushwrite", "o.xyz"), ".xyz"),
        (("read", "x.svg", "brush", "--brush", "broom"), "broom"),
        (
            ("read", "x.svg", "brushwrite", "--width", "3cm", "o.ngc"),
            "[0.000, 8.400] mm",
        ),
        (("read", "x.svg", "brushwrite", "--cell", "nowhere", "o.ngc"), "nowhere"),
        (("brushwrite", "o.ngc"), "nothing"),
        (
            ("pagesize", "5x5cm", "line", "0", "0", "9cm", "9cm", "brushwrite", "--width", "3mm", "o.ngc"),
            "beyond",
        ),
    ],
)
def test_unpaintable_layers_are_refused_in_a_sentence(vpype, desk, words, reported):
    assert reported in vpype(*words, cwd=desk, status=1)
    assert not list(desk.glob("o.*"))


def test_a_drawing_without_page_gets_a_margin(vpype, desk):
    vpype("line", "0", "0", "5cm", "3cm", "penwidth", "3mm", "brushwrite", "o.json", cwd=desk)
    assert json.loads((desk / "o.json").read_text())["sheet_mm"] == pytest.approx([90, 70], abs=0.01)


def zigzag(chance):
    """Return points (n, 2) of a line in px with only sharp turns.

    The plugin would read smaller turns as a flattened curve.
    """
    at, heading = chance.uniform((60, 60), (300, 160)), chance.uniform(0, 2 * np.pi)
    points = [at]
    for _ in range(int(chance.integers(1, 5))):
        at = np.clip(at + chance.uniform(30, 80) * np.array([np.cos(heading), np.sin(heading)]), 20, (340, 200))
        points.append(at)
        heading += chance.choice([-1, 1]) * chance.uniform(1.2, 2.2)
    return np.round(points, 1)


def test_programs_equal_the_bytes_of_convert(vpype, desk):
    """The lines are straight, in px, and have the names that the plugin gives.

    vpype flattens curves, drops names, and its millimetre is 0.5 ppm off.
    """
    chance = np.random.default_rng(7)
    for number in range(10):
        layers = []
        for layer, (label, ink) in enumerate((("Ink", "#203060"), ("Red", "#ff0000")), 1):
            lines = [" ".join(f"{x:g},{y:g}" for x, y in zigzag(chance)) for _ in range(4)]
            paths = (f'<path id="layer{layer}-{k}" d="M{line}"/>' for k, line in enumerate(lines, 1))
            layers.append(
                f'<g inkscape:groupmode="layer" inkscape:label="{label}" id="layer{layer}" fill="none" '
                f'stroke="{ink}" stroke-width="{4 + 4 * layer}">{"".join(paths)}</g>'
            )
        (desk / "x.svg").write_text(
            '<svg xmlns="http://www.w3.org/2000/svg" xmlns:inkscape="http://www.inkscape.org/namespaces/inkscape" '
            f'width="384" height="240" viewBox="0 0 384 240">{"".join(layers)}</svg>'
        )
        vpype("read", "x.svg", "brushwrite", f"{number}.ngc", cwd=desk)
        brushsvg("convert", "x.svg", "-o", "typed.ngc", "--force", cwd=desk, status=0)
        assert (desk / f"{number}.ngc").read_bytes() == (desk / "typed.ngc").read_bytes(), number
