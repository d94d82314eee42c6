"""Resolve the references of href and url()."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from urllib.parse import unquote

_XLINK_HREF = "{http://www.w3.org/1999/xlink}href"


def href(node: ET.Element) -> str:
    """Return the attribute href of an element or, if it is missing, xlink:href."""
    return node.get("href", node.get(_XLINK_HREF, ""))


def find_referenced(reference: str, by_id: dict[str, ET.Element]) -> ET.Element | None:
    """Return the element that a reference names in the same drawing, or None.

    The id is used as written or, because URLs quote letters beyond ASCII, unquoted.
    """
    if not reference.startswith("#") or reference == "#":
        return None
    return by_id.get(reference[1:], by_id.get(unquote(reference[1:])))
