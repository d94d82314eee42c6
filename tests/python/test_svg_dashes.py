import numpy as np
import pytest
from diagnostics import agrees, are_reported, refused
from scipy.integrate import quad
from svg_text import lines, read

from brushsvg.geometry.arc_length import knots, parameters_at
from brushsvg.read.dashes import cut_into_dashes
from brushsvg.read.design import SubPath
from brushsvg.read.svg import element


def speed(t, cubic):
    d = 3 * np.diff(cubic, axis=0)
    return np.hypot(*((1 - t) ** 2 * d[0] + 2 * t * (1 - t) * d[1] + t * t * d[2]))


def test_arc_length_agrees_with_quadrature():
    random = np.random.default_rng(3)
    cubics = random.uniform(0, 50, (40, 4, 2))
    cubics[1:, 0] = cubics[:-1, 3]
    cubics[5] = cubics[5, :1]  # all four points coincide
    known = knots(cubics)
    truth = [quad(speed, 0, 1, args=(cubic,), epsabs=1e-10, limit=200)[0] for cubic in cubics]
    error = np.abs(known[:, -1] - truth)
    assert error.max() < 5e-3  # [mm]; largest where a handle turns the line back on itself
    assert np.median(error) < 1e-8
    at = np.linspace(0, sum(truth), 200)
    number, t = parameters_at(cubics, known, at)
    begins = np.concatenate([[0], np.cumsum(known[:, -1])])
    for k, end, distance in zip(number, t, at, strict=True):
        assert begins[k] + quad(speed, 0, end, args=(cubics[k],), limit=200)[0] == pytest.approx(distance, abs=5e-3)


def test_dashes_divide_a_straight_line():
    design = read('<path id="p" d="M0 0H20" stroke-dasharray="4 2" stroke-dashoffset="1"/>')
    spans = [(start[0], end[0]) for _, start, end in lines(design)]
    assert spans == [(0, 3), (5, 9), (11, 15), (17, 20)]
    assert are_reported(design.notices, "dashed p 4")


@pytest.mark.parametrize(
    ("attributes", "count"),
    [
        ('stroke-dasharray="3"', 4),
        ('stroke-dasharray="3 1 2"', 5),
        ('stroke-dasharray="10%"', 2),
        ('stroke-dasharray="0 5"', 4),
        ('stroke-dasharray="30"', 1),
        ('stroke-dasharray="4 1"', 4),
        ('stroke-dasharray="4 1" transform="scale(.7)"', 4),
        ('stroke-dasharray="4 1" transform="rotate(31)"', 4),
        ('stroke-dasharray="1mm 1mm"', 3),
        ('stroke-dasharray="0"', 1),
        ('stroke-dasharray="3 -1"', 1),
        ('stroke-dasharray="none"', 1),
        ('style="stroke-dasharray:5px,5px;stroke-dashoffset:-5"', 2),
    ],
)
def test_dash_patterns_are_read(attributes, count):
    assert len(read(f'<path d="M0 0H20" {attributes}/>').elements[0].subpaths) == count


@pytest.mark.parametrize(
    ("expected", "ends"),
    [("10", [0, 4, 8, 12, 16, 20]), ("40", [0, 1, 2, 3, 4, 5]), ("0", [0, 20]), ("-3", [0, 2, 4, 6, 8, 10])],
)
def test_path_length_stretches_the_dashes(expected, ends):
    """pathLength stretches the dashes.

    A path of 20 mm with a pathLength of 10 has dashes twice as long. With a pathLength of 0, the line is
    solid.
    """
    design = read(f'<path d="M0 0H20" stroke-dasharray="2" pathLength="{expected}"/>')
    spans = [(start[0], end[0]) for _, start, end in lines(design)]
    assert np.ravel(spans)[: len(ends)] == pytest.approx(np.array(ends))
    (notice, *_) = read('<path id="p" d="M0 0H20" stroke-dasharray="2" pathLength="x"/>').notices
    assert agrees(notice, "path-length-unread pathLength x", "p")


def test_path_length_covers_all_sub_paths_and_stretches_the_offset():
    body = '<path d="M0 0H20M0 9H20" stroke-dasharray="2" stroke-dashoffset="1" pathLength="20" transform="scale(.5)"/>'
    spans = [(start[0], end[0]) for _, start, end in lines(read(body))]
    assert spans[:2] == [(0, 1), (3, 5)] and len(spans) == 6


@pytest.mark.parametrize("more", ["", ' pathLength="2"'])
def test_dashes_of_a_non_scaling_stroke_do_not_scale(more):
    """Dashes of a non-scaling stroke do not scale either.

    They are in px of the screen, like the stroke's width: 3 mm are 3 mm under any transform. With pathLength,
    a dash keeps its share of the line.
    """
    body = '<path d="M0 0H5" transform="scale(4 8)" stroke-dasharray="{}" vector-effect="non-scaling-stroke"{}/>'
    design = read(body.format(".5" if more else "5mm", more))
    assert [notice.code for notice in design.notices] == ["dashed"], "its width is as even as its dashes"
    spans = [(start[0], end[0]) for _, start, end in lines(design)]
    assert np.allclose(spans, [(0, 5), (10, 15)])


def test_an_invalid_dash_list_is_reported():
    for text in ("20 10,", "1,,2", ",3"):
        (notice,) = read(f'<path d="M0 0H20" stroke-dasharray="{text}"/>').notices
        assert agrees(notice, "dashes-unread stroke-dasharray")


def test_dashes_continue_around_corners_and_across_the_seam():
    square = read('<path d="M0 0H10V10H0Z" stroke-dasharray="7 3"/>').elements[0].subpaths
    assert all(not piece.closed for piece in square)
    assert [round(float(knots(piece.cubics)[:, -1].sum()), 9) for piece in square] == [7, 7, 7, 7]
    seam = read('<path d="M0 0H10V10H0Z" stroke-dasharray="5 3" stroke-dashoffset="2"/>').elements[0].subpaths
    assert [round(float(knots(piece.cubics)[:, -1].sum()), 6) for piece in seam] == [5, 5, 5, 5, 5]
    assert seam[0].cubics[0, 0].tolist() != [0, 50], "the last dash and the first are one"


def test_each_dash_is_on_the_line():
    cubics = np.array([[[0, 0], [10, 30], [30, -30], [40, 0]]], float)
    pieces = cut_into_dashes(SubPath(cubics), [2.0, 1.0], 0.5, 1000)
    t = np.linspace(0, 1, 4001)[:, None]
    p = cubics[0]
    curve = (1 - t) ** 3 * p[0] + 3 * t * (1 - t) ** 2 * p[1] + 3 * t * t * (1 - t) * p[2] + t**3 * p[3]
    for piece in pieces:
        for point in piece.cubics[:, [0, 3]].reshape(-1, 2):
            assert np.hypot(*(curve - point).T).min() < 0.01
    lengths = [knots(piece.cubics)[:, -1].sum() for piece in pieces]
    assert np.allclose(lengths[1:-1], 2.0, atol=1e-6)


def test_too_many_dashes_are_refused(monkeypatch):
    monkeypatch.setattr(element, "_MAX_DASHES", 300)
    line = '<path id="p" d="M0 0H20" stroke-dasharray="0.05"/>'
    assert len(read(line).elements[0].subpaths) == 200
    with refused("drawing-too-large 200 100"):
        read(line + line)
