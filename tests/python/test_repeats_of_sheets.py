"""`compare --sheets` names the photograph of the sheet that it cannot use."""

from types import SimpleNamespace

import pytest

from brushsvg.comparison.repeats import measure_repeats
from brushsvg.errors import Error


def test_the_photograph_with_too_few_marks_is_named():
    plan = SimpleNamespace(passes=())
    usable, unusable = SimpleNamespace(spread_mm=0.1, strokes=()), SimpleNamespace(spread_mm=None)
    with pytest.raises(Error) as refusal:
        measure_repeats(plan, ["a.jpg", "b.jpg"], [usable, unusable])
    assert (refusal.value.code, refusal.value.file) == ("marks-missing", "b.jpg")
