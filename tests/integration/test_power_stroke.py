"""Our line and width of a PowerStroke agree with the outline that Inkscape writes to d."""

import re
import xml.etree.ElementTree as ET
from pathlib import Path

import numpy as np
import pytest
import shapely

from brushsvg import flatten, strokes
from brushsvg.read.svg import read_svg
from brushsvg.read.text import text_svg
from brushsvg.show.editable_svg import lines_svg

FONT = Path("/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf")
LETTERS = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789&@$%?!&SGQRBDgase"
INKSCAPE = "{http://www.inkscape.org/namespaces/inkscape}"
LINE = "M 10,30 C 30,10 40,50 60,30 S 90,20 110,40"
SOURCE = """<svg xmlns="http://www.w3.org/2000/svg" xmlns:inkscape="http://www.inkscape.org/namespaces/inkscape"
 width="120mm" height="60mm" viewBox="0 0 120 60"><defs>
 <inkscape:path-effect effect="powerstroke" id="pe" is_visible="true" lpeversion="1.3" scale_width="1"
  offset_points="0.2,1 | 1,2.5 | 1.6,1.2" not_jump="false" sort_points="true" interpolator_type="{kind}"
  interpolator_beta="0.2" start_linecap_type="butt" linejoin_type="extrp_arc" miter_limit="4"
  end_linecap_type="butt"/></defs>
 <path id="p" style="fill:#000000;stroke:none" inkscape:path-effect="#pe" inkscape:original-d="{line}" d="{line}"/>
</svg>"""


def polygon_of_outline(cubics):
    t = np.linspace(0, 1, 40)[1:, None, None]
    p0, p1, p2, p3 = (cubics[:, k] for k in range(4))
    points = (1 - t) ** 3 * p0 + 3 * t * (1 - t) ** 2 * p1 + 3 * t**2 * (1 - t) * p2 + t**3 * p3
    return shapely.Polygon(points.transpose(1, 0, 2).reshape(-1, 2)).buffer(0)


def polygon_of_stroke(stroke):
    line = flatten(stroke, 0.002)
    along = np.gradient(line[:, :2], axis=0)
    along /= np.hypot(*along.T)[:, None]
    displaced = np.column_stack([-along[:, 1], along[:, 0]]) * line[:, 3:]
    return shapely.Polygon(np.vstack([line[:, :2] + displaced, (line[:, :2] - displaced)[::-1]])).buffer(0)


@pytest.mark.parametrize("kind", ["Linear", "CubicBezierJohan", "CentripetalCatmullRom"])
def test_power_strokes_agree_with_inkscapes_outline(kind, inkscape, tmp_path):
    source, saved = tmp_path / "source.svg", tmp_path / "saved.svg"
    source.write_text(SOURCE.format(kind=kind, line=LINE))
    # Inkscape redraws an effect only when its path changes
    inkscape(f"--actions=select-by-id:p;transform-translate:5,0;export-filename:{saved};export-do", source)
    text = saved.read_text()
    (stroke,), _ = strokes(read_svg(text.encode()))
    (outline,) = read_svg(re.sub(r'inkscape:original-d="[^"]*"', "", text).encode()).elements[0].subpaths
    ours, theirs = polygon_of_stroke(stroke), polygon_of_outline(outline.cubics)
    assert theirs.area > 300, "Inkscape has not drawn the effect"
    assert ours.hausdorff_distance(theirs) < 0.04


@pytest.mark.parametrize("size_mm", [30.0, 37.3])
def test_inkscape_draws_each_stroke_of_letters(size_mm, inkscape, tmp_path):
    """If Inkscape's geometry library fails, d is the line itself, which is not closed."""
    svg, _ = text_svg(LETTERS, FONT.read_bytes(), size_mm=size_mm, width_mm=None, sheet_mm=None)
    design = read_svg(svg.encode())
    source, saved = tmp_path / "source.svg", tmp_path / "saved.svg"
    source.write_text(lines_svg(strokes(design)[0], design.sheet_mm))
    ids = [node.get("id") for node in _lines(source)]
    moves = "transform-translate:1,0"
    inkscape(f"--actions=select-by-id:{','.join(ids)};{moves};export-filename:{saved};export-do", source)
    assert len(ids) > 90
    assert [node.get("id") for node in _lines(saved) if not node.get("d").rstrip().lower().endswith("z")] == []


def _lines(file):
    return [node for node in ET.parse(file).iter() if node.get(f"{INKSCAPE}original-d")]
