"""Call public names with nonsense arguments: python wrong_arguments.py NAME ...

test_public_wrong_arguments.py runs this script in a separate process. It prints one line per call with a wrong
outcome. A right outcome is a result, brushsvg.Error or, for a value of the wrong Python type, TypeError.
"""

import contextlib
import copy
import inspect
import io
import itertools
import operator
import pickle
import sys
import tempfile
from dataclasses import replace
from pathlib import Path

import numpy as np

import brushsvg
from brushsvg import _core
from brushsvg.cli import main as command
from brushsvg.read.design import Design

NAN, INF = float("nan"), float("inf")
NUMBERS = [0, -1, 1e-300, 1e300, 5.5e9, NAN, INF, -INF, 10**30, 10**400]
WRONG_TYPES = [None, "x", b"x", [], {}, (), object(), True, [None], [[1]], np.zeros(0), np.full((2, 8), NAN)]
LINE = [[10, 10, 20, 10, 30, 10, 40, 20.0]]


def brush(**changes):
    made = brushsvg.find_brush("round-6")
    for name, value in changes.items():
        setattr(made, name, value)
    return made


def footprints(change):
    table = brushsvg.find_brush("round-6").footprints
    dragged = [(shape.depth_mm, shape.outline_mm.copy()) for shape in table.dragged]
    return _core.FootprintTable([_core.Footprint(*shape) for shape in change(dragged)], [])


def moved(shapes, value):
    shapes[1][1][3, 0] = value
    return shapes


def brushes():
    yield brush()
    yield brushsvg.Brush()
    yield brush(footprints=_core.FootprintTable())
    yield brush(footprints=footprints(lambda shapes: shapes[::-1]))
    yield brush(footprints=footprints(lambda shapes: [shapes[0], (9.5, shapes[1][1][:5])]))
    yield brush(footprints=footprints(lambda shapes: [(shapes[0][0], np.zeros((0, 2)))]))
    yield brush(depth_range_mm=(8, 0))
    yield brush(lag=_core.Profile([]))
    yield brush(lag=_core.Profile([-5]))
    yield brush(lag=_core.Profile([1e-9] * 5000))
    yield brush(half_width=_core.Profile([9, -1]))
    yield brush(extra="[", name="\0")
    yield brush(paint=_core.Paint(NAN, lasts_mm=-1.0))
    for value in (NAN, INF, 1e300, 5.5e9):
        yield brush(footprints=footprints(lambda shapes, value=value: moved(shapes, value)))
        yield brush(lag=_core.Profile([value]), tip_gap=_core.Profile([0, value]))
        yield brush(depth_range_mm=(0, value), max_speed_mm_s=value, paint_depth_mm=value)
        yield brush(half_width=_core.Profile([value]), paint_depth_mm=value)


def stroke(line=LINE, width=((0, 1.0), (1, 1.0)), **more):
    made = brushsvg.Stroke("a", np.array(line, float), more.pop("closed", False), list(width))
    for name, value in more.items():
        setattr(made, name, value)
    return made


def some_strokes():
    yield stroke()
    yield brushsvg.Stroke()
    yield stroke(width=())
    yield stroke([[5.0] * 8], closed=True)
    yield stroke(width=[(1, 1), (0, 2)])
    yield stroke(np.array(LINE) * 2e4)
    for value in (NAN, INF, 1e300, 5.5e9, 1e-300, -1):
        yield stroke(np.array(LINE) * value)
        yield stroke(width=[(0, value), (1, 1)])
        yield stroke(width=[(value, 1), (1, 1)])
        yield stroke(target_mm=[np.full((4, 2), value), np.zeros((0, 2))])
    yield stroke(settings=_core.Settings(extra="{"), id="\0")


def a_pass(poses=((20, 20, 0), (30, 20, -2), (40, 20, -2)), **more):
    return brushsvg.Pass("a", np.array(poses, float).reshape(-1, 3), **more)


def plan(*passes, **more):
    return brushsvg.Plan("round-6", "", more.pop("sheet_mm", (100, 100)), list(passes), **more)


def plans():
    yield plan(a_pass())
    yield brushsvg.Plan()
    yield plan()
    yield plan(a_pass(()))
    yield plan(a_pass([(3, 3, -2)]))
    yield plan(a_pass(arcs=[brushsvg.Arc(-1, 5, (0, 0), 1)]))
    yield plan(a_pass(arcs=[brushsvg.Arc(1, 2, (35, 20), 1)] * 3))
    yield plan(a_pass(settings=_core.Settings(extra="{"), extra="[]"), extra="{")
    yield plan(a_pass(speed_mm_s=1e-320))
    yield plan(a_pass(tool_axes=[(0.28, 0.0, 0.96)] * 3))
    yield plan(a_pass(tool_axes=[(0.0, 0.0, 1.0)]))
    yield plan(a_pass((), tool_axes=[(0.28, 0.0, 0.96)]))
    for value in (NAN, INF, -INF, 1e300, 1e6, -1e6):
        yield plan(a_pass(settings=_core.Settings(speed_mm_s=value, width_mm=value, brush="\0")))
        yield plan(a_pass([(0, 0, 0), (value, 0, -2)]))
        yield plan(a_pass([(0, 0, 0), (9, 0, value)]))
        yield plan(a_pass(speed_mm_s=value), sheet_mm=(value, value))
        yield plan(a_pass(arcs=[brushsvg.Arc(1, 2, (value, 0), 1)]))
        yield plan(a_pass(tool_axes=[(0.0, value, 1.0)] * 3))


def marks():
    sound = brushsvg.simulate(plan(a_pass()), brush())
    brushsvg.trace_outlines(sound, brush())
    yield sound
    yield brushsvg.Marks()
    empty = brushsvg.Marks()
    empty.passes = [_core.PassMarks()]
    yield empty
    for value in (NAN, INF, 1e300, 5.5e9):
        far = brushsvg.simulate(plan(a_pass()), brush())
        far.outline_mm = [np.full((4, 2), value), np.zeros((0, 2))]
        yield far


def designs():
    yield brushsvg.read_drawing(FOLDER / "d.svg")
    yield Design((0, 0), [])
    yield Design((NAN, INF), [])


def cells():
    sound = brushsvg.find_cell("grbl-3axis")
    yield sound
    for value in (NAN, INF, -1, 1e300):
        yield replace(sound, heights=replace(sound.heights, safe_mm=value, clearance_mm=value))
        yield replace(sound, speeds=replace(sound.speeds, travel_mm_s=value, paint_mm_s=value))
        yield replace(sound, paper=replace(sound.paper, origin_mm=(value, 0, 0)))
        yield replace(sound, blending=replace(sound.blending, tolerance_mm=value))
        yield replace(sound, workspace=replace(sound.workspace, margin_mm=value, reach_mm=(value, 1)))
    yield replace(sound, decimals=-400)
    yield replace(sound, decimals=10**6)
    yield replace(sound, language="basic")


def rings():
    square = np.array([[0, 0], [9, 0], [9, 9], [0, 9.0]])
    yield [square]
    yield []
    yield [np.zeros((0, 2)), np.zeros((1, 2)), square[:2]]
    yield [square[::-1], square[[0, 2, 1, 3]]]
    for value in (NAN, INF, -INF, 1e300, 5.5e9):
        yield [np.where(square == 9, value, square)]


FOLDER = Path(tempfile.mkdtemp())
OPEN = '<svg xmlns="http://www.w3.org/2000/svg" width="90mm" height="90mm" viewBox="0 0 90 90">'
(FOLDER / "d.svg").write_text(f'{OPEN}<path id="p" fill="none" stroke="red" stroke-width="3" d="M9 9h40"/></svg>')
(FOLDER / "broken.svg").write_text(OPEN + "<g>" * 2000)
(FOLDER / "none.svg").write_bytes(b"")
(FOLDER / "noise.dxf").write_bytes(bytes(range(256)) * 50)
(FOLDER / "broken.toml").write_text("name = [[[[")
(FOLDER / "shared").mkdir()
(FOLDER / "shared" / "brushsvg.toml").write_text('format = "brushsvg/project"\nversion = 1\nbrush = "rigid"\n')
(FOLDER / "broken.json").write_text("[" * 100_000)
(FOLDER / "m.csv").write_text(
    "\n".join(["kind,depth_mm,value_mm", *(f"{k},{d},{d}" for d in range(1, 7) for k in ("lag", "width"))])
)
FILES = [FOLDER / name for name in ("broken.svg", "none.svg", "noise.dxf", "missing.svg", "broken.toml")]
PATHS = [
    *FILES,
    FOLDER / "broken.json",
    FOLDER,
    "",
    "\0",
    "a/b/c.ngc",
    "/dev/null/x.ngc",
    FOLDER / "x.varnish",
]
TEXTS = [
    "",
    "\0",
    "[" * 100_000,
    '{"format": "brushsvg/plan", "version": 1}',
    '{"format": "brushsvg/plan", "version": 1, "brush": "", "sheet_mm": [1e9, 1], "passes": []}',
    '{"format": "brushsvg/plan", "version": 1, "brush": "", "sheet_mm": [9, 9], "passes": [{"stroke": "a", '
    '"poses_mm": [[1e7, 0, 0]]}]}',
    '{"format": "brushsvg/marks", "version": 1, "outline_mm": [[[1e300, 0]]], "passes": []}',
    '{"format": "brushsvg/marks", "version": 1, "passes": [{"stroke": "a", "pose": [1e300], "contact_mm": [[0, 0]], '
    '"heading_rad": [0], "depth_mm": [0], "taut": [true]}]}',
]
SOUND_CELL = Path(brushsvg.__file__).parent / "data" / "cells" / "grbl-3axis.toml"
(FOLDER / "huge.toml").write_text(SOUND_CELL.read_text().replace("= 5", "= 1e400"))
NAMES = ["", "\0", "no-such", "../x", "a" * 5000, *PATHS]

SHEETS = [(100, 100), (0, 0), (NAN, 9), (1e300, 1e300), [np.zeros(3)] * 2, ("x", None), np.zeros(2)]
COLOURS = [["#000000"], [], ["varnish"], ["#0"], ["#zzzzzz"]]
FONT = (
    '<svg xmlns="http://www.w3.org/2000/svg"><font horiz-adv-x="9"><font-face units-per-em="9"/>'
    '<glyph unicode="A" d="M0 0L5 9"/></font></svg>'
)

ANGLES = [1.0, [0.1, 0.5], np.zeros((2, 0)), [NAN, 1], [1, 2, 3], 1j, np.zeros(2, "M8[s]"), *NUMBERS]
WAYS = [3.0, [1, 2], [], [[1], [2]], [INF, 1], *NUMBERS]
FUNCTIONS = [
    np.ones_like,
    lambda z: 0 * z,
    lambda z: np.full_like(z, NAN),
    lambda z: z[:2],
    lambda z: "x",
    lambda z: np.abs(z - 0.3),
    lambda z: 1e300 * z,
    lambda z: 1e-300 + 0 * z,
]


def some_laws():
    yield 4.0
    yield brush().lag
    yield brushsvg.laws.Profile([])
    yield brushsvg.laws.Profile([0, 1])
    yield brushsvg.laws.Profile([1, -1])
    yield brushsvg.laws.Profile([0.1] * 20)
    yield brushsvg.laws.Profile([1, 1], floor=-5, floor_slope=NAN)
    for value in NUMBERS[:-1]:
        yield brushsvg.laws.Profile([value])
        yield brushsvg.laws.Profile([1], floor=value, floor_slope=value)
    yield from NUMBERS


# Public name: the values to try for each argument. The first value is valid; the others are tried one at a
# time.
ARGUMENTS = {
    "Arc": [[1, *NUMBERS], [2, *NUMBERS], [(0, 0), (NAN, INF), (1e300, 0)], [1, *NUMBERS]],
    "Brush": [],
    "Cell": [],
    "Compensated": [],
    "Chart": [],
    "Conversion": [],
    "SetupProgram": [],
    "PaperPlacement": [],
    "SimulatedPhoto": [],
    "Check": [],
    "BrushCalibration": [],
    "PaintedJob": [],
    "Project": [],
    "Error": [["a sentence", *TEXTS], ["", *NUMBERS], [None, *NUMBERS], [None, *NUMBERS]],
    "Footprint": [[3.0, *NUMBERS], [[[0, 0], [4, -2], [6, 0], [4, 2]], [], [[NAN, 0]] * 3, [[1e300, 0]] * 3]],
    "FootprintTable": [
        lambda: [footprints(lambda shapes: shapes).dragged, (), [_core.Footprint(NAN, [])]],
        [(), [_core.Footprint(3, [[0, 0]])]],
    ],
    "Marks": [],
    "Paint": [[0.3, *NUMBERS]],
    "Pass": [
        ["a", *TEXTS],
        [np.zeros((2, 3)), np.zeros((0, 3)), np.zeros((2, 2)), [[NAN] * 3]],
        [20.0, *NUMBERS],
    ],
    "Plan": [["b", *TEXTS], ["", *TEXTS], [(9, 9), (NAN, INF), (9,)], [[a_pass()], []], ["{}", *TEXTS]],
    "Profile": [[[3.0], [], [NAN], [1e300] * 5000]],
    "ReadOptions": [],
    "Settings": [],
    "Stroke": [["a", *TEXTS], [LINE, [], [[NAN] * 8]], [False, *NUMBERS], [[(0, 1)], [(NAN, INF)], [(1,)]]],
    "area": [rings],
    "Batch": [],
    "batch": [[[], [("a", OPEN + "</svg>")], *([path] for path in PATHS)], [FOLDER / "many", *PATHS]],
    "brush_like": [["mine", *TEXTS], brushes],
    "brush_names": [],
    "calibrate": [
        [
            FOLDER / "m.csv",
            *PATHS,
            FOLDER / "broken.json",
            {},
            {"lag": object()},
            {(1, 2): 3},
            {"video": [{}]},
        ],
        ["a", *TEXTS],
    ],
    "cell_names": [],
    "chart": [
        lambda: brushes(),
        [(210, 297), *SHEETS, (1e5, 1e5)],
        [None, "few", "varnish"],
        [5.0, *NUMBERS],
    ],
    "chart_page": [lambda: charts(), [".svg", ".pdf", *TEXTS]],
    "compensate": [
        lambda: ([each] for each in some_strokes()),
        brushes,
        [(100, 100), (NAN, NAN), (-1, 0), (1e300, INF)],
        ["closed", "none", "constant", "refined", "varnish", ""],
        [0.05, *NUMBERS],
        [None, *NUMBERS],
        [20.0, *NUMBERS],
    ],
    "check": [
        lambda: [sound_program(), FOLDER / "d.svg", *PATHS],
        lambda: [None, *designs(), *plans(), *PATHS],
    ],
    "compare": [
        lambda: [FOLDER / "d.svg", *designs(), *plans(), *PATHS],
        lambda: [sound_photo(), [], [None], *PATHS],
    ],
    "convert": [lambda: [FOLDER / "d.svg", *designs(), *plans(), *PATHS], [None, FOLDER / "o.ngc", *PATHS]],
    "coverage": [
        marks,
        brushes,
        [(0, 0, 30, 30), (0, 0, 0, 0), (NAN, 0, 9, 9), (0, 0, INF, 9), (1e300, 0, 9, 9), (0, 0, 1e6, 1e6)],
        [4.0, *NUMBERS],
    ],
    "find_brush": [["round-6", *NAMES]],
    "find_cell": [["grbl-3axis", *NAMES]],
    "find_project": [[str(FOLDER), *PATHS, *NAMES]],
    "flatten": [some_strokes, [0.01, *NUMBERS]],
    "marks_png": [marks, brushes, SHEETS, COLOURS],
    "marks_svg": [marks, SHEETS, COLOURS],
    "new_brush": [
        ["a", *TEXTS],
        [5.0, *NUMBERS],
        [
            [(3, 2), (8, 7)],
            [],
            [(3, 2)],
            [(0, 0)],
            [(NAN, 1)],
            [(3, INF)],
            [(3,)],
            [(3, 2, 1)],
            [3, 2],
            [("x", 2)],
        ],
        [None, 9.0, *NUMBERS],
        [25.0, *NUMBERS],
    ],
    "overlap": [rings, rings],
    "path_from_pass": [lambda: [each for made in plans() for each in made.passes], [None, *NUMBERS]],
    "path_from_stroke": [some_strokes, [None, *NUMBERS]],
    "place_paper": [
        lambda: ["ur3e", "linuxcnc-3axis", *NAMES, *cells()],
        lambda: [None, FOLDER / "d.svg", *designs(), *plans(), *PATHS],
        [None, FOLDER / "p.svg", *PATHS],
    ],
    "read_project": [
        [FOLDER / "shared" / "brushsvg.toml", *PATHS, FOLDER / "broken.toml", FOLDER / "huge.toml", *TEXTS]
    ],
    "read_cell": [[SOUND_CELL, *PATHS, FOLDER / "broken.toml", FOLDER / "huge.toml", *TEXTS]],
    "read_drawing": [[FOLDER / "d.svg", *PATHS], lambda: read_options()],
    "read_marks": [lambda: [brushsvg.write_marks(next(marks())), *TEXTS]],
    "read_plan": [lambda: [brushsvg.write_plan(next(plans())), *TEXTS]],
    "save_brush": [brushes, [FOLDER / "b.json", *PATHS]],
    "setup_border": [lambda: [FOLDER / "d.svg", *designs(), *plans(), *PATHS], [None, FOLDER / "s.ngc", *PATHS]],
    "setup_first_run": [lambda: ["linuxcnc-3axis", *NAMES, *cells()], [None, FOLDER / "s.ngc", *PATHS]],
    "setup_height": [lambda: [None, *NAMES, *cells()], [None, FOLDER / "s.ngc", *PATHS]],
    "simulate_photo": [lambda: [FOLDER / "d.svg", *designs(), *plans(), *PATHS], [None, FOLDER / "p.jpg", *PATHS]],
    "simulate": [plans, brushes, [0.02, *NUMBERS]],
    "stroke_from_path": [
        ["M0 0 L9 9", "", "M0 0", "M0 0 L1e300 0", *TEXTS, np.zeros((0, 8)), [[NAN] * 8]],
        [3.0, *NUMBERS],
        ["a", *TEXTS],
        [None, *NUMBERS],
    ],
    "strokes": [designs, [None, "stroke", *NUMBERS, *WRONG_TYPES]],
    "text_svg": [["AA", *TEXTS], [FONT.encode(), b"", b"\0" * 99, b"OTTO" + bytes(99), FONT[:99].encode()]],
    "trace_outlines": [marks, brushes],
    "unite": [rings],
    "target_outline": [some_strokes, [0.01, *NUMBERS]],
    "within_reach": [
        lambda: ([each] for each in some_strokes()),
        brushes,
        ["auto", "clamp", "passes", "refuse", "varnish"],
    ],
    "lifted_at_corners": [lambda: ([each] for each in some_strokes()), brushes],
    "write_cell": [cells],
    "write_marks": [marks],
    "write_plan": [plans],
    "laws.Bristle": [],
    "laws.Followed": [],
    "laws.FromAngles": [],
    "laws.LawFit": [],
    "laws.Profile": [[[3.0], [], [NAN], [1e300] * 5000]],
    "laws.alpha_after": [ANGLES, WAYS, WAYS],
    "laws.alpha_after_turn": [ANGLES, WAYS, WAYS],
    "laws.alpha_on_ramp": [ANGLES, WAYS, lambda: some_laws(), WAYS, WAYS],
    "laws.bristle": [FUNCTIONS, FUNCTIONS, ["shear_free", "third_derivative", "varnish"]],
    "laws.bristle_of_article": [[0.5, *NUMBERS], ["shear_free", "varnish", *NUMBERS]],
    "laws.contact_offset": [ANGLES, WAYS],
    "laws.fit_law": [lambda: readings(), lambda: readings(), [1, 0, -1, 8, 9, 10**9, 2**70, 1.5]],
    "laws.follow": [
        [[[0, 0], [9, 0], [9, 9]], [[0, 0]], [], [[0, 0, 0]], [[0, NAN]], [[0, 0], [1e300, 0]], [[0, 0]] * 3],
        [2.0, [1, 2, 3], [0, 0, 0], [1, 2], *NUMBERS],
        lambda: some_laws(),
        [None, (-1, 0), (0, 0), (-50, 0), (NAN, 0), *NUMBERS],
    ],
    "laws.from_angles": [
        [1.5, [1.5, 1.2], *NUMBERS],
        [[1, 3, 6], [0, 0, 0], [], [[1, 3, 6]] * 2, *NUMBERS],
        [[1.2, 0.9, 0.5], [0.5, 0.9, 1.2], [], *NUMBERS],
        [None, [2.3, 2.0, 1.6], [], *NUMBERS],
    ],
    "laws.tip_direction": [ANGLES, ANGLES, WAYS, WAYS, WAYS],
    "laws.tip_offset": [ANGLES, WAYS, WAYS],
    "write_chart": [lambda: charts()],
    "write_program": [[FOLDER / "p.ngc", *PATHS], plans, brushes, ["", *TEXTS], cells],
}


def charts():
    return [brushsvg.chart(brushsvg.find_brush("round-6"), (250, 180), "few"), next(plans())]


def sound_program():
    brushsvg.convert(FOLDER / "d.svg", FOLDER / "sound.ngc")
    return FOLDER / "sound.ngc"


def sound_photo():
    photo = FOLDER / "photo.jpg"
    if not photo.exists():
        with contextlib.redirect_stdout(io.StringIO()):  # simulate-photo prints its studio
            assert command(["simulate-photo", str(FOLDER / "d.svg"), "-o", str(photo), "--quiet"]) == 0
    return photo


def read_options():
    yield brushsvg.ReadOptions()
    for value in [*SHEETS[1:], (True, 9), (1, 2, 3), *NUMBERS, *WRONG_TYPES]:
        yield brushsvg.ReadOptions(sheet_mm=value)
    for value in ["furlong", *NUMBERS, *WRONG_TYPES]:
        yield brushsvg.ReadOptions(units=value)
        yield brushsvg.ReadOptions(select=value)
        yield brushsvg.ReadOptions(paper_z_mm=value, skip_comments=value, skip_regions_mm=value)


def laws_requested():
    for span in [(0, 10), (10, 0), (3, 3), (NAN, 9), (0, INF), (-INF, 1e300)]:
        yield _core.LawShape(span, 1)
    for degree in (0, -1, 9, 2**31 - 1):
        yield _core.LawShape((0, 10), degree, through_zero=True)
    for value in NUMBERS[:-1]:
        yield _core.LawShape((0, 10), 1, floor=value)
        yield _core.LawShape((0, 10), 1, smoothing=value, norm=_core.Norm.absolute)


def readings():
    sound = np.arange(1.0, 7.0)
    yield sound
    yield sound[::-1]
    yield sound[:1]
    yield np.repeat(sound, 2)
    for value in NUMBERS[:-1]:
        yield np.where(sound == 3, value, sound)
        yield np.full(6, value)


def painted_marks():
    poses = np.array([[0, 0, 0], [5, 0, -3], [12, 0, -3], [12, 10, -3.0]])
    square = np.array([[-4, -3], [15, -3], [15, 10], [-4, 10.0]])
    sound = _core.PaintedMark("a", poses, [square])
    yield [sound]
    yield [sound, sound]
    yield [_core.PaintedMark("", poses[:1], [square])]
    yield [_core.PaintedMark("a", poses[:0], [square])]
    for rings in ([], [square[:2]], [square[::-1]], [square * 0]):
        yield [_core.PaintedMark("a", poses, rings)]
    for value in NUMBERS[:8]:  # Small values make marks that no brush paints.
        yield [_core.PaintedMark("a", np.where(poses == 12, value, poses), [square])]
        yield [_core.PaintedMark("a", poses, [np.where(square == 15, value, square)])]


def starts():
    yield None
    yield _core.MarkLaws([], [], [])
    for value in NUMBERS[:-1]:
        yield _core.MarkLaws([value], [0, value], [0, value])
        yield _core.MarkLaws([4], [0, 1], [0, 0.4], widest_per_half=value)


def mark_options(**changes):
    made = _core.MarkOptions()
    made.max_iterations, made.spacing_mm = 2, 4.0
    for name, value in changes.items():
        setattr(made, name, value)
    return made


def all_mark_options():
    yield mark_options()
    yield mark_options(lag_terms=0)
    yield mark_options(tip_gap_terms=2**31 - 1)
    names = (
        "deepest_mm",
        "spacing_mm",
        "placement_mm",
        "turn_rad",
        "displacement_mm",
        "noise_mm",
        "noise_length_mm",
    )
    for value in NUMBERS[:-1]:
        for name in names:
            yield mark_options(**{name: value})
        for name in ("widest_per_half", "front_per_half", "height_mm"):
            yield mark_options(**{name: _core.Prior(value, 1.0)})
            yield mark_options(**{name: _core.Prior(1.0, value)})
        laws = _core.MarkLaws([4], [0, 1], [0, 0.4])
        yield mark_options(laws=_core.LawPrior(laws, [[value] * 8]))
        yield mark_options(laws=_core.LawPrior(_core.MarkLaws([value], [0, 1], [0, 0.4]), [[1.0] * 8]))
    yield mark_options(laws=_core.LawPrior(laws, [[1.0] * 7]))
    yield mark_options(laws=_core.LawPrior(laws, []))


# These have no public name of their own: the fits that calibration calls, and a factory of a class.
FITS = {
    "Stroke.from_points": [
        [
            [(5, 5), (9, 9)],
            [(5, 5)],
            [(5, 5)] * 3,
            [(5, 5), (9, NAN)],
            [(5, 5), (1e300, 9)],
            [(0, 0, 0), (9, 9, 9)],
            [5, 9],
            np.arange(2000.0).reshape(-1, 2) % 7 * 99,
        ],
        [3.0, [3, 4], [3, 4, 5], [3, -4], [3, NAN], np.ones((2, 1)), np.ones((2, 2)), *NUMBERS],
        ["a", *TEXTS],
    ],
    "fit_law": [readings, readings, laws_requested],
    "from_angles": [
        [1.5, *NUMBERS],
        lambda: [[1, 3, 6], *([1, 3, each] for each in NUMBERS), [6, 3, 1], [0, 0, 0], []],
        lambda: [[1.2, 0.9, 0.5], *([1.2, 0.9, each] for each in NUMBERS), [0.5, 0.9, 1.2], []],
        lambda: [[2.3, 2.0, 1.6], *([2.3, 2.0, each] for each in NUMBERS), []],
    ],
    "fit_marks": [painted_marks, starts, all_mark_options],
}


def calls(name):
    """Yield the arguments of each call.

    First come valid arguments, then valid ones with a single argument replaced by nonsense or a wrong type.
    Last come arguments that all have the same wrong type.
    """
    given = (ARGUMENTS | FITS).get(name, [])
    choices = [list(choice() if callable(choice) else choice) + WRONG_TYPES for choice in given]
    sound = [choice[0] for choice in choices]
    yield sound
    for index, choice in enumerate(choices):
        for value in choice[1:]:
            yield [*sound[:index], value, *sound[index + 1 :]]
    for value in WRONG_TYPES:
        for count in range(len(choices) + 1):
            yield [value] * count


def truths(name):
    """Yield call arguments with True in place of one number.

    In a tuple of numbers, True replaces the first number.
    """
    given = ARGUMENTS.get(name, [])
    sound = [next(iter(choice() if callable(choice) else choice)) for choice in given]
    for index, value in enumerate(sound):
        if isinstance(value, int | float) and not isinstance(value, bool):
            yield [*sound[:index], True, *sound[index + 1 :]]
        elif isinstance(value, tuple) and value and all(isinstance(each, int | float) for each in value):
            yield [*sound[:index], (True, *value[1:]), *sound[index + 1 :]]


def is_refused(call) -> bool:
    try:
        call()
    except (brushsvg.Error, TypeError):
        return True
    return False


def values_of(name):
    """Return valid and invalid values of a class."""
    made = {
        "Brush": brushes,
        "Stroke": some_strokes,
        "Plan": plans,
        "Marks": marks,
        "Pass": lambda: (each for one in plans() for each in one.passes),
    }.get(name, tuple)
    return made()


def methods(name):
    """Yield (label, value, attribute) for each public attribute of a class's values."""
    for value in values_of(name):
        for attribute in dir(value):
            if attribute.startswith("_"):
                continue
            yield f"{name}.{attribute}", value, attribute


def shown_and_copied(value):
    """Call what every value must support: repr, copy and pickle."""
    repr(value)
    for made in (copy.copy(value), pickle.loads(pickle.dumps(value))):
        if made != value:
            raise AssertionError("a copy differs")


def outcome(call, words) -> str | None:
    """Return a description of a wrong outcome, or None if the outcome is right."""
    try:
        call()
    except (brushsvg.Error, TypeError) as refusal:
        is_one_line = "\n" not in str(refusal) or words.startswith(tuple(FITS))
        return None if is_one_line else f"{words}: more than one line: {str(refusal)[:200]}"
    except BaseException as error:  # The search is for every other kind of exception.
        return f"{words}: {type(error).__name__}: {str(error)[:200]}"
    return None


def main(names):
    for name in names:
        public = operator.attrgetter(name)(_core if name in FITS else brushsvg)
        if not callable(public):
            continue
        for count, arguments in enumerate(calls(name)):
            words = f"{name}({', '.join(repr(each)[:60] for each in arguments)})"
            print(words, file=sys.stderr, flush=True)  # Shows the last call if the process dies here.
            if count == 0 and arguments:
                public(*arguments)  # The valid call must succeed.
            if wrong := outcome(lambda f=public, given=arguments: f(*given), words):
                print(wrong, flush=True)
        for arguments in truths(name):
            if not is_refused(lambda f=public, given=arguments: f(*given)):
                print(f"{name}({arguments}): True is taken for a number", flush=True)
        if not inspect.isclass(public):
            continue
        for value in values_of(name):
            if wrong := outcome(lambda v=value: shown_and_copied(v), name):
                print(wrong, flush=True)
        for words, value, attribute in methods(name):
            print(words, file=sys.stderr, flush=True)
            found = None

            def read(value=value, attribute=attribute):
                nonlocal found
                found = getattr(value, attribute)

            if wrong := outcome(read, words):
                print(wrong, flush=True)
            if not callable(found):
                for nonsense in itertools.chain(NUMBERS, WRONG_TYPES):
                    if (
                        wrong := outcome(
                            lambda v=value, a=attribute, n=nonsense: setattr(v, a, n),
                            f"{words} = {nonsense!r}",
                        )
                    ) and "AttributeError" not in wrong:  # Read-only attributes cannot be set.
                        print(wrong, flush=True)
                continue
            for nonsense in [(), *((each,) for each in [*NUMBERS, *WRONG_TYPES])]:
                if wrong := outcome(
                    lambda f=found, n=nonsense: f(*n),
                    f"{words}{nonsense!r}",
                ):
                    print(wrong, flush=True)


if __name__ == "__main__":
    main(sys.argv[1:])
