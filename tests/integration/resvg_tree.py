"""Read a drawing with resvg: npm's @resvg/resvg-js prints a flattened tree."""

import json
import re
import subprocess
import xml.etree.ElementTree as ET
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from drawings import SVG

PACKAGE = "@resvg/resvg-js"
PACKAGES = {PACKAGE: "2.6.2"}
# A tree does not apply the viewBox of its root. So the drawing is read again as a nested svg, where resvg places
# everything itself. Without fonts, resvg drops text, which we do not read either.
SCRIPT = """
const { Resvg } = require(process.argv[1]);
const read = (svg) => new Resvg(svg, { font: { loadSystemFonts: false } }).toString();
const flattened = (svg) => {
  const tree = read(svg);
  const [, width, height] = /<svg width="([^"]*)" height="([^"]*)"/.exec(tree);
  return read(`<svg xmlns="http://www.w3.org/2000/svg" width="${width}" height="${height}">${tree}</svg>`);
};
const drawings = JSON.parse(require("fs").readFileSync(0, "utf8"));
const trees = Object.entries(drawings).map(([name, svg]) => [name, flattened(svg)]);
process.stdout.write(JSON.stringify(Object.fromEntries(trees)));
"""
CURVES = {"L": 1, "Q": 2, "C": 3}  # number of points after the letter


@dataclass(frozen=True)
class Line:
    """A sub-path in px of the page, y down.

    It has n >= 1 cubics (n, 4, 2), including the closing one.
    """

    cubics: np.ndarray
    closed: bool


@dataclass(frozen=True)
class Painted:
    """The visible parts of a path.

    Without a stroke, the width is 0. Without a fill, the rule is "".

    colour is "#rrggbb" of the stroke, or of the fill if there is no stroke. It is "" for a gradient.
    """

    lines: tuple[Line, ...]
    stroke_width_px: float
    fill_rule: str
    colour: str


@dataclass(frozen=True)
class Page:
    size_px: tuple[float, float]
    painted: tuple[Painted, ...]


class Resvg:
    def __init__(self, modules: Path):
        """Use resvg from modules, the folder of npm's packages."""
        self.package = modules / PACKAGE

    def pages(self, drawings: dict[str, str]) -> dict[str, Page]:
        """Return {name: the page that resvg paints} for {name: SVG text}."""
        done = subprocess.run(
            ["node", "-e", SCRIPT, str(self.package)],
            input=json.dumps(drawings),
            capture_output=True,
            encoding="utf-8",
            timeout=120,
        )
        assert done.returncode == 0, done.stderr
        return {name: parse_tree(tree) for name, tree in json.loads(done.stdout).items()}


def parse_tree(tree: str) -> Page:
    root = ET.fromstring(tree)
    return Page((float(root.get("width")), float(root.get("height"))), tuple(_painted(root, np.eye(3))))


def _painted(node: ET.Element, above: np.ndarray):
    """Yield the paths below a node in order.

    Invisible paths are in resvg's tree, and not in ours.
    """
    if node.tag == SVG + "defs" or node.get("opacity") == "0" or node.get("visibility", "visible") != "visible":
        return
    matrix = above @ _matrix(node.get("transform"))
    if node.tag == SVG + "path" and (path := _path(node, matrix)):
        yield path
    for child in node:
        yield from _painted(child, matrix)


def _matrix(text: str | None) -> np.ndarray:
    if text is None:
        return np.eye(3)
    a, b, c, d, e, f = map(float, re.fullmatch(r"matrix\((.*)\)", text)[1].split())
    return np.array([[a, c, e], [b, d, f], [0, 0, 1]])


def _path(node: ET.Element, matrix: np.ndarray) -> Painted | None:
    seen = [of for of in ("stroke", "fill") if node.get(of) != "none" and node.get(f"{of}-opacity") != "0"]
    lines = _lines(node.get("d"), matrix)
    if not seen or not lines:
        return None
    width = float(node.get("stroke-width", 1)) * abs(np.linalg.det(matrix)) ** 0.5 if "stroke" in seen else 0.0
    colour = node.get(seen[0])
    return Painted(
        lines=tuple(lines),
        stroke_width_px=width,
        fill_rule=node.get("fill-rule", "nonzero") if "fill" in seen else "",
        colour="" if colour.startswith("url(") else colour,
    )


def _lines(d: str, matrix: np.ndarray) -> list[Line]:
    """Return the sub-paths of a path of resvg, which has only absolute M, L, Q, C, Z."""
    lines, cubics = [], []
    here = start = np.zeros(2)
    for letter, words in re.findall(r"([A-Z])([^A-Z]*)", d):
        points = np.array(words.split(), float).reshape(-1, 2)
        if letter in CURVES:
            assert len(points) == CURVES[letter], (letter, words)
            cubics.append(_cubic(here, points))
            here = points[-1]
            continue
        assert letter in "MZ", letter
        if letter == "Z" and ((start != here).any() or not cubics):
            cubics.append(_cubic(here, start[None]))
        if cubics:
            lines.append(Line(_mapped(cubics, matrix), letter == "Z"))
        cubics, here = [], start
        if letter == "M":
            here = start = points[0]
    if cubics:
        lines.append(Line(_mapped(cubics, matrix), False))
    return lines


def _cubic(here: np.ndarray, points: np.ndarray) -> np.ndarray:
    end = points[-1]
    if len(points) == 1:
        return np.array([here, here + (end - here) / 3, end - (end - here) / 3, end])
    if len(points) == 2:
        return np.array([here, here + (points[0] - here) * 2 / 3, end + (points[0] - end) * 2 / 3, end])
    return np.array([here, *points])


def _mapped(cubics: list[np.ndarray], matrix: np.ndarray) -> np.ndarray:
    return np.array(cubics) @ matrix[:2, :2].T + matrix[:2, 2]
