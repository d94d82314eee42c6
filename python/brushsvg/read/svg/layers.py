"""Find the groups of an SVG file that are layers, and their names.

Inkscape marks layers. In files of other programs, the outermost groups with a name are layers. The name is an id, in
which Illustrator and CorelDRAW escape special characters, or Affinity's serif:id or Illustrator's data-name next to
the id. If such a group contains the whole drawing, as a page or an artboard does, the groups inside are layers, too.
"""

from __future__ import annotations

import re
import xml.etree.ElementTree as ET
from collections.abc import Iterator

from .context import local_name, printable_line
from .paths.power_stroke import INKSCAPE

_SERIF = "{http://www.serif.com/}"
_ESCAPE = re.compile("_x([0-9A-Fa-f]{2,6})_")
_CONTAINERS = frozenset(("svg", "switch", "a"))  # elements that can contain layers and are not layers
_MAX_LAYER_DEPTH = 100  # nesting depth of layers that get their own names; no user needs more
_NOT_DRAWN = frozenset("title desc metadata defs style script foreignObject namedview".split())


def layer_names(root: ET.Element) -> dict[ET.Element, str]:
    """Return the name of each layer, prefixed by the layers around it: "Ink/Fine"."""
    own = {
        node: printable_line(node.get(INKSCAPE + "label") or node.get("id", ""))
        for node in root.iter()
        if node.get(INKSCAPE + "groupmode") == "layer"
    }
    own = own or _names_by_convention(root)
    names: dict[ET.Element, str] = {}
    stack = [("", 0, iter(root))] if own else []
    while stack:
        path, depth, nodes = stack[-1]
        node = next(nodes, None)
        if node is None:
            stack.pop()
            continue
        if node in own:
            if depth < _MAX_LAYER_DEPTH:
                path, depth = "/".join(filter(None, (path, own[node]))), depth + 1
            names[node] = path
        if len(node):
            stack.append((path, depth, iter(node)))
    return names


def is_notes_layer(path: str) -> bool:
    """Whether a layer contains notes that are not plotted.

    AxiDraw's software never plots layers whose names start with % (wiki.evilmadscientist.com, "AxiDraw Layer
    Control").
    """
    return path.rpartition("/")[2].startswith("%")


def _names_by_convention(root: ET.Element) -> dict[ET.Element, str]:
    names: dict[ET.Element, str] = {}
    container: ET.Element | None = root
    while container is not None:
        outermost = list(_outermost_groups(container))
        groups = {node: name for node, name in outermost if name}
        names.update(groups)
        container = outermost[0][0] if len(outermost) == len(groups) == 1 else None
    return names


def _outermost_groups(parent: ET.Element) -> Iterator[tuple[ET.Element, str]]:
    """Yield (element, name) for the outermost named groups.

    Painted elements outside of these groups have the name "".
    """
    stack = [iter(parent)]
    while stack:
        node = next(stack[-1], None)
        if node is None:
            stack.pop()
        elif local_name(node) == "g" and (name := _group_name(node)):
            yield node, name
        elif local_name(node) in _CONTAINERS or local_name(node) == "g":
            stack.append(iter(node))
        elif local_name(node) not in _NOT_DRAWN:
            yield node, ""


def _group_name(node: ET.Element) -> str:
    given_name = node.get(_SERIF + "id") or node.get("data-name")
    return printable_line(given_name or _ESCAPE.sub(_unescape, node.get("id", "")))


def _unescape(escape: re.Match) -> str:
    number = int(escape[1], 16)
    return chr(number) if number < 0x110000 and chr(number).isprintable() else escape[0]
