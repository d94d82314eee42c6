import pytest
from diagnostics import refused

from brushsvg.errors import Error
from brushsvg.units import length_mm, length_px, size_mm


@pytest.mark.parametrize(
    ("text", "mm"),
    [
        ("5", 5.0),
        ("10mm", 10.0),
        ("1cm", 10.0),
        ("0.5in", 12.7),
        ("72pt", 25.4),
        ("6pc", 25.4),
        ("96px", 25.4),
        ("4Q", 1.0),
        (" .5 IN ", 12.7),
        ("1e1mm", 10.0),
        ("-2.mm", -2.0),
    ],
)
def test_lengths_are_converted_to_mm(text, mm):
    assert length_mm(text) == pytest.approx(mm, abs=1e-12)


def test_a_bare_number_is_in_the_requested_unit():
    assert length_mm("2", "in") == 50.8


@pytest.mark.parametrize("text", ["1in", "2.54cm", "25.4mm", "101.6Q", "72pt", "6pc", "96px", "96", "48%"])
def test_an_inch_in_every_unit_is_96_px(text):
    assert length_px(text, 200.0) == pytest.approx(96.0, abs=1e-12)


@pytest.mark.parametrize("text", ["", "mm", "5 furlongs", "2em", "nan", "inf", "1e999", "1,5mm", "\u0665mm", "0x10"])
def test_an_invalid_length_is_refused_and_quoted(text):
    with pytest.raises(Error) as refused:
        length_mm(text)
    assert text.strip() in str(refused.value)


def test_a_percentage_needs_a_whole():
    with refused("not-a-length '50%'"):
        length_mm("50%")


def test_a_long_text_is_refused_at_once_and_shortened():
    with pytest.raises(Error) as refused:
        length_mm("1" * 200_000 + "!")
    assert len(str(refused.value)) < 120


@pytest.mark.parametrize(
    ("text", "size"),
    [
        ("210x297", (210.0, 297.0)),
        ("210x297mm", (210.0, 297.0)),
        ("8.5x11in", (215.9, 279.4)),
        ("1in x 30 mm", (25.4, 30.0)),
        ("96pxx96PX", (25.4, 25.4)),
    ],
)
def test_sizes_are_converted_to_mm(text, size):
    assert size_mm(text) == size


@pytest.mark.parametrize("text", ["210", "x", "0x5", "5x-1", "1e9x1", "nanx1", "1x2furlongs", "1mm2mm"])
def test_an_invalid_size_is_refused(text):
    with pytest.raises(Error):
        size_mm(text)
