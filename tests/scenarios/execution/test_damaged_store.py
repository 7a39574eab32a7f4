"""Damage of a store: no traceback, no wrong number believed, nothing overwritten, good rows saved."""

import random
import resource
import sqlite3
from contextlib import closing
from pathlib import Path

import pytest

from engines.interface.variant import Variant
from reference_lcp import ParameterError
from reference_lcp.console import run_command
from reference_lcp.exit_code import ExitCode
from reference_lcp.refusal import RunError
from reports.__main__ import app as reports_app
from scenarios.__main__ import app
from scenarios.execution.storage.store import ResultStore
from scenarios.execution.storage.store_check import check_store, salvage
from scenarios.tasks.result import Result, ResultSummary
from scenarios.tasks.task import SteadyStateTask
from scenarios.verdicts.stored_results import read_all

TRIALS = 300

TASKS = [
    SteadyStateTask(variant=Variant("reference"), friction_ratio=0.3, frequency_ratio=0.5 + k / 10) for k in range(12)
]
RESULTS = [
    Result(
        status="converged", transmittance_db=-k / 3, residual=1e-9, periods=30 + k, steps_per_period=400, period=0.25,
        stuck_fraction=tuple(k / 100 + cell / 10 for cell in range(7)), seconds=0.1,
    )
    for k in range(12)
]  # fmt: skip
SUMMARIES = [ResultSummary.of(result) for result in RESULTS]


@pytest.fixture
def file(tmp_path: Path) -> Path:
    file = tmp_path / "results.sqlite"
    with ResultStore(file) as store:
        for pair in zip(TASKS, RESULTS, strict=True):
            store.keep([pair])
        store.note('{"a": "sweep"}')
    return file


def change(file: Path, statement: str) -> None:
    with closing(sqlite3.connect(file)) as connection, connection:
        assert connection.execute(statement).rowcount in (-1, 1)


def mutated(content: bytes, seed: int) -> bytes:
    """Flip a bit, or overwrite, cut, move or repeat a part."""
    draw = random.Random(seed)
    changed, place = bytearray(content), draw.randrange(len(content))
    match draw.choice(["bit", "bit", "bit", "header", "zeros", "noise", "cut", "move"]):
        case "bit":
            changed[place] ^= 1 << draw.randrange(8)
        case "header":
            changed[draw.randrange(120)] ^= 1 << draw.randrange(8)
        case "zeros":
            changed[place : place + 64] = bytes(len(changed[place : place + 64]))
        case "noise":
            changed[place : place + 64] = draw.randbytes(len(changed[place : place + 64]))
        case "cut":
            del changed[place:]
        case "move":
            other = draw.randrange(len(content))
            changed[place : place + 512] = content[other : other + len(changed[place : place + 512])]
    return bytes(changed)


def believed(file: Path) -> bool:
    """Read a store in every way, and compare with what was kept; gives whether everything was read."""
    whole = True
    readers = [
        (lambda store: store.results(TASKS), RESULTS),
        (lambda store: store.summaries(TASKS), SUMMARIES),
        (lambda store: (result for _, result in store.all_results()), None),
    ]
    for read, expected in readers:
        found, refused = [], ""
        try:
            with ResultStore(file) as store:
                found = list(read(store))
        except ParameterError as problem:
            whole, refused = False, str(problem)
        if refused:
            assert str(file) in refused
            assert "\n" not in refused
            continue
        if expected is None:
            assert all(result in RESULTS for result in found)
        else:
            assert all(one is None or one == kept for one, kept in zip(found, expected, strict=True))
        whole = whole and None not in found and len(found) == len(TASKS)
    return whole


def test_no_damage_ends_in_a_traceback_or_is_believed(file, tmp_path, capsys) -> None:
    content, noticed, saved = file.read_bytes(), 0, 0
    for seed in range(TRIALS):
        damaged, new = tmp_path / f"{seed}.sqlite", tmp_path / f"{seed}-good.sqlite"
        damaged.write_bytes(mutated(content, seed))
        before = damaged.read_bytes()
        if not before:
            continue
        whole = believed(damaged)
        line = ["store", "check", str(damaged), *(["--salvage", str(new)] if seed % 10 == 0 else [])]
        code = run_command(app, line)
        printed = capsys.readouterr()
        assert code in (0, ExitCode.WRONG_INPUT)
        assert len(printed.err.splitlines()) <= 1
        assert printed.err or printed.out
        assert damaged.read_bytes() == before, seed
        if new.exists():
            saved += 1
            assert believed(new) or "no damages" not in printed.out
        noticed += not whole
    assert noticed > TRIALS / 4, "much of the damage hits what is read, the rest free space"
    assert saved > TRIALS / 20


def test_one_flipped_digit_is_refused_with_file_row_and_what_to_do(file, tmp_path, capsys) -> None:
    change(file, "UPDATE answers SET answer = replace(answer, '-1.3333', '-7.3333') WHERE rowid = 5")
    message = (
        r"results\.sqlite is damaged: the digest of row 5 does not fit; python -m scenarios store check .*--salvage"
    )
    with ResultStore(file) as store:
        assert store.find(TASKS[0]) == RESULTS[0]
        for read in (
            lambda: store.find(TASKS[4]),
            lambda: list(store.summaries(TASKS)),
            lambda: list(store.all_results()),
        ):
            with pytest.raises(ParameterError, match=message):
                read()
    with pytest.raises(ParameterError, match=message):
        read_all(file)
    assert run_command(reports_app, ["compare", str(file), str(file)]) == ExitCode.WRONG_INPUT
    assert "row 5" in capsys.readouterr().err
    assert run_command(app, ["store", "check", str(file)]) == ExitCode.WRONG_INPUT
    assert "table answers, row 5: its digest does not fit" in capsys.readouterr().out
    assert run_command(app, ["store", "check", str(file), "--salvage", str(tmp_path / "good.sqlite")]) == 0
    with ResultStore(tmp_path / "good.sqlite") as store:
        assert list(store.results(TASKS)) == [*RESULTS[:4], None, *RESULTS[5:]]
        assert store.noted() == ['{"a": "sweep"}']


def test_a_damaged_sweep_is_refused(file) -> None:
    change(file, "UPDATE sweeps SET sweep = '{}'")
    with ResultStore(file) as store, pytest.raises(ParameterError, match="the digest of row 1 does not fit"):
        store.noted()


def test_an_intact_store_has_no_damage_and_a_salvage_overwrites_nothing(file, capsys) -> None:
    found = check_store(file)
    assert not found.damage
    assert (len(found.good["answers"]), len(found.good["sweeps"])) == (12, 1)
    before = file.read_bytes()
    with pytest.raises(ParameterError, match="is there already"):
        salvage(found, file)
    assert run_command(app, ["store", "check", str(file), "--salvage", str(file)]) == ExitCode.WRONG_INPUT
    assert run_command(app, ["store", "check", str(file)]) == 0
    assert "12 intact results, 1 intact sweeps, no damages" in capsys.readouterr().out
    assert file.read_bytes() == before


def test_a_salvage_that_finds_no_room_leaves_nothing(file, tmp_path) -> None:
    """A limit on the size of files stands for the disk."""
    good = check_store(file)
    before = set(tmp_path.iterdir())
    old = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (file.stat().st_size - 4096, old[1]))
    try:
        with pytest.raises(RunError, match=r"good\.sqlite cannot be written: .*; it is not there"):
            salvage(good, tmp_path / "good.sqlite")
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, old)
    assert set(tmp_path.iterdir()) == before


@pytest.mark.parametrize(
    "statement",
    [
        "CREATE TRIGGER lie AFTER INSERT ON answers BEGIN UPDATE answers SET answer = '{}'; END",
        "CREATE VIEW more AS SELECT 1",
        "CREATE TABLE more (x)",
        "DROP TABLE answers",
    ],
)
def test_a_store_consists_of_its_tables_only(file, statement) -> None:
    change(file, statement)
    before = file.read_bytes()
    with pytest.raises(ParameterError, match="its tables are not those of a store"):
        ResultStore(file)
    assert file.read_bytes() == before
