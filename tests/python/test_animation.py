"""The animation page shows the timeline, and no text in it can inject code."""

import json
import re

import numpy as np
import pytest
from programs import whole

from brushsvg.jobs import outputs, prediction
from brushsvg.jobs.preparation import preparation
from brushsvg.machine.cells.cell_file import find_cell
from brushsvg.machine.writer import whole_program
from brushsvg.show.timeline import timeline

HOSTILE = "</script><script>alert(1)</script><!-- ]]> & \" ' \u2028 \ud83d"
LINE = '<path id="{}" d="M20 40 C40 10 60 10 90 30" fill="none" stroke="#203060" stroke-width="3"/>'


def work_of(folder, name="line", title="A line"):
    file = folder / "a.svg"
    size = 'width="120mm" height="60mm" viewBox="0 0 120 60"'
    file.write_text(f'<svg xmlns="http://www.w3.org/2000/svg" {size}>{LINE.format(name)}</svg>')
    work = preparation.prepare(file)
    object.__setattr__(work, "title", title)
    return work, prediction.predict(work)


def played_of(tmp_path):
    work, marks = work_of(tmp_path)
    return work, whole(work.plan), marks


def data_of(page: bytes) -> dict:
    (text,) = re.findall(rb'<script id="data" type="application/json">(.*?)</script>', page, re.DOTALL)
    return json.loads(text)


def test_page_rows_match_the_timeline_within_the_documented_rounding(tmp_path):
    work, marks = work_of(tmp_path)
    rows = timeline(whole_program(whole(work.plan), work.brush, find_cell()), marks)
    sent = {
        name: np.cumsum(steps)
        for name, steps in data_of(outputs.make_animation(work, whole(work.plan), marks, find_cell()))["rows"].items()
    }
    assert np.abs(sent["t"] / 1000 - rows.time_s).max() <= 0.0005 + 1e-9
    for axis, name in enumerate("xyz"):
        assert np.abs(sent[name] / 100 - rows.tcp_mm[:, axis]).max() <= 0.005 + 1e-9
    touching = ~np.isnan(rows.depth_mm)
    assert (sent["on"] == touching).all()
    assert np.abs(sent["px"] / 100 - rows.contact_mm[touching, 0]).max() <= 0.005 + 1e-9
    assert np.abs(sent["py"] / 100 - rows.contact_mm[touching, 1]).max() <= 0.005 + 1e-9
    assert np.abs(sent["heading"] / 1000 - rows.heading_rad[touching]).max() <= 0.0005 + 1e-9
    assert np.abs(sent["gap"] / 100 - [work.brush.tip_gap(d) for d in rows.depth_mm[touching]]).max() <= 0.0051


def test_page_rings_equal_the_predicted_rings(tmp_path):
    work, marks = work_of(tmp_path)
    data = data_of(outputs.make_animation(work, whole(work.plan), marks, find_cell()))
    (a_pass,) = data["passes"]
    assert (a_pass["name"], a_pass["colour"]) == ("line", "#203060")
    for sent, ring in zip(a_pass["rings"], marks.passes[0].outline_mm, strict=True):
        points = np.cumsum(np.reshape(sent, (-1, 2)), axis=0) / 100
        nearest = np.linalg.norm(ring[:, None] - points[None], axis=2).min(axis=1)
        assert nearest.max() < 0.0075
    (target,) = data["wanted"]
    assert len(target) == 1


def test_a_plan_does_not_hold_its_target(tmp_path):
    work, marks = work_of(tmp_path)
    object.__setattr__(work, "strokes", None)
    assert data_of(outputs.make_animation(work, whole(work.plan), marks, find_cell()))["wanted"] == []


def test_text_of_a_drawing_cannot_inject_html_or_script(tmp_path):
    work, marks = work_of(tmp_path, title=HOSTILE)
    plan = work.plan
    passes = plan.passes
    passes[0].stroke, passes[0].colour = HOSTILE.replace("\ud83d", ""), '"><img src=x onerror=alert(1)>'
    plan.passes = passes
    page = outputs.make_animation(work, whole(work.plan), marks, find_cell())
    plain = outputs.make_animation(*played_of(tmp_path), find_cell())
    for word in (b"<script", b"</script", b"<!--", b"<img"):
        assert page.lower().count(word) == plain.lower().count(word), word
    data = data_of(page)
    assert data["title"] == HOSTILE
    assert HOSTILE[:-1] in data["chapters"][0][0]


def test_page_loads_no_external_resources(tmp_path):
    page = outputs.make_animation(*played_of(tmp_path), find_cell()).decode()
    assert "default-src 'none'" in page
    assert not re.findall(r"(?:https?:|\bsrc=|\bhref=|@import|url\()", page)
    # every placeholder of the template was filled
    assert "/*" not in re.sub(r"(?s)<style>.*?</style>", "", page)


def test_same_input_gives_the_same_bytes(tmp_path):
    first, second = (outputs.make_animation(*played_of(tmp_path), find_cell(), 5.0) for _ in range(2))
    assert first == second
    assert data_of(first)["speed"] == 5.0


@pytest.mark.parametrize("speed", [1.0, 2.5])
def test_page_numbers_are_integers(tmp_path, speed):
    data = data_of(outputs.make_animation(*played_of(tmp_path), find_cell(), speed))
    for name, steps in data["rows"].items():
        assert all(isinstance(step, int) for step in steps), name
