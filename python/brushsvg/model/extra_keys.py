"""Read the keys of a brush file that brushsvg's core keeps without reading them."""

from __future__ import annotations

import json


def read_extra_keys(text: str) -> dict:
    """Return the JSON object in a text, or {} if there is none.

    A brush made by hand may contain anything here. A value that is no object is refused when the brush is written.
    """
    try:
        parsed = json.loads(text)
    except (ValueError, RecursionError):
        return {}
    return parsed if isinstance(parsed, dict) else {}
