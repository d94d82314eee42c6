"""CSS selectors held against an SVG tree, within bounds, by cssselect2."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections import Counter
from collections.abc import Iterator

import tinycss2
from cssselect2 import ElementWrapper, SelectorError, compile_selector_list

from ...errors import Error

# Steps through the tree that selectors may take together: some ten seconds' worth, a hundred times what drawings need.
STEP_LIMIT = 3_000_000


class _Budget:
    def __init__(self):
        self.left = STEP_LIMIT

    def spend(self, steps: int) -> None:
        self.left -= steps
        if self.left < 0:
            raise Error(
                "its CSS selectors take too long on a drawing of this size",
                where="style",
                code="css-too-complex",
            )


class _Node(ElementWrapper):
    """Walks to its kin one by one and counts: kept lists of them would grow with the depth squared."""

    budget: _Budget

    @property
    def ancestors(self) -> Iterator[ElementWrapper]:
        node = self.parent
        while node is not None:
            self.budget.spend(1)
            yield node
            node = node.parent

    @property
    def previous_siblings(self) -> Iterator[ElementWrapper]:
        node = self.previous
        while node is not None:
            self.budget.spend(1)
            yield node
            node = node.previous

    def iter_children(self) -> Iterator[ElementWrapper]:
        for child in super().iter_children():
            self.budget.spend(1)
            yield child


class Tree:
    """A document as selectors see it."""

    def __init__(self, root: ET.Element):
        self.budget = _Budget()
        kind = type("_CountedNode", (_Node,), {"budget": self.budget})
        self.nodes = {node.etree_element: node for node in kind.from_xml_root(root).iter_subtree()}

    def compiled(self, prelude) -> list | None:
        """Selectors; None if the text is none that is read."""
        text = tinycss2.serialize(prelude)
        if "-of-type" in text:  # counts its siblings where they cannot be counted here
            self.budget.spend(
                sum(n * n for n in Counter(id(node.parent) for node in self.nodes.values()).values())
            )
        try:
            return compile_selector_list(prelude)
        except (SelectorError, SyntaxError, RecursionError, MemoryError):
            return None
