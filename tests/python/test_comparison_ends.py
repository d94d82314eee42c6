"""The ends of a photographed stroke explain only the paint near them.

They explain nothing in the middle of the stroke.
"""

from brushsvg.comparison.ends import UNKNOWN_ENDS, Ends

EARLY = Ends(None, -0.3, (10.0, 20.0), (60.0, 20.0))


def test_an_end_is_named_only_near_it():
    assert EARLY.near((58.0, 21.0)) == {"ended": -0.3}
    assert EARLY.near((35.0, 20.0)) == {}, "in the middle of the stroke"
    assert EARLY.near((12.0, 20.0)) == {}, "nothing is known of where it began"


def test_both_ends_of_a_line_that_returns_to_its_start_are_named_there():
    there = Ends(0.2, -0.3, (10.0, 20.0), (11.0, 20.0))
    assert there.near((10.0, 21.0)) == {"began": 0.2, "ended": -0.3}
    assert there.near((40.0, 20.0)) == {}


def test_a_stroke_without_known_ends_names_no_end():
    assert UNKNOWN_ENDS.near((0.0, 0.0)) == {}
