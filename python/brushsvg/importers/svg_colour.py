"""Paint as SVG writes it, to "#rrggbb"."""

from __future__ import annotations

import math
import re
from functools import lru_cache

from tinycss2 import color4

_HEX = re.compile("#[0-9a-fA-F]{6}")


@lru_cache
def parse_colour(value: str) -> str | None:
    """ "#rrggbb", "none" (also for a colour that is fully transparent) or "currentcolor"; None if it is neither."""
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
    return (
        "#" + bytes(math.floor(255 * min(1.0, max(0.0, part)) + 0.5) for part in parts).hex()
        if alpha
        else "none"
    )
