"""Settings that a drawing gives to an element for brushsvg.

They are values in C++ and Python, and JSON in plan.json only.
"""

import numpy as np
import pytest

from brushsvg import Error, Pass, Plan, Settings, _core, find_brush, write_plan

ALL = {
    "brush": "b",
    "end": "butt",
    "kind": "arc",
    "order": -3,
    "passes": 2,
    "reload": True,
    "skip": False,
    "speed_mm_s": 7.0,
    "start": "round",
    "width_mm": 0.1,
}
WRITTEN = (
    '{"brush":"b","end":"butt","kind":"arc","order":-3,"passes":2,"reload":true,"skip":false,"speed_mm_s":7.0,'
    '"start":"round","width_mm":0.1}'
)


def plan_with(settings):
    return Plan("b", "", (9, 9), [Pass("a", np.zeros((1, 3)), settings=settings)])


def test_settings_are_written_and_read_back():
    text = write_plan(plan_with(Settings(**ALL)))
    assert f'"settings": {WRITTEN}' in text
    (back,) = _core.read_plan(text).passes
    assert back.settings == Settings(**ALL)
    assert {name: getattr(back.settings, name) for name in ALL} == ALL
    assert '"settings": {}' in write_plan(plan_with(Settings()))


def test_unknown_keys_are_kept_after_the_known_ones():
    text = write_plan(plan_with(Settings(order=1)))
    text = text.replace('{"order":1}', '{"theirs":[1,{"a":2.50}],"order":1}')
    (back,) = _core.read_plan(text).passes
    assert (back.settings.order, back.settings.extra) == (1, '{"theirs":[1,{"a":2.5}]}')
    assert '"settings": {"order":1,"theirs":[1,{"a":2.5}]}' in write_plan(plan_with(back.settings))


@pytest.mark.parametrize("name", ALL)
def test_each_setting_is_part_of_the_value(name):
    one, same, none = Settings(**{name: ALL[name]}), Settings(**{name: ALL[name]}), Settings()
    assert one == same and hash(one) == hash(same) and one != none
    assert repr(one) == f"Settings({name}={ALL[name]!r})"
    with pytest.raises(AttributeError):
        setattr(one, name, None)
    assert Settings(extra='{"a":1}') != none and none != "Settings()"


@pytest.mark.parametrize("name", ALL)
def test_a_value_of_another_type_is_refused_on_reading(name):
    text = write_plan(plan_with(Settings())).replace('"settings": {}', f'"settings": {{"{name}": [1]}}')
    with pytest.raises(Error) as refused:
        _core.read_plan(text)
    assert (refused.value.where, refused.value.code) == (f"passes[0].settings.{name}", "wrong-type")


def test_a_pass_has_the_settings_of_its_stroke():
    stroke = _core.Stroke("a", [[0, 0, 5, 0, 9, 0, 20, 0]], half_width=[(0, 1)], settings=Settings(order=4))
    made = _core.compensate([stroke], find_brush("round-6"), (50, 50))
    assert made.plan.passes[0].settings == stroke.settings == Settings(order=4)


def test_settings_that_are_not_replaced_stay():
    settings = Settings(**ALL)
    for name in ALL:
        now = settings.replaced(**{name: None})
        assert now == Settings(**{key: value for key, value in ALL.items() if key != name})
    assert settings.replaced(order=9) == Settings(**{**ALL, "order": 9})
    stroke = _core.Stroke("a/1", [[0, 0, 5, 0, 9, 0, 20, 0]], False, [(0, 1)], "ink", "#123456", settings)
    stroke.target_mm = [np.array([[0, 0], [5, 0], [0, 5]])]
    fields = ("id", "middle_mm", "closed", "half_width", "layer", "colour", "settings", "target_mm")
    for name, value in (("id", "b"), ("closed", True), ("layer", "x"), ("settings", Settings())):
        now = stroke.replaced(**{name: value})
        assert getattr(now, name) == value
        for other in set(fields) - {name}:
            assert np.array_equal(getattr(now, other), getattr(stroke, other)), other
    assert stroke.id == "a/1", "the stroke itself is as it was"
    with pytest.raises(AttributeError):
        stroke.replaced(width=1)
    with pytest.raises(TypeError):
        settings.replaced(width=1)
