"""Programs for random drawings and machines keep all limits, and `brushsvg check` accepts them."""

import pytest
from judge.checked import quick_check
from judge.random_jobs import tried
from judge.works import CELLS, FEWER
from sampling import sample

JOBS = 75
FIRST = 100


@sample("dialect", CELLS, keep=5)
def test_random_programs_keep_the_limits_and_pass_check(dialect, tmp_path):
    jobs = 20 if dialect in FEWER else JOBS
    with quick_check() as check:
        all_ = [tried(dialect, number, tmp_path / str(number), check) for number in range(FIRST, FIRST + jobs)]
    assert [job for job in all_ if job.wrong] == []
    assert [job for job in all_ if job.denied] == []
    assert sum(not job.refused for job in all_) > jobs / 3, "most are written"


@pytest.mark.parametrize("dialect, number", [("jaka", 5031), ("grbl", 5064)])
def test_circles_of_a_large_lag_become_lines_on_tilted_paper(dialect, number, tmp_path):
    with quick_check() as check:
        job = tried(dialect, number, tmp_path, check)
    assert not (job.refused or job.wrong or job.denied), job
