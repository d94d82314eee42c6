"""Fixtures for the tests of journeys."""

import shutil
from collections import Counter

import pytest
from user import STUDIO, User

from brushsvg.cli import main

TABLE = "test_every_combination.py"


def pytest_terminal_summary(terminalreporter):
    """Print how many combinations ran and how many were refused, by code."""
    rows = [each for each in terminalreporter.stats.get("passed", ()) if TABLE in each.nodeid and "[" in each.nodeid]
    reasons = Counter(value for each in rows for name, value in each.user_properties if name == "refused")
    if rows:
        refused = ", ".join(f"{count} {code}" for code, count in sorted(reasons.items())) or "none"
        terminalreporter.write_line(
            f"combinations: {len(rows)} as promised or refused with a reason; refused: {refused}"
        )


@pytest.fixture(scope="session")
def desk(tmp_path_factory):
    """Return a folder in which brushes and drawings are made once."""
    return tmp_path_factory.mktemp("desk")


@pytest.fixture
def user(tmp_path, capsys, monkeypatch):
    return User(tmp_path, capsys, monkeypatch)


@pytest.fixture(scope="session")
def chart_folder(tmp_path_factory):
    """Make chart.json and chart.jpg.

    A studio without faults paints and photographs a small chart.
    """
    folder = tmp_path_factory.mktemp("chart")
    plan, chart, photo, studio = (folder / name for name in ("plan.json", "chart.json", "chart.jpg", "studio.toml"))
    studio.write_text(STUDIO)
    for words in (
        ("chart", "-o", plan, "--chart", chart, "--sheet", "a5", "--strokes", "few"),
        ("simulate-photo", chart, "-o", photo, "--studio", studio),
    ):
        assert main([*map(str, words), "--quiet"]) == 0, words
    return folder


@pytest.fixture
def user_with_chart(user, chart_folder):
    """A user whose folder has the chart and its photograph."""
    for name in ("chart.json", "chart.jpg"):
        shutil.copy(chart_folder / name, user.folder)
    return user
