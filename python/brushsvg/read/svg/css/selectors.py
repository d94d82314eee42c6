"""Match CSS selectors against an SVG tree with cssselect2, with limited work."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections import Counter
from collections.abc import Iterator

import tinycss2
from cssselect2 import ElementWrapper, SelectorError, compile_selector_list

from ....errors import Error

# Steps through the tree that all selectors together may take. The limit corresponds to about ten seconds and is a
# hundred times the need of real drawings.
STEP_LIMIT = 3_000_000


class _StepBudget:
    def __init__(self):
        self.left = STEP_LIMIT

    def spend(self, steps: int) -> None:
        self.left -= steps
        if self.left < 0:
            sentence = "its CSS selectors take too long on a drawing of this size"
            raise Error(sentence, where="style", code="css-too-complex")


class _CountingNode(ElementWrapper):
    """A node that walks to its relatives one by one and counts the steps.

    Lists of relatives would need memory in proportion to the square of the depth.
    """

    budget: _StepBudget

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
    """A document, or a copied part of a document, as selectors see it.

    budget: for a copied part, the budget of its document.
    """

    def __init__(self, root: ET.Element, budget: _StepBudget | None = None):
        self.budget = budget or _StepBudget()
        kind = type("_CountedNode", (_CountingNode,), {"budget": self.budget})
        self.nodes = {node.etree_element: node for node in kind.from_xml_root(root).iter_subtree()}

    def spend_sibling_counts(self) -> None:
        """Spend the estimated steps of a selector that counts siblings of a type.

        cssselect2 takes these steps itself, so they cannot be counted one by one.
        """
        counts = Counter(id(node.parent) for node in self.nodes.values()).values()
        self.budget.spend(sum(n * n for n in counts))

    def compile_selectors(self, prelude) -> list | None:
        """Return the compiled selectors of a prelude, None if they cannot be read."""
        if "-of-type" in tinycss2.serialize(prelude):
            self.spend_sibling_counts()
        try:
            return compile_selector_list(prelude)
        except (SelectorError, SyntaxError, RecursionError, MemoryError):
            return None
        except (AttributeError, TypeError):  # tinycss2 1.5 fails at the end of ":nth-child(2n +)"
            return None


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
