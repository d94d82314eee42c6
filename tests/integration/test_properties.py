"""Programs of random drawings, brushes, cells and options have all required properties.

The properties are in judge.properties. `benchmarks/properties.py` runs the same cases in larger numbers.
"""

import pytest
from judge.checked import quick_check
from judge.properties import one

CASES, PART = 300, 25
# Cases of benchmarks/properties.py that once failed: steep paths of servos, a short lift of a ROS 2 trajectory, a
# plan refused for a path that its program does not use, and two faults of the judge.
WERE_WRONG = (
    200183,
    200741,
    200762,
    201322,
    202112,
    202271,
    202292,
    203699,
    204656,
    205507,
    900168,
    910284,
    910531,
)
WERE_WRONG_OF_EBB = (1000261, 1000459)  # with --dialect ebb


@pytest.mark.parametrize("first", range(0, CASES, PART))
def test_written_programs_have_the_required_properties(first, tmp_path, capsys):
    with quick_check() as check:
        cases = [one(n, tmp_path / str(n), tmp_path, check) for n in range(first, first + PART)]
    assert [case for case in cases if case.wrong] == []
    assert sum(not case.refused for case in cases) > PART / 5, "many are written"


@pytest.mark.parametrize(
    ("number", "dialects"),
    [*((each, ()) for each in WERE_WRONG), *((each, ("ebb",)) for each in WERE_WRONG_OF_EBB)],
)
def test_earlier_failures_stay_fixed(number, dialects, tmp_path, capsys):
    with quick_check() as check:
        assert one(number, tmp_path / str(number), tmp_path, check, dialects).wrong == ()
