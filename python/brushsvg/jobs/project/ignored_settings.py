"""Drop the settings of a project file that a command ignores.

They have no effect on this kind of drawing, or the command line, the drawing or the plan overrules them.
"""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping
from contextlib import suppress
from dataclasses import replace

from ...errors import Error
from ...machine.cells.cell_file import cell_names
from ...model.library import brush_names
from ..choices.choices import CHOICE_BY_FLAG, CHOICES, END_CHOICES, METHODS_WITHOUT_ENDS, Choices, suffix_of
from ..choices.ineffective_flags import list_ineffective_flags
from ..json_files import read_plan
from ..options import load_brush, load_cell


def drop_overruled(chosen: Choices, settings: Mapping[str, object] | None = None) -> Choices:
    """Drop project choices that are overruled or have no effect.

    The choices of this call, the settings of the drawing, and the brush that a plan names are more specific.
    A project file serves many drawings, so a choice that does not suit one of them is no mistake.
    """
    if not chosen.from_project:
        return chosen
    settings = settings or {}
    made_here = {name for name in CHOICES if getattr(chosen, name) is not None} - {*chosen.from_project}
    ineffective = {CHOICE_BY_FLAG.get(flag, flag) for flag in list_ineffective_flags(chosen.input)[0]}
    dropped = {*settings} - {"brush", "cell"} | ineffective
    if "terminals" in made_here:
        dropped |= {"start", "end"}
    for option, excluded_by in (("fit", "scale"), ("scale", "fit")):
        if excluded_by in made_here:
            dropped.add(option)
    compensation = chosen.compensation
    if "compensation" not in made_here:
        compensation = settings.get("compensation", compensation)
    if compensation != "constant":
        dropped.add("lag")
    if compensation in METHODS_WITHOUT_ENDS:
        dropped.update(END_CHOICES)
    names = settings if suffix_of(chosen.input) != ".json" else {"brush": _find_plan_brush(chosen)}
    return drop_from_project(chosen, dropped | find_overruled_names(chosen, names))


def drop_from_project(chosen: Choices, names: Iterable[str]) -> Choices:
    """Return the choices without project choices of these names.

    Choices of these names that were made elsewhere stay.
    """
    dropped = {*names} & {*chosen.from_project}
    kept = tuple(name for name in chosen.from_project if name not in dropped)
    return replace(chosen, from_project=kept, **dict.fromkeys(dropped))


def find_overruled_names(chosen: Choices, named: Mapping[str, object], unknown: bool = True) -> set[str]:
    """Return "brush" and "cell" where a source names another one than the project.

    The source is a drawing, a plan or a program.

    unknown: also count a name that is not shipped with brushsvg.
    """
    overruled = set()
    for kind, names, read in (("brush", brush_names(), load_brush), ("cell", cell_names(), load_cell)):
        name = named.get(kind)
        if name is None or kind not in chosen.from_project or not (unknown or name in names):
            continue
        if read(getattr(chosen, kind)).name != name:
            overruled.add(kind)
    return overruled


def _find_plan_brush(chosen: Choices) -> str | None:
    """Return the shipped brush of a plan, if a project file names a brush too."""
    plan = chosen.input
    if "brush" in chosen.from_project and isinstance(plan, str | os.PathLike):
        with suppress(Error):  # preparation reports what is wrong with the plan
            plan = read_plan(plan)
    name = getattr(plan, "brush", None)
    return name if name in brush_names() else None
