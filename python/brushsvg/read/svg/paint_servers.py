"""The paint of stroke and fill: a colour, nothing, or an unread paint server.

An unread paint server counts as a colour.
"""

from __future__ import annotations

import re
import xml.etree.ElementTree as ET
from collections.abc import Callable

from ...errors import Error, Notice
from ...units import length_px
from .colour import parse_colour
from .css.declarations import Declaration, declarations
from .references import find_referenced, href

URL = re.compile(r"url\(([^)]*+)\)(.*)", re.DOTALL)
INVISIBLE_OPACITY = 1 / 512  # an opacity below half a step of 8 bits is invisible
_GRADIENTS = frozenset(("linearGradient", "radialGradient"))
_UNSUPPORTED_SERVERS = frozenset("meshgradient mesh hatch solidcolor solidColor".split())


class PaintServers:
    """The paint servers of a drawing.

    by_id: the elements of the drawing; rules: returns the declarations of its style sheets for an element.
    """

    def __init__(self, by_id: dict[str, ET.Element], rules: Callable[[ET.Element], list[Declaration]]):
        self._by_id = by_id
        self._rules = rules
        # A cache, because thousands of shapes can share a long gradient.
        self._paint_cache: dict[tuple[str, str], tuple[str, list[Notice]]] = {}

    def find_paint(self, properties: dict[str, str], name: str) -> tuple[str, list[Notice]]:
        """Return the paint, "#rrggbb" or "none", and notices about unread parts.

        properties: of the element; name: "stroke" or "fill".
        """
        key = properties[name] or "#000000", name
        if key not in self._paint_cache:
            self._paint_cache[key] = self._colour(*key)
        colour, notices = self._paint_cache[key]
        notices = [*notices]
        colour = properties["color"] if colour == "currentcolor" else colour
        opacity = float(properties[f"{name}-opacity"])
        alpha = int(colour[7:], 16) / 255 if len(colour) == 9 else 1.0
        if colour == "none" or alpha * opacity < INVISIBLE_OPACITY:
            return "none", []
        if alpha < 1:
            notices.append(
                Notice(
                    "",
                    f"the {name}'s colour has an opacity of {alpha:.2g}: it counts as 1",
                    code="opacity-unread",
                )
            )
        if opacity < 1:
            notices.append(Notice("", f"{name}-opacity is not read: it counts as 1", code="opacity-unread"))
        return colour[:7], notices

    def explain_no_paint(self, properties: dict[str, str], name: str) -> str:
        """Return the reason why a stroke or fill of the drawing paints nothing."""
        url = URL.match(properties[name])
        if url and self._colour(properties[name], name)[0] == "none":
            return f"the {name}'s paint {url[1].strip()[:40]} is nowhere in the drawing or paints nothing"
        return f"its {name} is fully transparent"

    def _colour(self, value: str, name: str) -> tuple[str, list[Notice]]:
        """Return the colour of a paint value, and notices.

        A reference to nothing, or to an element that is not a paint server, counts as its fallback, as SVG
        prescribes.
        """
        url = URL.match(value)
        if not url:
            return value, []
        reference, fallback = url[1].strip(" \"'"), url[2].strip()
        fallback_colour = (parse_colour(fallback) or "none") if fallback else "none"
        server = find_referenced(reference, self._by_id)
        tag = "" if server is None else server.tag.rpartition("}")[2]
        if tag in _GRADIENTS:
            stops = [self._stop(stop) for stop in self._content(server) if _has_tag(stop, "stop")]
            if len(set(stops)) <= 1 and None not in stops:
                return stops[0] if stops else "none", []
        elif tag == "pattern":
            if not self._paints_something(server):
                return fallback_colour, []
        elif tag not in _UNSUPPORTED_SERVERS:
            return fallback_colour, []
        colour = fallback_colour[:7] if fallback_colour.startswith("#") else "#000000"
        sentence = f"the {name}'s paint {reference[:40]} is not read: it counts as {colour}"
        return colour, [Notice("", sentence, code="paint-unread", about=name)]

    def _stop(self, stop: ET.Element) -> str | None:
        """Return the colour of a stop of a gradient, None if it cannot be read."""
        declared = {name: stop.get(name) for name in ("stop-color", "stop-opacity") if name in stop.attrib}
        declared |= {name: value for name, value, _ in (*self._rules(stop), *declarations(stop.get("style", "")))}
        colour = parse_colour(declared.get("stop-color", "#000000").strip())
        try:
            opacity = min(1.0, max(0.0, length_px(declared.get("stop-opacity", "1"), 1.0)))
        except Error:
            return None
        if colour is None or not colour.startswith("#"):
            return None
        alpha = opacity * (int(colour[7:], 16) if len(colour) == 9 else 255)
        return colour[:7] if alpha >= 254.5 else f"{colour[:7]}{round(alpha):02x}"

    def _paints_something(self, pattern: ET.Element) -> bool:
        """Whether a pattern has a size and content. A size that cannot be read counts as present."""
        for name in ("width", "height"):
            declared = next((server.get(name) for server in self._chain(pattern) if name in server.attrib), "0")
            try:
                if length_px(declared or "0", 100.0) <= 0:
                    return False
            except Error:
                continue
        return bool(self._content(pattern))

    def _content(self, server: ET.Element) -> list[ET.Element]:
        """Return the children of a gradient or pattern, or of the first server in its chain that has some."""
        return next((list(node) for node in self._chain(server) if len(node)), [])

    def _chain(self, server: ET.Element):
        seen: set[ET.Element] = set()
        while server is not None and server not in seen:
            yield server
            seen.add(server)
            server = find_referenced(href(server).strip(), self._by_id)


def _has_tag(node: ET.Element, tag: str) -> bool:
    return isinstance(node.tag, str) and node.tag.rpartition("}")[2] == tag
