"""Labels stay inside the picture and apart from each other.

They stay off the marks where there is room.
"""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from brushsvg.reporting import label_space
from brushsvg.reporting.label_space import LEADER_SAMPLES, LabelSpace

WIDTH, HEIGHT, CELL = 240, 160, 2.0
SIZE = (30.0, 10.0)
places = st.tuples(st.floats(0, WIDTH), st.floats(0, HEIGHT))
marks_of = st.lists(st.tuples(st.integers(0, 119), st.integers(0, 79), st.integers(1, 30)), max_size=8)


def marks_from(blocks):
    marks = np.zeros((int(HEIGHT / CELL), int(WIDTH / CELL)), bool)
    for x, y, side in blocks:
        marks[y : y + side, x : x + side] = True
    return marks


def common(one, other):
    wide = min(one[2], other[2]) - max(one[0], other[0])
    tall = min(one[3], other[3]) - max(one[1], other[1])
    return max(wide, 0.0) * max(tall, 0.0)


@settings(max_examples=40, deadline=None)
@given(st.lists(places, min_size=1, max_size=8), marks_of)
def test_labels_cover_nothing_if_a_free_candidate_exists(anchors, blocks):
    marks = marks_from(blocks)
    space, before = LabelSpace(marks, CELL, anchors=anchors, radius=2.0), []
    for anchor in anchors:
        candidates = space._candidates(np.array(anchor), np.array(SIZE), (1.0, -1.0), np.inf)
        label = space.place(anchor, [SIZE])
        left, top, right, bottom = label.box
        assert left >= 0 and top >= 0 and right <= WIDTH + 1e-9 and bottom <= HEIGHT + 1e-9
        boxes = [np.array(label.box)] if label.is_free else candidates[::7]
        for box in boxes:
            assert covers(box, marks, before, anchors, np.array(anchor)) != label.is_free
        before.append(label)


def test_crowded_labels_compare_few_leaders(monkeypatch):
    """A chart of 244 strokes took minutes to label, nearly all of them for leaders of boxes on marks."""
    compared, is_inside = [], label_space._are_points_inside

    def count(points, boxes):
        found = is_inside(points, boxes)
        compared.append(found.size)
        return found

    monkeypatch.setattr(label_space, "_are_points_inside", count)
    marks = np.zeros((160, 120), bool)
    marks[::4] = True  # no box is free of marks
    space = LabelSpace(marks, CELL)
    for x, y in np.random.default_rng(1).uniform((0, 0), (240, 320), (80, 2)):
        space.place((x, y), [(60, 10), (30, 10)])
    assert sum(compared) < 5e7, f"{sum(compared):.3g} comparisons"


def covers(box, marks, placed, anchors, anchor) -> bool:
    """Return whether a label at this box would cover something.

    This slow check looks for marks, labels and leaders under the box, and for anchors within 2 of the box.
    It also checks whether the box's own leader crosses a label.
    """
    rows, columns = np.nonzero(marks)
    cells = [(x * CELL, y * CELL, (x + 1) * CELL, (y + 1) * CELL) for x, y in zip(columns, rows, strict=True)]
    on_marks = any(common(box, cell) > 1e-9 for cell in cells)
    end = np.clip(anchor, box[:2], box[2:])
    on_lines = any(within(at, label.box) for label in placed for at in np.linspace(anchor, end, LEADER_SAMPLES)) or any(
        within(at, box) for label in placed if label.leader for at in np.linspace(*label.leader, LEADER_SAMPLES)
    )
    away = [np.hypot(*(np.clip(each, box[:2], box[2:]) - each)) for each in anchors]
    on_labels = any(common(box, label.box) > 0 for label in placed)
    return on_marks or on_lines or on_labels or min(away) <= 2.0


def within(at, box) -> bool:
    return box[0] < at[0] < box[2] and box[1] < at[1] < box[3]


def test_the_first_candidate_is_at_the_anchor_without_a_leader():
    label = LabelSpace(np.zeros((80, 120), bool), CELL).place((100, 100), [SIZE], towards=(-1, 0))
    assert label.box == pytest.approx((67, 95, 97, 105)) and label.is_free and label.leader is None


def test_a_distant_label_has_a_leader_from_its_ring():
    marks = marks_from([(0, 0, 80)])
    label = LabelSpace(marks, CELL, anchors=[(80, 80)], radius=5.0).place((80, 80), [SIZE])
    (x, y), end = label.leader
    assert label.is_free and label.left >= 160 and end[0] == pytest.approx(label.left)
    assert np.hypot(x - 80, y - 80) == pytest.approx(5.0)


def test_a_shorter_text_nearby_is_preferred_to_a_longer_one_far_away():
    marks = ~marks_from([(10, 10, 20)])
    space = LabelSpace(marks, CELL)
    assert space.place((40, 40), [(60.0, 10.0), (15.0, 10.0)]).choice == 1
    assert LabelSpace(np.zeros_like(marks), CELL).place((40, 40), [(60.0, 10.0), (15.0, 10.0)]).choice == 0


def test_a_label_without_space_covers_marks_rather_than_labels():
    space = LabelSpace(np.ones((80, 120), bool), CELL)
    labels = [space.place((120, 80), [SIZE]) for _ in range(8)]
    assert not any(label.is_free or label.covers_labels for label in labels)


def test_no_place_is_found_beyond_the_maximum_distance():
    space = LabelSpace(np.zeros((80, 120), bool), CELL)
    labels = [space.place((120, 80), [SIZE], reach=4.0) for _ in range(30)]
    assert labels[0].is_free and labels[-1].covers_labels
