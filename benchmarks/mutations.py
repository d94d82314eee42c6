"""Judge and check a thousand damaged programs for every dialect and job.

    python benchmarks/mutations.py [COUNT of each job [DIALECT ...]]

The result is the table of docs/evidence/trust.md.
"""

import sys
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path
from tempfile import TemporaryDirectory

sys.path.insert(0, str(Path(__file__).parents[1] / "tests" / "integration"))

from judge.table import Figures, measure
from judge.works import CELLS, WORKS, make

SEED = 1


def one(dialect: str, name: str, count: int) -> Figures:
    figures = Figures()
    with TemporaryDirectory() as folder:
        measure(make(name, dialect, Path(folder)), count, SEED, figures)
    return figures


def main() -> None:
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 1000
    jobs = [(dialect, name, count) for dialect in sys.argv[2:] or CELLS for name in WORKS]
    whole = Figures()
    with ProcessPoolExecutor() as pool:
        for figures in pool.map(one, *zip(*jobs, strict=True)):
            whole.counts += figures.counts
            whole.cases += figures.cases
            whole.crashes += figures.crashes
    print(whole.table())
    wrong = [case for case in whole.cases if (case.verdict == "harmless") == bool(case.refusals)]
    wrong = [case for case in wrong if case.verdict != "neither"]
    for case in wrong[:200]:
        print(f"\n{case.dialect}, {case.job}, {case.damage}: {case.verdict}: {case.why} {' / '.join(case.refusals)}")
        print(*case.changed, sep="\n")
    print(*whole.crashes, sep="\n")


if __name__ == "__main__":
    main()
