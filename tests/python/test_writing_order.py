"""The order in which the lines of a letter are painted.

The tests compare the positions of the lines' centres.
"""

from dataclasses import replace

import numpy as np
import pytest
from svg_text import read

from brushsvg import _core
from brushsvg.strokes.extraction import strokes
from brushsvg.strokes.skeleton.reading_order import group_areas, stand_side_by_side

# The outline of each letter, and a point on each line in writing order; y is down, as in the drawing.
LETTERS = {
    "P": ("M10 5H30A11 11 0 0 1 30 27H16V45H10ZM16 11V21H30A5 5 0 0 0 30 11Z", [(13, 35), (38, 16)]),
    "R": (
        "M10 5H30A11 11 0 0 1 33 26.6L42 45H35L26 27H16V45H10ZM16 11V21H30A5 5 0 0 0 30 11Z",
        [(13, 35), (38, 16), (35, 40)],
    ),
    "D": ("M10 5H25A20 20 0 0 1 25 45H10ZM16 11V39H25A14 14 0 0 0 25 11Z", [(13, 25), (42, 25)]),
    "B": (
        "M10 5H28A10 10 0 0 1 34 23A11.5 11.5 0 0 1 30 45H10ZM16 11V20H28A4.5 4.5 0 0 0 28 11Z"
        "M16 26V39H30A6.5 6.5 0 0 0 30 26Z",
        [(13, 25), (35, 15), (38, 33)],
    ),
    "E": ("M10 5H40V11H16V22H36V28H16V39H40V45H10Z", [(13, 33), (35, 8), (30, 25)]),
    "F": ("M10 5H40V11H16V22H36V28H16V45H10Z", [(13, 35), (35, 8), (30, 25)]),
    "G": (
        "M44 13A20 20 0 1 0 40 42L41 45H46V25H29V31H40V34A14 14 0 1 1 38.5 17Z",
        [(12, 25), (32, 28)],
    ),
    "H": ("M10 5H16V22H34V5H40V45H34V28H16V45H10Z", [(13, 40), (37, 40), (25, 25)]),
    "T": ("M5 5H45V11H28V45H22V11H5Z", [(10, 8), (25, 35)]),
    "A": ("M22 5H28L44 45H37L33 34H17L13 45H6ZM25 12L19 28H31Z", [(12, 38), (38, 38), (25, 31)]),
    "i": ("M22 20H28V45H22ZM21 5H29V12H21Z", [(25, 35), (25, 8)]),
    "j": ("M22 20H28V42A10 10 0 0 1 18 50L17 44A5 5 0 0 0 22 40ZM21 5H29V12H21Z", [(25, 35), (25, 8)]),
    "4": ("M30 5H36V30H42V36H36V45H30V36H8V30ZM30 14L16 30H30Z", [(20, 22), (33, 42)]),
    "bold 4": ("M22 5H36V30H42V36H36V45H26V36H8V29ZM26 14L16 30H26Z", [(15, 27), (31, 42)]),
    "d": ("M34 3H40V45H34V42A14 14 0 1 1 34 20ZM34 31A8 8 0 1 0 18 31A8 8 0 1 0 34 31Z", [(12, 31), (37, 8)]),
    "cross": ("M22 5H28V22H45V28H28V45H22V28H5V22H22Z", [(10, 25), (25, 10)]),
    "t": ("M22 5H28V15H38V21H28V45H22V21H12V15H22Z", [(25, 40), (14, 18)]),
    "x": ("M8 5H15L24 19L34 5H41L28 25L42 45H35L24 30L8 45H0L20 25Z", [(12, 9), (38, 9)]),
    "I with serifs": ("M12 5H38V9H29V41H38V45H12V41H21V9H12Z", [(25, 25), (15, 7), (15, 43)]),
    "F with a serif": (
        "M10 5H42V11H22V22H36V28H22V41H28V45H8V41H14V11H10Z",
        [(18, 35), (38, 8), (32, 25)],
    ),
    "slanted A": (
        "M24 5H30L44 45H38L34 32H4V26H14L10 45H4L20 5ZM26 14L20 26H31Z",
        [(12, 38), (39, 38), (6, 29)],
    ),
    "leg and stem with a serif": (
        "M3 3H24.5L44.2 47H30.4L14.6 11V47H9.7V7.3H3Z",
        [(12, 30), (5, 5), (27, 25)],
    ),
    "N": ("M10 5H16L34 34V5H40V45H34L16 16V45H10Z", [(13, 35), (25, 25), (37, 15)]),
}


def lines_of(d: str, script: str = "latin") -> list[np.ndarray]:
    made = strokes(script=script, design=read(f'<path d="{d}" fill="red" stroke="none"/>'))[0]
    flat = [_core.flatten(stroke, 0.02) for stroke in made]
    at = np.linspace(0, 1, 200)
    return [np.column_stack([np.interp(at * f[-1, 2], f[:, 2], f[:, k]) for k in (0, 1)]) for f in flat]


@pytest.mark.parametrize("d, places", LETTERS.values(), ids=LETTERS)
def test_lines_are_painted_in_writing_order(d, places):
    found = lines_of(d)
    off = np.array([[np.hypot(*(line - (x, 50 - y)).T).min() for line in found] for x, y in places])
    order = off.argmin(axis=1)
    assert (off.min(axis=1) < 3).all(), "each place is on a line"
    assert order.tolist() == sorted(order.tolist())
    assert len(set(order.tolist())) == len(places)


# Accents over a letter that begins at x = 0 and is 24 wide, from y = 18 down.
ACCENTS = {
    "acute": "m12 10l6-6h5l-6 6Z",
    "tilde": "m3 9q5-6 10-2t10-2v3q-5 6-10 2t-10 2Z",
    "ring": "m12 1a5 5 0 1 1-.1 0Zm0 2a3 3 0 1 0 .1 0Z",
    "two dots": "m4 4h4v4h-4Zm12 0h4v4h-4Z",
}


@pytest.mark.parametrize("accent", ACCENTS.values(), ids=ACCENTS)
def test_accents_follow_their_letter_in_a_word_that_is_one_path(accent):
    body = "m0 18h6v2q8-5 18 2v23h-6v-21q-6-2-12 2v19h-6Z"
    data = "".join(f"M{x} 0{part}" for x in (5, 35, 65) for part in (accent, body))
    found = lines_of(data)
    places = [line.mean(axis=0) for line in found]
    count = len(places) // 3
    assert count * 3 == len(places)
    for k, x in enumerate((5, 35, 65)):
        letter = places[k * count : (k + 1) * count]
        assert all(x < place[0] < x + 24 for place in letter)
        above = [place[1] > 50 - 14 for place in letter]
        assert any(above)
        assert above == sorted(above)


@pytest.mark.parametrize("script", ["auto", "latin"])
@pytest.mark.parametrize("bar", [(0, -5, 100, -2), (0, 33, 100, 36)], ids=["underline", "overline"])
def test_a_line_under_or_over_a_word_is_no_accent(bar, script):
    letters = [(35 * k, 0, 35 * k + 24, 30) for k in range(3)]
    groups = group_areas(np.array([bar, *letters]), script)
    assert [each for each in groups if each != [0]] == [[1], [2], [3]]


def test_a_dot_above_a_bar_comes_first_in_a_character():  # the dot of an i comes after its bar in a letter
    dot, bar = lines_of("M5 20H45V26H5ZM21 5H29V12H21Z", "cjk")
    assert dot[:, 1].mean() > bar[:, 1].mean()


@pytest.mark.parametrize(
    ("d", "first", "last"),
    [
        ("M10 10H17V17Q22 10 34 10V18Q20 17 17 28V45H10Z", (14.4, 26.5), (30.5, 14)),
        ("M10 5H28L13 45H5L18 12H10Z", (13, 8.5), (10, 42)),  # it bends as far, but falls
    ],
    ids=["r", "7"],
)
def test_an_arm_that_leaves_its_stem_in_an_arch_starts_at_the_stem(d, first, last):
    line = max(lines_of(d), key=lambda line: line[:, 0].max())
    assert np.hypot(*(line[0] - (first[0], 50 - first[1]))) < 2
    assert np.hypot(*(line[-1] - (last[0], 50 - last[1]))) < 2


def test_a_hairline_between_two_stems_is_written_upwards():
    hairline = max(lines_of("M8 5H14V31L32 8V5H38V45H32V16L14 39V45H8Z"), key=lambda line: np.ptp(line[:, 0]))
    assert np.ptp(hairline[:, 0]) > 10
    assert hairline[0, 1] < hairline[-1, 1]


def test_a_diagonal_from_one_stem_down_to_the_next_is_written_downwards():  # the diagonal of an N
    _, slant, _ = lines_of("M8 5H14V8L32 31V5H38V45H32V39L14 16V45H8Z")
    assert slant[0, 1] > slant[-1, 1]


def test_letters_are_side_by_side_but_parts_of_one_character_are_not():
    stem, dot, letter = (0, 0, 6, 30), (0, 36, 6, 42), (12, 0, 30, 30)
    assert stand_side_by_side(np.array([stem, dot, letter]))
    roof, below = (0, 30, 30, 36), (2, 0, 28, 25)
    assert not stand_side_by_side(np.array([roof, below]))


def test_the_stem_of_a_bold_4_is_not_part_of_its_slant():
    _, stem = lines_of(LETTERS["bold 4"][0])
    assert np.ptp(stem[:, 0]) < 0.5, "straight up to the top"
    assert stem[0, 1] > 38 > 12 > stem[-1, 1]


def test_a_roof_joins_the_parts_below_it_and_text_lines_follow_each_other():
    roof, left, right, near_by = (0, 30, 20, 40), (0, 5, 8, 31), (12, 5, 20, 31), (25, 5, 40, 40)
    assert [set(each) for each in group_areas(np.array([right, near_by, left, roof]), "latin")] == [
        {0, 2, 3},
        {1},
    ]
    letters = np.array([[30 * k, 0, 30 * k + 20, 20 + 10 * (k % 2)] for k in range(6)])
    two_lines = np.vstack([letters - (0, 100, 0, 100), letters])
    assert group_areas(two_lines, "auto") == [[k] for k in (*range(6, 12), *range(6))]


def test_arabic_is_written_from_the_right_with_bodies_before_dots():
    first, second, dot_of_second, dot_of_first = (
        (30, 0, 60, 20),
        (0, 0, 28, 20),
        (10, 26, 14, 30),
        (40, -8, 44, -4),
    )
    boxes = np.array([dot_of_first, second, dot_of_second, first])
    assert group_areas(boxes, "arabic") == [[3], [1], [0], [2]]


def test_a_small_arabic_letter_next_to_a_wide_one_is_no_dot():
    first, wide, dot = (64, -6, 76, 8), (0, 0, 60, 20), (30, 26, 34, 30)
    assert group_areas(np.array([wide, dot, first]), "arabic") == [[2], [0], [1]], "reh and sheen"
    alef, hamza = (6, 0, 10, 40), (2, 44, 12, 52)
    assert group_areas(np.array([hamza, alef]), "arabic") == [[1], [0]]


def test_a_dot_of_a_small_arabic_letter_next_to_a_wide_one_comes_after_both():
    wide, small, dot = [20, 0, 105, 22], [108, 12, 127, 37], [118, 5, 122, 9]
    assert group_areas(np.array([wide, dot, small]), "arabic") == [[2], [0], [1]]


def test_arabic_glyphs_that_are_paths_of_their_own_are_written_from_the_right():
    glyphs = [
        ("dot", "M18 8h4v4h-4z"),
        ("last", "M5 20H35V30H5Z"),
        ("alef", "M38 5h5v25h-5z"),
        ("first", "M46 20H76V30H46Z"),
    ]
    drawn = read("".join(f'<path id="{name}" d="{d}" fill="red" stroke="none"/>' for name, d in glyphs))
    line = read('<path id="line" d="M5 40H76"/>')
    design = replace(drawn, elements=(*drawn.elements, *line.elements))

    def order(design, script) -> list[str]:
        return [stroke.id.split("/")[0] for stroke in strokes(design, script=script)[0]]

    assert order(design, "arabic") == ["first", "alef", "last", "dot", "line"]
    assert order(design, "latin") == order(design, "auto") == ["dot", "last", "alef", "first", "line"]
    typeset = replace(design, elements=tuple(replace(each, settings={"script": "arabic"}) for each in design.elements))
    assert order(typeset, "arabic") == order(design, "auto"), "such as brushsvg text writes them"


def test_dots_and_accents_above_each_other_follow_their_letter():
    body, left, right, top = (0, 0, 60, 20), (42, 26, 46, 30), (48, 26, 52, 30), (45, 38, 49, 42)
    assert group_areas(np.array([top, left, right, body]), "arabic") == [[3], [2], [0], [1]], "a sheen"
    letter, next_letter, roof, acute = (0, 0, 30, 35), (36, 0, 60, 35), (9, 37, 21, 43), (14, 46, 22, 53)
    groups = group_areas(np.array([acute, roof, next_letter, letter]), "latin")
    assert [set(group) for group in groups] == [{3}, {0, 1}, {2}], "an A with a roof and an acute"


def test_characters_of_a_line_are_cut_at_gaps_and_each_is_one_group():
    # Two characters of two parts each, side by side.
    parts = np.array([(0, 0, 8, 20), (10, 0, 20, 20), (24, 0, 32, 20), (34, 0, 44, 20)])
    assert group_areas(parts, "cjk") == [[0, 1], [2, 3]]
    assert group_areas(parts, "latin") == [[0], [1], [2], [3]]


def test_the_headline_of_a_word_is_written_last():
    headline, stem, bowl = "M5 5H45V11H5Z", "M36 8H42V45H36Z", "M10 18H16V30H38V36H10Z"
    made = strokes(read(f'<path d="{headline}{stem}{bowl}" fill="red" stroke="none"/>'), script="devanagari")[0]
    line = _core.flatten(made[-1], 0.02)
    assert np.ptp(line[:, 0]) > 30
    assert np.allclose(line[:, 1], 50 - 8, atol=1)


def test_a_flat_line_of_arabic_runs_to_the_left():
    def start_and_end(script):
        line = _core.flatten(strokes(read('<path d="M5 20H45V26H5Z" fill="red"/>'), script=script)[0][0], 0.02)
        return line[0, 0], line[-1, 0]

    start, end = start_and_end("arabic")
    assert start > end
    start, end = start_and_end("latin")
    assert start < end


@pytest.mark.parametrize("script", ["auto", "latin"])
def test_the_stem_of_a_t_or_f_comes_before_its_crossbar(script):
    t = LETTERS["t"][0]
    f = "M38 5V11H32Q28 11 28 15V19H36V25H28V45H22V25H15V19H22V15Q22 5 32 5Z"
    for letter in (t, f):
        stem, bar = lines_of(letter, script)
        assert np.ptp(stem[:, 1]) > 30
        assert np.ptp(bar[:, 1]) < 2


def test_the_bar_of_a_character_comes_before_the_line_that_crosses_it():  # "auto" reads this form as a t
    wide_and_high = "M22 5H28V16H44V22H28V45H22V22H6V16H22Z"  # 十 with a bar as high as that of a t
    bar, stem = lines_of(wide_and_high, "cjk")
    assert np.ptp(bar[:, 0]) > 30
    assert np.ptp(stem[:, 1]) > 30
