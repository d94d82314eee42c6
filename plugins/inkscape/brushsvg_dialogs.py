# SPDX-License-Identifier: GPL-2.0-or-later
"""Show messages in the words of Inkscape's dialogs.

No dialog is opened if nobody can close it.
"""

from __future__ import annotations

import contextlib
import glob
import os
import re
import sys

UNATTENDED = (b"--batch-process", b"--export-", b"-o")  # with these, Inkscape opens no window that stays open
IN_DIALOGS = {  # code of a notice: advice for Inkscape, in place of the advice for people who type commands
    "background": "raise it above another object to paint it",
    "brush-unknown": "choose another one in Brush settings, or a brush file in this dialog",
    "cell-unknown": "choose another one in Brush settings",
    "program-format": "choose it in Brush settings",
    "lines-meet": "combine them with Path > Combine, then join their end nodes with the node tool",
    "depth-not-measured": "Object > Fill and Stroke gives all strokes one width",
    "width-out-of-reach": "passes in Brush settings fills it",
    "paper-example": "brushsvg cell new --taught, in a terminal, writes a cell to choose in Brush settings",
    "sheet-too-small": "fewer Strokes need less",
    "text-unread": "turn it into paths with Path > Object to Path, or into strokes with Extensions > Brush > Convert "
    "to strokes",
}
FLAG = re.compile(r"(?:^|[\s(`])(?:brushsvg [a-z]+ [^;]*)?--[a-z]")
REPAIR = "repair or delete it, or draw it again"  # advice for damage with any code


def in_dialogs(notice: dict) -> str:
    """Return the text of a notice, with advice for people who have no command line."""
    sentence, advice = notice["sentence"], notice["advice"]
    done = IN_DIALOGS.get(notice["code"], REPAIR if notice["damaged"] else "") if advice else ""
    if done:
        sentence = sentence[: len(sentence) - len(advice)].removesuffix("; ")
    # The rest of the sentence may name flags, which nobody can type in a dialog.
    clauses = [clause for clause in sentence.split("; ") if not FLAG.search(clause)]
    first = re.match(r"(.*?)(?:[:,] [^:,]*)?$", FLAG.split(sentence)[0].rstrip(" ,:("), re.DOTALL)[1]
    return "; ".join([*(clauses or [first]), *([done] if done else [])])


def show_message(text: str) -> None:
    """Show sentences in a dialog, or on the stderr of an unattended Inkscape.

    Inkscape shows the stderr of an extension in a dialog that waits until somebody closes it.
    """
    sys.stdout.flush()
    inkscape = _unattended_inkscape()
    if inkscape is None:
        sys.stderr.write(f"{text}\n")
        sys.stderr.flush()
        return
    with contextlib.suppress(OSError), open(f"{inkscape}/fd/2", "a", encoding="utf-8") as warnings:
        warnings.write(f"{text}\n")


def _unattended_inkscape() -> str | None:
    """Return the /proc folder of the unattended Inkscape that reads our stderr.

    Inkscape is unattended if it was started to do something and to end; else the result is None. Inkscape is
    not the parent process, because it detaches the programs that it starts. Systems other than Linux do not
    show the process.
    """
    with contextlib.suppress(OSError):
        pipe = os.readlink("/proc/self/fd/2")
        return next((each for each in glob.iglob("/proc/[0-9]*") if _is_unattended(each) and _has(each, pipe)), None)
    return None


def _is_unattended(process: str) -> bool:
    # The process may end at any time.
    with contextlib.suppress(OSError), open(f"{process}/cmdline", "rb") as file:
        program, *words = file.read().split(b"\0")
        return b"inkscape" in os.path.basename(program) and any(word.startswith(UNATTENDED) for word in words)
    return False


def _has(process: str, pipe: str) -> bool:
    with contextlib.suppress(OSError):  # a process of another user
        return pipe in (os.readlink(f"{process}/fd/{each}") for each in os.listdir(f"{process}/fd"))
    return False
