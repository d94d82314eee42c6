"""Compare a photograph of a painted sheet with the drawing, and correct the next sheet.

Run: python examples/09_compare.py. It writes two simulated photographs (first.jpg, second.jpg), what compare sees in
the first one (seen.png), and the corrections (corrections.json). The run takes half a minute. For a real machine, paint
the sheets and take the photographs yourself.
"""

from pathlib import Path

import brushsvg

drawing = Path(__file__).with_name("robot.svg")

# The simulated machine paints each stroke about 0.8 mm to a side, the same on every sheet.
studio = 'format = "brushsvg/studio"\nversion = 1\n[machine]\nown_mm = 0.8\n'
Path("studio.toml").write_text(studio, encoding="utf-8")
brushsvg.simulate_photo(drawing, "first.jpg", studio="studio.toml")
first = brushsvg.compare(drawing, "first.jpg")
for stroke in first.strokes:
    x_mm, y_mm = stroke.placed.shift_mm
    print(f"{stroke.stroke}: {x_mm:+.2f}, {y_mm:+.2f} mm from the predicted place")
Path("seen.png").write_bytes(first.picture())
Path("corrections.json").write_text(first.json, encoding="utf-8")

# The second sheet is painted with the corrections.
brushsvg.simulate_photo(drawing, "second.jpg", studio="studio.toml", corrections="corrections.json")
second = brushsvg.compare(drawing, "second.jpg", corrections="corrections.json")
print(f"overlap with the drawing: first sheet {first.overlap:.3f}, second sheet {second.overlap:.3f}")
