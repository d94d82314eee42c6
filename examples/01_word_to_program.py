"""A drawing becomes a robot program: python 01_word_to_program.py DRAWING.svg PROGRAM.ngc"""

import sys

import brushsvg


def main(drawing_file: str, program_file: str) -> None:
    drawing = brushsvg.read_drawing(drawing_file)
    strokes, renamed = brushsvg.strokes(drawing)
    brush = brushsvg.find_brush("round-6")
    done = brushsvg.compensate(strokes, brush, drawing.sheet_mm)
    brushsvg.write_program(program_file, done.plan, brush, title=drawing.title)

    for notice in (*drawing.notices, *renamed):
        print(f"{notice.where}: {notice.sentence}")
    for where, sentence in done.warnings:
        print(f"{where}: {sentence}")
    marks = brushsvg.simulate(done.plan, brush)
    brushsvg.trace_outlines(marks, brush)
    wanted = brushsvg.unite([ring for stroke in strokes for ring in brushsvg.wanted_outline(stroke, 0.01)])
    print(
        f"{len(strokes)} strokes; overlap with the drawing: {brushsvg.overlap(marks.outline_mm, wanted):.3f}"
    )


if len(sys.argv) != 3:
    sys.exit(__doc__)
try:
    main(*sys.argv[1:])
except brushsvg.Error as refused:
    sys.exit(f"{refused.where}: {refused}" if refused.where else str(refused))
