"""Time the reading of a drawing of 1,000 elements as Inkscape writes it, by stage.

Two other readers of SVG are compared, and the floor is expat, which parses the XML. Then the command runs as a
process, and the large modules that it loads are listed. Every round starts cold, without cached values of the reader.
"""

from __future__ import annotations

import argparse
import math
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from xml.parsers import expat

import numpy as np

from brushsvg import units
from brushsvg.read.svg import colour, read_svg, transform, viewport
from brushsvg.read.svg.css import cascade, declarations, style_sheets
from brushsvg.read.svg.paths import shapes as svg_shapes
from brushsvg.read.svg.paths.path_to_cubics import trace
from brushsvg.read.svg.xml import parse_xml
from brushsvg.strokes.extraction import strokes

ELEMENTS = 1000
SEGMENTS = 10
LAYERS = 5
HEAVY = "numpy cv2 scipy svgpathtools ezdxf tinycss2"
SHEET = """
.thin { stroke: #203040 } .wide { stroke-linecap: square }
#layer2 path.thin { stroke: #402030 } g > .loose { stroke-dasharray: none }
"""


def drawing() -> str:
    """Return an A3 drawing of five layers with rotated groups of paths, shapes and copies."""
    random = np.random.default_rng(1)
    layers = "".join(_layer(random, number) for number in range(1, LAYERS + 1))
    return (
        '<svg xmlns="http://www.w3.org/2000/svg" xmlns:xlink="http://www.w3.org/1999/xlink"'
        ' xmlns:inkscape="http://www.inkscape.org/namespaces/inkscape"'
        ' width="420mm" height="297mm" viewBox="0 0 420 297">'
        f"<style>{SHEET}</style>{layers}</svg>"
    )


def _layer(random, number: int) -> str:
    each = ELEMENTS // LAYERS
    lines = [f'<g inkscape:groupmode="layer" inkscape:label="Layer {number}" id="layer{number}">']
    for k in range(each):
        if k % 20 == 0:
            turn = f"translate({random.uniform(0, 20):.4f},{random.uniform(0, 20):.4f}) rotate({k / 10:.3f})"
            lines.append(("</g>" if k else "") + f'<g id="g{number}-{k}" transform="{turn}">')
        lines.append(_element(random, f"{number}-{k}", k))
    return "\n".join([*lines, "</g></g>"])


def _element(random, name: str, k: int) -> str:
    x, y, r = random.uniform(40, 380), random.uniform(40, 250), random.uniform(2, 8)
    look = f'id="e{name}" class="{("thin", "wide", "loose")[k % 3]}" style="{_style(random)}"'
    if k % 20 == 5:
        return f'<rect {look} x="{x:.4f}" y="{y:.4f}" width="{2 * r:.4f}" height="{r:.4f}" ry="1"/>'
    if k % 20 == 10:
        return f'<circle {look} cx="{x:.4f}" cy="{y:.4f}" r="{r:.4f}"/>'
    if k % 20 == 15:
        return f'<path {look} d="M {x:.4f},{y:.4f} a {r:.4f},{r / 2:.4f} 30 1 0 {r:.4f},{r:.4f}"/>'
    if k % 20 == 19:
        return f'<use id="e{name}" xlink:href="#e{name.split("-")[0]}-{k - 1}" x="{r:.4f}" y="{r:.4f}"/>'
    steps = random.uniform(-6, 6, (SEGMENTS, 6))
    d = f"m {x:.4f},{y:.4f} c " + " ".join("{:.6f},{:.6f} {:.6f},{:.6f} {:.6f},{:.6f}".format(*s) for s in steps)
    return f'<path {look} d="{d}"/>'


def _style(random) -> str:
    return (
        f"fill:none;stroke:#{random.integers(1 << 24):06x};stroke-width:{random.uniform(1, 5):.6f};"
        "stroke-linecap:round;stroke-linejoin:round;stroke-miterlimit:4;stroke-dasharray:none;"
        "stroke-dashoffset:0;stroke-opacity:1;paint-order:normal"
    )


def cold_ms(work, rounds: int) -> float:
    times = []
    for _ in range(rounds):
        for remembering in (declarations.declarations, colour.parse_colour, units._parts):
            remembering.cache_clear()
        begin = time.perf_counter()
        work()
        times.append(time.perf_counter() - begin)
    return 1e3 * float(np.median(times))


def styles(root) -> None:
    """Compute the rules, and the style of every element from its parent."""
    rules = style_sheets.StyleSheets(root)
    waiting = [(root, cascade.INITIAL)]
    while waiting:
        node, parent = waiting.pop()
        style, _ = cascade.cascade(parent, node.attrib, rules.declarations_for(node), 100.0)
        waiting += [(child, style) for child in node]


def stages(data: bytes, rounds: int) -> dict[str, float]:
    root = parse_xml(data).root
    page = viewport.read_page(root.attrib)
    scale = transform.scales(page.paper_from_user)[0]
    shapes = [(tag, node.attrib) for node in root.iter() if (tag := node.tag.rpartition("}")[2]) in svg_shapes.TAGS]

    def path_data():
        return [svg_shapes.shape_commands(tag, attributes, page.viewport) for tag, attributes in shapes]

    drawn = path_data()
    design = read_svg(data)
    works = {
        "XML": lambda: parse_xml(data),
        "CSS and style": lambda: styles(root),
        "path data": path_data,
        "geometry": lambda: [trace(commands, page.paper_from_user, scale) for commands in drawn],
        "all of read_svg": lambda: read_svg(data),
        "strokes": lambda: strokes(design),
    }
    return {name: cold_ms(work, rounds) for name, work in works.items()}


def process_s(command: list, rounds: int) -> float:
    times = []
    for _ in range(rounds):
        begin = time.perf_counter()
        subprocess.run(command, check=True, capture_output=True)
        times.append(time.perf_counter() - begin)
    return float(np.median(times))


def loaded(code: str) -> str:
    """Return the large modules that Python code loads."""
    code = f"import sys\n{code}\nprint(*[name for name in {HEAVY.split()} if name in sys.modules], file=sys.stderr)"
    done = subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True)
    return done.stderr.splitlines()[-1] or "none of them"


def processes(folder: Path, rounds: int) -> None:
    small, picture = folder / "small.svg", folder / "picture.svg"
    small.write_text(
        '<svg xmlns="http://www.w3.org/2000/svg" width="60mm" height="40mm" viewBox="0 0 60 40">'
        '<path id="a" style="fill:none;stroke:#000;stroke-width:3" d="M5 5C20 5 20 30 50 30"/></svg>'
    )
    command = Path(sys.executable).with_name("brushsvg")
    main = "from brushsvg.cli import main\nmain({})".format
    read = f"import brushsvg\nbrushsvg.read_drawing({str(small)!r})"
    print(f"as processes, in s, and what they load of {HEAVY}")
    for name, what, code in (
        ("`brushsvg --help` (aim: 0.15 s)", [command, "--help"], main(["--help"])),
        ("reading a small SVG (aim: no scipy, no cv2)", [sys.executable, "-c", read], read),
        (
            "`brushsvg preview small.svg -o picture.svg --show strokes`",
            [command, "preview", small, "-o", picture, "--show", "strokes"],
            main(["preview", str(small), "-o", str(picture), "--show", "strokes"]),
        ),
        ("floor: Python alone", [sys.executable, "-c", "pass"], "pass"),
    ):
        print(f"  {name:<48} {process_s(what, rounds):7.3f} s    {loaded(code)}")


def main() -> None:
    from svgelements import SVG
    from svgpathtools import svg2paths

    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rounds", type=int, default=5)
    rounds = parser.parse_args().rounds
    data = drawing().encode()
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder, "drawing.svg")
        file.write_bytes(data)
        ours = stages(data, rounds)
        elements = cold_ms(lambda: SVG.parse(str(file)), math.ceil(rounds / 2))
        paths = cold_ms(lambda: svg2paths(str(file)), math.ceil(rounds / 2))
        floor = cold_ms(lambda: expat.ParserCreate().Parse(data, True), rounds)

        print(f"a drawing of {ELEMENTS} elements, {len(data) / 1e3:.0f} kB, medians")
        for name, ms in ours.items():
            print(f"  {name:<48} {ms:9.1f} ms")
        print(f"  {'peer: svgelements, SVG.parse':<48} {elements:9.1f} ms")
        print(f"  {'peer: svgpathtools, svg2paths (no CSS, no use)':<48} {paths:9.1f} ms")
        print(f"  {'floor: expat parsing the XML':<48} {floor:9.1f} ms")
        whole = ours["all of read_svg"]
        print(f"  svgelements / ours: {elements / whole:.1f} (aim: well above 1); ours / floor: {whole / floor:.0f}")
        processes(Path(folder), rounds)


if __name__ == "__main__":
    main()
