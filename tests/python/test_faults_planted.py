"""A fault planted by benchmarks/faults has no effect until it is switched on.

It then changes what it names.
"""

import ast
import sys
from pathlib import Path

import pytest

sys.path.append(str(Path(__file__).parents[2] / "benchmarks" / "faults"))

import fault
import python_faults

EXAMPLES = Path(__file__).parents[2] / "examples"

SOURCE = b'''\
"""A module."""

LIMIT = 3
SHARED = 3


def steep(x: float, y: float = 1.0) -> bool:
    found = []
    if x < y and (y - x) * 2 <= LIMIT:
        found.append(x)
    x += 1.5
    return 0 <= len(found) == 1 or x in [SHARED]


class Heap:
    most = 20

    def top(self) -> list[float]:
        return [each for each in range(self.most - 2) if each > 16]
'''
RUN = "[[steep(x, y) for x in (0, 1, 1.5, 2) for y in (0.5, 1, 2, 20)], Heap().top()]"


def candidates():
    found = python_faults.candidates("a.py", SOURCE, {"SHARED"})
    for number, each in enumerate(found, 1):
        each.number, each.edits = number, each.variants[0]
    return found


def result(source: bytes, active: int):
    names = {"__fault__": lambda number, *_: number == active}
    try:
        exec(source, names)
        return eval(RUN, names)
    except Exception as problem:
        return repr(problem)


def test_the_examples_that_are_built_with_faults_exist():
    """The examples that are built with faults exist.

    They were renamed once, and no fault could be planted after that.
    """
    for name in fault.EXAMPLES:
        assert (EXAMPLES / f"{name}.cpp").is_file()


def test_planted_code_is_equivalent_until_a_fault_is_switched_on():
    for each in candidates():
        source = fault.planted(SOURCE, [each])
        assert result(source, 0) == result(SOURCE, 0), each.change
        assert source.count(b"\n") == SOURCE.count(b"\n"), "lines keep their numbers"


@pytest.mark.parametrize("each", candidates(), ids=lambda each: each.change)
def test_an_active_fault_makes_its_stated_change(each):
    before, code = SOURCE.splitlines(), each.code.encode()
    assert code in before[each.line - 1]
    assert each.code[each.column - 1 :].startswith(each.original) or "+=" in each.original
    changed = SOURCE.replace(code, each.code.replace(each.original, each.mutated, 1).encode(), 1)
    ast.parse(changed)
    if each.kind == "constant":
        changed = SOURCE.replace(b"LIMIT = 3", b"LIMIT = 4")
    assert result(fault.planted(SOURCE, [each]), each.number) == result(changed, 0)


def test_faults_are_of_all_kinds_and_not_in_import_time_code():
    found = candidates()
    assert {each.kind for each in found} == {
        "arithmetic", "boolean", "call removed", "comparison", "condition", "constant", "number", "return value",
    }  # fmt: skip
    assert {each.line for each in found if each.kind != "constant"} == {9, 10, 11, 12, 19}
    assert [each.change for each in found if each.kind == "constant"] == ["LIMIT = 3 -> LIMIT = 4"]


def test_the_selection_is_seeded_spread_and_without_overlaps():
    many = []
    for folder, size in (("a", 1), ("b", 3)):
        for number in range(size * 20):
            edits = [[fault.Edit(10 * number, 10 * number + 11, "")]]  # each edit overlaps the next
            words = (f"kind {number % 3}", str(number), "")
            many.append(fault.Fault(f"{folder}/x.py", number, 1, "", *words, edits))

    def taken(seed):
        choice = fault.Choice(many, seed, lambda each: each.line != 7)
        for folder, count in fault.shares(9, {"a": 10, "b": 90}).items():
            assert sum(choice.take(folder) is not None for _ in range(count)) == count
        return choice.chosen

    chosen = taken(1)
    assert chosen == taken(1) != taken(2)
    assert [each.place for each in chosen] == ["a"] * 2 + ["b"] * 7
    assert not any(a.overlaps(b) for a in chosen for b in chosen if a is not b)
    assert {each.kind for each in chosen} == {"kind 0", "kind 1", "kind 2"}
    assert all(each.line != 7 for each in chosen)
