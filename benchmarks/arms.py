"""All joint angles for random places of each arm that comes along, held against EAIK's: see tests/python/arm_judge.py.

python benchmarks/arms.py [PLACES [CELL ...]]     # a twentieth of them where Newton's method judges, which is slow
"""

from __future__ import annotations

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1] / "tests" / "python"))

from arm_judge import compare, judge_of

from brushsvg.machine.cell_file import cell_names, find_cell

if __name__ == "__main__":
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 10_000
    for name in sys.argv[2:] or cell_names():
        if arm := find_cell(name).arm:
            print(name, compare(name, count if judge_of(arm) else count // 20), flush=True)
