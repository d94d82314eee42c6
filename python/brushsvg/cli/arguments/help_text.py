"""Help in groups: commands by task, and options by topic.

Common options come first, and --help-all shows all options.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterable

COMMANDS = {
    "Start": ("demo", "init", "doctor"),
    "Drawings": ("text", "preview", "convert", "check", "batch"),
    "Machines": ("cell", "setup"),
    "Brushes": ("brush", "chart", "calibrate", "compare"),
    "Research": ("simulate-photo",),
}
TOPICS = {
    "output": "output show picture marks-picture page report playback band editable details json all-brushes",
    "brush and machine": "brush cell speed z-offset compensation lag tolerance corrections",
    "size and place": "sheet fit scale origin units",
    "what is painted": "layer select colour background width as lenient pen paper-z skip-region skip-comment",
    "strokes": "wide detail terminals start end corners script join order from-stroke margin-strokes per-colour",
}
HELP_ALL = "--help-all"
# Options that only --help-all shows.
RARE_OPTIONS = {
    f"--{name}"
    for name in (
        "z-offset compensation lag tolerance corrections origin units select colour background width as lenient pen "
        "paper-z skip-region skip-comment start end corners script join order from-stroke margin-strokes norm total "
        "spread height dpi mirrored prior noise aim paint playback editable at-least explain"
    ).split()
}
# Options that are common in convert and rare in other commands.
COMMON_IN_CONVERT = {f"--{name}" for name in "explain wide detail terminals scale speed".split()}
# A command with more options than this shows its rare options only with --help-all.
MAX_UNGROUPED_OPTIONS = 12


def commands_text(parser: argparse.ArgumentParser, commands: argparse._SubParsersAction) -> str:
    """Return the help of the program itself."""
    helps = {each.dest: each.help for each in commands._choices_actions}
    lines = [f"usage: {parser.prog} COMMAND ...", "", parser.description or ""]
    for title, names in COMMANDS.items():
        lines += ["", f"{title}:", *(f"  {name:<16}{helps[name]}" for name in names)]
    options = [
        f"  {', '.join(action.option_strings):<16}{action.help}" for action in parser._actions if action.option_strings
    ]
    return "\n".join([*lines, "", "Options:", *options, "", f"{parser.prog} COMMAND --help explains a command.", ""])


def group_options(parser: argparse.ArgumentParser) -> None:
    """Sort the options of a command into the groups of its help.

    Options without a topic stay with the output.
    """
    own_options = parser._optionals
    own_options.title = "output and more" if len(own_options._group_actions) > MAX_UNGROUPED_OPTIONS else "options"
    for title, names in TOPICS.items() if len(own_options._group_actions) > MAX_UNGROUPED_OPTIONS else ():
        flags = {f"--{name}" for name in names.split()}
        topic_options = [action for action in own_options._group_actions if flags & {*action.option_strings}]
        if topic_options:
            topic_options.sort(
                key=lambda action: min(names.split().index(flag[2:]) for flag in flags & {*action.option_strings})
            )
            parser.add_argument_group(title)._group_actions.extend(topic_options)
            for action in topic_options:
                own_options._group_actions.remove(action)
    parser._action_groups.remove(own_options)
    parser._action_groups.append(own_options)


def command_text(parser: argparse.ArgumentParser, is_whole: bool) -> str:
    """Return the help of a command.

    is_whole: include its rare options.
    """
    options = [action for action in parser._actions if action.option_strings and HELP_ALL not in action.option_strings]
    rare = RARE_OPTIONS if parser.prog.endswith(" convert") else RARE_OPTIONS | COMMON_IN_CONVERT
    is_long = len(options) > MAX_UNGROUPED_OPTIONS and not is_whole
    hidden = [action for action in options if is_long and rare & {*action.option_strings}]
    unlisted = [*hidden, *(action for action in parser._actions if HELP_ALL in action.option_strings and not is_whole)]
    saved_help = {action: action.help for action in unlisted}
    for action in unlisted:
        action.help = argparse.SUPPRESS
    parser.usage = " ".join([parser.prog, *_list_operands(parser._actions)])
    text = argparse.ArgumentParser.format_help(parser)
    parser.usage = None
    for action, help_words in saved_help.items():
        action.help = help_words
    hint = f"\n{HELP_ALL} shows {len(hidden)} more options.\n"
    return text + hint * bool(hidden)


def _list_operands(actions: Iterable[argparse.Action]) -> list[str]:
    """Return [options], then the operands and options that a command requires."""
    parts = ["[options]"]
    for action in actions:
        name = action.metavar if isinstance(action.metavar, str) else action.dest
        if isinstance(action, argparse._SubParsersAction):
            parts.append(f"{name} ...")
        elif action.option_strings and action.required:
            parts.append(f"{action.option_strings[0]} {name}")
        elif not action.option_strings and action.help != argparse.SUPPRESS:
            by_count = {None: name, "?": f"[{name}]", "*": f"[{name} ...]", "+": f"{name} [{name} ...]"}
            parts.append(by_count.get(action.nargs, name))
    return parts
