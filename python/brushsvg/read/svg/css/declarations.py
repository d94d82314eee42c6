"""Parse CSS declarations of style attributes and rules, with tinycss2."""

from __future__ import annotations

import re
from functools import lru_cache

import tinycss2

Declaration = tuple[str, str, bool]  # name in lower case, value, important
# A declaration of one word, colour or number, as drawing programs write most of them. It needs no parser.
_SIMPLE_DECLARATION = re.compile(
    r"[ \t\n]*+([a-z][a-z-]*+)[ \t\n]*+:[ \t\n]*+"
    r"([a-zA-Z][a-zA-Z-]*+|#[0-9a-fA-F]++|-?[0-9]++(?:\.[0-9]++)?(?:%|[a-df-zA-DF-Z]*+))[ \t\n]*+"
)
_UNSPLITTABLE = re.compile(r"[\"'(){}\[\]\\/]")  # with these characters a semicolon may be part of a value


@lru_cache(4096)
def declarations(text: str) -> tuple[Declaration, ...]:
    """Return the declarations of a style attribute or the block of a rule.

    Invalid parts are ignored, as CSS prescribes.
    """
    parts = [text] if _UNSPLITTABLE.search(text) else text.split(";")
    return tuple(declaration for part in parts for declaration in _parse_declarations(part))


def _parse_declarations(text: str) -> tuple[Declaration, ...]:
    if simple := _SIMPLE_DECLARATION.fullmatch(text):
        return ((simple[1], simple[2], False),)
    parsed = tinycss2.parse_blocks_contents(text, skip_comments=True, skip_whitespace=True)
    return tuple(
        (node.name if node.name.startswith("--") else node.lower_name, value, node.important)
        for node in parsed
        if node.type == "declaration" and (value := tinycss2.serialize(node.value).strip())
    )
