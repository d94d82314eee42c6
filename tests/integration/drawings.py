"""Real drawings: ours, characters of KanjiVG, and files that Inkscape saved."""

import importlib.metadata
import os
import subprocess
import xml.etree.ElementTree as ET
from pathlib import Path

SVG = "{http://www.w3.org/2000/svg}"
KANJI_SCALE = 1.5

# A drawing as a user would save it: layers, live shapes and transforms, in mm. Inkscape turns its objects into
# paths, moves elements, and writes the rest in its own style.
SKETCH = """<svg xmlns="http://www.w3.org/2000/svg" width="150mm" height="100mm" viewBox="0 0 150 100"
  xmlns:inkscape="http://www.inkscape.org/namespaces/inkscape"
  xmlns:sodipodi="http://sodipodi.sourceforge.net/DTD/sodipodi-0.dtd">
 <title>A sketch</title>
 <sodipodi:namedview id="view" inkscape:document-units="mm"/>
 <g inkscape:groupmode="layer" inkscape:label="Letters" id="layer1" transform="translate(10,5)">
  <path id="wave" d="M 10,20 C 20,0 40,0 50,20 S 80,40 90,20"
        style="fill:none;stroke:#102030;stroke-width:3;stroke-linecap:round;stroke-linejoin:round"/>
  <g id="turned" transform="rotate(-10)">
   <path id="bar" d="M 10,50 H 60" style="fill:none;stroke:#a00000;stroke-width:2.5px;stroke-linecap:round"/>
  </g>
 </g>
 <g inkscape:groupmode="layer" inkscape:label="Shapes &amp; more" id="layer2"
    style="fill:none;stroke:#0000ff">
  <path id="spiral" sodipodi:type="spiral" sodipodi:cx="110" sodipodi:cy="65" sodipodi:expansion="1"
        sodipodi:revolution="2" sodipodi:radius="22" sodipodi:argument="0" sodipodi:t0="0.25"
        style="stroke-width:2;stroke-linecap:round;stroke-linejoin:round"/>
  <ellipse id="ring" cx="45" cy="80" rx="20" ry="9" transform="rotate(15 45 80)" style="stroke-width:2"/>
  <rect id="box" x="122" y="8" width="20" height="16" rx="6" style="stroke-width:0.08cm"/>
 </g>
</svg>
"""
ACTIONS = (
    "select-by-id:spiral,ring;object-to-path;select-clear;"
    "select-by-id:bar;transform-rotate:5;select-clear;"
    "select-by-id:box;transform-translate:-3,2;select-clear"
)

SOURCES = ("vincent", "robot", "kanji-eternity", "kanji-write", "inkscape", "inkscape-plain")


class Inkscape:
    """Run Inkscape without a display, in a separate profile."""

    def __init__(self, folder: Path):
        self.folder = folder
        self.env = {**os.environ, "INKSCAPE_PROFILE_DIR": str(folder / "profile"), "HOME": str(folder)}
        self.env.pop("DISPLAY", None)

    def __call__(self, *words):
        subprocess.run(["inkscape", *map(str, words)], env=self.env, check=True, capture_output=True, timeout=120)

    def save(self, out: Path, *, plain: bool) -> Path:
        sketch = self.folder / "sketch.svg"
        sketch.write_text(SKETCH, encoding="utf-8")
        kind = ["--export-plain-svg"] if plain else ["--export-type=svg"]
        self(*kind, f"--export-filename={out}", f"--actions={ACTIONS};export-do", sketch)
        return out

    def paint(self, drawing: Path, px_per_mm: float) -> Path:
        """Return the page of a drawing as a PNG whose alpha shows its strokes, without texts."""
        root = ET.parse(drawing).getroot()
        for parent in list(root.iter()):
            for text in parent.findall(SVG + "text"):
                parent.remove(text)
        copy, out = self.folder / f"{drawing.stem}-lines.svg", self.folder / f"{drawing.stem}.png"
        ET.ElementTree(root).write(copy)
        self(
            "--export-type=png",
            "--export-area-page",
            f"--export-dpi={25.4 * px_per_mm}",
            f"--export-filename={out}",
            copy,
        )
        return out


def kanji_file(letter: str) -> Path:
    name = f"kanji/{ord(letter):05x}.svg"
    found = [file for file in importlib.metadata.files("kanjivg") if file.as_posix() == name]
    return Path(found[0].locate())


def enlarged_kanji(letter: str, out: Path) -> Path:
    """Return the strokes of a character without their numbers, in the size of brush writing."""
    strokes = ET.parse(kanji_file(letter)).getroot().find(SVG + "g")
    side = 109 * KANJI_SCALE
    root = ET.Element(SVG + "svg", width=f"{side}mm", height=f"{side}mm", viewBox=f"0 0 {side} {side}")
    ET.SubElement(root, SVG + "g", transform=f"scale({KANJI_SCALE})").append(strokes)
    ET.ElementTree(root).write(out, encoding="utf-8", xml_declaration=True)
    return out
