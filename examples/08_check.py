"""Check a program before a machine runs it, and see what a check finds.

Run: python examples/08_check.py. It writes word.ngc, and edited.ngc, in which one height is wrong.
"""

from pathlib import Path

import brushsvg

drawing = Path(__file__).with_name("robot.svg")
brushsvg.convert(drawing, "word.ngc")

# check reads the program back, simulates every move, and compares the paint with the drawing.
found = brushsvg.check("word.ngc", drawing)
assert found.plan and found.figures
print(f"word.ngc: {len(found.problems)} problems, {found.time_s:.0f} s, overlap {found.figures.total.overlap:.3f}")

# Somebody edits the program: after the third stroke the machine lifts the brush to 0.1 mm instead of 10 mm.
parts = Path("word.ngc").read_text(encoding="utf-8").split("Z10.0000")
Path("edited.ngc").write_text("Z10.0000".join(parts[:6]) + "Z0.1000" + "Z10.0000".join(parts[6:]))
found = brushsvg.check("edited.ngc", drawing)
print(f"edited.ngc: {len(found.problems)} problems")
for problem in found.problems:
    print(f"  {problem.where}: {problem.sentence}")
