"""Take settings that were not typed from the project file.

With --explain, print where each setting comes from.
"""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Iterable
from dataclasses import replace

from ...errors import Notice
from ...jobs.project import Project, find_project_file, read_project
from ..console import refuse_errors, say, say_notice

# The settings of a project file that an option excludes, by the dest of the option.
EXCLUDED_BY = {"per_colour": ("colour", "margin_strokes")}
# Settings that the header of a program may name, in place of the project file.
PROGRAM_SETTINGS = ("brush", "cell", "sheet", "z_offset")


def use_project(args, argv: list[str] | None) -> None:
    """Fill options that were not typed from the project file.

    This concerns commands with --explain. The filled options are in `args.from_project`: settings in the drawing
    still take precedence, see jobs.project.ignored_settings.
    """
    if "explain" not in args:
        return
    start_path = _find_start_path(args)
    path = find_project_file(start_path)
    if path is None and not args.explain:
        return
    with refuse_errors(path or ""):
        project = read_project(path) if path else Project("")
    typed_options = _find_typed_options(args, sys.argv[1:] if argv is None else argv)
    settable_options = _list_settable_options(args.parser)
    excluded = {name for dest in EXCLUDED_BY if getattr(args, dest, False) for name in EXCLUDED_BY[dest]}
    if _writes_plan(args):  # the poses of a plan are relative to the paper, at any height of the paper
        excluded.add("z_offset")
    if getattr(args, args.project_near or "", None) is None:  # without a drawing, these have no effect
        excluded |= {*settable_options} - {*PROGRAM_SETTINGS}
    filled = [name for name in project.settings if name in settable_options and name not in typed_options | excluded]
    for name in filled:
        value = project.settings[name]
        is_listed = isinstance(settable_options[name], argparse._AppendAction)
        setattr(args, name, value if not is_listed or isinstance(value, list) else [value])
    # A list of all brushes has the shipped brushes and the project's brush, not the brush that the drawing names.
    args.from_project = tuple(name for name in filled if not (name == "brush" and getattr(args, "all_brushes", False)))
    if args.explain:
        _print_sources(args, project, typed_options)
    elif filled and args.messages == "text" and not getattr(args, "quiet", False):
        # A file in a parent folder must not change a program without a message.
        used = _list_used_flags(args, filled, settable_options)
        if used:
            say(path or "", f"settings used: {used}; --explain lists where each comes from")


def _list_used_flags(args, filled: list[str], settable_options: dict[str, argparse.Action]) -> str:
    """List the options that have their values from the project file; "" if there are none.

    Options that the command line or the drawing overrules, or that do not suit the drawing, are left out.
    """
    final_names = _make_final_choices(args).from_project
    used = [name for name in filled if name in final_names or name not in args.from_project]
    of_program = [name for name in used if _is_of_program(args) and name in PROGRAM_SETTINGS]
    certain = ", ".join(_get_flag(settable_options[name]) for name in used if name not in of_program)
    if not of_program:
        return certain
    uncertain = ", ".join(_get_flag(settable_options[name]) for name in of_program)
    return "; ".join(filter(None, [certain, f"{uncertain} unless the program names another"]))


def _writes_plan(args) -> bool:
    output = args.format if "format" in args else getattr(args, "output", None)
    return str(output).lower().endswith(".json")


def _find_start_path(args) -> str:
    """Return where the project file is searched: at the first drawing, the program, or the current folder."""
    given = getattr(args, args.project_near or "", None)
    if isinstance(given, list):
        given = given[0] if given else getattr(args, "words", None)
    return given or getattr(args, "program", None) or os.curdir


def _list_settable_options(parser: argparse.ArgumentParser) -> dict[str, argparse.Action]:
    """Return the options that a project file can set, by the names of their choices."""
    from ...jobs.choices.choices import CHOICES

    actions = {action.dest: action for action in parser._actions if action.option_strings}
    return {name: actions[name] for name in CHOICES if name in actions}


def _find_typed_options(args, argv: Iterable[str]) -> set[str]:
    """Return the dests of typed options; flags are never abbreviated, and no option's value equals one."""
    arguments = list(argv)
    arguments = arguments[: arguments.index("--")] if "--" in arguments else arguments
    flags = {word.partition("=")[0] for word in arguments}
    return {action.dest for action in args.parser._actions if flags & {*action.option_strings}}


def _print_sources(args, project: Project, typed: set[str]) -> None:
    """Print a line for each setting: its name, its value, and where it comes from."""
    final_choices = _make_final_choices(args)
    rows = [
        (
            _get_flag(action),
            *_describe_source(args, project, typed, name, getattr(final_choices, name), final_choices.from_project),
        )
        for name, action in _list_settable_options(args.parser).items()
    ]
    widths = [max(len(row[column]) for row in rows) for column in (0, 1)]
    for name, value, source in rows:
        if args.messages == "json":
            say_notice(_find_start_path(args), Notice(name, f"{value}, from {source}", code="setting-explained"))
        else:
            say(f"{name:<{widths[0]}}  {value:<{widths[1]}}  {source}")


def _get_flag(action: argparse.Action) -> str:
    return next(flag for flag in action.option_strings if flag.startswith("--"))[2:]


def _make_final_choices(args):
    """Return the choices as the command makes them; raise RefusedError if the drawing cannot be read."""
    from ...jobs.project.ignored_settings import drop_overruled
    from ...read import settings_in
    from . import options

    given = getattr(args, args.project_near or "", None)
    drawing = given if isinstance(given, str) else None
    chosen = options.make_choices(args, input=drawing)
    if drawing is None:
        return chosen
    if not _is_of_program(args):
        return options.apply_drawing_settings(chosen, drawing, alone=args.project_near != "input")
    with refuse_errors(drawing):
        drawing_settings = settings_in(drawing)
    settings = {name: value for name, value in drawing_settings.items() if name not in ("brush", "cell")}
    chosen = drop_overruled(chosen, settings)
    return replace(chosen, **{name: settings[name] for name in settings if getattr(chosen, name) is None})


def _describe_source(args, project: Project, typed, name: str, value, from_project) -> tuple[str, str]:
    """Return the value of a setting and where it comes from."""
    if name in typed:
        return _format_value(value), "command line"
    if name in from_project or (name in project.settings and value == project.settings[name]):
        exception = ", unless the program names another" if _is_of_program(args) and name in PROGRAM_SETTINGS else ""
        return _format_value(value), project.path + exception
    default = getattr(args, name)
    if value is None or value == default:
        return _format_default(args, name, value), "default"
    return _format_value(value), f"drawing {_find_start_path(args)}"


def _format_default(args, name: str, value) -> str:
    from ...jobs.options import DEFAULT_BRUSH, DEFAULTS
    from ...jobs.setting_up import DEFAULT_SHEET_MM
    from ...machine.cells.cell_file import DEFAULT_CELL

    if value is not None:
        return _format_value(value)
    if _is_of_program(args) and name in ("brush", "cell", "sheet", "z_offset"):
        return "the program's"
    if name == "brush" and _find_start_path(args).lower().endswith(".json"):
        return "the plan's"
    if name == "sheet" and getattr(args, args.project_near or "", None) is None:
        return _format_value(DEFAULT_SHEET_MM)
    defaults = {"brush": DEFAULT_BRUSH, "cell": DEFAULT_CELL, "terminals": "auto", "paint_speed": None}
    return _format_value(defaults.get(name, getattr(DEFAULTS, name, getattr(DEFAULTS, f"{name}_mm", None))))


def _is_of_program(args) -> bool:
    """Return whether the command reads a program, whose header says how it was made."""
    return "program" in args


def _format_value(value) -> str:
    if value is None or value == ():
        return "-"
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, list):
        return " ".join(map(_format_value, value))
    if isinstance(value, tuple):
        return ("x" if len(value) == 2 else ",").join(f"{number:g}" for number in value)
    return f"{value:g}" if isinstance(value, float) else str(value)
