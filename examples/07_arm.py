"""Write a program for a robot arm whose joints reach every pose.

Run: python examples/07_arm.py. It writes my_ur5e.toml (the cell) and arm.script (URScript). It needs the extra arm.
"""

from dataclasses import replace
from pathlib import Path

import brushsvg

drawing = Path(__file__).with_name("vincent.svg")
shipped = brushsvg.find_cell("ur5e")


def cell_at(origin_mm: tuple[float, float, float]) -> brushsvg.Cell:
    """Return a UR5e whose paper has its lower left corner at a place in the robot's frame."""
    return replace(shipped, name="my-ur5e", paper=replace(shipped.paper, origin_mm=origin_mm, example=False))


# Here a part of the sheet is too far away. brushsvg refuses the job and writes nothing.
try:
    brushsvg.convert(drawing, "arm.script", cell=cell_at((-350.0, -820.0, 20.0)))
except brushsvg.Error as refused:
    print(f"refused: {refused.where}: {refused}")

# On a real machine, you touch three points of the paper with the brush and enter them as taught_mm.
cell = cell_at((-120.0, -600.0, 20.0))
Path("my_ur5e.toml").write_text(brushsvg.write_cell(cell), encoding="utf-8")
done = brushsvg.convert(drawing, "arm.script", cell="my_ur5e.toml")
for notice in done.notices:
    print(f"warning: {notice.where}: {notice.sentence}")
print(f"arm.script: {len(done.plan.passes)} strokes, {done.time_s:.0f} s, {len(done.text.splitlines())} lines")
