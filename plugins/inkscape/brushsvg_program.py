# SPDX-License-Identifier: GPL-2.0-or-later
"""Find and run the program brushsvg.

This module imports only the standard library: a live preview has no time for other imports.
"""

from __future__ import annotations

import argparse
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
from xml.etree import ElementTree

from brushsvg_dialogs import in_dialogs, show_message

NEEDED = (0, 1, 0)
INSTALL = "make demo && .venv/bin/brushsvg setup inkscape"  # in the folder of the source
DRAWING = "drawing.svg"
EXECUTABLE_NOTE = "brushsvg-executable.txt"  # written by `brushsvg setup inkscape`
# bytes of an argument: systems allow 32 768 and 131 072
LONGEST = 30_000 if sys.platform == "win32" else 120_000
# Modules that Inkscape's Python needs in addition to its own, and their packages in Debian and Ubuntu.
PACKAGES = {name: f"python3-{name}" for name in ("lxml", "cssselect", "numpy", "packaging", "tinycss2")}
# Folders in which pipx, uv, pip and Homebrew put programs, and in which pipx and uv keep environments. The
# PATH of a desktop may contain none of them. Folders with a variable that is not set are left out.
USUAL = (
    "$PIPX_BIN_DIR",
    "$UV_TOOL_BIN_DIR",
    "$XDG_BIN_HOME",
    "~/.local/bin",
    "/usr/local/bin",
    "/opt/homebrew/bin",
    "$PIPX_HOME/venvs/brushsvg/bin",
    "~/.local/share/pipx/venvs/brushsvg/bin",
    "~/.local/pipx/venvs/brushsvg/bin",
    "$UV_TOOL_DIR/brushsvg/bin",
    "$XDG_DATA_HOME/uv/tools/brushsvg/bin",
    "~/.local/share/uv/tools/brushsvg/bin",
    "~/pipx/venvs/brushsvg/Scripts",  # this and the following: Windows
    "$LOCALAPPDATA/pipx/pipx/venvs/brushsvg/Scripts",
    "$APPDATA/uv/tools/brushsvg/Scripts",
    "$APPDATA/uv/data/tools/brushsvg/Scripts",
)


class StopError(Exception):
    """A message in sentences for the user of the drawing program."""


def arguments(**choices: str) -> argparse.Namespace:
    """Return the arguments from Inkscape.

    They are the parameters with their defaults, the ids of the selected objects and the drawing's file.
    """
    parser = argparse.ArgumentParser(allow_abbrev=False)
    parser.add_argument("--id", action="append", dest="ids", default=[])
    for name, default in {"executable": "", **choices}.items():
        parser.add_argument(f"--{name}", default=default)
    parser.add_argument("input_file")
    return parser.parse_known_args()[0]


def guarded(main) -> None:
    """Run main; after a failure, show a sentence in a dialog and exit with 1."""
    try:
        main()
    except StopError as stop:
        message = str(stop)
    except OSError as problem:  # a full disk, no folder for temporary files
        message = f"{problem.filename or 'Temporary files'} cannot be written or read: {problem.strerror}."
    except ImportError as problem:
        message = _lacking((problem.name or str(problem)).partition(".")[0])
    except Exception as mistake:
        message = f"brushsvg's extension made a mistake, please report it: {type(mistake).__name__}: {mistake}"
    else:
        return
    show_message(message)
    sys.exit(1)


def _lacking(module: str) -> str:
    """Return how to install a module that the running Python lacks.

    Inkscape's packages only recommend the modules that its extensions need.
    """
    lacks = f"{sys.executable}, which Inkscape runs extensions with, lacks {module}"
    if module == "inkex":
        return f"{lacks}, which comes with Inkscape: call this from Inkscape's menu Extensions."
    package = f"the package {PACKAGES[module]} on Debian and Ubuntu, else with  " if module in PACKAGES else ""
    return f"{lacks}: install {package}{sys.executable} -m pip install {module}"


def executable(chosen: str) -> str:
    """Find the program brushsvg.

    A program chosen in the dialog comes first. Then follow PATH, the program noted when the extension was
    installed, and the usual folders.
    """
    if chosen and not os.path.isdir(chosen):  # Inkscape turns an empty choice of a file into a folder
        if shutil.which(chosen):
            return chosen
        raise StopError(f"{chosen} is not a program that can be run: choose another one under Program.")
    expanded = (os.path.expanduser(os.path.expandvars(folder)) for folder in USUAL)
    usual = os.pathsep.join(folder for folder in expanded if not folder.startswith("$"))
    found = shutil.which("brushsvg") or shutil.which(_noted()) or shutil.which("brushsvg", path=usual)
    if found is None and (sandbox := _sandbox()):
        raise StopError(
            f"This Inkscape is {sandbox}. It cannot start programs that are installed outside of its sandbox, such as "
            "brushsvg. Install Inkscape from your distribution or as an AppImage instead. Or save the drawing, and "
            "type in a terminal:  brushsvg convert DRAWING.svg -o OUT.ngc"
        )
    if found is None:
        raise StopError(
            f"The program brushsvg was not found. In the folder of its source, type:  {INSTALL}\n"
            "If it is installed already, choose its file under Program."
        )
    return found


def described() -> str:
    """Return the path of brushsvg with its version, or the reason why there is none."""
    try:
        program = executable("")
    except StopError as stop:
        return str(stop)
    return f"{program} ({_version(program) or 'it does not say its version'})"


def _sandbox() -> str:
    """Return the kind of package that hides other programs from this Inkscape, or ""."""
    if os.environ.get("FLATPAK_ID") or os.path.exists("/.flatpak-info"):
        return "a Flatpak"
    return "a Snap" if os.environ.get("SNAP") else ""


def _version(program: str) -> str:
    """Return the program's version, such as "brushsvg 0.1.0".

    The result is "" if it is another program.
    """
    try:
        answer = subprocess.run(
            [program, "--version"],
            capture_output=True,
            encoding="utf-8",
            timeout=20,
            check=False,
            env=_environment(),
        )
        found = re.match(r"brushsvg \d+\.\d+\.\d+", answer.stdout)
    except (OSError, ValueError, subprocess.TimeoutExpired):
        found = None
    return found[0] if found else ""


def _noted() -> str:
    note = os.path.join(os.path.dirname(os.path.abspath(__file__)), EXECUTABLE_NOTE)
    if not os.path.exists(note):
        return ""
    with open(note, "rb") as file:
        return os.fsdecode(file.read()).strip()


class Run:
    """One brushsvg command, started at once in a temporary folder.

    The folder holds a copy of the drawing, called DRAWING. Use Run in a `with` statement, which removes the
    folder.
    """

    def __init__(self, chosen: str, drawing: str, *words: str):
        self.program, self.words = executable(chosen), words
        quiet = [] if words[0] == "chart" else ["--quiet"]  # the page of a chart shows its report
        self.folder = tempfile.TemporaryDirectory(prefix="brushsvg")
        shutil.copyfile(drawing, os.path.join(self.folder.name, DRAWING))
        try:
            self.process = subprocess.Popen(
                [self.program, "--messages", "json", *words, *quiet],
                cwd=self.folder.name,
                stdin=subprocess.DEVNULL,
                stdout=subprocess.PIPE,
                stderr=subprocess.PIPE,
                encoding="utf-8",
                errors="replace",
                env=_environment(),
                creationflags=getattr(subprocess, "CREATE_NO_WINDOW", 0),
            )
        except OSError as problem:
            self.folder.cleanup()
            raise StopError(f"{self.program} cannot be run: {problem.strerror}.") from None

    def __enter__(self) -> Run:
        return self

    def __exit__(self, *_) -> None:
        self.process.kill()
        self.process.wait()
        self.folder.cleanup()

    def finish(self, may_refuse: bool = False) -> tuple[str, list[str]]:
        """Wait for the end; return the printed text and the lines of warnings.

        Raises StopError if brushsvg refused. With may_refuse, a refusal that printed some text is accepted.
        `save_refuses` holds the warnings for which brushsvg would write no program.
        """
        out, err = self.process.communicate()
        notices = [(line, _notice(line)) for line in err.splitlines()]
        self.save_refuses = [
            self._in_words(notice) for _, notice in notices if notice and (notice["damaged"] or notice["refused"])
        ]
        lines = [self._in_words(notice) if notice else line for line, notice in notices]
        status = self.process.returncode
        if status == 0 or (may_refuse and status == 1 and out):
            return out, lines
        if status != 1:
            self._stop_if_too_old()
        # If there is no message, the program's Python failed before brushsvg could print one.
        if not any(notice or line.startswith("brushsvg: ") for line, notice in notices):
            reason = f": {lines[-1]}" if lines else f" ({status})"
            raise StopError(
                f"{self.program} does not run{reason}\nIn the folder of its source, type:  make clean && {INSTALL}"
            )
        raise StopError("\n".join(["brushsvg refuses:", *lines]))

    def _in_words(self, notice: dict) -> str:
        """Return a line for the dialog, without names of temporary files."""
        ours = notice["file"] in self.words and os.path.basename(notice["file"]) == notice["file"]
        return ": ".join(filter(None, ("" if ours else notice["file"], notice["where"], in_dialogs(notice))))

    def made(self, name: str) -> bytes:
        path = os.path.join(self.folder.name, name)
        if not os.path.exists(path):
            self._stop_if_too_old()
            raise StopError(f"{self.program} has written nothing.")
        suffix = os.path.splitext(path)[1]
        if {each for each in os.listdir(self.folder.name) if each.endswith(suffix)} - {DRAWING, *self.words}:
            raise StopError(
                "This job is several programs, and Inkscape saves one file: save the drawing, then type  "
                f"brushsvg convert DRAWING.svg -o OUT{suffix}"
            )
        with open(path, "rb") as file:
            return file.read()

    def report(self) -> dict:
        """Return the printed report of paintable and refused objects."""
        out, _ = self.finish(may_refuse=True)
        try:
            report = json.loads(out)
            for each in (*report["refused"], *report["warnings"], *report["forbidden"]):
                each["sentence"] = in_dialogs(each)
            report["brush"]
        except (ValueError, KeyError, TypeError):
            self._stop_if_too_old()
            raise StopError(f"{self.program} has not printed a report.") from None
        return report

    def _stop_if_too_old(self) -> None:
        """Stop if the program is not brushsvg or is too old.

        Call this only after a failure: it would cost each preview a tenth of a second.
        """
        found = _version(self.program)
        if not found:
            raise StopError(f"{self.program} is not the program brushsvg: choose another one under Program.")
        if tuple(map(int, re.findall(r"\d+", found))) < NEEDED:
            needed = ".".join(map(str, NEEDED))
            raise StopError(
                f"{found} is too old: this extension needs {needed}. "
                f"In the folder of its source, type:  git pull && {INSTALL}"
            )


def _notice(line: str) -> dict | None:
    """Return the warning or refusal in a line of brushsvg, None for any other line."""
    try:
        notice = json.loads(line)
        return (
            notice if {"file", "where", "sentence", "code", "advice", "damaged", "refused"} <= notice.keys() else None
        )
    except (ValueError, AttributeError):
        return None


def root_of(drawing: str) -> dict[str, str]:
    """Return the attributes of the drawing's root element."""
    return dict(next(ElementTree.iterparse(drawing, events=("start",)))[1].attrib)


def _environment() -> dict[str, str]:
    """Return the environment without PYTHONPATH and PYTHONHOME.

    An Inkscape that brings its own Python sets them for that Python.
    """
    return {key: value for key, value in os.environ.items() if key not in ("PYTHONPATH", "PYTHONHOME")}


def choices(args: argparse.Namespace) -> list[str]:
    """Return the flags for the choices; a choice of "document" needs no flag."""
    words = []
    for flag in ("brush", "cell", "compensation"):
        said = getattr(args, flag, "document")
        file = getattr(args, f"{flag}_file", "")
        if file and os.path.isfile(file):
            said = file
        if said and said != "document":
            words += [f"--{flag}", said]
    return words


def selection(ids: list[str]) -> list[str]:
    """Return the flags for the selected objects, if there are any."""
    chosen = [re.sub(r'(["\\])', r"\\\1", each) for each in ids]
    words = ", ".join(f'[id="{each}"]' for each in chosen)
    if len(words.encode()) > LONGEST:
        raise StopError(
            f"{len(ids)} objects are selected, more than can be passed to brushsvg: select their layer or group "
            "instead, or nothing for the page."
        )
    return ["--select", words] if chosen else []


def element_of(by_id: dict, where: str):
    """Return the element of a stroke, None if it is unknown.

    where: the id, id/2 for a part of the element, id#2 for a pass, use/id for a copy; each may end in ~2 for a lane
    and +2 for a load.
    """
    whole = re.sub(r"(~\d+)?(\+\d+)?$", "", where)
    for name in (where, whole, whole.rpartition("#")[0], whole.rpartition("/")[0], whole.partition("/")[0]):
        if name in by_id:
            return by_id[name]
    return None
