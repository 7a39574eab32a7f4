"""Results in one file: what is added is found again, and what is no store is refused as it is."""

import os
import shutil
import sqlite3
from collections.abc import Callable
from contextlib import closing
from pathlib import Path

import pytest

from multibody_xval.scenarios import store as stores
from multibody_xval.scenarios.model import REFERENCE, Case, Config, Result, Run, Status, failed
from multibody_xval.scenarios.output_files import RunError
from multibody_xval.scenarios.store import Store, opened
from reference_lcp.errors import ParameterError

CASE = Case(friction_ratio=0.3, frequency_ratio=0.9, cells=2, mass_ratio=(1.0, 0.5), modulation=0.25)
RUN = Run(REFERENCE, CASE, 400)
FOUND = Result(
    status=Status.PERIODIC, transmittance=0.25 - 0.5j, residual=1e-12, amplification=3.0, periods=2, stuck=(0.5, 1.0),
    transitions=((1, 0.25, "stick"),), stick_velocity=0.0, series={"travels": (0.1, 0.2)}, seconds=0.5,
)  # fmt: skip


def stored_in(file: Path) -> Path:
    with opened(file) as store:
        store.add({RUN: FOUND})
    return file


def test_a_result_is_found_again_as_it_was_by_another_and_in_a_copy_of_the_file(tmp_path: Path) -> None:
    file = stored_in(tmp_path / "own.sqlite")
    with opened(file) as store, opened(file) as other:
        for one in (store, other):
            assert one.known([RUN, Run(REFERENCE, CASE, 800)]) == {RUN: FOUND}
            assert [(own.run, own.result) for own in one.rows()] == [(RUN, FOUND)]
    copy = shutil.copy(file, tmp_path / "copy.sqlite")
    assert sorted(own.name for own in tmp_path.iterdir()) == ["copy.sqlite", "own.sqlite"]
    with opened(Path(copy)) as store:
        assert store.known([RUN]) == {RUN: FOUND}


def test_a_result_of_other_sources_is_not_taken(tmp_path: Path, monkeypatch) -> None:
    file = stored_in(tmp_path / "own.sqlite")
    monkeypatch.setattr(stores, "digest", lambda _name: "another")
    with opened(file) as store:
        assert store.known([RUN]) == {}
        assert len(list(store.rows())) == 1


def foreign(file: Path) -> None:
    with closing(sqlite3.connect(file)) as other, other:
        other.execute("CREATE TABLE mine (number)")


def changed(statement: str) -> Callable[[Path], None]:
    """Make a store, and change it by a statement of SQL."""

    def written(file: Path) -> None:
        stored_in(file)
        with closing(sqlite3.connect(file)) as own, own:
            own.execute(statement)

    return written


REFUSED = {
    "has other tables": changed("ALTER TABLE results RENAME TO answers"),
    "other tables than a store": changed("CREATE TABLE mine (number)"),
    "is no store of this suite": foreign,
    "is of format 2": changed("PRAGMA user_version = 2"),
    "is damaged or no store": lambda file: file.write_text("no database at all, of some length" * 99),
    "is a folder or a device": Path.mkdir,
}


@pytest.mark.parametrize("problem", REFUSED)
def test_what_is_no_store_is_refused_and_stays_as_it_is(tmp_path: Path, problem: str) -> None:
    file = tmp_path / "other.sqlite"
    REFUSED[problem](file)
    before = file.read_bytes() if file.is_file() else b""
    with pytest.raises(ParameterError, match=problem), opened(file):
        pass
    assert (file.read_bytes() if file.is_file() else b"") == before


def test_a_refused_file_is_not_kept_open_by_its_error(tmp_path: Path) -> None:
    """From Python 3.13 on a connection that nobody has closed is a warning."""
    foreign(tmp_path / "other.sqlite")
    with pytest.raises(ParameterError) as refused:
        Store(tmp_path / "other.sqlite")
    held = [os.path.realpath(own) for own in Path("/proc/self/fd").iterdir()]
    assert str(tmp_path / "other.sqlite") not in held, refused.value


@pytest.mark.parametrize("name", [":memory:", "", "file::memory:?cache=shared", "/dev/full"])
def test_a_store_that_would_keep_nothing_is_refused(tmp_path: Path, monkeypatch, name: str) -> None:
    monkeypatch.chdir(tmp_path)
    with pytest.raises(ParameterError, match=r"store .*; allowed: a file"), opened(Path(name)):
        pass
    assert not list(tmp_path.iterdir())


def test_a_full_disk_ends_in_a_line_and_loses_nothing_and_a_failure_by_circumstance_is_not_kept() -> None:
    with opened(None) as store:
        store.add({RUN: failed("its process has ended by signal SIGKILL", circumstance=True)})
        assert store.known([RUN]) == {}
        store.add({RUN: FOUND})
        store._file.execute("PRAGMA max_page_count = 1")
        many = {Run(Config("reference"), CASE, steps): FOUND for steps in range(100, 400)}
        with pytest.raises(RunError, match="the disk is full; what is stored stays"):
            store.add(many)
        assert store.known([RUN]) == {RUN: FOUND}


HOSTILE_ROWS = [
    ("run", '{"config": "mujoco", "case": {"friction_ratio": -1, "frequency_ratio": 1}, "steps": 400}'),
    ("result", "[" * 5000),
    ("result", '{"status": "periodic", "transmittance": [1, 0], "__class__": "os.system"}'),
]


@pytest.mark.parametrize(("column", "text"), HOSTILE_ROWS)
def test_a_row_of_the_wrong_form_is_refused_in_a_line_with_its_store(tmp_path: Path, column: str, text: str) -> None:
    file = stored_in(tmp_path / "own.sqlite")
    with closing(sqlite3.connect(file)) as own, own:
        own.execute(f"UPDATE results SET {column} = ?", (text,))
    with opened(file) as store, pytest.raises(ParameterError, match=r"own\.sqlite: .*allowed"):
        list(store.rows())
    if column == "result":
        with opened(file) as store, pytest.raises(ParameterError, match=r"own\.sqlite: .* cannot be read: .*; allowed"):
            store.known([RUN])
