"""What journeys share: a user of their own each, and one brush that a photograph of a chart gave."""

import shutil

import pytest
from user import STUDIO, User

from brushsvg.cli import main


@pytest.fixture
def user(tmp_path, capsys, monkeypatch):
    return User(tmp_path, capsys, monkeypatch)


@pytest.fixture(scope="session")
def chart_folder(tmp_path_factory):
    """chart.json and chart.jpg: a small chart, painted and photographed in a studio in which nothing is wrong."""
    folder = tmp_path_factory.mktemp("chart")
    plan, chart, photo, studio = (
        folder / name for name in ("plan.json", "chart.json", "chart.jpg", "studio.toml")
    )
    studio.write_text(STUDIO)
    for words in (
        ("chart", plan, "--chart", chart, "--sheet", "a5", "--strokes", "few"),
        ("simulate-photo", chart, photo, "--studio", studio),
    ):
        assert main([*map(str, words), "--quiet"]) == 0, words
    return folder


@pytest.fixture
def user_with_chart(user, chart_folder):
    """A user whose folder has the chart and its photograph."""
    for name in ("chart.json", "chart.jpg"):
        shutil.copy(chart_folder / name, user.folder)
    return user
