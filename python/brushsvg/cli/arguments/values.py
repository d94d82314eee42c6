"""Types for argparse: read a typed value and check its range."""

from __future__ import annotations

import argparse
from collections.abc import Callable

from ...errors import Error
from ...jobs.calibration_options import MAX_DPI, MIN_DPI
from ...units import length_mm, number, paper_mm, size_mm


def size(text: str) -> tuple[float, float]:
    return _parse(size_mm, text)


EDGE_NOISE_MM = 0.1  # default standard deviation of a digitized edge


def _parse(reader, text: str):
    try:
        return reader(text)
    except Error as problem:
        raise argparse.ArgumentTypeError(str(problem)) from None


def _parse_number(text: str, error: str) -> float:
    try:
        return number(text)
    except Error:
        raise argparse.ArgumentTypeError(error) from None


def _length_type(minimum: float, maximum: float) -> Callable[[str], float]:
    """Return a type for lengths in a range [mm]."""

    def read(text: str) -> float:
        value = _parse(length_mm, text)
        if not minimum <= value <= maximum:
            raise argparse.ArgumentTypeError(f"{value:g} mm is outside the range [{minimum:g}, {maximum:g}] mm")
        return value

    return read


noise = _length_type(0.001, 10.0)
lag = _length_type(0.0, 1000.0)
tolerance = _length_type(1e-5, 10.0)  # a program is written to 1e-4 mm: a smaller tolerance would only add poses
height = _length_type(-20.0, 20.0)
step = _length_type(0.01, 5.0)
width = _length_type(0.001, 1000.0)
paper_z = _length_type(-1000.0, 1000.0)


def _parse_lengths(text: str, count: int, what: str) -> list[float]:
    """Read lengths separated by commas. what: the expected text in words, with an example."""
    parts = text.split(",")
    if len(parts) != count:
        raise argparse.ArgumentTypeError(f"{text[:24]!r} is not {what}")
    return [_parse(length_mm, part) for part in parts]


def _parse_point(text: str, count: int, example: str, limit: str) -> tuple[float, ...]:
    place = _parse_lengths(text, count, f"a point; write for example {example}")
    if not max(map(abs, place)) <= float(limit):
        raise argparse.ArgumentTypeError(f"{text[:24]!r} is beyond {limit} mm")
    return tuple(place)


def point(text: str) -> tuple[float, ...]:
    return _parse_point(text, 2, "20,15 or 2cm,1in", "1e6")


def point3(text: str) -> tuple[float, ...]:
    return _parse_point(text, 3, "120.5,-300,42", "1e5")


def region(text: str) -> tuple[float, float, float, float]:
    x0, y0, x1, y1 = _parse_lengths(text, 4, "a region; write for example 0,0,30,20")
    return min(x0, x1), min(y0, y1), max(x0, x1), max(y0, y1)


def _need_in_range(value: float, minimum: float, maximum: float, error: str) -> float:
    if not minimum <= value <= maximum:
        raise argparse.ArgumentTypeError(error)
    return value


def paint_speed(text: str) -> float:
    value = _parse_number(text, f"{text[:24]!r} is not a speed in mm/s; write for example 15")
    return _need_in_range(value, 0.001, 5000.0, f"{text[:24]!r} is outside the range [0.001, 5000] mm/s")


def share(text: str) -> float:
    error = f"{text[:24]!r} is outside the range [0, 1]"
    return _need_in_range(_parse_number(text, error), 0.0, 1.0, error)


def scale(text: str) -> float:
    error = f"{text[:24]!r} is not a factor; write for example 1.5 or 150%"
    value = _parse_number(text.removesuffix("%"), error) / (100 if text.endswith("%") else 1)
    return _need_in_range(value, 1e-4, 1e4, f"{value:g} is outside the range [0.0001, 10000]")


def playback_factor(text: str) -> float:
    value = _parse_number(text, f"{text[:24]!r} is not a factor; write for example 5")
    return _need_in_range(value, 0.1, 1000.0, f"{value:g} is outside the range [0.1, 1000]")


def resolution(text: str) -> float:
    value = _parse_number(text, f"{text[:24]!r} is not a number of dots per inch; write for example 600")
    sentence = f"{value:g} dpi is outside the range [{MIN_DPI:g}, {MAX_DPI:g}] dpi in which a scan can be measured"
    return _need_in_range(value, MIN_DPI, MAX_DPI, sentence)


def sheet(text: str) -> tuple[float, float]:
    return _parse(paper_mm, text)


def words(text: str) -> str:
    if not text.strip():
        raise argparse.ArgumentTypeError("it is empty")
    return text


def machine_parts(text: str) -> tuple[str, ...]:
    from ...calibration.marks.machine_found import PARTS

    parts = [part.strip() for part in text.split(",")]
    for part in parts:
        if part not in PARTS:
            raise argparse.ArgumentTypeError(f"{part[:24]!r} is not one of {', '.join(PARTS)}")
    return tuple(part for part in PARTS if part in parts)


def count(text: str) -> int:
    if not (text.isascii() and text.isdigit() and 1 <= int(text[:9]) < 10**8):
        raise argparse.ArgumentTypeError(f"{text[:24]!r} is not a number from 1 on")
    return int(text)


def jobs(text: str) -> int:
    number = count(text)
    if number > 1000:
        raise argparse.ArgumentTypeError(f"{number} is outside the range [1, 1000]")
    return number


def lag_at(text: str) -> tuple[float, float]:
    depth, lag_text = _split_at_depth(text, "lag", "3=7.4")
    return lag(depth), width(lag_text)


def width_at(text: str) -> tuple[float, float]:
    depth, width_text = _split_at_depth(text, "width", "3=2.5")
    return width(depth), width(width_text)


def _split_at_depth(text: str, quantity: str, example: str) -> tuple[str, str]:
    depth, equals, value = text.partition("=")
    if not equals:
        raise argparse.ArgumentTypeError(
            f"{text[:24]!r} is not a depth and its {quantity}; write for example {example}"
        )
    return depth, value


def colour(text: str) -> str:
    from ...jobs.choices.choice_checks import read_colour

    return _parse(read_colour, text)
