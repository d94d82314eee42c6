"""Types for argparse: read a typed value and check its range."""

from __future__ import annotations

import argparse

from ...errors import Error
from ...jobs.calibration_options import MAX_DPI, MIN_DPI
from ...units import PAPERS_MM

SHEETS_MM = PAPERS_MM


def size(text: str) -> tuple[float, float]:
    from ...units import size_mm

    return _parse(size_mm, text)


EDGE_NOISE_MM = 0.1  # default standard deviation of a digitized edge


def noise(text: str) -> float:
    return _parse_length(text, 0.001, 10.0)


def sheet(text: str) -> tuple[float, float]:
    from ...units import paper_mm

    return _parse(paper_mm, text)


def lag(text: str) -> float:
    return _parse_length(text, 0.0, 1000.0)


def tolerance(text: str) -> float:
    # A program is written to 1e-4 mm: a smaller tolerance would only add poses.
    return _parse_length(text, 1e-5, 10.0)


def paint_speed(text: str) -> float:
    value = _parse_number(text, f"{text[:24]!r} is not a speed in mm/s; write for example 15")
    if not 0.001 <= value <= 5000:
        raise argparse.ArgumentTypeError(f"{text[:24]!r} is outside the range [0.001, 5000] mm/s")
    return value


def words(text: str) -> str:
    if not text.strip():
        raise argparse.ArgumentTypeError("it is empty")
    return text


def machine_parts(text: str) -> tuple[str, ...]:
    from ...calibration.marks.machine_found import PARTS

    parts = [part.strip() for part in text.split(",")]
    if not set(parts) <= set(PARTS):
        raise argparse.ArgumentTypeError(f"{text[:24]!r} is not some of {','.join(PARTS)}")
    return tuple(part for part in PARTS if part in parts)


def height(text: str) -> float:
    return _parse_length(text, -20.0, 20.0)


def step(text: str) -> float:
    return _parse_length(text, 0.01, 5.0)


def count(text: str) -> int:
    if not (text.isascii() and text.isdigit() and 1 <= int(text[:9]) < 10**8):
        raise argparse.ArgumentTypeError(f"{text[:24]!r} is not a number from 1 on")
    return int(text)


def jobs(text: str) -> int:
    number = count(text)
    if number > 1000:
        raise argparse.ArgumentTypeError(f"{number} is outside the range [1, 1000]")
    return number


def share(text: str) -> float:
    error = f"{text[:24]!r} is outside the range [0, 1]"
    value = _parse_number(text, error)
    if not 0.0 <= value <= 1.0:
        raise argparse.ArgumentTypeError(error)
    return value


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


def width(text: str) -> float:
    return _parse_length(text, 0.001, 1000.0)


def scale(text: str) -> float:
    error = f"{text[:24]!r} is not a factor; write for example 1.5 or 150%"
    value = _parse_number(text.removesuffix("%"), error) / (100 if text.endswith("%") else 1)
    if not 1e-4 <= value <= 1e4:
        raise argparse.ArgumentTypeError(f"{value:g} is outside the range [0.0001, 10000]")
    return value


def speed(text: str) -> float:
    value = _parse_number(text, f"{text[:24]!r} is not a factor; write for example 5")
    if not 0.1 <= value <= 1000:
        raise argparse.ArgumentTypeError(f"{value:g} is outside the range [0.1, 1000]")
    return value


def resolution(text: str) -> float:
    value = _parse_number(text, f"{text[:24]!r} is not a number of dots per inch; write for example 600")
    if not MIN_DPI <= value <= MAX_DPI:
        sentence = f"{value:g} dpi is outside the range [{MIN_DPI:g}, {MAX_DPI:g}] dpi"
        raise argparse.ArgumentTypeError(f"{sentence} in which a scan can be measured")
    return value


def point(text: str) -> tuple[float, float]:
    from ...units import length_mm

    parts = text.split(",")
    if len(parts) != 2:
        raise argparse.ArgumentTypeError(f"{text[:24]!r} is not a point; write for example 20,15 or 2cm,1in")
    x, y = (_parse(length_mm, part) for part in parts)
    if not max(abs(x), abs(y)) <= 1e6:
        raise argparse.ArgumentTypeError(f"{text[:24]!r} is beyond 1e6 mm")
    return x, y


def region(text: str) -> tuple[float, float, float, float]:
    from ...units import length_mm

    parts = text.split(",")
    if len(parts) != 4:
        raise argparse.ArgumentTypeError(f"{text[:24]!r} is not a region; write for example 0,0,30,20")
    x0, y0, x1, y1 = (_parse(length_mm, part) for part in parts)
    return min(x0, x1), min(y0, y1), max(x0, x1), max(y0, y1)


def colour(text: str) -> str:
    from ...jobs.choices import read_colour

    return _parse(read_colour, text)


def paper_z(text: str) -> float:
    return _parse_length(text, -1000.0, 1000.0)


def point3(text: str) -> tuple[float, float, float]:
    from ...units import length_mm

    parts = text.split(",")
    if len(parts) != 3:
        raise argparse.ArgumentTypeError(f"{text[:24]!r} is not a point; write for example 120.5,-300,42")
    x, y, z = (_parse(length_mm, part) for part in parts)
    if not max(abs(x), abs(y), abs(z)) <= 1e5:
        raise argparse.ArgumentTypeError(f"{text[:24]!r} is beyond 1e5 mm")
    return x, y, z


def _parse_number(text: str, error: str) -> float:
    from ...units import number

    try:
        return number(text)
    except Error:
        raise argparse.ArgumentTypeError(error) from None


def _parse_length(text: str, minimum: float, maximum: float) -> float:
    from ...units import length_mm

    value = _parse(length_mm, text)
    if not minimum <= value <= maximum:
        raise argparse.ArgumentTypeError(f"{value:g} mm is outside the range [{minimum:g}, {maximum:g}] mm")
    return value


def _parse(reader, text: str):
    try:
        return reader(text)
    except Error as problem:
        raise argparse.ArgumentTypeError(str(problem)) from None
