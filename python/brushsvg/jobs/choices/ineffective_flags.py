"""Report flags that have no effect on a kind of drawing."""

from __future__ import annotations

from collections.abc import Iterable

from ...errors import Notice
from ...machine.posts import GCODE
from .choices import CHOICE_BY_FLAG, Choices, suffix_of

GCODE_FLAGS = ("pen", "paper-z", "skip-region", "skip-comment")
LAYOUT_FLAGS = (
    *"sheet units select layer background".split(),
    *GCODE_FLAGS,
    *"width fit scale origin as".split(),
)
PLANNING_FLAGS = tuple(
    "wide corners detail script join compensation lag tolerance terminals start end margin-strokes".split()
)


def list_ineffective_flags(source) -> tuple[tuple[str, ...], str]:
    """Return the flags that have no effect on this kind of drawing, and the kind in words."""
    suffix = suffix_of(source)
    if suffix == ".json":
        return (*LAYOUT_FLAGS, *PLANNING_FLAGS), "a plan, whose poses are fixed"
    if suffix in GCODE:
        return ("units", "select", "background"), "G-code"
    if suffix == ".dxf":
        return (*GCODE_FLAGS, "select", "background"), "a DXF"
    if suffix in (".svg", ".svgz"):
        return (*GCODE_FLAGS, "units"), "an SVG"
    return (() if source is None else GCODE_FLAGS), "a drawing that is not G-code"


def report_ineffective_flags(chosen: Choices) -> list[Notice]:
    """Return notices on the flags that have no effect on this kind of drawing, or on its paths as they are read."""
    flags, subject = list_ineffective_flags(chosen.input)
    notices = report_flags_without_effect(chosen, flags, subject)
    if chosen.paths_as == "outline":
        of_lines = [flag for flag in ("width", "join") if flag not in flags]
        notices += report_flags_without_effect(chosen, of_lines, "outlines, as --as outline reads all paths")
    return notices


def report_flags_without_effect(chosen: Choices, flags: Iterable[str], subject: str) -> list[Notice]:
    """Return a notice on each of these flags that was given.

    Settings of a project file are no mistake: they serve many drawings and commands.

    subject: what the flags have no effect on, in words.
    """
    names = {flag: CHOICE_BY_FLAG.get(flag, flag) for flag in flags}
    return [
        Notice("", f"--{flag} has no effect on {subject}", code="flag-without-effect", about=flag)
        for flag, name in names.items()
        if getattr(chosen, name) is not None and name not in chosen.from_project
    ]
