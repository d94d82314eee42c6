"""Every public value type: its repr, its equality, and its copies.

Copies are complete and share nothing with their original.
"""

import copy
import inspect
import pickle
import subprocess
import sys
from xml.etree import ElementTree

import numpy as np
import pytest
from svg_text import read

import brushsvg
from brushsvg import _core, laws
from brushsvg.errors import Notice
from brushsvg.read.design import Design, Element, SubPath
from brushsvg.reporting.report_text import Report

NAN = float("nan")
BRUSH = brushsvg.find_brush("round-6")
SQUARE = np.array([[-4, -3], [15, -3], [15, 10], [-4, 10.0]])
LINE = [[10, 10, 20, 10, 30, 10, 40, 20.0]]
POSES = [(20, 20, 0), (30, 20, -2), (40, 20, -2), (50, 30, -2.0)]
PASS = _core.Pass("a", POSES, 9.0, "Ink", "#102030", _core.Settings(order=3), '{"k": 1}', load=2)
ARC_PASS = _core.Pass("b", [(20, 20, -2), (30, 30, -2)], arcs=[_core.Arc(0, 1, (30, 20), -1)])
PLAN = _core.Plan("round-6", "ab", (100, 60), [PASS, ARC_PASS], '{"k": 2}')
STROKE = _core.Stroke(_core.StrokeId("s", 2), LINE, False, [(0, 1), (1, 2)], "Ink", "#102030")
LAWS = _core.MarkLaws([4, 1], [0, 1], [0, 0.4])
DEPTHS, VALUES = [1.0, 2, 3, 4, 5], [2.0, 3.1, 3.9, 5.1, 6.0]


def with_(value, **fields):
    made = copy.copy(value)
    for name, other in fields.items():
        setattr(made, name, other)
    return made


LEANING = _core.Plan("round-6", "ab", (100, 60), [with_(PASS, tool_axes=[(0.0, 0.28, 0.96)] * 4)])


def marks(plan=PLAN):
    made = brushsvg.simulate(plan, BRUSH)
    brushsvg.trace_outlines(made, BRUSH)
    return made


def compensated(**how):
    return brushsvg.compensate([STROKE], BRUSH, (100, 60), **how)


def mark_fit(noise_mm=0.1):
    options = _core.MarkOptions()
    options.noise_mm, options.spacing_mm = noise_mm, 2.0
    ways = [PASS.poses_mm, PASS.poses_mm * (1, -1, 1)]
    painted = [_core.PaintedMark(str(k), way, [SQUARE + way[1, :2]]) for k, way in enumerate(ways)]
    return _core.fit_marks(painted, LAWS, options)


def law_fit(more=0.0):
    return laws.fit_law(DEPTHS, [*VALUES[:-1], VALUES[-1] + more], 1)


def branch(width=9.0):
    box = np.array([[0, 0], [30, 0], [30, width], [0, width]])
    return _core.medial_axis([box], 0.2)[1][0]


def scores(shift=0.0):
    painted = brushsvg.simulate(compensated().plan, BRUSH)
    return _core.score_strokes(painted.passes, [with_(STROKE, middle_mm=np.array(LINE) + shift)], BRUSH)[0]


def design(width=3.0, last_mm=NAN):
    line = SubPath(np.array(LINE).reshape(1, 4, 2), widths=np.array([[0, 1], [1, last_mm]]))
    return Design((90, 60), (Element("p", (line,), width),), (Notice("p", "it is so"),), "T")


def calibrated(folder, more=0.0):
    rows = [f"lag,{d},{v}\nwidth,{d},{v + more}" for d, v in zip(DEPTHS, VALUES, strict=True)]
    path = folder / f"m{more:g}.csv"
    path.write_text("\n".join(["kind,depth_mm,value_mm", *rows]))
    return brushsvg.calibrate(path)


# class: values that all differ from each other
PROFILES = [
    _core.Profile([1, 2]),
    _core.Profile([1, 2, 0]),
    *(
        _core.Profile([1, 2], **{name: value})
        for name, value in {
            "floor": 0.0,
            "floor_slope": 0.5,
            "calibrated_mm": (1, 9),
            "source": "s",
            "assumed": True,
            "half_interval_95": [0.1, NAN],
            "rmse_mm": 0.2,
            "degrees_of_freedom": 4.0,
            "extra": '{"k": 1}',
        }.items()
    ),
]
TABLE = BRUSH.footprints
OTHER_TABLE = _core.FootprintTable(TABLE.dragged[:2], TABLE.dragged[:1])
SHAPE = dict(range_mm=(0, 10), degree=1)
VALUES_OF = {
    _core.Profile: lambda _: PROFILES,
    _core.Paint: lambda _: [
        _core.Paint(0.2),
        *(
            _core.Paint(0.2, **{name: value})
            for name, value in {
                "lasts_mm": 300.0,
                "calibrated_mm": (0, 400),
                "source": "s",
                "assumed": True,
                "covariance": [[0.01]],
                "degrees_of_freedom": 4.0,
                "extra": '{"k": 1}',
            }.items()
        ),
    ],
    _core.Footprint: lambda _: [_core.Footprint(1, SQUARE), _core.Footprint(2, SQUARE), TABLE.dragged[1]],
    _core.FootprintTable: lambda _: [TABLE, OTHER_TABLE, _core.FootprintTable(TABLE.dragged[:2], [])],
    _core.Brush: lambda _: [
        BRUSH,
        brushsvg.Brush(),
        *(with_(BRUSH, **{law: PROFILES[3]}) for law in ("lag", "tip_gap", "tip_to_widest", "half_width")),
        *(
            with_(BRUSH, **{name: value})
            for name, value in {
                "name": "b",
                "kind": "flat",
                "depth_range_mm": (0, 9),
                "footprints": OTHER_TABLE,
                "covariance": [[1.0, 2.0], [2.0, 1.0]],
                "paint": _core.Paint(0.3),
                "max_speed_mm_s": 3.0,
                "paint_depth_mm": 3.0,
                "sha256": "ff",
                "extra": "{}",
            }.items()
        ),
    ],
    _core.Settings: lambda _: [
        _core.Settings(),
        *(_core.Settings(**{name: "x"}) for name in ("brush", "end", "kind", "start", "extra")),
        *(_core.Settings(**{name: 3}) for name in ("order", "passes", "speed_mm_s", "width_mm")),
        *(_core.Settings(**{name: True}) for name in ("reload", "skip")),
    ],
    _core.StrokeId: lambda _: [
        _core.StrokeId("a"),
        _core.StrokeId("a/2"),
        *(_core.StrokeId("a", **{name: 2}) for name in ("part", "repeat", "lane", "load")),
    ],
    _core.Stroke: lambda _: [
        STROKE,
        brushsvg.Stroke(),
        *(
            with_(STROKE, **{name: value})
            for name, value in {
                "id": "s/2",
                "middle_mm": np.array(LINE) + 1,
                "closed": True,
                "half_width": [(0, 1), (1, 3)],
                "target_mm": [SQUARE],
                "start_covered": True,
                "end_covered": True,
                "layer": "x",
                "colour": "#ffffff",
                "settings": _core.Settings(skip=True),
            }.items()
        ),
    ],
    _core.Arc: lambda _: [
        _core.Arc(0, 1, (3, 4), 1),
        _core.Arc(1, 1, (3, 4), 1),
        _core.Arc(0, 2, (3, 4), 1),
        _core.Arc(0, 1, (3, 5), 1),
        _core.Arc(0, 1, (3, 4), -1),
    ],
    _core.Pass: lambda _: [
        PASS,
        ARC_PASS,
        brushsvg.Pass(),
        *(
            with_(PASS, **{name: value})
            for name, value in {
                "stroke": "x",
                "poses_mm": np.array(POSES)[1:],
                "arcs": [_core.Arc(0, 1, (30, 20), -1)],
                "speed_mm_s": 3.0,
                "layer": "x",
                "colour": "#ffffff",
                "settings": _core.Settings(skip=True),
                "load": 3,
                "extra": "{}",
                "tool_axes": [(0.0, 0.6, 0.8)] * 4,
            }.items()
        ),
    ],
    _core.Plan: lambda _: [
        PLAN,
        brushsvg.Plan(),
        *(
            with_(PLAN, **{name: value})
            for name, value in {
                "brush": "b",
                "brush_sha256": "",
                "sheet_mm": (9, 9),
                "passes": [PASS],
                "extra": "{}",
            }.items()
        ),
    ],
    _core.PassMarks: lambda _: [
        marks().passes[0],
        brushsvg.simulate(PLAN, BRUSH).passes[0],
        brushsvg.simulate(LEANING, BRUSH).passes[0],
        with_(marks().passes[0], stroke="x"),
        marks().passes[1],
        _core.PassMarks(),
    ],
    _core.Marks: lambda _: [
        marks(),
        brushsvg.simulate(PLAN, BRUSH),
        with_(marks(), outline_mm=[SQUARE]),
        with_(marks(), passes=marks().passes[:1]),
        brushsvg.Marks(),
    ],
    brushsvg.Compensated: lambda _: [
        compensated(),
        compensated(method="none"),
        compensated(tolerance_mm=0.2),
    ],
    _core.TrackingError: lambda _: [
        compensated().tracking_errors[0],
        compensated(method="none").tracking_errors[0],
    ],
    _core.AxisBranch: lambda _: [branch(), branch(8.0)],
    _core.CommonArea: lambda _: [_core.CommonArea(1, 2), _core.CommonArea(1, 3), _core.CommonArea(2, 2)],
    _core.StrokeScore: lambda _: [scores(), scores(1.0)],
    _core.WorstPlace: lambda _: [scores().worst, scores(1.0).worst],
    _core.LawShape: lambda _: [
        _core.LawShape(**SHAPE),
        _core.LawShape((0, 9), 1),
        _core.LawShape((0, 10), 2),
        *(_core.LawShape(**SHAPE, **{name: True}) for name in ("through_zero", "positive", "rising")),
        *(_core.LawShape(**SHAPE, **{name: 0.5}) for name in ("floor", "smoothing")),
        _core.LawShape(**SHAPE, norm=_core.Norm.absolute),
    ],
    _core.LawFit: lambda _: [law_fit(), law_fit(0.3)],
    _core.PaintedMark: lambda _: [
        _core.PaintedMark("a", POSES, [SQUARE]),
        _core.PaintedMark("b", POSES, [SQUARE]),
        _core.PaintedMark("a", POSES[1:], [SQUARE]),
        _core.PaintedMark("a", POSES, [SQUARE[1:]]),
        _core.PaintedMark("a", POSES, [SQUARE], [_core.Arc(0, 1, (30, 20), -1)]),
    ],
    _core.Prior: lambda _: [_core.Prior(1, 2), _core.Prior(1, 3), _core.Prior(2, 2)],
    _core.MarkLaws: lambda _: [
        LAWS,
        _core.MarkLaws([4], [0, 1], [0, 0.4]),
        _core.MarkLaws([4, 1], [0, 2], [0, 0.4]),
        _core.MarkLaws([4, 1], [0, 1], [0, 0.5]),
        _core.MarkLaws([4, 1], [0, 1], [0, 0.4], widest_per_half=2),
        _core.MarkLaws([4, 1], [0, 1], [0, 0.4], front_per_half=2),
        _core.MarkLaws([4, 1], [0, 1], [0, 0.4], round_tail=True),
        _core.MarkLaws([4, 1], [0, 1], [0, 0.4], widest_by_depth=[1.8, 0.1]),
        _core.MarkLaws([4, 1], [0, 1], [0, 0.4], front_by_depth=[1.0, 0.1]),
    ],
    _core.LawPrior: lambda _: [
        _core.LawPrior(LAWS, [[1.0, 2.0]]),
        _core.LawPrior(LAWS, [[1.0, 3.0]]),
        _core.LawPrior(_core.MarkLaws([4], [0, 1], [0, 0.4]), [[1.0, 2.0]]),
    ],
    _core.MarkOptions: lambda _: [
        _core.MarkOptions(),
        *(
            with_(_core.MarkOptions(), **{name: other})
            for name in dir(_core.MarkOptions)
            if not name.startswith("_")
            for other in [another(getattr(_core.MarkOptions(), name), name)]
        ),
    ],
    _core.Machine: lambda _: [mark_fit().machine],
    _core.MarkResidual: lambda _: mark_fit().marks,
    _core.MarkFit: lambda _: [mark_fit(), mark_fit(0.2)],
    brushsvg.Cell: lambda _: [brushsvg.find_cell("ur5e"), brushsvg.find_cell("grbl-3axis")],
    brushsvg.ReadOptions: lambda _: [brushsvg.ReadOptions(), brushsvg.ReadOptions(units="in")],
    Design: lambda _: [design(), design(4.0)],
    Element: lambda _: [design().elements[0], design(4.0).elements[0]],
    SubPath: lambda _: [
        design().elements[0].subpaths[0],
        SubPath(np.ones((1, 4, 2))),
        SubPath(np.ones((2, 4, 2))),
    ],
    Notice: lambda _: [Notice("a", "b"), Notice("a", "c")],
    laws.Followed: lambda _: [laws.follow([[0, 0], [9, k]], 2.0, 4.0) for k in (0, 1)],
    laws.FromAngles: lambda _: [laws.from_angles(1.5, [1, 3, 6], [1.2, 0.9, k]) for k in (0.5, 0.6)],
    laws.Bristle: lambda _: [laws.bristle(np.ones_like, load) for load in (np.ones_like, np.exp)],
    "Chart": lambda _: [brushsvg.chart(BRUSH, (210, 297)), brushsvg.chart(BRUSH, (297, 420))],
    "Conversion": lambda _: [
        brushsvg.convert(read(f'<path id="a" d="M30 {y}h20" fill="none" stroke="red" stroke-width="2"/>'))
        for y in (30, 31)
    ],
    "PaperPlacement": lambda _: [brushsvg.place_paper(each, sheet=(60.0, 50.0)) for each in ("ur3e", "ur5e")],
    "SetupProgram": lambda _: [brushsvg.setup_height("grbl-3axis", lowest=each) for each in (-1.0, -0.5)],
    "SimulatedPhoto": lambda _: [brushsvg.SimulatedPhoto(b"", "", count) for count in (1, 2)],
    "Check": lambda folder: [checked(folder, 30), checked(folder, 31)],
    "PaintedJob": lambda _: [
        brushsvg.PaintedJob(*painted, CELL, False, (), Report("good", ()), "") for painted in PAINTED_JOBS
    ],
    "Project": lambda _: [brushsvg.Project("a.toml", {"brush": each}) for each in ("rigid", "round-6")],
    "Batch": lambda _: [brushsvg.Batch((), 0, ()), brushsvg.Batch((), 1, ("a.csv",))],
    "BrushCalibration": lambda folder: [calibrated(folder), calibrated(folder, 0.1)],
    "Calibration": lambda folder: [calibrated(folder).fit, calibrated(folder, 0.1).fit],
}
CELL = brushsvg.find_cell()
PAINTED_JOBS = [("word", overlap, (), {}, None, {}) for overlap in (0.8, 0.9)]
NAMES = {each if isinstance(each, str) else each.__name__: values for each, values in VALUES_OF.items()}


def checked(folder, y):
    line = read(f'<path id="a" d="M30 {y}h20" fill="none" stroke="red" stroke-width="2"/>')
    brushsvg.convert(line, folder / f"{y}.ngc")
    return brushsvg.check(folder / f"{y}.ngc", line)


def another(value, name):
    if isinstance(value, _core.Prior):
        return _core.Prior(value.value + 1, 7.0)
    if name == "laws":
        return _core.LawPrior(LAWS, [[1.0]])
    return not value if isinstance(value, bool) else (value or 0) + 1


def can_be_hashed(value):
    try:
        hash(value)
    except TypeError:  # the value is mutable or contains a mutable value
        return False
    return True


def fields_of(value):
    """Return the public fields as plain values that numpy can compare.

    The function never calls the equality of the value itself.
    """
    if isinstance(value, np.ndarray):
        return value.tolist()
    if isinstance(value, list | tuple):
        return [fields_of(each) for each in value]
    if type(value).__module__.startswith("brushsvg") and not isinstance(type(value).__dict__.get("name"), str):
        names = [n for n in dir(value) if not n.startswith("_")]
        found = {n: getattr(value, n) for n in names}
        return {n: fields_of(f) for n, f in found.items() if not callable(f) or isinstance(f, _core.Profile)}
    return value


def arrays_of(value, way=()):
    """Yield (path of fields, array) for all arrays in public fields."""
    if isinstance(value, np.ndarray):
        yield way, value
    elif isinstance(value, tuple):
        for k, each in enumerate(value[:3]):
            yield from arrays_of(each, (*way, k))
    elif type(value).__module__.startswith("brushsvg"):
        for name in dir(value):
            if not name.startswith("_") and not inspect.isroutine(getattr(value, name)):
                yield from arrays_of(getattr(value, name), (*way, name))


def reached(value, way):
    for step in way:
        value = value[step] if isinstance(step, int) else getattr(value, step)
    return value


def test_every_value_type_is_tested():
    classes = {each for _, each in inspect.getmembers(_core, inspect.isclass)}
    public = {getattr(brushsvg, name) for name in brushsvg.__all__} | {getattr(laws, n) for n in laws.__all__}
    enums = {_core.Norm, _core.Lines}
    target = classes - enums | {each for each in public if inspect.isclass(each)} - {brushsvg.Error}
    assert {each.__name__ for each in target} <= set(NAMES)


@pytest.mark.parametrize("name", NAMES)
def test_values_support_repr_comparison_copy_and_pickle(name, tmp_path):
    values = list(NAMES[name](tmp_path))
    for number, value in enumerate(values):
        shown = repr(value)
        assert type(value).__name__ in shown and " at 0x" not in shown and "\n" not in shown
        assert len(shown) < 250 or name == "Cell", shown
        for made in (copy.copy(value), copy.deepcopy(value), pickle.loads(pickle.dumps(value))):
            assert made is not value and type(made) is type(value)
            assert made == value
            assert (made != value) is False
            assert repr(fields_of(made)) == repr(fields_of(value))
            if can_be_hashed(value):
                assert hash(made) == hash(value)
        assert value != name and (value == None) is False  # noqa: E711
        assert [value == other for other in values] == [k == number for k in range(len(values))], shown


@pytest.mark.parametrize("name", NAMES)
def test_writing_to_an_array_raises_or_changes_its_owner(name, tmp_path):
    """Writing to an array either raises or changes the value that owns it."""
    value = NAMES[name](tmp_path)[0]
    for way, array in arrays_of(value):
        if array.size == 0:
            continue
        before = array.flat[0]
        other = not before if array.dtype == bool else before + 1
        try:
            array.flat[0] = other
        except ValueError as error:
            assert "read-only" in str(error)
            continue
        assert reached(value, way).flat[0] == other, way
        array.flat[0] = before


def test_a_copy_shares_nothing():
    for made in (copy.copy(PLAN), copy.deepcopy(PLAN), pickle.loads(pickle.dumps(PLAN))):
        made.passes[0].speed_mm_s = 1.0
        made.passes[0].poses_mm = made.passes[0].poses_mm + 1
        assert PLAN.passes[0].speed_mm_s == 9.0
        assert PLAN.passes[0].poses_mm.tolist() == [list(map(float, pose)) for pose in POSES]


def test_a_pickle_of_another_version_is_refused():
    state = _core.Arc(0, 1, (3, 4), 1).__getstate__()
    with pytest.raises(TypeError, match="another version"):
        _core.Arc.__new__(_core.Arc).__setstate__(state[:-1])


@pytest.mark.parametrize("kind", [kind for kind in vars(_core).values() if isinstance(kind, type)])
def test_an_unconstructed_object_raises_type_error(kind):
    """An object without a finished constructor raises TypeError instead of crashing.

    A debugger shows such objects, and so does pytest when a constructor refuses its arguments. Uninitialized
    memory was once read.
    """
    unmade = kind.__new__(kind)
    fields = [name for name, field in inspect.getmembers(kind) if isinstance(field, property)]
    asks = [lambda name=name: getattr(unmade, name) for name in fields]
    asks += [lambda: repr(unmade)] if kind.__repr__ is not object.__repr__ else []
    asks += [lambda: pickle.dumps(unmade), lambda: unmade == unmade] if kind in VALUES_OF else []
    assert asks, "there is something to ask of each"
    for ask in asks:
        with pytest.raises(TypeError, match="not initialised"):
            ask()


def test_repr_shows_sizes_and_units():
    reported = [
        (BRUSH, "round-6", "0 to 10 mm", "3.1 to 13.7 mm", "8.4 mm"),
        (PLAN, "round-6", "2 passes", "6 poses", "100 x 60 mm"),
        (PASS, "'a'", "4 poses", "34.14 mm", "2 mm", "9 mm/s"),
        (STROKE, "'s/2'", "1 cubic", "32.68 mm", "2 to 4 mm"),
        (_core.Profile([3.1, 0, -0.5], calibrated_mm=(1, 10)), "3.1 - 0.5 d^2 mm", "1 to 10 mm"),
    ]
    for value, *parts in reported:
        assert all(part in repr(value) for part in parts), repr(value)


def test_repr_pictures_exist_only_in_notebooks():
    asks = "import brushsvg; print(hasattr(brushsvg.find_brush('round-6'), '_repr_svg_'))"
    runs = "import sys, types; sys.modules['IPython'] = types.ModuleType('IPython'); " + asks
    for words, expected in ((asks, "False"), (runs, "True")):
        done = subprocess.run([sys.executable, "-c", words], capture_output=True, text=True, check=True)
        assert done.stdout.strip() == expected


def test_values_have_pictures_in_a_notebook(tmp_path):
    from brushsvg import notebook

    for value, part in (
        (PLAN, "polyline"),
        (marks(), "path"),
        (design(last_mm=2.0), "path"),
        (BRUSH, "path"),
    ):
        root = ElementTree.fromstring(value._repr_svg_())
        assert [e for e in root.iter() if e.tag.endswith(part)], part
    for empty in (brushsvg.Brush(), brushsvg.Plan(), brushsvg.Marks(), Design((90, 60), ())):
        picture = empty._repr_svg_()
        assert picture is None or isinstance(empty, Design)
    far = _core.Plan("b", "", (9, 9), [_core.Pass("a", [[NAN, 0, 0], [1, 1, 0]])])
    assert far._repr_svg_() is None
    assert notebook.plan_svg(PLAN).count("<polyline") == 2


@pytest.mark.parametrize("name", ["element", "layer", "colour"])
def test_bytes_are_not_accepted_as_text(name):
    with pytest.raises(TypeError):
        STROKE.replaced(**({"id": _core.StrokeId(b"a")} if name == "element" else {name: b"a"}))
