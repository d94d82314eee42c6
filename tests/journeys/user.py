"""Run the public commands as a user types them, for journeys that read from top to bottom."""

import shlex
from pathlib import Path

from brushsvg.cli import main

STUDIO = 'format = "brushsvg/studio"\nversion = 1\n[camera]\nlong_side_px = 1500\n'


class User:
    """A user who types commands in a folder. `capsys` collects their output."""

    def __init__(self, folder: Path, capsys, monkeypatch):
        self.folder, self._capsys = folder, capsys
        monkeypatch.chdir(folder)

    def types(self, command: str) -> str:
        """Type `brushsvg COMMAND`, which must succeed, and return its output."""
        status = main(shlex.split(command))
        printed = self._capsys.readouterr()
        assert status == 0, f"brushsvg {command}\n{printed.err}"
        return printed.out

    def saves(self, name: str, text: str) -> None:
        self.folder.joinpath(name).write_text(text)

    def reads(self, name: str) -> str:
        return self.folder.joinpath(name).read_text()
