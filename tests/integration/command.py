"""Run the installed command as a shell would, with small drawings for it."""

import json
import os
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

from diagnostics import heard

from brushsvg.errors import Notice
from brushsvg.model.library import SHIPPED

COMMAND = Path(sys.executable).with_name("brushsvg")
OPEN = '<svg xmlns="http://www.w3.org/2000/svg" width="120mm" height="60mm" viewBox="0 0 120 60">'
LINE = '<path id="line" d="M20 40 C40 10 60 10 90 30" fill="none" stroke="#203060" stroke-width="3"/>'
SOUND = f"{OPEN}<title>A line</title>{LINE}</svg>"


@dataclass(frozen=True)
class Done:
    status: int
    out: str
    err: tuple[str, ...]

    @property
    def reported(self) -> list[tuple[str, Notice]]:
        """Return the notices of `--messages json`, each with its file."""
        return heard(self.err)


def brushsvg(*words, cwd, status=None, env=None, before=(), timeout_s=60, **settings) -> Done:
    """Run the installed command and check its output.

    status is the required exit status. stderr must hold only our lines, or JSON if it was requested. before
    holds words of a program that starts the command. env holds changes to the environment; None removes a
    variable.
    """
    environment = {**os.environ, **(env or {})}
    done = subprocess.run(
        [*map(str, before), str(COMMAND), *map(str, words)],
        cwd=cwd,
        env={key: value for key, value in environment.items() if value is not None},
        capture_output=True,
        encoding="utf-8",
        timeout=timeout_s,
        check=False,
        **settings,
    )
    err = tuple(done.stderr.splitlines())
    ours = ("brushsvg: ", '{"file": ') if "--messages" in words else "brushsvg: "
    assert all(line.startswith(ours) for line in err), done.stderr
    assert "this should not happen" not in done.stderr, done.stderr
    if status is not None:
        assert done.returncode == status, (words, done.returncode, done.stderr)
    return Done(done.returncode, done.stdout, err)


def brush_file(name: str) -> dict:
    return json.loads((SHIPPED / f"{name}.json").read_text(encoding="utf-8"))


def path(d, width="3"):
    return f'{OPEN}<path id="p" d="{d}" fill="none" stroke="#000" stroke-width="{width}"/></svg>'


def listing(folder):
    return {str(each.relative_to(folder)): each.read_bytes() if each.is_file() else None for each in folder.rglob("*")}


def refused(folder, *words, status=1, **settings):
    """Run a command that must be refused, and return the sentence of its refusal.

    The refusal must be one sentence, and no file may change.
    """
    before = listing(folder)
    done = brushsvg(*words, cwd=folder, status=status, **settings)
    assert done.out == ""
    assert len(done.err) == 1, done.err
    assert listing(folder) == before
    return done.err[0].removeprefix("brushsvg: ")


def refusal(folder, *words, **settings) -> tuple[str, Notice]:
    """Run a command that must be refused; return the file and its notice."""
    (reported,) = heard([refused(folder, "--messages", "json", *words, **settings)])
    return reported
