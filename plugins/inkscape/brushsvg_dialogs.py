# SPDX-License-Identifier: GPL-2.0-or-later
"""Messages for people: in the words of Inkscape's dialogs, and without a dialog where nobody can close it."""

from __future__ import annotations

import contextlib
import glob
import os
import re
import sys

UNATTENDED = (b"--batch-process", b"--export-", b"-o")  # with these Inkscape opens no window that stays
IN_DIALOGS = {  # by the code of the notice: what to do in Inkscape in place of its advice for those who type
    "background": "raise it above another object to paint it",
    "brush-unknown": "choose another one in Brush settings, or a brush file in this dialog",
    "cell-unknown": "choose another one in Brush settings",
    "program-format": "choose it in Brush settings",
    "depth-not-measured": "Object > Fill and Stroke gives all strokes one width",
    "width-out-of-reach": "passes in Brush settings fills it",
    "paper-example": "brushsvg cell new --taught, in a terminal, writes a cell to choose in Brush settings",
    "sheet-too-small": "fewer Strokes need less",
    "text-unread": "turn it into paths with Path > Object to Path, or into strokes with Extensions > Brush > Convert "
    "to strokes",
}
FLAG = re.compile(r"(?:^|[\s(`])(?:brushsvg [a-z]+ [^;]*)?--[a-z]")
REPAIR = "repair or delete it, or draw it again"  # for damage of any code


def in_dialogs(notice: dict) -> str:
    """The text of a notice, with its advice worded for who has dialogs and no flags."""
    sentence, advice = notice["sentence"], notice["advice"]
    done = IN_DIALOGS.get(notice["code"], REPAIR if notice["damaged"] else "") if advice else ""
    if done:
        sentence = sentence[: len(sentence) - len(advice)].removesuffix("; ")
    # what is left may name flags: who has dialogs cannot type them
    clauses = [clause for clause in sentence.split("; ") if not FLAG.search(clause)]
    first = re.match(r"(.*?)(?:[:,] [^:,]*)?$", FLAG.split(sentence)[0].rstrip(" ,:("), re.DOTALL)[1]
    return "; ".join([*(clauses or [first]), *([done] if done else [])])


def show_message(text: str) -> None:
    """Show sentences in Inkscape's dialog, which it makes of stderr and which waits for somebody to close it.

    Where nobody will, they go where Inkscape's own warnings go.
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
    """The process, in /proc, of the Inkscape that reads our stderr, if it was called to do something and to end. (It is
    not our parent: it lets go of what it starts.) Other systems than Linux do not say."""
    with contextlib.suppress(OSError):
        pipe = os.readlink("/proc/self/fd/2")
        return next(
            (each for each in glob.iglob("/proc/[0-9]*") if _is_unattended(each) and _has(each, pipe)), None
        )
    return None


def _is_unattended(process: str) -> bool:
    with contextlib.suppress(OSError), open(f"{process}/cmdline", "rb") as file:  # it may end just now
        program, *words = file.read().split(b"\0")
        return b"inkscape" in os.path.basename(program) and any(word.startswith(UNATTENDED) for word in words)
    return False


def _has(process: str, pipe: str) -> bool:
    with contextlib.suppress(OSError):  # somebody else's
        return pipe in (os.readlink(f"{process}/fd/{each}") for each in os.listdir(f"{process}/fd"))
    return False
