"""Fill choices from the settings that a drawing contains."""

from __future__ import annotations

from dataclasses import replace

from ...errors import Error
from ...machine.cells.cell_file import cell_names
from ...model.library import brush_names
from ...read import settings_in
from ...suggestions import did_you_mean
from ..project.ignored_settings import drop_overruled
from .choice_checks import refuse_ends_without_effect, refuse_lag_without_effect
from .choices import Choices


def fill_from_drawing(chosen: Choices, drawing, alone: bool = False) -> Choices:
    """Fill choices that nobody made with the settings in the drawing.

    A drawing can only name shipped brushes and cells, because its settings read no other file.

    alone: read nothing of the drawing except its settings.
    """
    settings = settings_in(drawing, alone)
    chosen = drop_overruled(chosen, settings)
    if chosen.terminals is not None and "terminals" not in chosen.from_project:
        settings = {name: value for name, value in settings.items() if name not in ("start", "end")}
    for kind, names in (("brush", brush_names()), ("cell", cell_names())):
        if getattr(chosen, kind) is None and settings.get(kind, names[0]) not in names:
            sentence = (
                f"data-brushsvg-{kind} asks for {kind} {settings[kind]!r}, which brushsvg does not ship"
                f"{did_you_mean(settings[kind], names)} Known are {', '.join(names)}"
            )
            raise Error(sentence, where="svg", code=f"{kind}-unknown", advice=f"give --{kind}")
    filled = replace(chosen, **{name: value for name, value in settings.items() if getattr(chosen, name) is None})
    refuse_lag_without_effect(filled)
    refuse_ends_without_effect(replace(chosen, compensation=filled.compensation))
    return filled
