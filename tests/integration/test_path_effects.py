"""Path effects are painted as Inkscape draws them.

The effects are Spiro, BSpline, mirrors and PowerStroke. Inkscape changes and saves each drawing, so it
computes the effects itself. The test compares Inkscape's picture of the saved file with our reading of this
file.
"""

import cv2
import numpy as np
import pytest
import shapely
from shapely.ops import polygonize

from brushsvg.read.svg import read_svg

PX_PER_MM = 10
FINER = 4  # samples along each side of a pixel, for its edges
LEAST = 0.015  # share of the area of both, for the pixels at the edges
EFFECTS = {
    "spiro": 'effect="spiro" lpeversion="1"',
    "bspline": 'effect="bspline" lpeversion="1.3" weight="33.333333" steps="2" helper_size="0" uniform="false" '
    'apply_no_weight="true" apply_with_weight="true" only_selected="false"',
    "power": 'effect="powerstroke" lpeversion="1.3" scale_width="1" offset_points="0.2,1.5 | 1,3.2 | 1.6,0.9" '
    'not_jump="false" sort_points="true" interpolator_type="CubicBezierJohan" interpolator_beta="0.2" '
    'start_linecap_type="round" linejoin_type="round" miter_limit="4" end_linecap_type="round"',
    "mirror": 'effect="mirror_symmetry" lpeversion="1.2" lpesatellites="" mode="free" fuse_paths="false" '
    'discard_orig_path="false" oposite_fuse="false" split_items="false" split_open="false" link_styles="false" '
    'start_point="62,20" end_point="62,70" center_point="62,45"',
}
LINE = "M 10,30 C 20,10 30,50 40,30 C 45,20 50,15 55,40"
DRAWN = {  # effects, in Inkscape's order; whether the line is drawn with a stroke
    "spiro": (["spiro"], True),
    "bspline": (["bspline"], True),
    "power stroke on spiro": (["spiro", "power"], False),
    "power stroke on bspline": (["bspline", "power"], False),
    "mirrored": (["mirror"], True),
    "mirrored spiro": (["spiro", "mirror"], True),
    "power stroke on a mirrored line": (["mirror", "power"], False),
    "mirrored power stroke": (["power", "mirror"], False),
    "mirrored power stroke on spiro": (["spiro", "power", "mirror"], False),
}


def source(kinds, stroked):
    effects = "".join(f'<inkscape:path-effect id="e{k}" is_visible="true" {EFFECTS[k]}/>' for k in kinds)
    style = "fill:none;stroke:#000;stroke-width:2" if stroked else "fill:#000;fill-rule:nonzero;stroke:none"
    return f"""<svg xmlns="http://www.w3.org/2000/svg" width="120mm" height="90mm" viewBox="0 0 120 90"
 xmlns:inkscape="http://www.inkscape.org/namespaces/inkscape"><defs>{effects}</defs>
 <path id="p" style="{style};stroke-linecap:round;stroke-linejoin:round" d="{LINE}" inkscape:original-d="{LINE}"
  inkscape:path-effect="{";".join(f"#e{k}" for k in kinds)}"/></svg>"""


@pytest.fixture(scope="module")
def saved(inkscape, tmp_path_factory):
    """Return {name: (the file, its darkness (h, w))}.

    Inkscape wrote the file after it had moved the line.
    """
    folder, found = tmp_path_factory.mktemp("effects"), {}
    for number, (name, (kinds, stroked)) in enumerate(DRAWN.items()):
        given, out = folder / f"{number}.svg", folder / f"{number}-saved.svg"
        given.write_text(source(kinds, stroked), encoding="utf-8")
        # Inkscape draws an effect again only if its path changes.
        inkscape(f"--actions=select-by-id:p;transform-translate:3,4;export-filename:{out};export-do", given)
        alpha = cv2.imread(str(inkscape.paint(out, PX_PER_MM)), cv2.IMREAD_UNCHANGED)[..., 3]
        found[name] = out.read_bytes(), alpha / 255
    return found


def painted(design):
    """Return the darkness of our paint in Inkscape's pixels."""
    width, height = np.round(np.array(design.sheet_mm) * PX_PER_MM * FINER).astype(int)
    image = np.zeros((height, width), np.uint8)
    for mark in (mark for element in design.elements for mark in marks(element)):
        rings = [np.array(ring.coords) for ring in (mark.exterior, *mark.interiors)]
        rings = [(ring * [1, -1] + [0, design.sheet_mm[1]]) * PX_PER_MM * FINER - 0.5 for ring in rings]
        one = np.zeros_like(image)
        cv2.fillPoly(one, [np.round(ring * 256).astype(np.int32) for ring in rings], 255, shift=8)
        image |= one
    return cv2.resize(image, None, fx=1 / FINER, fy=1 / FINER, interpolation=cv2.INTER_AREA) / 255


def marks(element):
    """Return the painted polygons of an element.

    It has one width, or is a shape filled nonzero.
    """
    lines = [points(subpath.cubics) for subpath in element.subpaths]
    if not element.fill_rule:
        return [shapely.LineString(line).buffer(element.stroke_width_mm / 2, 32) for line in lines]
    assert element.fill_rule == "nonzero" and not element.stroke_width_mm
    edges = shapely.union_all([shapely.LinearRing(line) for line in lines])
    return [face for face in polygonize(edges) if turns(lines, face.representative_point())]


def points(cubics):
    t = np.linspace(0, 1, 41)[1:, None, None]
    p0, p1, p2, p3 = (cubics[:, k] for k in range(4))
    found = (1 - t) ** 3 * p0 + 3 * t * (1 - t) ** 2 * p1 + 3 * t**2 * (1 - t) * p2 + t**3 * p3
    return np.vstack([cubics[:1, 0], found.transpose(1, 0, 2).reshape(-1, 2)])


def turns(lines, place) -> int:
    """Return how often all lines together go around a place."""
    count = 0
    for line in lines:
        line = np.vstack([line, line[:1]]) - [place.x, place.y]
        angle = np.unwrap(np.arctan2(line[:, 1], line[:, 0]))
        count += round((angle[-1] - angle[0]) / (2 * np.pi))
    return count


@pytest.mark.parametrize("name", DRAWN)
def test_path_effects_agree_with_inkscapes_rendering(name, saved):
    data, theirs = saved[name]
    design = read_svg(data)
    ours = painted(design)
    assert ours.shape == theirs.shape
    assert theirs.sum() / PX_PER_MM**2 > 80, "Inkscape has not drawn the effect"
    assert np.abs(theirs - ours).sum() / np.maximum(theirs, ours).sum() < LEAST
    near_by = len(DRAWN[name][0]) > 1 and "power" in DRAWN[name][0]
    assert any(notice.code == "path-effect-unread" for notice in design.notices) == (
        near_by or "mirror" in DRAWN[name][0]
    )


def test_the_effects_make_a_difference(saved):
    pictures = [theirs for _, theirs in saved.values()]
    plain = painted(read_svg(source([], True).replace("<path", '<path transform="translate(3,4)"').encode()))
    assert all(np.abs(theirs - plain).sum() / theirs.sum() > 0.1 for theirs in pictures)
