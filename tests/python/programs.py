"""Shared parts of the program tests: cells and extensions, commands, plans."""

import re
from dataclasses import replace

from diagnostics import in_json, is_reported

from brushsvg.cli import main
from brushsvg.cli.commands.drawings import check
from brushsvg.machine.job_program import WHOLE_JOB, make_checked_program
from brushsvg.machine.paint_reload import PlanInLoads
from brushsvg.machine.preflight import check_job

LANGUAGES = {
    "linuxcnc-3axis": ".ngc",
    "grbl-3axis": ".gcode",
    "grbl-servo": ".nc",
    "fluidnc-3axis": ".ngc",
    "marlin-3axis": ".gcode",
    "klipper-3axis": ".gcode",
    "ur5e": ".script",
    "jaka-zu3": ".jks",
    "irb120": ".mod",
    "xarm6": ".py",
    "kr6-r900": ".src",
    "cr5": ".lua",
    "lrmate200id": ".ls",
    "m0609": ".drl",
    "fr3": ".csv",
    "axidraw-ebb": ".ebb",
}
SERVOS = ("grbl-servo", "axidraw-ebb")
RUNNABLE = check.RUNNABLE  # the text printed for a program without problems


def call(capsys, *words):
    """Return the exit status, standard output, and the lines of standard error."""
    status = main(list(words))
    reported = capsys.readouterr()
    return status, reported.out, reported.err.splitlines()


def whole(plan):
    """Return a plan with one load for each stroke."""
    return PlanInLoads(tuple(plan.sheet_mm), tuple(plan.passes))


def program(plan, brush, cell, header=(), job=WHOLE_JOB):
    """Return the program of a plan; raise an Error if a check forbids it."""
    return replace(make_checked_program(whole(plan), brush, cell, job).allowed(), header=header)


def forbidden(plan, brush, cell):
    return make_checked_program(whole(plan), brush, cell).problems


def problems(plan, brush, marks, cell, tolerance_mm):
    return check_job(whole(plan), brush, marks, cell, tolerance_mm).problems


def is_refused_when_damaged(capsys, path, old, new, reported, *words):
    """Return whether check accepts a program and refuses it once it is damaged.

    The damage replaces one match of a pattern. `reported` lists the codes of which one must be reported.
    """
    text = path.read_text()
    check = ("check", path, *words)
    assert in_json(capsys, *check)[0] == 0
    damaged, count = re.subn(old, new, text, count=1)
    assert count == 1
    path.write_text(damaged)
    status, _, messages = in_json(capsys, *check)
    return status == 1 and any(is_reported(messages, code) for code in reported.split("|"))
