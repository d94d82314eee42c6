"""What the tests of journeys share."""

from collections import Counter

import pytest

TABLE = "test_every_combination.py"


def pytest_terminal_summary(terminalreporter):
    """How many combinations ran and how many were refused, by the code of the reason."""
    rows = [
        each
        for each in terminalreporter.stats.get("passed", ())
        if TABLE in each.nodeid and "[" in each.nodeid
    ]
    reasons = Counter(value for each in rows for name, value in each.user_properties if name == "refused")
    if rows:
        refused = ", ".join(f"{count} {code}" for code, count in sorted(reasons.items())) or "none"
        terminalreporter.write_line(
            f"combinations: {len(rows)} as promised or refused with a reason; refused: {refused}"
        )


@pytest.fixture(scope="session")
def desk(tmp_path_factory):
    """A folder in which brushes and drawings are made once."""
    return tmp_path_factory.mktemp("desk")
