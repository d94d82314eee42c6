"""A fault to plant, and the choice of faults over all folders of the sources."""

from __future__ import annotations

import json
import random
from collections import Counter
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field
from pathlib import Path, PurePosixPath

BUILD = "build/faults"  # in the planted tree
EXAMPLES = ("01_first_word", "11_custom_post")  # C++ examples that write programs
NUMBER = "@K@"  # replaced by the fault's number in the text of an edit


@dataclass(frozen=True)
class Edit:
    """Replace the bytes from begin to end of a file by the text."""

    begin: int
    end: int
    text: str


@dataclass
class Fault:
    """One wrong piece of code that can be switched on."""

    file: str  # from the root of the tree, with slashes
    line: int
    column: int  # from 1, in code
    code: str  # the whole line, stripped
    kind: str
    original: str
    mutated: str
    variants: list[list[Edit]]  # ways to write the switch; the first that compiles is used
    number: int = 0
    part: str = ""  # the group for choosing and counting, if it is not the folder
    edits: list[Edit] = field(default_factory=list)  # the variant that is used

    @property
    def place(self) -> str:
        """The part of the fault, or its folder."""
        return self.part or str(PurePosixPath(self.file).parent)

    @property
    def identity(self) -> tuple[str, str, int, str]:
        """An identity that stays while the line is unchanged, even if the line moves."""
        return self.file, self.code, self.column, self.change

    @property
    def change(self) -> str:
        return f"{self.original} -> {self.mutated}"

    def overlaps(self, other: Fault) -> bool:
        if self.file != other.file:
            return False
        mine = [edit for variant in self.variants for edit in variant]
        theirs = [edit for variant in other.variants for edit in variant]
        return any(a.begin < b.end and b.begin < a.end for a in mine for b in theirs)


def read_faults(work: Path) -> list[Fault]:
    faults = [Fault(**each) for each in json.loads((work / "faults.json").read_text(encoding="utf-8"))]
    for fault in faults:
        fault.edits = [Edit(**each) for each in fault.edits]
        fault.variants = [[Edit(**each) for each in variant] for variant in fault.variants]
    return faults


def one_line(text: str) -> str:
    """Return the text with single spaces instead of runs of white space."""
    return " ".join(text.split())


def place(source: bytes, begin: int) -> tuple[int, int, str]:
    """Return the place of a byte.

    It is the number of the line, the column in the stripped text of the line, and this text.
    """
    start = source.rfind(b"\n", 0, begin) + 1
    end = source.find(b"\n", begin)
    text = source[start : end if end >= 0 else None].decode()
    left = source[start:begin].decode().lstrip()
    return source.count(b"\n", 0, begin) + 1, len(left) + 1, text.strip()


def another(number: str) -> str | None:
    """Return another number, or None if the number is unclear.

    Small integers get one more, and other numbers are doubled.
    """
    try:
        return str(int(number) + 1 if abs(int(number)) <= 16 else 2 * int(number))
    except ValueError:
        pass
    try:
        value = float(number)
    except ValueError:
        return None
    return repr(2 * value if value else 1.0)


def planted(source: bytes, faults: Iterable[Fault]) -> bytes:
    """Return the source with the switches of all faults."""
    edits = [(edit, fault.number) for fault in faults for edit in fault.edits]
    for edit, number in sorted(edits, key=lambda pair: pair[0].begin, reverse=True):
        text = edit.text.replace(NUMBER, str(number)).encode()
        source = source[: edit.begin] + text + source[edit.end :]
    return source


def shares(total: int, sizes: dict[str, int]) -> dict[str, int]:
    """Return how many faults each folder gets.

    Each folder gets at least one. The rest is by its lines (largest remainders).
    """
    rest = max(total - len(sizes), 0)
    exact = {name: rest * size / sum(sizes.values()) for name, size in sizes.items()}
    result = {name: 1 + int(value) for name, value in exact.items()}
    by_remainder = sorted(exact, key=lambda name: exact[name] % 1, reverse=True)
    for name in by_remainder[: max(total - sum(result.values()), 0)]:
        result[name] += 1
    return result


class Choice:
    """Choose faults folder by folder, with kinds evenly.

    The seed gives a tree the same faults each time.
    """

    def __init__(self, candidates: list[Fault], seed: int, accept: Callable[[Fault], bool]):
        self._by_folder: dict[str, list[Fault]] = {}
        for fault in candidates:
            self._by_folder.setdefault(fault.place, []).append(fault)
        self._seed, self._accept = seed, accept
        self._kinds: Counter[str] = Counter()
        self._offers: dict[str, Iterator[Fault]] = {}
        self.chosen: list[Fault] = []

    @property
    def folders(self) -> list[str]:
        return sorted(self._by_folder)

    def take(self, folder: str) -> Fault | None:
        """Return one more fault of a folder, or None if it has no more."""
        offers = self._offers.setdefault(folder, self._offered(folder))
        for fault in offers:
            if not any(map(fault.overlaps, self.chosen)) and self._accept(fault):
                self.chosen.append(fault)
                self._kinds[fault.kind] += 1
                return fault
        return None

    def give_back(self, fault: Fault) -> None:
        self.chosen.remove(fault)
        self._kinds[fault.kind] -= 1

    def _offered(self, folder: str) -> Iterator[Fault]:
        rng = random.Random(f"{self._seed} {folder}")
        left: dict[str, list[Fault]] = {}
        for fault in sorted(self._by_folder[folder], key=lambda fault: (fault.file, fault.line, fault.change)):
            left.setdefault(fault.kind, []).append(fault)
        for faults in left.values():
            rng.shuffle(faults)
        while left:
            kind = min(left, key=lambda kind: (self._kinds[kind], rng.random()))
            yield left[kind].pop()
            if not left[kind]:
                del left[kind]
