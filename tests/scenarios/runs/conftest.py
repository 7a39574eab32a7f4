"""A store, and engines with faults, that every test of runs may ask for."""

import pytest

from scenarios.runs.store import ResultStore


@pytest.fixture
def store(tmp_path):
    with ResultStore(tmp_path / "results.sqlite") as opened:
        yield opened


@pytest.fixture(scope="module")
def faulty(install):
    """Let this process, and those that it starts, see the faulty engines."""
    with install("mutations").visible():
        yield


@pytest.fixture
def sweep_folder(tmp_path, monkeypatch):
    """Work in a folder that holds the file of a sweep, and nothing else."""
    (tmp_path / "sweep.toml").write_text(
        'engines = ["reference:joint"]\n[grid]\nfriction_ratio = [0.3]\nfrequency_ratio = [0.9]'
    )
    monkeypatch.chdir(tmp_path)
    yield tmp_path
    assert [path.name for path in tmp_path.iterdir()] == ["sweep.toml"]
