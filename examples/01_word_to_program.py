"""A drawing becomes a robot program: python 01_word_to_program.py DRAWING.svg PROGRAM.ngc"""

import sys

import brushsvg

drawing = brushsvg.read_drawing(sys.argv[1])
strokes, warnings = brushsvg.strokes(drawing)
brush = brushsvg.find_brush("round-6")
plan = brushsvg.compensate(strokes, brush, drawing.sheet_mm).plan
brushsvg.write_program(sys.argv[2], plan, brush, title=drawing.title)

for warning in (*drawing.notices, *warnings):
    print(f"{warning.where}: {warning.sentence}")
marks = brushsvg.simulate(plan, brush)
brushsvg.trace_outlines(marks, brush)
wanted = brushsvg.unite([ring for stroke in strokes for ring in brushsvg.wanted_outline(stroke, 0.01)])
print(f"{len(strokes)} strokes; overlap with the drawing: {brushsvg.overlap(marks.outline_mm, wanted):.3f}")
