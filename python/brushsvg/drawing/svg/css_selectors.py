"""CSS rules of an SVG file: which declarations reach which element, by tinycss2 and cssselect2."""

from __future__ import annotations

import re
import xml.etree.ElementTree as ET
from collections import Counter
from collections.abc import Iterable, Iterator
from functools import lru_cache

import tinycss2
from cssselect2 import ElementWrapper, Matcher, SelectorError, compile_selector_list

from ...errors import Error
from ..design import Notice

# Steps through the tree that selectors may take together: some ten seconds' worth, a hundred times what drawings need.
STEP_LIMIT = 3_000_000
TEXT_LIMIT = 1_000_000  # characters of style sheets: drawing programs write a hundredth of it

Declaration = tuple[str, str, bool]  # name in lower case, value, important
_SVG = "http://www.w3.org/2000/svg"
_STYLES = (f"{{{_SVG}}}style", "{http://www.w3.org/1999/xhtml}style", "style")


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


class Rules:
    """The document's style sheets, in order. notices: what of them is not read."""

    def __init__(self, root: ET.Element):
        self.notices: list[Notice] = []
        self._matcher = Matcher()
        sheets = [node for node in root.iter() if node.tag in _STYLES and self._counts(node)]
        self._tree = Tree(root) if sheets else None
        texts = ["".join(sheet.itertext()) for sheet in sheets]
        if (length := sum(map(len, texts))) > TEXT_LIMIT:
            raise Error(
                f"its CSS of {length} characters is beyond the limit of {TEXT_LIMIT}",
                where="style",
                code="css-too-complex",
            )
        for text in texts:
            self._add(tinycss2.parse_stylesheet(text, True, True))

    def of(self, node: ET.Element) -> list[Declaration]:
        """An element's declarations, from the weakest to the strongest among those of equal importance."""
        if self._tree is None:
            return []
        self._tree.budget.spend(self._matcher.order // 10)
        matches = self._matcher.match(self._tree.nodes[node])
        return [declaration for *_, pseudo, found in matches if pseudo is None for declaration in found]

    def _add(self, rules: Iterable) -> None:
        for rule in rules:
            if rule.type == "at-rule" and rule.lower_at_keyword == "media" and rule.content is not None:
                if self._for_screens(rule.prelude):
                    self._add(tinycss2.parse_rule_list(rule.content, True, True))
            elif rule.type == "at-rule" and rule.lower_at_keyword == "import":
                self._note("@import names another file, which is not read", about="@import")
            elif rule.type == "at-rule" and rule.lower_at_keyword == "namespace":
                if not any(each.type in ("url", "string") and each.value == _SVG for each in rule.prelude):
                    self._note("@namespace is not read: its rules count for all elements", about="@namespace")
            elif rule.type == "at-rule" and rule.lower_at_keyword not in _NO_STROKES:
                name = f"@{rule.at_keyword[:40]}"
                self._note(f"{name} is not read: what it says is missing", about=name)
            elif rule.type == "error":
                self._note(
                    f"line {rule.source_line} is not CSS: {rule.message[:80]}",
                    code="css-invalid",
                    about="syntax",
                )
            elif rule.type == "qualified-rule":
                self._add_rule(rule)

    def _add_rule(self, rule) -> None:
        text = tinycss2.serialize(rule.content)
        declared = declarations(text)
        if "{" in text:
            where = tinycss2.serialize(rule.prelude).strip()[:60]
            self._note(f"rules in the rule {where!r} are not read", about="rules in rules")
        if not declared:
            return
        selectors = self._tree.compiled(rule.prelude)
        if selectors is None:
            selector = tinycss2.serialize(rule.prelude).strip()[:60]
            self._note(f"selector {selector!r} is not read", about="selector")
        for selector in selectors or ():
            self._matcher.add_selector(selector, declared)

    def _counts(self, style: ET.Element) -> bool:
        media = tinycss2.parse_component_value_list(style.get("media", ""))
        return style.get("type", "").strip().lower() in ("", "text/css") and self._for_screens(media)

    def _for_screens(self, media) -> bool:
        """Whether one of the media queries holds on a screen in daylight, or there is none; told if that is open."""
        queries = [" ".join(query.split()) for query in tinycss2.serialize(media).lower().split(",")]
        known = [_MEDIA.get(query.removeprefix("only ")) for query in queries]
        if True not in known and None in known:
            self._note(
                f"@media {queries[known.index(None)][:60]} is not read: what it says is missing",
                about="@media",
            )
        return True in known

    def _note(self, sentence: str, *, code: str = "css-unread", about: str) -> None:
        self.notices.append(Notice("style", sentence, code=code, about=about))


# What media queries say, as far as it is known beforehand.
_MEDIA = {"": True, "all": True, "screen": True, "not print": True, "(prefers-color-scheme: light)": True}
_MEDIA |= {"print": False, "speech": False, "not all": False, "not screen": False}
_MEDIA |= {"(prefers-color-scheme: dark)": False, "(prefers-color-scheme:dark)": False}
_MEDIA |= {"(prefers-color-scheme:light)": True}
# At-rules that say nothing about strokes.
_NO_STROKES = frozenset("media font-face charset keyframes -webkit-keyframes page".split())
# A declaration of one word, colour or number, as drawing programs write most: there is nothing to parse.
_PLAIN = re.compile(
    r"[ \t\n]*+([a-z][a-z-]*+)[ \t\n]*+:[ \t\n]*+"
    r"([a-zA-Z][a-zA-Z-]*+|#[0-9a-fA-F]++|-?[0-9]++(?:\.[0-9]++)?(?:%|[a-df-zA-DF-Z]*+))[ \t\n]*+"
)
_NOT_SPLIT = re.compile(r"[\"'(){}\[\]\\/]")  # where a semicolon may be part of a value


@lru_cache(4096)
def declarations(text: str) -> tuple[Declaration, ...]:
    """The declarations of a style attribute or a rule's block; what is not one is passed over, as CSS asks."""
    parts = [text] if _NOT_SPLIT.search(text) else text.split(";")
    return tuple(declaration for part in parts for declaration in _declarations(part))


def _declarations(text: str) -> tuple[Declaration, ...]:
    if plain := _PLAIN.fullmatch(text):
        return ((plain[1], plain[2], False),)
    parsed = tinycss2.parse_blocks_contents(text, skip_comments=True, skip_whitespace=True)
    return tuple(
        (each.name if each.name.startswith("--") else each.lower_name, value, each.important)
        for each in parsed
        if each.type == "declaration" and (value := tinycss2.serialize(each.value).strip())
    )
