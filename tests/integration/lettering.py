"""Other people's lettering: Chinese characters with middle lines, and four fonts."""

import json

import numpy as np
from svgpathtools import Line, parse_path

from brushsvg import _core
from brushsvg.read.design import Design, Element, SubPath
from brushsvg.read.svg import read_svg
from brushsvg.read.text import text_svg

PACKAGES = {
    "hanzi-writer-data": "2.0.1",
    "@fontsource/open-sans": "5.3.0",
    "@fontsource/lora": "5.3.0",
    "@fontsource/kaushan-script": "5.3.0",
    "@fontsource/caveat-brush": "5.3.0",
}
FONTS = {"sans": "open-sans", "serif": "lora", "script": "kaushan-script", "brush": "caveat-brush"}
CHARACTER_MM = 100.0
MM_PER_UNIT = CHARACTER_MM / 1024


class Lettering:
    """Read the packages that npm has fetched into a folder node_modules."""

    def __init__(self, modules):
        self.modules = modules

    def characters(self, count: int, seed: int) -> list[tuple[str, dict]]:
        """Return random characters.

        An item is (character, {"strokes": path data, "medians": polylines}).
        """
        files = sorted(f for f in (self.modules / "hanzi-writer-data").glob("*.json") if len(f.stem) == 1)
        chosen = np.random.default_rng(seed).choice(len(files), count, replace=False)
        return [(files[k].stem, json.loads(files[k].read_text(encoding="utf-8"))) for k in chosen]

    def drawings(self, count: int, seed: int) -> list[Design]:
        """Return random characters as filled shapes, one per stroke."""
        sheet_mm = (CHARACTER_MM, CHARACTER_MM)
        return [
            Design(sheet_mm, tuple(outline(f"s{k}", data) for k, data in enumerate(each["strokes"])))
            for _, each in self.characters(count, seed)
        ]

    def font(self, kind: str, weight: int = 400) -> bytes:
        name = FONTS[kind]
        files = self.modules / "@fontsource" / name / "files"
        return (files / f"{name}-latin-{weight}-normal.woff").read_bytes()


def outline(name: str, path_data: str) -> Element:
    """Return one stroke of a character as a filled element; the box is 100 mm."""
    subpaths = []
    for line in parse_path(path_data).continuous_subpaths():
        rows = [each.bpoints() for each in line]
        cubics = [
            (p[0], p[0] + (p[1] - p[0]) / 3, p[0] + (p[1] - p[0]) * 2 / 3, p[1])
            if isinstance(each, Line)
            else (p[0], p[0] + (p[1] - p[0]) * 2 / 3, p[2] + (p[1] - p[2]) * 2 / 3, p[2])
            if len(p) == 3
            else p
            for each, p in zip(line, rows, strict=True)
        ]
        points = np.array(cubics) * MM_PER_UNIT
        subpaths.append(SubPath(np.stack([points.real, points.imag], axis=-1), True))
    return Element(name, tuple(subpaths), 0.0, fill_rule="nonzero")


def letter(font: bytes, text: str, size_mm: float = 60.0):
    """Return a drawing of a text in a font."""
    document, _ = text_svg(text, font, size_mm=size_mm)
    return read_svg(document.encode())


def swept(strokes) -> list[np.ndarray]:
    """Return the paint of a disc of the found width along the found lines.

    The lines' own outlines are not used.
    """
    bare = [_core.Stroke(middle_mm=s.middle_mm, half_width=s.half_width, closed=s.closed) for s in strokes]
    return _core.unite([ring for stroke in bare for ring in _core.target_outline(stroke, 0.02)])


def covered(paint, shape) -> float:
    """Return the share of a shape that is painted."""
    return (_core.area(paint) + _core.area(shape) - _core.area(_core.unite([*paint, *shape]))) / _core.area(shape)


def evenly(line: np.ndarray, count: int = 64) -> np.ndarray:
    at = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(line[:, :2], axis=0).T))])
    return np.column_stack([np.interp(np.linspace(0, at[-1], count), at, line[:, k]) for k in (0, 1)])
