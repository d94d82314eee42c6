import numpy as np
import pytest
from diagnostics import are_reported, is_reported
from svg_text import read

EFFECT = (
    '<inkscape:path-effect effect="{effect}" id="e" is_visible="{visible}" interpolator_type="{kind}" '
    'offset_points="{points}" scale_width="{scale}" sort_points="true" interpolator_beta="0.2"/>'
)
PATH = (
    '<path id="p" stroke="none" fill="#00f" inkscape:path-effect="#e" d="M0 0H9V9Z" '
    'inkscape:original-d="M10 10H30L50 10" {}/>'
)


def powered(points="0,1 | 1.5,3", kind="Linear", scale=1, effect="powerstroke", visible="true", more=""):
    effects = EFFECT.format(points=points, kind=kind, scale=scale, effect=effect, visible=visible)
    return read(f"<defs>{effects}</defs>{PATH.format(more)}")


def width_at(design, fraction):
    (subpath,) = design.elements[0].subpaths
    return float(np.interp(fraction, subpath.widths[:, 0], subpath.widths[:, 1]))


def test_a_power_stroke_is_its_original_line_with_widths():
    design = powered()
    (element,) = design.elements
    assert element.subpaths[0].cubics[[0, -1], [0, 3]].tolist() == [[10, 40], [50, 40]]
    assert (element.colour, element.fill_rule, element.is_stroked) == ("#0000ff", "", True)
    assert [width_at(design, at) for at in (0, 0.25, 0.75, 1)] == pytest.approx([2, 2 + 4 / 3, 6, 6])
    assert not design.notices


@pytest.mark.parametrize("reference", ["#ä", "#%C3%A4"])
def test_effects_are_referenced_like_urls(reference):
    effects = EFFECT.format(points="0,1 | 1.5,3", kind="Linear", scale=1, effect="powerstroke", visible="true")
    drawn = (effects.replace('id="e"', 'id="ä"'), PATH.format("").replace('"#e"', f'"{reference}"'))
    assert width_at(read("<defs>{}</defs>{}".format(*drawn)), 0) == pytest.approx(2)


def test_widths_scale_with_the_transform_and_the_effect():
    assert width_at(powered(scale=1.5, more='transform="scale(2)"'), 0) == pytest.approx(6)
    assert width_at(powered("1.5,-3 | 0,1"), 0.75) == pytest.approx(6), "sorted; the side does not matter"


def test_johan_interpolation_is_flat_at_its_points_and_midpoints():
    design = powered("0,1 | 2,3", "CubicBezierJohan")
    assert width_at(design, 0.5) == pytest.approx(4)
    assert width_at(design, 0.05) < 2 + 0.05 * 4


def test_catmull_rom_passes_through_its_points():
    design = powered("0.5,1 | 1,3 | 1.5,2", "CentripetalCatmullRom")
    assert [width_at(design, at) for at in (0.25, 0.5, 0.75)] == pytest.approx([2, 6, 4], abs=1e-3)


@pytest.mark.parametrize(
    ("choices", "expected"),
    [
        ({"kind": "SpiroInterpolator"}, "path-effect-unread SpiroInterpolator Linear"),
        ({"effect": "skeletal"}, "path-effect-unread skeletal outline"),
        ({"points": "0,1 | nan"}, "path-effect-unread points outline"),
    ],
)
def test_unsupported_effect_settings_are_named(choices, expected):
    assert is_reported(powered(**choices).notices, expected, "p")


def test_an_unsupported_effect_with_an_outline_is_reported():
    design = powered(effect="taper_stroke")
    assert are_reported(design.notices, "path-effect-unread p taper_stroke outline")
    assert not design.elements[0].is_stroked


def test_hidden_and_line_effects_use_the_path_data():
    for choices in ({"visible": "false"}, {"effect": "spiro"}):
        (element,) = powered(**choices).elements
        assert element.fill_rule and not element.is_stroked
        assert element.subpaths[0].cubics[0, 0].tolist() == [0, 50]


@pytest.mark.parametrize("other", ["spiro", "bspline", "mirror_symmetry", "powerstroke", "skeletal"])
@pytest.mark.parametrize("order", ["#e;#f", "#f; #e"])
def test_the_outline_is_used_if_there_is_another_effect(other, order):
    """Next to another path effect, the outline counts.

    Inkscape shows the outline. The line under a Spiro was once drawn 5 mm from its visible position.
    """
    effects = EFFECT.format(effect="powerstroke", visible="true", kind="Linear", points="0,1", scale=1)
    effects += f'<inkscape:path-effect effect="{other}" id="f"/>'
    design = read(f"<defs>{effects}</defs>{PATH.replace('#e', order).format('')}")
    (element,) = design.elements
    assert element.fill_rule and element.subpaths[0].widths is None
    assert element.subpaths[0].cubics[0, 0].tolist() == [0, 50]
    assert are_reported(design.notices, "path-effect-unread p PowerStroke outline")
    hidden = effects.replace('id="f"', 'id="f" is_visible="false"')
    assert not read(f"<defs>{hidden}</defs>{PATH.replace('#e', order).format('')}").notices


def test_the_outline_is_used_in_a_group_with_effects():
    effects = EFFECT.format(effect="powerstroke", visible="true", kind="Linear", points="0,1", scale=1)
    design = read(f'<defs>{effects}</defs><g inkscape:path-effect="#x"><g>{PATH.format("")}</g></g>')
    assert design.elements[0].fill_rule
    assert are_reported(design.notices, "path-effect-unread p PowerStroke group outline")


def test_many_width_points_are_interpolated():
    design = powered(" | ".join(f"{k / 500:.4f},{1 + k % 3}" for k in range(1001)))
    assert width_at(design, 0.5) == pytest.approx(2 * (1 + 500 % 3))
