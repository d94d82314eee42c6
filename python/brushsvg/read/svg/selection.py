"""Select elements of an SVG by a CSS selector from the user."""

from __future__ import annotations

import xml.etree.ElementTree as ET

import tinycss2

from ...errors import Error
from .css.selectors import Tree


def select_elements(root: ET.Element, text: str) -> set[ET.Element]:
    """Return the elements that a CSS selector matches.

    Raises Error if the text is not a selector, or matches nothing.
    """
    tree = Tree(root)
    selectors = tree.compile_selectors(tinycss2.parse_component_value_list(text))
    if not selectors:
        sentence = f"{text[:60]!r} is not a CSS selector; write for example #signature or g.ink path"
        raise Error(sentence, code="selector-invalid")
    found = {node for node, wrapped in tree.nodes.items() if any(selector.test(wrapped) for selector in selectors)}
    if not found:
        raise Error(f"selector {text[:60]!r} matches no element of the drawing", code="selector-matches-nothing")
    return found
