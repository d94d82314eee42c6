"""Faults of a simulated studio: from a file, or drawn at random."""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass, field, fields

import numpy as np

from ..errors import Error, shown
from ..files import toml_document

FORMAT, VERSION = "brushsvg/studio", 1


def _number(default: float, least: float, greatest: float):
    return field(default=default, metadata={"range": (least, greatest), "count": None})


def _pair(default: float, least: float, greatest: float, count: int = 2):
    return field(default=(default,) * count, metadata={"range": (least, greatest), "count": count})


@dataclass(frozen=True)
class BrushOff:
    """By how many times lag and half width of the brush that paints are those of its file."""

    lag: float = _number(1.0, 0.5, 2.0)
    half_width: float = _number(1.0, 0.5, 2.0)


@dataclass(frozen=True)
class MachineOff:
    """The machine, as a cell's table [machine] has it; backlash_mm: of x and y, all of it; own_mm: displacement of each
    stroke that repeats (standard deviation); random_mm: of one that does not repeat; field_x_mm,
    field_y_mm: the rows of field_mm, over the whole sheet."""

    scale: tuple[float, float] = _pair(1.0, 0.9, 1.1)
    skew: float = _number(0.0, -0.1, 0.1)
    lean_mm_per_mm: tuple[float, float] = _pair(0.0, -1.5, 1.5)
    height_mm: float = _number(0.0, -5.0, 5.0)
    tilt_mm_per_mm: tuple[float, float] = _pair(0.0, -0.05, 0.05)
    backlash_mm: tuple[float, float] = _pair(0.0, 0.0, 3.0)
    own_mm: float = _number(0.0, 0.0, 5.0)
    random_mm: float = _number(0.0, 0.0, 5.0)
    field_x_mm: tuple[float, float, float] = _pair(0.0, -5.0, 5.0, 3)
    field_y_mm: tuple[float, float, float] = _pair(0.0, -5.0, 5.0, 3)


@dataclass(frozen=True)
class Laid:
    """The pose of the sheet."""

    shift_mm: tuple[float, float] = _pair(0.0, -20.0, 20.0)
    turn_deg: float = _number(0.0, -10.0, 10.0)


@dataclass(frozen=True)
class Paint:
    """lasts_mm: the way of a stroke after which its paint begins to run out; 0: it does not."""

    lasts_mm: float = _number(0.0, 0.0, 1e5)


@dataclass(frozen=True)
class Lens:
    """The camera. focal: in picture widths; bend: of the lens, 0.02 moves corners by 2 %; noise: of light, 1 is white;
    quality: of the JPEG; shadow: depth of a soft one over a corner."""

    long_side_px: float = _number(2400, 800, 8000)
    focal: float = _number(1.1, 0.5, 5.0)
    tilt_deg: tuple[float, float] = _pair(3.0, -25.0, 25.0)
    turn_deg: float = _number(1.0, -20.0, 20.0)
    bend: float = _number(-0.02, -0.1, 0.1)
    blur_px: float = _number(0.8, 0.0, 10.0)
    noise: float = _number(0.008, 0.0, 0.2)
    quality: float = _number(92, 30, 100)
    shadow: float = _number(0.0, 0.0, 0.9)


@dataclass(frozen=True)
class Studio:
    brush: BrushOff = BrushOff()
    machine: MachineOff = MachineOff()
    sheet: Laid = Laid()
    paint: Paint = Paint()
    camera: Lens = Lens()


TABLES = {one.name: type(one.default) for one in fields(Studio)}


def random_studio(seed: int, sheet_mm: tuple[float, float]) -> Studio:
    """As studios are: a brush up to 20 % off, 2 mm of tilt over the sheet, 0.5 mm of backlash, 1 % of scale."""
    draw = np.random.default_rng(seed)

    def within(most: float, count: int | None = None):
        found = draw.uniform(-most, most, count)
        return tuple(round(each, 5) for each in found.tolist()) if count else round(float(found), 5)

    lag, half_width = (1 + each for each in within(0.2, 2))
    scale = tuple(round(1 + each, 5) for each in within(0.01, 2))
    tilt = tuple(round(each / side, 6) for each, side in zip(within(1.0, 2), sheet_mm, strict=True))
    return Studio(
        BrushOff(round(lag, 4), round(half_width, 4)),
        MachineOff(
            scale,
            within(0.003),
            within(0.05, 2),
            within(0.15),
            tilt,
            tuple(map(abs, within(0.5, 2))),
            0.1,
            0.1,
        ),
        Laid(within(1.0, 2), within(0.5)),
        Paint(round(float(draw.uniform(80, 250)))),
        Lens(tilt_deg=within(5.0, 2), turn_deg=within(2.0), bend=within(0.03), blur_px=1.0),
    )


def read_studio(data: bytes) -> Studio:
    """What a TOML file says; what it leaves out is as it should be. Error naming the key."""
    try:
        text = data.decode("utf-8")
    except UnicodeDecodeError as problem:
        raise Error(f"the studio file is not TOML: {str(problem)[:200]}", code="not-toml") from None
    document = toml_document(text, "studio")
    if document.pop("format", None) != FORMAT:
        raise Error(
            f'the file is not a studio: format = "{FORMAT}" is missing', "format", code="format-unknown"
        )
    if (version := document.pop("version", None)) != VERSION or isinstance(version, bool):
        sentence = f"version {str(version)[:40]} of the studio file is not known; known: {VERSION}"
        raise Error(sentence, "version", code="version-unknown")
    for name in document:
        if name not in TABLES:
            sentence = f"a studio has no table {name[:40]}; known: {', '.join(TABLES)}"
            raise Error(sentence, name[:40], code="key-unknown")
    return Studio(**{name: _table(TABLES[name], values, name) for name, values in document.items()})


def _table(kind, values, where: str):
    known = {one.name: one.metadata for one in fields(kind)}
    if not isinstance(values, dict):
        raise Error(f"{where} must be a table", where, code="wrong-type")
    for key in values:
        if key not in known:
            sentence = f"a studio has no key {where}.{key[:40]}; known here: {', '.join(known)}"
            raise Error(sentence, f"{where}.{key[:40]}", code="key-unknown")
    return kind(**{key: _value(known[key], value, f"{where}.{key}") for key, value in values.items()})


def _value(said, value, where: str):
    if (count := said["count"]) is not None:
        if not isinstance(value, list) or len(value) != count:
            raise Error(f"{where} must be {count} finite numbers", where, code="wrong-type")
        return tuple(_value(said | {"count": None}, each, where) for each in value)
    if isinstance(value, bool) or not isinstance(value, int | float) or not abs(value) < math.inf:
        raise Error(f"{where} must be a finite number, not {str(value)[:40]}", where, code="wrong-type")
    least, greatest = said["range"]
    if not least <= value <= greatest:
        sentence = f"{where} {shown(value)} is outside the range [{least:g}, {greatest:g}]"
        number = float(value) if abs(value) < 1e300 else None
        raise Error(sentence, where, number, (least, greatest), code="out-of-range")
    return value


def write_studio(studio: Studio) -> str:
    """TOML that read_studio reads back."""
    lines = [f'format = "{FORMAT}"', f"version = {VERSION}"]
    for name, table in asdict(studio).items():
        lines += ["", f"[{name}]"]
        lines += [f"{key} = {list(v) if isinstance(v, tuple) else v}" for key, v in table.items()]
    return "\n".join([*lines, ""])
