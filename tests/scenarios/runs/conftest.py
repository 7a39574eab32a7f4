"""A store that every test of runs may ask for."""

import pytest

from scenarios.runs.store import ResultStore


@pytest.fixture
def store(tmp_path):
    with ResultStore(tmp_path / "results.sqlite") as opened:
        yield opened
