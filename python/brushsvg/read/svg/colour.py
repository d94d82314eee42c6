"""Parse the colours of SVG."""

from __future__ import annotations

import math
import re
from functools import lru_cache

from tinycss2 import color4

_HEX = re.compile("#[0-9a-fA-F]{6}")


@lru_cache
def parse_colour(value: str) -> str | None:
    """Return a colour as "#rrggbb", "#rrggbbaa", "none" or "currentcolor".

    "#rrggbbaa" stands for a transparent colour. The result is None if the value is not a colour.
    """
    if value.lower() == "none":
        return "none"
    if _HEX.fullmatch(value):
        return value.lower()
    try:
        colour = color4.parse_color(value)
        if colour is None or colour == "currentcolor":
            return colour
        *parts, alpha = colour.to("srgb")
    except (NotImplementedError, ValueError):
        return None
    shares = parts if alpha >= 1 else [*parts, alpha]
    return "#" + bytes(math.floor(255 * min(1.0, max(0.0, share)) + 0.5) for share in shares).hex()
