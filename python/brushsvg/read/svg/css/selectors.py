"""CSS selectors held against an SVG tree, within bounds, by cssselect2."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections import Counter
from collections.abc import Iterator

import tinycss2
from cssselect2 import ElementWrapper, SelectorError, compile_selector_list

from ....errors import Error

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
    """A document, or the copied part of it, as selectors see it. budget: of the document that it is copied from."""

    def __init__(self, root: ET.Element, budget: _Budget | None = None):
        self.budget = budget or _Budget()
        kind = type("_CountedNode", (_Node,), {"budget": self.budget})
        self.nodes = {node.etree_element: node for node in kind.from_xml_root(root).iter_subtree()}

    def spend_of_type(self) -> None:
        """What a selector takes that counts siblings of a type, where they cannot be counted here."""
        counts = Counter(id(node.parent) for node in self.nodes.values()).values()
        self.budget.spend(sum(n * n for n in counts))

    def compiled(self, prelude) -> list | None:
        """Selectors; None if the text is none that is read."""
        if "-of-type" in tinycss2.serialize(prelude):
            self.spend_of_type()
        try:
            return compile_selector_list(prelude)
        except (SelectorError, SyntaxError, RecursionError, MemoryError):
            return None
        except (AttributeError, TypeError):  # tinycss2 1.5 meets the end of ":nth-child(2n +)" unprepared
            return None
