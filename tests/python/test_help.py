"""`--help` groups commands by task and common options on one screen.

`--help-all` shows all options.
"""

import argparse
import re

import pytest

from brushsvg.cli import main
from brushsvg.cli.arguments.help_text import COMMANDS, RARE_OPTIONS, TOPICS, command_text
from brushsvg.cli.arguments.parser import command_parser

MAX_LINES = {"convert": 60}  # 40 for the other commands


def is_listed(flag: str, text: str) -> bool:
    return bool(re.search(rf"(?m)^  (-\w[^,\n]*, )?{flag}(?![\w-])", text))


def commands() -> dict[str, argparse.ArgumentParser]:
    """Return the parsers of all commands and their subcommands, such as `cell place`."""
    found: dict[str, argparse.ArgumentParser] = {}
    waiting = [("", command_parser())]
    for name, parser in waiting:
        for action in parser._actions:
            if isinstance(action, argparse._SubParsersAction):
                below = {f"{name} {word}".strip(): each for word, each in action.choices.items()}
                found |= below
                waiting += below.items()
    return found


def test_every_command_is_in_one_group(capsys):
    assert sorted(name for names in COMMANDS.values() for name in names) == sorted(
        top := {name for name in commands() if " " not in name}
    )
    assert main(["--help"]) == 0
    printed = capsys.readouterr().out
    assert all(f"\n  {name} " in printed for name in top)


@pytest.mark.parametrize("name", commands())
def test_help_fits_on_a_screen_and_help_all_has_every_option(name, monkeypatch, capsys):
    monkeypatch.setenv("COLUMNS", "80")
    assert main([*name.split(), "--help"]) == 0
    short = capsys.readouterr().out
    assert len(short.splitlines()) <= MAX_LINES.get(name, 40)
    whole = command_text(commands()[name], is_whole=True)
    flags = {flag for action in commands()[name]._actions for flag in action.option_strings}
    assert flags == {flag for flag in flags if is_listed(flag, whole)}
    assert main([*name.split(), "--help-all"]) == 0
    assert capsys.readouterr().out == whole
    left_out = {flag for flag in flags - {"--help-all"} if not is_listed(flag, short)}
    assert bool(left_out) == ("--help-all" in short), "it is named where it shows more"


def test_groups_name_options_that_exist():
    flags = {flag for each in commands().values() for action in each._actions for flag in action.option_strings}
    assert flags >= RARE_OPTIONS
    assert {f"--{name}" for names in TOPICS.values() for name in names.split()} <= flags
