"""Every kind of brush file paints every kind of drawing, or is refused for a physical reason."""

from __future__ import annotations

from pathlib import Path

import pytest
from desk import BRUSHES, DRAWINGS, SLOW_BRUSHES, brush_file, drawing_file
from diagnostics import in_json, is_reported

# Brush and drawing: the code of the refusal, and why this kind of brush cannot paint the drawing.
REFUSED = {
    ("like", "sliver"): "nothing-to-paint",  # a hundredth of the smallest mark of the brush
    ("liner-1", "sliver"): "nothing-to-paint",
    ("rigid", "plan"): "depth-out-of-range",  # the plan presses round-6 deeper than this pen can go
}


def paints(desk: Path, brush: str, drawing: str, capsys) -> None:
    out = desk / "out.ngc"
    out.unlink(missing_ok=True)
    words = "convert", drawing_file(desk, drawing), "-o", out, "--brush", brush_file(desk, brush)
    status, _, reported = in_json(capsys, *words)
    if code := REFUSED.get((brush, drawing)):
        assert status == 1 and is_reported(reported, code), reported
        assert not out.exists()
        return
    assert status == 0, reported
    assert "G1" in out.read_text()
    assert not is_reported(reported, "internal-error")


@pytest.mark.parametrize("drawing", DRAWINGS)
@pytest.mark.parametrize("brush", BRUSHES)
def test_every_brush_paints_every_drawing(desk, capsys, brush, drawing):
    paints(desk, brush, drawing, capsys)


@pytest.mark.thorough
@pytest.mark.parametrize("drawing", DRAWINGS)
@pytest.mark.parametrize("brush", SLOW_BRUSHES)
def test_every_photographed_brush_paints_every_drawing(desk, capsys, brush, drawing):
    paints(desk, brush, drawing, capsys)


@pytest.mark.parametrize("brush", ["from-depth-0", "liner-1", "rigid"])
@pytest.mark.parametrize("drawing", ["shape", "line", "dots"])
def test_every_brush_gives_a_report_and_a_checked_program(desk, capsys, brush, drawing):
    at = drawing_file(desk, drawing)
    status, _, reported = in_json(capsys, "preview", at, "--brush", brush_file(desk, brush))
    assert status == 0, reported
    out = desk / "checked.ngc"
    assert in_json(capsys, "convert", at, "-o", out, "--brush", brush_file(desk, brush))[0] == 0
    status, _, reported = in_json(capsys, "check", out, at, "--brush", brush_file(desk, brush))
    assert status == 0, reported
