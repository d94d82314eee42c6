"""Random drawings on random machines: what is written breaks no limit anywhere, and `brushsvg check` takes it."""

import pytest
from judge.checked import quick_check
from judge.random_jobs import tried
from judge.works import CELLS

JOBS = 75
FIRST = 100


@pytest.mark.parametrize("dialect", CELLS)
def test_whatever_is_written_keeps_the_limits_and_is_allowed(dialect, tmp_path):
    with quick_check() as check:
        all_ = [
            tried(dialect, number, tmp_path / str(number), check) for number in range(FIRST, FIRST + JOBS)
        ]
    assert [job for job in all_ if job.wrong] == []
    assert [job for job in all_ if job.denied] == []
    assert sum(not job.refused for job in all_) > JOBS / 3, "most are written"
