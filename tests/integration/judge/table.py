"""Judge and check damaged programs; count results by dialect, list disagreements."""

from __future__ import annotations

import difflib
import re
from collections import Counter
from dataclasses import dataclass, field

from .checked import CRASHED, put, quick_check
from .damage import damaged
from .verdict import judged
from .works import Made


@dataclass(frozen=True)
class Case:
    """One damaged program on which check and judge disagree."""

    dialect: str
    job: str
    damage: str
    verdict: str
    why: str
    refusals: tuple[str, ...]
    changed: tuple[str, ...]


@dataclass
class Figures:
    """The results. counts are by (dialect, verdict, refused)."""

    counts: Counter = field(default_factory=Counter)
    cases: list[Case] = field(default_factory=list)
    crashes: list[tuple] = field(default_factory=list)

    def of(self, dialect: str, verdict: str | None = None, refused: bool | None = None) -> int:
        return sum(
            number
            for (its, its_verdict, was), number in self.counts.items()
            if its == dialect and verdict in (None, its_verdict) and refused in (None, was)
        )

    def table(self) -> str:
        """Return the table of docs/evidence/trust.md."""
        lines = [
            "| dialect | damaged programs | dangerous | of them allowed | harmless | of them refused | neither |",
            "|---|---|---|---|---|---|---|",
        ]
        for dialect in dict.fromkeys(dialect for dialect, _, _ in self.counts):
            figures = (
                self.of(dialect),
                self.of(dialect, "dangerous"),
                self.of(dialect, "dangerous", False),
                self.of(dialect, "harmless"),
                self.of(dialect, "harmless", True),
                self.of(dialect, "neither"),
            )
            lines.append(f"| {dialect} | " + " | ".join(map(str, figures)) + " |")
        return "\n".join(lines)


def changed(before: str, after: str, most: int = 6) -> tuple[str, ...]:
    """Return the lines that differ."""
    differing = difflib.unified_diff(before.split("\n"), after.split("\n"), lineterm="", n=0)
    return tuple(line for line in differing if line[:2] not in ("--", "++", "@@"))[:most]


# The judge does not know how the brush moves between places: blends of KRL, and a servo's steps and waits.
BLENDED = re.compile(r"^(?:LIN|CIRC) .*?(C_DIS)?[ \t]*$", re.MULTILINE)
STEP_OR_WAIT = re.compile(r"^((?:M3|M280|G4|SP|S2|SM)\b[^\d\n]*)(\d*)", re.MULTILINE)
SAME_STEP = 2  # servo values up to this far apart count as equal: a few hundredths of a millimetre


def is_paced_alike(text: str, other: str) -> bool:
    """Return whether two programs blend, stop, step and wait in the same order."""
    if BLENDED.findall(text) != BLENDED.findall(other):
        return False
    ours, theirs = STEP_OR_WAIT.findall(text), STEP_OR_WAIT.findall(other)
    return len(ours) == len(theirs) and all(
        word == its
        and (value == other_value or (value and other_value and abs(int(value) - int(other_value)) <= SAME_STEP))
        for (word, value), (its, other_value) in zip(ours, theirs, strict=True)
    )


def measure(made: Made, count: int, seed: int, figures: Figures) -> None:
    """Judge and check count damaged programs of one job."""
    with quick_check() as check:
        for damage, text in damaged(made.whole.text, made.dialect, count, [seed, *made.name.encode()]):
            verdict, why = judged(text, made.whole)
            if verdict == "harmless" and not is_paced_alike(text, made.whole.text):
                verdict, why = "neither", "it stops or waits elsewhere, where paint may bleed"
            refusals = tuple(check(put(made.program, text), *made.words))
            figures.counts[made.dialect, verdict, bool(refusals)] += 1
            wrong = verdict == "harmless" and refusals
            crashed = any(CRASHED in refusal for refusal in refusals)
            figures.crashes += [(made.dialect, made.name, damage, refusals)] if crashed else []
            if wrong or crashed or (verdict == "dangerous" and not refusals) or verdict == "neither":
                lines = changed(made.whole.text, text)
                figures.cases.append(Case(made.dialect, made.name, damage, verdict, why, refusals, lines))
