"""Compare all joint angles for random places of each shipped arm with EAIK.

    python benchmarks/arms.py [PLACES [CELL ...]]

10,000 places of an xArm need five minutes, because Newton's method judges them. See tests/python/arm_judge.py.
"""

from __future__ import annotations

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1] / "tests" / "python"))

from arm_judge import compare

from brushsvg.machine.cells.cell_file import cell_names, find_cell

if __name__ == "__main__":
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 10_000
    for name in sys.argv[2:] or cell_names():
        if find_cell(name).arm:
            print(name, compare(name, count), flush=True)
