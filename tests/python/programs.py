"""What tests of `brushsvg check` share: shipped cells with their extension, and a call of the command."""

from brushsvg.cli import main

LANGUAGES = {
    "linuxcnc-3axis": ".ngc",
    "grbl-3axis": ".gcode",
    "grbl-servo": ".nc",
    "ur5e": ".script",
}


def call(capsys, *words):
    """Exit status, standard output, and the lines of standard error."""
    status = main(list(words))
    told = capsys.readouterr()
    return status, told.out, told.err.splitlines()
