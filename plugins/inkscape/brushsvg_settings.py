#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-2.0-or-later
"""Store the settings of the whole job in the document.

brushsvg on the command line reads these settings as well. Inkscape cannot show the stored values in a dialog.
So the fields start with "keep the setting of the document", and a message shows the stored values.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator

from brushsvg_dialogs import show_message
from brushsvg_program import StopError, arguments, described, guarded

PREFIX = "data-brushsvg-"
OWN = {  # brushsvg's defaults, for settings that the document does not have
    "brush": "round-6",
    "compensation": "closed",
    "start": "auto",
    "end": "auto",
    "cell": "the usual machine of the format that you save",
    "wide": "auto",
    "tolerance": "0.05mm",
}
NAMES = {  # names of settings in the dialog
    "start": "beginnings",
    "end": "ends",
    "cell": "machine",
    "wide": "letters wider than the brush",
}
KEEP, TAKE_BACK = ("", "keep"), "default"
TOLERANCE_MM = (1e-5, 10.0)


def main() -> None:
    from lxml import etree

    args = arguments(**dict.fromkeys(OWN, "keep"))
    wished = {name: getattr(args, name).strip() for name in OWN}
    if wished["tolerance"] not in (*KEEP, TAKE_BACK):
        wished["tolerance"] = _tolerance(wished["tolerance"])
    document = etree.parse(args.input_file, etree.XMLParser(huge_tree=True))
    root = document.getroot()
    before = _said(root)
    for name, value in wished.items():
        if value == TAKE_BACK:
            root.attrib.pop(PREFIX + name, None)
        elif value not in KEEP:
            root.set(PREFIX + name, value)
    document.write(sys.stdout.buffer)
    show_message("\n".join([*_changes(before, _said(root)), f"The program that is used: {described()}"]))


def _tolerance(typed: str) -> str:
    least, greatest = TOLERANCE_MM
    try:
        value = float(typed.removesuffix("mm").replace(",", "."))
    except ValueError:
        raise StopError(f"{typed[:24]!r} is no tolerance: type millimetres, {TAKE_BACK}, or nothing.") from None
    if not least <= value <= greatest:
        raise StopError(f"Tolerance {value:g} mm is outside the range [{least:g}, {greatest:g}] mm.")
    return f"{value:g}mm"


def _said(root) -> dict[str, str]:
    """Return the document's settings of the whole job.

    Settings that the dialog does not have are included, for example a speed.
    """
    return {key.removeprefix(PREFIX): value for key, value in root.items() if key.startswith(PREFIX)}


def _changes(before: dict[str, str], after: dict[str, str]) -> Iterator[str]:
    yield "The document says now:" if before != after else "Nothing was changed. The document says:"
    for name in [*OWN, *(name for name in after if name not in OWN)]:
        own = f"nothing, and brushsvg takes {OWN.get(name)}"
        was = f" (before: {before.get(name, 'nothing')})" if before.get(name) != after.get(name) else ""
        called = NAMES.get(name, name) if name in OWN else PREFIX + name
        yield f"    {called}: {after.get(name, own)}{was}"


if __name__ == "__main__":
    guarded(main)
