"""`--help`: commands by task, common options in groups on one screen, all of them with `--help-all`."""

import argparse
import re

import pytest

from brushsvg.cli import main
from brushsvg.cli.arguments.help_text import COMMANDS, RARE, TOPICS, command_text
from brushsvg.cli.arguments.parser import command_parser

MAX_LINES = {"convert": 60}  # 40 for the others


def is_listed(flag: str, text: str) -> bool:
    return bool(re.search(rf"(?m)^  (-\w[^,\n]*, )?{flag}(?![\w-])", text))


def commands() -> dict[str, argparse.ArgumentParser]:
    (found,) = (each for each in command_parser()._actions if isinstance(each, argparse._SubParsersAction))
    return found.choices


def test_every_command_is_in_one_group(capsys):
    assert sorted(name for names in COMMANDS.values() for name in names) == sorted(commands())
    assert main(["--help"]) == 0
    said = capsys.readouterr().out
    assert all(f"\n  {name} " in said for name in commands())


@pytest.mark.parametrize("name", commands())
def test_help_fits_on_a_screen_and_help_all_has_every_option(name, monkeypatch, capsys):
    monkeypatch.setenv("COLUMNS", "80")
    assert main([name, "--help"]) == 0
    short = capsys.readouterr().out
    assert len(short.splitlines()) <= MAX_LINES.get(name, 40)
    whole = command_text(commands()[name], is_whole=True)
    flags = {flag for action in commands()[name]._actions for flag in action.option_strings}
    assert flags == {flag for flag in flags if is_listed(flag, whole)}
    if flags != {flag for flag in flags if is_listed(flag, short)}:
        assert main([name, "--help-all"]) == 0
        assert capsys.readouterr().out == whole


def test_groups_name_options_that_exist():
    flags = {
        flag for each in commands().values() for action in each._actions for flag in action.option_strings
    }
    assert flags >= RARE
    assert {f"--{name}" for names in TOPICS.values() for name in names.split()} <= flags
