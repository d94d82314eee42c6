"""One photograph makes a brush: a chart painted by a brush that nobody knows, in small steps by another simulator, with
faults of paint and sheet, photographed by a camera of its own kind. Its lag comes back."""

import numpy as np
import painter
import photograph
import pytest
from photograph import BLUE, Camera

core = pytest.importorskip("brushsvg._core")
if not hasattr(core, "fit_marks"):
    pytest.skip("built without Ceres", allow_module_level=True)

from brushsvg import find_brush  # noqa: E402
from brushsvg.brush.confidence import law_band  # noqa: E402
from brushsvg.calibration.chart.file import write_chart  # noqa: E402
from brushsvg.calibration.chart.layout import chart  # noqa: E402
from brushsvg.cli import main  # noqa: E402

TRUTH = painter.TrueBrush(
    10.0, np.array([2.6, 1.3, 0.1, -0.009]), np.array([0.0, 0.45]), np.array([0.0, 0.5, -0.005]), 1.6, 0.9
)
FAULTS = painter.Faults(noise=0.05, noise_length=0.5, displacement=0.3, placement=0.8, turn=0.008, height=0.1)
DEPTHS = np.linspace(1, 10, 10)


@pytest.fixture(scope="module")
def desk(tmp_path_factory):
    folder = tmp_path_factory.mktemp("desk")
    made = chart(find_brush("round-6"), (148.0, 210.0), "few")
    strokes = [(one.stroke, np.array(one.poses_mm)) for one in made.plan.passes]
    painted = painter.paint(np.random.default_rng(4), TRUTH, strokes, FAULTS)
    sheet = photograph.page(made)
    for _, _, rings in painted.marks:
        sheet.paint(rings, BLUE)
    camera = Camera(size_px=(1500, 2050), shadow=0.3)
    (folder / "photo.jpg").write_bytes(photograph.photograph(sheet, camera))
    (folder / "chart.json").write_text(write_chart(made))
    return folder


def test_one_photograph_gives_the_brush_back(desk, capsys):
    files = [str(desk / name) for name in ("photo.jpg", "chart.json", "own.json", "read.png")]
    assert main(["calibrate", files[0], "--chart", files[1], "-o", files[2], "--picture", files[3]]) == 0
    told = capsys.readouterr()
    assert "written; 24 strokes read, 6 markers within 0.0" in told.err
    assert "all edges may lie 0.02 mm off together" in told.out
    found = find_brush(desk / "own.json")
    off = {}
    for law in ("lag", "half_width"):
        truth = TRUTH.law(law)(DEPTHS)
        values = np.array([getattr(found, law)(depth) for depth in DEPTHS])
        off[law] = np.abs(values / truth - 1).max()
        band = law_band(found, law, DEPTHS)[0]
        assert np.mean(np.abs(values - truth) < band) > 0.7, (law, values - truth, band)
    assert off["lag"] < 0.03 and off["half_width"] < 0.03, off
    assert (desk / "read.png").stat().st_size > 10_000
