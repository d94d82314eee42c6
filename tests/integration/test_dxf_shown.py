"""No part of a DXF is misread without a notice.

450 small drawings have one feature each. ezdxf's own drawing add-on shows them, and the test compares the
result with our painting. If they differ by more than 3 % of the area, brushsvg must report the reason. It
must also report parts that the add-on does not show. dxf_features.OWN lists where the add-on itself is
simpler than the DXF reference.
"""

import platform

import dxf_features
import dxf_shown
import pytest
from dxf_text import drawing, encoded, save_font
from sampling import sample

from brushsvg.read.dxf.ezdxf_import import ezdxf

import ezdxf.addons.drawing.frontend  # isort: skip  after the library

LEAST = 0.03  # share of the area; round ends of wide lines use up to 0.02
FEATURES = {name: draw for table in dxf_features.TABLES.values() for name, draw in table.items()}


@pytest.fixture(scope="module", autouse=True)
def fonts(tmp_path_factory):
    """Put fonts into the only folder where ezdxf searches for fonts.

    Their letters are cut in half, so that a mirrored letter differs.
    """
    folder = tmp_path_factory.mktemp("fonts")
    save_font(folder / "triangles.ttf", "Triangles", slanted=True)
    save_font(folder / "other.ttf", "Other", 900, slanted=True)
    known = ezdxf.fonts.fonts.font_manager
    with pytest.MonkeyPatch.context() as patch:
        patch.setitem(ezdxf.fonts.font_manager.FONT_DIRECTORIES, platform.system(), [str(folder)])
        # Use one layout for all MTEXT. Plain text would get another layout, with lines at other places.
        patch.setattr(ezdxf.addons.drawing.frontend, "is_complex_mtext", lambda mtext: True)
        known.build([str(folder)], support_dirs=False)
        yield
        known.clear()


def written(draw) -> bytes:
    document = drawing()
    document.styles.add("T", font="triangles.ttf")
    draw(document, document.modelspace())
    return encoded(document)


def off(draw):
    """Return the share of the area that differs, and the notices."""
    data = written(draw)
    ours, reported = dxf_shown.painted(data)
    return dxf_shown.difference(dxf_shown.shown(data), ours), reported


@sample("table", dxf_features.TABLES, keep=5)
def test_differences_from_the_rendered_dxf_are_reported(table):
    silent, stale = {}, []
    for name, draw in dxf_features.TABLES[table].items():
        share, reported = off(draw)
        if name in dxf_features.OWN:
            stale += [name] if share <= LEAST else []
        elif share > LEAST and not reported:
            silent[name] = round(share, 3)
        elif not reported and name in dxf_features.NAMED:
            silent[name] = "not named"
    assert (silent, stale) == ({}, [])


def test_every_exception_names_an_existing_feature():
    assert {*dxf_features.OWN, *dxf_features.NAMED} <= FEATURES.keys()


TAMPERED = {
    "nothing": ((10, 10), (70, 30), {}, False),
    "moved by an eighth of a millimetre": ((10, 10.125), (70, 30.125), {}, True),
    "longer by 4 mm": ((10, 10), (73.8, 31.3), {}, True),
    "of another colour": ((10, 10), (70, 30), {"color": 1}, True),
    "heavier": ((10, 10), (70, 30), {"lineweight": 50}, True),
    "dashed": ((10, 10), (70, 30), {"linetype": "DASHED"}, True),
}


@pytest.mark.parametrize("change", TAMPERED)
def test_the_comparison_detects_another_drawing(change):
    begin, end, attributes, differs = TAMPERED[change]
    sound = written(lambda d, m: dxf_features.line(m, (10, 10), (70, 30)))
    other = written(lambda d, m: (dxf_features.line_types(d), dxf_features.line(m, begin, end, **attributes)))
    ours, _ = dxf_shown.painted(other)
    assert (dxf_shown.difference(dxf_shown.shown(sound), ours) > LEAST) == differs
