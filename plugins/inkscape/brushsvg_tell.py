# SPDX-License-Identifier: GPL-2.0-or-later
"""What people are told: in the words of Inkscape's dialogs, and without a dialog where nobody is there to close it."""

from __future__ import annotations

import contextlib
import glob
import os
import re
import sys

UNATTENDED = (b"--batch-process", b"--export-", b"-o")  # with these Inkscape opens no window that stays
IN_DIALOGS = {  # what brushsvg advises those who type: what is done in Inkscape instead
    "give --brush": "choose another one in Brush settings, or a brush file in this dialog",
    "give --cell": "choose another one in Brush settings",
    "--width MM gives all strokes one width": "Object > Fill and Stroke gives all strokes one width",
    "--wide passes fills it": "passes in Brush settings fills it",
    " (--lenient draws what is sound)": ": mend or delete it, or draw it anew",
    "(brushsvg cell new --taught ...)": "in a terminal (brushsvg cell new --taught ...) and choose its file",
    "--strokes few needs less": "fewer Strokes need less",
    "in Inkscape with Path > Object to Path, or with "
    "inkscape --export-text-to-path --export-plain-svg -o out.svg in.svg": (
        "with Path > Object to Path, or into strokes with Extensions > Brush > Convert to strokes"
    ),
}


def in_dialogs(sentence: str) -> str:
    """A sentence of brushsvg with its advice worded for who has dialogs and no flags."""
    sentence = re.sub(r"give --cell ((?:[a-z0-9-]+(?: or )?)+)$", r"choose \1 in Brush settings", sentence)
    for typed, done in IN_DIALOGS.items():
        sentence = sentence.replace(typed, done)
    return sentence


def tell(text: str) -> None:
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
