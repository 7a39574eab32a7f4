"""A store that a stranger made: refused in one line and in bounded time, or read as what it says."""

import json
import multiprocessing
import sqlite3
from contextlib import closing
from pathlib import Path

import pytest

from multibody_xval.reports.cli.console_script import app
from multibody_xval.scenarios.runs import store as store_file
from multibody_xval.scenarios.runs.store import ResultStore
from reference_lcp import ParameterError
from reference_lcp.errors import ExitCode
from reference_lcp.process import run_command
from tests.scenarios.runs.builders import certified, steady

PAGE, COUNT_OF_PAGES = 4096, 28
"""Size of a page of SQLite [bytes], and where the header of the file has the number of pages."""

TASK = steady()
RESULT = certified(transmittance_db=-1.5, periods=30)


@pytest.fixture
def file(tmp_path: Path) -> Path:
    file = tmp_path / "results.sqlite"
    with ResultStore(file) as store:
        store.keep([(TASK, RESULT)])
    return file


def write(file: Path, table: str, column: str, text: bytes) -> None:
    """Change a text of the only row of a table."""
    with closing(sqlite3.connect(file)) as connection, connection:
        connection.execute(f"UPDATE {table} SET {column} = CAST(? AS TEXT)", (text,))


@pytest.mark.parametrize(
    "script",
    [
        "DROP TABLE answers; CREATE VIEW answers AS WITH RECURSIVE n(key, content, answer) AS "
        "(SELECT '', '', '' UNION ALL SELECT key, content, answer FROM n) SELECT * FROM n",
        "ALTER TABLE answers ADD COLUMN more GENERATED ALWAYS AS (length(answer))",
        "CREATE TABLE more (x)",
        "CREATE VIEW more AS SELECT 1",
        "DROP TABLE answers",
        "CREATE INDEX more ON answers (length(answer))",
        "CREATE TRIGGER more AFTER INSERT ON answers BEGIN UPDATE answers SET answer = '{}'; END",
        "DROP TABLE sweeps; CREATE TABLE sweeps (number INTEGER PRIMARY KEY, sweep TEXT DEFAULT (randomblob(9)))",
    ],
)
def test_only_the_tables_of_a_store_are_read(file, script) -> None:
    with closing(sqlite3.connect(file)) as connection:
        connection.executescript(script)
    before = file.read_bytes()
    with pytest.raises(ParameterError, match="its tables are not those of a store"):
        ResultStore(file)
    assert file.read_bytes() == before


def test_a_text_beyond_the_limit_is_not_read(file, monkeypatch) -> None:
    monkeypatch.setattr(store_file, "LARGEST_TEXT", 2_000)
    write(file, "answers", "answer", json.dumps({"status": "converged", "reason": "x" * 3_000}).encode())
    with ResultStore(file) as store, pytest.raises(ParameterError, match=r"results\.sqlite is damaged: .*too big"):
        store.find(TASK)


@pytest.mark.parametrize(
    "name", [":memory:", "", "file:results.sqlite", "file::memory:?cache=shared", ":", "/dev/full"]
)
def test_a_store_that_would_keep_nothing_is_refused(sweep_folder, capsys, name) -> None:
    assert run_command(app, ["run", "unit-cell", "--store", name]) == ExitCode.WRONG_INPUT
    assert capsys.readouterr().err.startswith("error: store ")


@pytest.mark.parametrize("command", ["run unit-cell", "run all", "run record"])
def test_a_misspelt_store_is_not_made_where_nothing_is_run(sweep_folder, capsys, command) -> None:
    arguments = [*command.split(), "--no-run", "--store", "misspelt.sqlite"]
    assert run_command(app, arguments) == ExitCode.WRONG_INPUT
    assert capsys.readouterr().err.startswith("error: store misspelt.sqlite does not exist")


def open_together(file: Path, barrier, refused) -> None:
    """Open a store at the moment at which all others do."""
    barrier.wait()
    try:
        ResultStore(file).close()
    except ParameterError as problem:
        refused.put(str(problem))
    else:
        refused.put("")


def test_processes_that_make_one_store_at_once_all_get_it(tmp_path) -> None:
    context, processes = multiprocessing.get_context("fork"), 8
    for trial in range(5):
        barrier, refused = context.Barrier(processes), context.Queue()
        arguments = (tmp_path / f"{trial}.sqlite", barrier, refused)
        crowd = [context.Process(target=open_together, args=arguments) for _ in range(processes)]
        for process in crowd:
            process.start()
        assert [refused.get(timeout=60) for _ in crowd] == [""] * processes
        for process in crowd:
            process.join()
