"""A store that is locked, full, gone or read-only while a command runs: it waits, or ends with what it has."""

import contextlib
import subprocess
import sys
import threading
from pathlib import Path

import pytest

from multibody_xval.scenarios.runs import store as module
from multibody_xval.scenarios.runs.result import Result
from multibody_xval.scenarios.runs.store import ResultStore
from reference_lcp.errors import RunError
from tests.scenarios.runs.builders import certified, steady

LOCK = """
import sqlite3, sys
connection = sqlite3.connect(sys.argv[1], isolation_level=None)
connection.execute(sys.argv[2])
connection.execute("SELECT count(*) FROM answers").fetchone()
print("locked", flush=True)
sys.stdin.read()
"""
"""A process that locks a store until its input ends, as a writer or as a reader."""


def result(eta: float, values: int = 1) -> Result:
    return certified(transmittance_db=eta, series={"long": (eta,) * values})


def kept(file: Path, etas: list[float]) -> list[float]:
    with ResultStore(file) as store:
        return [found.transmittance_db for found in store.results(map(steady, etas)) if found is not None]


@pytest.fixture
def file(tmp_path: Path) -> Path:
    """A store with one result."""
    file = tmp_path / "results.sqlite"
    with ResultStore(file) as store:
        store.keep([(steady(0.5), result(0.5))])
    return file


@pytest.fixture
def impatient(monkeypatch: pytest.MonkeyPatch) -> None:
    """Waits that would take minutes take a third of a second; a message comes at once."""
    monkeypatch.setattr(module, "WAITS", {code: (state, 0.3) for code, (state, _) in module.WAITS.items()})
    monkeypatch.setattr(module, "PATIENCE_SECONDS", 0.0)
    monkeypatch.setattr(module, "ATTEMPT_SECONDS", 0.05)


@contextlib.contextmanager
def locked(file: Path, statement: str):
    """Another process has the file locked until its input is closed; gives it."""
    with subprocess.Popen(
        [sys.executable, "-c", LOCK, str(file), statement], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    ) as other:
        assert other.stdout.readline() == "locked\n"
        yield other


def full(file: Path) -> ResultStore:
    """Open a store that may have no further page."""
    store = ResultStore(file)
    pages = store._connection.execute("PRAGMA page_count").fetchone()[0]
    store._connection.execute(f"PRAGMA max_page_count = {pages}")
    return store


@pytest.mark.parametrize("statement", ["BEGIN", "BEGIN EXCLUSIVE"], ids=["reader", "writer"])
def test_a_lock_that_is_given_back_is_waited_for_with_one_message(file, statement, monkeypatch, capsys) -> None:
    monkeypatch.setattr(module, "PATIENCE_SECONDS", 0.2)
    monkeypatch.setattr(module, "ATTEMPT_SECONDS", 0.1)
    with ResultStore(file) as store, locked(file, statement) as other:
        told = threading.Event()
        monkeypatch.setattr(module, "print", lambda *words, **_: (print(*words), told.set()), raising=False)
        giver = threading.Thread(target=lambda: told.wait(60) and other.stdin.close())
        giver.start()
        store.keep([(steady(0.9), result(0.9))])
        giver.join()
    assert kept(file, [0.5, 0.9]) == [0.5, 0.9]
    assert capsys.readouterr().out == f"store {file} is locked by another process; waiting up to 300 s\n"


@pytest.mark.parametrize("statement", ["BEGIN", "BEGIN EXCLUSIVE"], ids=["reader", "writer"])
def test_a_lock_that_is_held_ends_the_wait_with_one_line(file, statement, impatient, capsys) -> None:
    message = r"results\.sqlite cannot be used any more: database is locked"
    with ResultStore(file) as store, locked(file, statement), pytest.raises(RunError, match=message):
        store.keep([(steady(0.9), result(0.9))])
    assert len(capsys.readouterr().err.splitlines()) == 1
    assert kept(file, [0.5, 0.9]) == [0.5]


def test_a_disk_that_has_room_again_in_time_loses_nothing(file, monkeypatch, capsys) -> None:
    monkeypatch.setattr(module, "PATIENCE_SECONDS", 0.0)
    large = result(0.9, values=10_000)
    with full(file) as store:
        connection = store._connection
        monkeypatch.setattr(
            module, "print", lambda *_, **__: connection.execute("PRAGMA max_page_count = 1000000"), raising=False
        )
        store.keep([(steady(0.9), large)])
    with ResultStore(file) as store:
        assert store.find(steady(0.9)) == large


def test_a_disk_that_stays_full_keeps_what_is_stored(file, impatient, capsys) -> None:
    with full(file) as store, pytest.raises(RunError, match="database or disk is full; what it holds stays"):
        store.keep([(steady(0.9), result(0.9, values=10_000))])
    assert "is on a full disk; waiting up to 0.3 s" in capsys.readouterr().err
    assert kept(file, [0.5, 0.9]) == [0.5]


@pytest.mark.parametrize("taken_away", [Path.unlink, lambda file: file.rename(file.with_name("moved.sqlite"))])
def test_results_of_a_store_that_is_taken_away_are_all_in_a_copy(file, taken_away) -> None:
    with ResultStore(file) as store:
        taken_away(file)
        with pytest.raises(RunError, match="was deleted, moved or replaced while the command ran") as problem:
            store.keep([(steady(0.9), result(0.9))])
    copy = Path(str(problem.value).rpartition(" in ")[2])
    assert copy.parent.parent == file.parent
    assert kept(copy, [0.5, 0.9]) == [0.5, 0.9]
    assert not file.exists()


def test_a_file_in_the_place_of_the_store_is_left_alone(file) -> None:
    with ResultStore(file) as store:
        file.unlink()
        with ResultStore(file) as other:
            other.keep([(steady(0.1), result(0.1))])
        with pytest.raises(RunError, match="all its results are in"):
            store.keep([(steady(0.9), result(0.9))])
    assert kept(file, [0.1, 0.5, 0.9]) == [0.1]


def test_a_folder_that_takes_no_journal_and_a_store_that_is_read_only_end_with_one_line(file) -> None:
    journal = file.with_name("results.sqlite-journal")
    with ResultStore(file) as store:
        journal.mkdir()  # what permissions do to others, root does with this
        with pytest.raises(RunError, match="disk I/O error; what it holds stays"):
            store.keep([(steady(0.9), result(0.9))])
        journal.rmdir()
        store._connection.execute("PRAGMA query_only = ON")
        with pytest.raises(RunError, match="attempt to write a readonly database; what it holds stays"):
            store.keep([(steady(0.9), result(0.9))])
    assert kept(file, [0.5, 0.9]) == [0.5]
