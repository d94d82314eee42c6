"""Errors of a simulated studio, read from a file or drawn at random."""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass, field, fields

import numpy as np

from ..errors import Error, format_value
from ..files import toml_document

FORMAT, VERSION = "brushsvg/studio", 1


def _number_field(default: float, least: float, greatest: float):
    return field(default=default, metadata={"range": (least, greatest), "count": None})


def _numbers_field(default: float, least: float, greatest: float, count: int = 2):
    return field(default=(default,) * count, metadata={"range": (least, greatest), "count": count})


@dataclass(frozen=True)
class BrushErrors:
    """Factors from lag and half width of the brush file to the real brush."""

    lag: float = _number_field(1.0, 0.5, 2.0)
    half_width: float = _number_field(1.0, 0.5, 2.0)


@dataclass(frozen=True)
class MachineErrors:
    """Errors of the machine, with the keys of a cell's table [machine].

    backlash_mm: full backlash of x and y; own_mm: standard deviation of each stroke's repeatable displacement;
    random_mm: standard deviation of the displacement that does not repeat; field_x_mm, field_y_mm: the rows of
    field_mm, over the whole sheet.
    """

    scale: tuple[float, float] = _numbers_field(1.0, 0.9, 1.1)
    skew: float = _number_field(0.0, -0.1, 0.1)
    lean_mm_per_mm: tuple[float, float] = _numbers_field(0.0, -1.5, 1.5)
    height_mm: float = _number_field(0.0, -5.0, 5.0)
    tilt_mm_per_mm: tuple[float, float] = _numbers_field(0.0, -0.05, 0.05)
    backlash_mm: tuple[float, float] = _numbers_field(0.0, 0.0, 3.0)
    own_mm: float = _number_field(0.0, 0.0, 5.0)
    random_mm: float = _number_field(0.0, 0.0, 5.0)
    field_x_mm: tuple[float, float, float] = _numbers_field(0.0, -5.0, 5.0, 3)
    field_y_mm: tuple[float, float, float] = _numbers_field(0.0, -5.0, 5.0, 3)


@dataclass(frozen=True)
class SheetPose:
    """The pose of the sheet."""

    shift_mm: tuple[float, float] = _numbers_field(0.0, -20.0, 20.0)
    turn_deg: float = _number_field(0.0, -10.0, 10.0)


@dataclass(frozen=True)
class Paint:
    """The paint on the brush.

    lasts_mm: the distance along a stroke after which its paint begins to run out; 0: it does not run out.
    """

    lasts_mm: float = _number_field(0.0, 0.0, 1e5)


@dataclass(frozen=True)
class Lens:
    """The camera.

    focal: focal length in picture widths; bend: lens distortion, where 0.02 moves the corners of the picture by 2 %;
    noise: standard deviation of the light, where 1 is white; quality: of the JPEG; shadow: depth of a soft shadow over
    a corner.
    """

    long_side_px: float = _number_field(2400, 800, 8000)
    focal: float = _number_field(1.1, 0.5, 5.0)
    tilt_deg: tuple[float, float] = _numbers_field(3.0, -25.0, 25.0)
    turn_deg: float = _number_field(1.0, -20.0, 20.0)
    bend: float = _number_field(-0.02, -0.1, 0.1)
    blur_px: float = _number_field(0.8, 0.0, 10.0)
    noise: float = _number_field(0.008, 0.0, 0.2)
    quality: float = _number_field(92, 30, 100)
    shadow: float = _number_field(0.0, 0.0, 0.9)


@dataclass(frozen=True)
class Studio:
    brush: BrushErrors = BrushErrors()
    machine: MachineErrors = MachineErrors()
    sheet: SheetPose = SheetPose()
    paint: Paint = Paint()
    camera: Lens = Lens()


TABLE_TYPES = {item.name: type(item.default) for item in fields(Studio)}


def random_studio(seed: int, sheet_mm: tuple[float, float]) -> Studio:
    """Draw realistic errors at random.

    The brush is up to 20 % off, the sheet tilts by up to 2 mm, backlash is up to 0.5 mm and scale up to 1 % off.
    """
    rng = np.random.default_rng(seed)

    def draw_within(most: float, count: int | None = None):
        drawn = rng.uniform(-most, most, count)
        return tuple(round(value, 5) for value in drawn.tolist()) if count else round(float(drawn), 5)

    lag, half_width = (1 + value for value in draw_within(0.2, 2))
    scale = tuple(round(1 + value, 5) for value in draw_within(0.01, 2))
    tilt = tuple(round(value / side, 6) for value, side in zip(draw_within(1.0, 2), sheet_mm, strict=True))
    return Studio(
        BrushErrors(round(lag, 4), round(half_width, 4)),
        MachineErrors(
            scale,
            draw_within(0.003),
            draw_within(0.05, 2),
            draw_within(0.15),
            tilt,
            tuple(map(abs, draw_within(0.5, 2))),
            0.1,
            0.1,
        ),
        SheetPose(draw_within(1.0, 2), draw_within(0.5)),
        Paint(round(float(rng.uniform(80, 250)))),
        Lens(tilt_deg=draw_within(5.0, 2), turn_deg=draw_within(2.0), bend=draw_within(0.03), blur_px=1.0),
    )


def read_studio(data: bytes) -> Studio:
    """Read a studio from a TOML file; missing keys mean no error.

    Raises Error with the name of a key that cannot be used.
    """
    try:
        text = data.decode("utf-8")
    except UnicodeDecodeError as problem:
        raise Error(f"the studio file is not TOML: {str(problem)[:200]}", code="not-toml") from None
    document = toml_document(text, "studio", VERSION)
    for name in document:
        if name not in TABLE_TYPES:
            sentence = f"a studio has no table {name[:40]}; known: {', '.join(TABLE_TYPES)}"
            raise Error(sentence, name[:40], code="key-unknown")
    return Studio(**{name: _table(TABLE_TYPES[name], values, name) for name, values in document.items()})


def _table(kind, values, where: str):
    known = {item.name: item.metadata for item in fields(kind)}
    if not isinstance(values, dict):
        raise Error(f"{where} must be a table", where, code="wrong-type")
    for key in values:
        if key not in known:
            sentence = f"a studio has no key {where}.{key[:40]}; known here: {', '.join(known)}"
            raise Error(sentence, f"{where}.{key[:40]}", code="key-unknown")
    return kind(**{key: _value(known[key], value, f"{where}.{key}") for key, value in values.items()})


def _value(limits, value, where: str):
    if (count := limits["count"]) is not None:
        if not isinstance(value, list) or len(value) != count:
            raise Error(f"{where} must be {count} finite numbers", where, code="wrong-type")
        return tuple(_value(limits | {"count": None}, each, where) for each in value)
    if isinstance(value, bool) or not isinstance(value, int | float) or not abs(value) < math.inf:
        raise Error(f"{where} must be a finite number, not {value!r:.40}", where, code="wrong-type")
    least, greatest = limits["range"]
    if not least <= value <= greatest:
        sentence = f"{where} {format_value(value)} is outside the range [{least:g}, {greatest:g}]"
        number = float(value) if abs(value) < 1e300 else None
        raise Error(sentence, where, number, (least, greatest), code="out-of-range")
    return value


def write_studio(studio: Studio) -> str:
    """Write a studio as TOML for read_studio."""
    lines = [f'format = "{FORMAT}"', f"version = {VERSION}"]
    for name, table in asdict(studio).items():
        lines += ["", f"[{name}]"]
        lines += [f"{key} = {list(v) if isinstance(v, tuple) else v}" for key, v in table.items()]
    return "\n".join([*lines, ""])
