"""Report keys of a brush file that brushsvg does not know, and which of them are mistyped."""

from __future__ import annotations

import json

from .. import _core
from ..errors import Notice
from ..suggestions import nearest_name
from .confidence import LAWS, LEARNED
from .extra_keys import read_extra_keys

# Keys of a brush file, see docs/reference/brush.md.
_KEYS = (
    *(
        "format",
        "version",
        "name",
        "kind",
        "about",
        LEARNED,
        "depth_range_mm",
        "max_speed_mm_s",
        "paint_depth_mm",
    ),
    *(*LAWS, "covariance", "footprints", "paint"),
)
_KEYS_OF_FOOTPRINTS = ("dragged", "pressed", "source", "assumed", "standard_error_mm")
_KEYS_OF_LAW = (
    *("coefficients", "floor", "floor_slope", "calibrated_mm", "source", "assumed"),
    *("half_interval_95", "rmse_mm", "degrees_of_freedom"),
)
_KEYS_OF_PAINT = (
    *("narrows_per_m", "lasts_mm", "calibrated_mm", "source", "assumed"),
    *("covariance", "degrees_of_freedom"),
)


def unknown_keys(brush: _core.Brush) -> list[Notice]:
    """Return a notice for each key of a brush file that brushsvg does not know.

    Such a key is kept and has no effect.
    """
    entries = read_extra_keys(brush.extra)
    tables = [
        ("", entries, _KEYS),
        ("footprints.", read_extra_keys(json.dumps(entries.get("footprints"))), _KEYS_OF_FOOTPRINTS),
    ]
    tables += [(f"{law}.", read_extra_keys(getattr(brush, law).extra), _KEYS_OF_LAW) for law in LAWS]
    if brush.paint:
        tables.append(("paint.", read_extra_keys(brush.paint.extra), _KEYS_OF_PAINT))
    return [
        _make_unknown_notice(where + key, where, key, known)
        for where, entries, known in tables
        for key in entries
        if key not in known
    ]


def _make_unknown_notice(path: str, where: str, key: str, known: tuple[str, ...]) -> Notice:
    near = nearest_name(key, known)
    hint = f"; did you mean {where}{near}?" if near else ""
    return Notice(
        path,
        f"this key is not known and has no effect{hint}",
        code="key-unknown",
        about=near,
    )


def mistyped_keys(brush: _core.Brush) -> list[Notice]:
    """Return notices for unknown keys that may be mistyped.

    Other unknown keys may be notes that somebody keeps in the file. They are not reported.
    """
    mistyped = [notice for notice in unknown_keys(brush) if notice.about]
    return [
        Notice(f"brush {brush.name}", f"{notice.where}: {notice.sentence}", code=notice.code) for notice in mistyped
    ]
