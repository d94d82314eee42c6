"""The style sheets of an SVG document, parsed with tinycss2 and cssselect2."""

from __future__ import annotations

import re
import xml.etree.ElementTree as ET
from collections.abc import Iterable

import tinycss2
from cssselect2 import Matcher, compile_selector_list

from ....errors import Error
from ...design import Notice
from .declarations import Declaration, declarations
from .selectors import Tree

TEXT_LIMIT = 1_000_000  # characters of all style sheets; drawing programs write a hundredth of this

_SVG_NAMESPACE = "http://www.w3.org/2000/svg"
_ROOT_SELECTOR = re.compile(r":(?:root|scope)\b", re.IGNORECASE)
_STYLE_TAGS = (f"{{{_SVG_NAMESPACE}}}style", "{http://www.w3.org/1999/xhtml}style", "style")


class StyleSheets:
    """The style sheets of a document, in order.

    notices: about the parts that are not read.
    """

    def __init__(self, root: ET.Element):
        self.notices: list[Notice] = []
        self._matcher, self._copy_matcher = Matcher(), Matcher()
        self._copy_trees: dict[ET.Element, Tree] = {}
        self._sibling_count_rules = 0  # number of rules that count siblings of a type
        sheets = [node for node in root.iter() if node.tag in _STYLE_TAGS and self._applies(node)]
        self._tree = Tree(root) if sheets else None
        texts = ["".join(sheet.itertext()) for sheet in sheets]
        if (length := sum(map(len, texts))) > TEXT_LIMIT:
            sentence = f"its CSS of {length} characters is beyond the limit of {TEXT_LIMIT}"
            raise Error(sentence, where="style", code="css-too-complex")
        for text in texts:
            self._add_rules(tinycss2.parse_stylesheet(text, True, True))

    def declarations_for(self, node: ET.Element, copied: ET.Element | None = None) -> list[Declaration]:
        """Return the declarations for an element.

        Among declarations of equal importance, the strongest is last.

        copied: for an element inside a copy, the element that a `use` copies. Selectors then see the copied element
        and its content only, as SVG 2 (5.6.3) prescribes.
        """
        if self._tree is None:
            return []
        self._tree.budget.spend(self._matcher.order // 10)
        if copied is None:
            matches = self._matcher.match(self._tree.nodes[node])
        else:
            matches = self._copy_matcher.match(self._copy_tree(copied).nodes[node])
        return [declaration for *_, pseudo, found in matches if pseudo is None for declaration in found]

    def _copy_tree(self, copied: ET.Element) -> Tree:
        if copied not in self._copy_trees:
            tree = self._copy_trees[copied] = Tree(copied, self._tree.budget)
            tree.budget.spend(len(tree.nodes))
            for _ in range(self._sibling_count_rules):
                tree.spend_sibling_counts()
        return self._copy_trees[copied]

    def _add_rules(self, rules: Iterable) -> None:
        for rule in rules:
            if rule.type == "at-rule" and rule.lower_at_keyword == "media" and rule.content is not None:
                if self._matches_screen(rule.prelude):
                    self._add_rules(tinycss2.parse_rule_list(rule.content, True, True))
            elif rule.type == "at-rule" and rule.lower_at_keyword == "import":
                self._note("@import names another file, which is not read", about="@import")
            elif rule.type == "at-rule" and rule.lower_at_keyword == "namespace":
                if not any(token.type in ("url", "string") and token.value == _SVG_NAMESPACE for token in rule.prelude):
                    self._note("@namespace is not read: its rules count for all elements", about="@namespace")
            elif rule.type == "at-rule" and rule.lower_at_keyword not in _IRRELEVANT_AT_RULES:
                name = f"@{rule.at_keyword[:40]}"
                self._note(f"{name} is not read: its rules are ignored", about=name)
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
        selectors = self._tree.compile_selectors(rule.prelude)
        if selectors is None:
            selector = tinycss2.serialize(rule.prelude).strip()[:60]
            self._note(f"selector {selector!r} is not read", about="selector")
        for selector in selectors or ():
            self._matcher.add_selector(selector, declared)
        # The root of a copy is not the root of a document, so :root must not match it.
        text = tinycss2.serialize(rule.prelude)
        self._sibling_count_rules += "-of-type" in text
        for selector in (selectors and compile_selector_list(_ROOT_SELECTOR.sub(":host", text))) or ():
            self._copy_matcher.add_selector(selector, declared)

    def _applies(self, style: ET.Element) -> bool:
        media = tinycss2.parse_component_value_list(style.get("media", ""))
        return style.get("type", "").strip().lower() in ("", "text/css") and self._matches_screen(media)

    def _matches_screen(self, media) -> bool:
        """Whether a media query matches a screen with a light colour scheme.

        An empty query matches. A query that is not known is reported.
        """
        queries = [" ".join(query.split()) for query in tinycss2.serialize(media).lower().split(",")]
        known = [_MEDIA_QUERIES.get(query.removeprefix("only ")) for query in queries]
        if True not in known and None in known:
            self._note(
                f"@media {queries[known.index(None)][:60]} is not read: its rules are ignored",
                about="@media",
            )
        return True in known

    def _note(self, sentence: str, *, code: str = "css-unread", about: str) -> None:
        self.notices.append(Notice("style", sentence, code=code, about=about))


# Results of the media queries that are known.
_MEDIA_QUERIES = {
    "": True,
    "all": True,
    "screen": True,
    "not print": True,
    "(prefers-color-scheme: light)": True,
}
_MEDIA_QUERIES |= {"print": False, "speech": False, "not all": False, "not screen": False}
_MEDIA_QUERIES |= {"(prefers-color-scheme: dark)": False, "(prefers-color-scheme:dark)": False}
_MEDIA_QUERIES |= {"(prefers-color-scheme:light)": True}
# At-rules that do not affect strokes, or are read elsewhere.
_IRRELEVANT_AT_RULES = frozenset("media font-face charset keyframes -webkit-keyframes page".split())
