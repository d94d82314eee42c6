"""Jobs before the first stroke: the air run, and strokes that find the paper."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from diagnostics import refused

from brushsvg.machine.cells.cell_file import find_cell
from brushsvg.machine.setup_programs import make_border_program, make_height_program
from brushsvg.model.library import find_brush

BRUSH = find_brush("round-6")
CELL = find_cell()


def points(program):
    return np.vstack([move.points_mm for section in program.sections() for move in section.moves])


def test_the_border_is_followed_above_the_paper():
    path = points(make_border_program((10, 20, 60, 45), BRUSH, CELL, (80, 60)))
    assert (path[:, 2] == CELL.heights.safe_mm).all()
    assert path[:, :2].tolist() == [[10, 20], [60, 20], [60, 45], [10, 45], [10, 20]]
    (section,) = make_border_program((10, 20, 60, 45), BRUSH, CELL, (80, 60)).sections()
    assert max(move.speed_mm_s for move in section.moves[1:]) <= BRUSH.max_speed_mm_s


def test_each_height_stroke_is_one_step_deeper_and_states_its_height():
    sections = list(make_height_program(BRUSH, CELL, (200, 100), 1.0, -1.0, 0.1).sections())
    assert len(sections) == 21
    painted = [next(move for move in section.moves if move.meaning == "paint") for section in sections]
    heights = [move.points_mm[0, 2] for move in painted]
    assert heights == pytest.approx(np.linspace(1, -1, 21))
    for section, height in zip(sections, heights, strict=True):
        assert section.title.endswith(f" --z-offset {height + 0.0:.2f}")
        low = [move for move in section.moves if move.meaning in ("land", "paint", "lift")]
        assert max(move.speed_mm_s for move in low) <= 15
    assert heights[10] == pytest.approx(0, abs=1e-12)


def test_height_strokes_are_separate_and_on_the_sheet():
    sheet = (120, 60)
    made = make_height_program(BRUSH, CELL, sheet, 1.0, -1.0, 0.1)
    rows = [[move.points_mm for move in s.moves if move.meaning in ("land", "paint")] for s in made.sections()]
    spans = [(land[0, 0], paint[0, 0], land[0, 1]) for land, paint in rows]
    for number, (left, right, y) in enumerate(spans):
        assert 0 < left < right < sheet[0] and 0 < y < sheet[1]
        for other in spans[:number]:
            assert abs(other[2] - y) >= 6 or other[1] + 5 < left or right + 5 < other[0]


@pytest.mark.parametrize(
    ("sheet", "heights", "expected"),
    [
        ((30, 20), (1, -1, 0.1), "strokes-out-of-range 2 21 'larger sheet'"),
        ((200, 100), (1, -12, 0.5), "height-out-of-range -12 '[-10, 1]'"),
        ((200, 100), (12, -1, 0.5), "height-out-of-range 12"),
        ((200, 100), (1, -1, 0.01), "strokes-out-of-range 201 2 100 'larger step'"),
        ((200, 100), (1, 0.5, 0.6), "strokes-out-of-range 1 2 100 'smaller step'"),
        ((200, 100), (-1, 1, 0.1), "strokes-out-of-range 0 2 100 'last height below'"),
    ],
)
def test_height_strokes_that_do_not_fit_are_refused(sheet, heights, expected):
    with refused(expected):
        make_height_program(BRUSH, CELL, sheet, *heights)


def test_border_and_height_jobs_stay_in_the_workspace():
    small = replace(CELL, workspace=replace(CELL.workspace, box_mm=((0.0, 0.0, -20.0), (50.0, 50.0, 60.0))))
    with refused("out-of-box 'x 60.0 mm'"):
        make_border_program((10, 20, 60, 45), BRUSH, small, (80, 60))
    with refused("out-of-box"):
        make_height_program(BRUSH, small, (200, 100), 1.0, -1.0, 0.1)
    with refused("height-out-of-range -1"):
        make_height_program(
            SimpleNamespace(**{"depth_range_mm": (0, 0.5), "max_speed_mm_s": 9.0}),
            CELL,
            (200, 100),
            1,
            -1,
            0.1,
        )
