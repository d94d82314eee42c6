"""Brush files and drawings of every kind, made by the public commands."""

from __future__ import annotations

import json
from pathlib import Path

from dxf_text import save_font

import brushsvg
from brushsvg.cli import main

SHIPPED = Path(brushsvg.__file__).parent / "data/brushes"
STUDIO = 'format = "brushsvg/studio"\nversion = 1\n'
SHEET = 'xmlns="http://www.w3.org/2000/svg" width="100mm" height="70mm" viewBox="0 0 100 70"'


def run(*words) -> None:
    assert main([*map(str, words), "--quiet"]) == 0, words


def typed(at: Path) -> None:
    run("brush", "new", "-o", at, "--lag", 6, "--width-at", "3=2.2", "--width-at", "8=4.8")


def lag_at(at: Path) -> None:
    run(
        "brush",
        "new",
        "-o",
        at,
        *"--lag-at 1=4 --lag-at 4=6 --lag-at 8=9 --width-at 3=2.2 --width-at 8=4.8".split(),
    )


def pen(at: Path) -> None:
    run("brush", "new", "-o", at, "--lag", 0, "--width-at", "3=2.2", "--width-at", "8=4.8")


def like(at: Path) -> None:
    run("brush", "new", "-o", at, "--like", "liner-1")


def measured(at: Path) -> None:
    table = at.with_suffix(".csv")
    rows = [f"lag,{d},{3 + 0.8 * d}\nwidth,{d},{0.7 * d}" for d in (1, 2, 3, 4, 6, 8)]
    table.write_text("\n".join(["kind,depth_mm,value_mm", *rows]))
    run("calibrate", table, "-o", at)


def photographed(at: Path) -> None:
    run("calibrate", photograph(at, "--sheet", "a5"), "--chart", at.with_suffix(".chart.json"), "-o", at)


def photograph(at: Path, *flags: str) -> Path:
    """Paint and photograph a small chart in a studio without faults."""
    plan, chart, photo, studio = (at.with_suffix(end) for end in (".plan.json", ".chart.json", ".jpg", ".toml"))
    studio.write_text(STUDIO)
    run("chart", "-o", plan, "--chart", chart, *flags)
    run("simulate-photo", chart, "-o", photo, "--studio", studio)
    return photo


def measured_from_depth_0(at: Path) -> None:
    """Write a brush as from a photograph, with laws from depth 0 on.

    At depth 0, the brush has no width.
    """
    brush = json.loads((SHIPPED / "round-6.json").read_text())
    for law in ("lag", "tip_gap", "tip_to_widest", "half_width"):
        brush[law] |= {"calibrated_mm": [0, 10], "source": "Fitted to 49 painted marks.", "assumed": False}
    at.write_text(json.dumps({**brush, "name": at.stem}))


def from_dabs(at: Path) -> None:
    photo = photograph(at, "--dabs", "--brush", "round-6")
    run("calibrate", photo, "--chart", at.with_suffix(".chart.json"), "--brush", "round-6", "-o", at)


def running_dry(at: Path) -> None:
    """Write a brush with paint that narrows its mark, as calibrate --paint does."""
    brush = json.loads((SHIPPED / "round-6.json").read_text())
    at.write_text(json.dumps({**brush, "name": at.stem, "paint": {"narrows_per_m": 0.4, "lasts_mm": 700}}))


def shipped(name: str):
    return lambda at: at.write_bytes((SHIPPED / f"{name}.json").read_bytes())


BRUSHES = {
    "typed": typed,
    "lag-at": lag_at,
    "pen": pen,
    "like": like,
    "measured": measured,
    "from-depth-0": measured_from_depth_0,
    "running-dry": running_dry,
    "round-6": shipped("round-6"),
    "round-6-angles": shipped("round-6-angles"),
    "liner-1": shipped("liner-1"),
    "rigid": shipped("rigid"),
}
SLOW_BRUSHES = {"photographed": photographed, "from-dabs": from_dabs}


def svg(*elements: str):
    return lambda at: at.with_suffix(".svg").write_text(f"<svg {SHEET}>{''.join(elements)}</svg>")


LINE = '<path id="line" fill="none" stroke="#000" stroke-width="1.8" d="M20 20C40 10 60 30 80 20"/>'
THIN = '<path id="thin" fill="none" stroke="#000" stroke-width="{}" d="M20 50C40 40 60 60 80 50"/>'
SHAPE = '<path id="shape" d="M20 15H24V45H34L36 48H20Z"/>'
SLIVER = '<path id="sliver" d="M60 20L60.2 20.01L60 20.03Z"/>'
DOTS = '<circle id="dot" cx="70" cy="40" r="1.2"/>' + (
    '<path id="point" fill="none" stroke="#000" stroke-width="1.5" stroke-linecap="round" d="M30 30h0.01"/>'
)
GCODE = "G21\nG90\nG0 Z5\nG0 X10 Y10\nG1 Z-1 F300\nG1 X60 Y10 F1200\nG3 X60 Y30 I0 J10\nG0 Z5\nM2\n"
SVG_FONT = (
    '<svg xmlns="http://www.w3.org/2000/svg"><defs><font horiz-adv-x="600"><font-face units-per-em="1000"/>'
    '<glyph unicode="L" d="M0 700L0 0L400 0"/></font></defs></svg>'
)


def dxf(at: Path) -> None:
    import ezdxf

    document = ezdxf.new("R2010", units=4)
    document.modelspace().add_lwpolyline([(0, 0), (40, 0), (40, 20)])
    document.modelspace().add_circle((20, 30), 8)
    document.saveas(at.with_suffix(".dxf"))


def gcode(at: Path) -> None:
    at.with_suffix(".gcode").write_text(GCODE)


def plan(at: Path) -> None:
    """Write a plan that convert made for another brush."""
    svg(LINE)(at)
    run("convert", at.with_suffix(".svg"), "-o", at.with_suffix(".json"))
    at.with_suffix(".svg").unlink()


def outline_text(at: Path) -> None:
    save_font(at.with_suffix(".ttf"), "Boxes", wide=150)
    run("text", "Ax", "-o", at.with_suffix(".svg"), "--font", at.with_suffix(".ttf"), "--size", 20)
    at.with_suffix(".ttf").unlink()


def line_text(at: Path) -> None:
    font = at.with_name("font.svg")
    font.write_text(SVG_FONT)
    run("text", "LL", "-o", at.with_suffix(".svg"), "--font", font, "--width", 1.6)
    font.unlink()


DRAWINGS = {
    "line": svg(LINE),
    "thinnest line": svg(LINE, THIN.format(1.0)),
    "thinner line": svg(LINE, THIN.format(0.4)),
    "shape": svg(SHAPE),
    "shape and sliver": svg(SHAPE, SLIVER),
    "sliver": svg(SLIVER),
    "dots": svg(DOTS),
    "outline text": outline_text,
    "line text": line_text,
    "dxf": dxf,
    "gcode": gcode,
    "plan": plan,
}


def brush_file(desk: Path, kind: str) -> Path:
    at = desk / f"{kind}.json"
    if not at.exists():
        (BRUSHES | SLOW_BRUSHES)[kind](at)
    return at


def drawing_file(desk: Path, kind: str) -> Path:
    folder = desk / "drawings" / kind.replace(" ", "-")
    if not folder.exists():
        folder.mkdir(parents=True)
        DRAWINGS[kind](folder / "drawing")
    (file,) = folder.iterdir()
    return file
