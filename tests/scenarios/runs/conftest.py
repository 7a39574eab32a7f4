"""A store, and engines with faults, that every test of runs may ask for."""

import pytest

from multibody_xval.scenarios.runs.store import ResultStore


@pytest.fixture
def store(tmp_path):
    with ResultStore(tmp_path / "results.sqlite") as opened:
        yield opened


@pytest.fixture(scope="session")
def faulty_folder(tmp_path_factory):
    return tmp_path_factory.mktemp("faulty")


@pytest.fixture(scope="module")
def faulty(install, faulty_folder):
    """Let this process, and those that it starts, see the faulty engines.

    They note what they do in the same files in all tests, which then have the same template of workers.
    """
    with install("mutations").visible(), pytest.MonkeyPatch.context() as environment:
        environment.setenv("FAULTY_CHILD", str(faulty_folder / "child"))
        environment.setenv("FAULTY_PREPARED", str(faulty_folder / "prepared"))
        yield


@pytest.fixture
def notes(faulty, faulty_folder):
    """Give the folder in which faulty engines note what they do, empty."""
    for file in faulty_folder.iterdir():
        file.unlink()
    return faulty_folder


@pytest.fixture
def sweep_folder(tmp_path, monkeypatch):
    """Work in a folder that holds the file of a sweep, and nothing else."""
    (tmp_path / "sweep.toml").write_text(
        'engines = ["reference:joint"]\n[grid]\nfriction_ratio = [0.3]\nfrequency_ratio = [0.9]'
    )
    monkeypatch.chdir(tmp_path)
    yield tmp_path
    assert [path.name for path in tmp_path.iterdir()] == ["sweep.toml"]
