"""What the tests of journeys share."""

import pytest


@pytest.fixture(scope="session")
def desk(tmp_path_factory):
    """A folder in which brushes and drawings are made once."""
    return tmp_path_factory.mktemp("desk")
