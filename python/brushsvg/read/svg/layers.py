"""Which groups of an SVG file are layers, and what they are called, by the habits of the programs that write them.

Inkscape marks layers. Elsewhere they are the outermost groups with a name: an id, in which Illustrator and CorelDRAW
escape what an id cannot hold, or, next to it, Affinity's serif:id or Illustrator's data-name. Where such a group holds
the whole drawing, as a page or an artboard does, the groups in it are layers, too.
"""

from __future__ import annotations

import re
import xml.etree.ElementTree as ET
from collections.abc import Iterator

from .context import local, one_line
from .paths.power_stroke import INKSCAPE

_SERIF = "{http://www.serif.com/}"
_ESCAPE = re.compile("_x([0-9A-Fa-f]{2,6})_")
_AROUND = frozenset(("svg", "switch", "a"))  # what stands around layers without being one
_DEEPEST = 100  # layers in layers with names of their own: nobody clicks deeper
_NOT_DRAWN = frozenset("title desc metadata defs style script foreignObject namedview".split())


def layer_names(root: ET.Element) -> dict[ET.Element, str]:
    """Return the name of each group that is a layer, with those of the layers around it: "Ink/Fine"."""
    own = {
        node: one_line(node.get(INKSCAPE + "label") or node.get("id", ""))
        for node in root.iter()
        if node.get(INKSCAPE + "groupmode") == "layer"
    }
    own = own or _by_convention(root)
    names: dict[ET.Element, str] = {}
    waiting = [("", 0, iter(root))] if own else []
    while waiting:
        path, depth, nodes = waiting[-1]
        node = next(nodes, None)
        if node is None:
            waiting.pop()
            continue
        if node in own:
            if depth < _DEEPEST:
                path, depth = "/".join(filter(None, (path, own[node]))), depth + 1
            names[node] = path
        if len(node):
            waiting.append((path, depth, iter(node)))
    return names


def is_documentation(path: str) -> bool:
    """Whether a layer holds notes for people: AxiDraw's software never plots layers whose names start with %
    (wiki.evilmadscientist.com, "AxiDraw Layer Control")."""
    return path.rpartition("/")[2].startswith("%")


def _by_convention(root: ET.Element) -> dict[ET.Element, str]:
    names: dict[ET.Element, str] = {}
    inside: ET.Element | None = root
    while inside is not None:
        found = list(_outermost(inside))
        groups = {node: name for node, name in found if name}
        names.update(groups)
        inside = found[0][0] if len(found) == len(groups) == 1 else None
    return names


def _outermost(parent: ET.Element) -> Iterator[tuple[ET.Element, str]]:
    """Return the outermost named groups and, with "", everything painted outside of them."""
    waiting = [iter(parent)]
    while waiting:
        node = next(waiting[-1], None)
        if node is None:
            waiting.pop()
        elif local(node) == "g" and (name := _name(node)):
            yield node, name
        elif local(node) in _AROUND or local(node) == "g":
            waiting.append(iter(node))
        elif local(node) not in _NOT_DRAWN:
            yield node, ""


def _name(node: ET.Element) -> str:
    said = node.get(_SERIF + "id") or node.get("data-name")
    return one_line(said or _ESCAPE.sub(_character, node.get("id", "")))


def _character(escape: re.Match) -> str:
    number = int(escape[1], 16)
    return chr(number) if number < 0x110000 and chr(number).isprintable() else escape[0]
