"""What the href of an element, or a url(), refers to."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from urllib.parse import unquote

_XLINK_HREF = "{http://www.w3.org/1999/xlink}href"


def href(node: ET.Element) -> str:
    """Of the attribute or, where that is not given, XLink's."""
    return node.get("href", node.get(_XLINK_HREF, ""))


def referred(reference: str, by_id: dict[str, ET.Element]) -> ET.Element | None:
    """The element of the same drawing: of the id as it is written or, as URLs write letters beyond ASCII, unquoted."""
    if not reference.startswith("#") or reference == "#":
        return None
    return by_id.get(reference[1:], by_id.get(unquote(reference[1:])))
