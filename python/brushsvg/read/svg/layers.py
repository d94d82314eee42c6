"""Find the groups of an SVG file that are layers, and their names.

Inkscape marks layers. In files of other programs, the outermost groups with a name are layers. The name is an id, in
which Illustrator and CorelDRAW escape special characters, or Affinity's serif:id or Illustrator's data-name next to
the id. If such a group contains the whole drawing, as a page or an artboard does, the groups inside are layers, too.
"""

from __future__ import annotations

import re
import xml.etree.ElementTree as ET
from collections.abc import Iterator

from .context import local, one_line
from .paths.power_stroke import INKSCAPE

_SERIF = "{http://www.serif.com/}"
_ESCAPE = re.compile("_x([0-9A-Fa-f]{2,6})_")
_AROUND = frozenset(("svg", "switch", "a"))  # elements that can contain layers and are not layers
_DEEPEST = 100  # nesting depth of layers that get their own names; no user needs more
_NOT_DRAWN = frozenset("title desc metadata defs style script foreignObject namedview".split())


def layer_names(root: ET.Element) -> dict[ET.Element, str]:
    """Return the name of each layer, with the names of the layers around it: "Ink/Fine"."""
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
    """Whether a layer contains notes that are not plotted.

    AxiDraw's software never plots layers whose names start with % (wiki.evilmadscientist.com, "AxiDraw Layer
    Control").
    """
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
    """Yield the outermost named groups and, with "", all painted elements outside of them."""
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
