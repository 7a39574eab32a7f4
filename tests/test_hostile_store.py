"""A store whose texts are hostile, through every output: nothing is obeyed, and nothing is run."""

import json
import re
from dataclasses import replace
from pathlib import Path

import pytest

from multibody_xval.reports.cli.console_script import app
from multibody_xval.scenarios.model import failed
from multibody_xval.scenarios.runs.result import Result
from multibody_xval.scenarios.runs.store import ResultStore
from multibody_xval.scenarios.runs.task import Task
from reference_lcp.errors import ExitCode
from reference_lcp.process import run_command
from tests.scenarios.stores import CASE, OTHER, with_bound, write_store

FORGED = "\n## Engine regression: passes\n"

HOSTILE = f'\x1b[2J\u202e{FORGED}</details><script>run()</script>|[passes](http://x)"""\u2028import os\r[red]'
"""A text that a terminal would obey, a reader see backwards, and Markdown, HTML and Python take for their own."""

RAW = re.compile("[\x00-\x09\x0b-\x1f\x7f-\x9f\u061c\u200e\u200f\u2028-\u202e\u2066-\u2069]")

BLOCKED = json.dumps({"status": "blocked", "reason": HOSTILE, "by_engine": True})


@pytest.fixture
def answered(monkeypatch: pytest.MonkeyPatch) -> None:
    """Every store has an answer of a stranger to every question that is not the reference's."""
    known = ResultStore.results

    def results(store: ResultStore, tasks: list[Task]):
        for task in tasks:
            own = task.variant.engine.startswith(("reference", "exact"))
            yield next(known(store, [task])) if own else Result.from_json(BLOCKED)

    monkeypatch.setattr(ResultStore, "results", results)


def run(*arguments: str) -> int:
    return run_command(app, list(arguments))


def check_texts(folder: Path, printed: str) -> None:
    """Look at what was printed and at every text that was written, but for JSON, which has its own escapes."""
    written = {
        str(file): file.read_text() for file in folder.rglob("*") if file.suffix in (".md", ".csv", ".html", ".py")
    }
    for name, text in {"terminal": printed, **written}.items():
        body = text if not name.endswith(".html") else re.sub("<script>.*?</script>", "", text, flags=re.S)
        assert RAW.search(body) is None, (name, RAW.search(body))
        assert name.endswith(".html") or FORGED not in text, name  # lines of HTML mean nothing
        assert not name.endswith(".md") or "[passes](" not in text, name
        if name.endswith((".md", ".html")):
            assert "<script>run()" not in text, name
            assert "</details><script" not in text, name


def test_comparing_hostile_stores_shows_their_texts_and_obeys_none(tmp_path, capsys) -> None:
    write_store(tmp_path / "a.sqlite", {CASE: with_bound(1.0)}, HOSTILE, options={HOSTILE: "1"})
    write_store(tmp_path / "b.sqlite", {CASE: failed(HOSTILE)}, HOSTILE + "2", options={HOSTILE: HOSTILE})
    outs = [f"--out={tmp_path}/changes{ending}" for ending in (".md", ".csv", ".json")]
    assert run("compare", str(tmp_path / "a.sqlite"), str(tmp_path / "b.sqlite"), *outs) == ExitCode.FAILED
    printed = capsys.readouterr().out
    assert "\\x1b[2J\\u202e" in printed
    check_texts(tmp_path, printed)
    assert (tmp_path / "changes.md").read_text().startswith("## Engine regression: fails\n")


@pytest.mark.slow
def test_the_page_of_a_hostile_store_shows_its_texts_and_obeys_none(tmp_path, capsys) -> None:
    store = write_store(tmp_path / "a.sqlite", {CASE: failed(HOSTILE), OTHER: with_bound(1.1, OTHER)}, HOSTILE)
    assert run("report", "--no-run", f"--store={store}", f"--out={tmp_path / 'page'}") == ExitCode.FAILED
    assert "passes" in (tmp_path / "page" / "index.html").read_text()
    check_texts(tmp_path, capsys.readouterr().out)


@pytest.mark.usefixtures("answered")
@pytest.mark.parametrize(
    ("line", "code", "shown"),
    [
        ("run stopping-distance --engine mujoco --out OUT/a.md --out OUT/a.csv", None, True),
        ("run slope-hold --engine mujoco:contact:default --out OUT/a.md", None, True),
        ("reproduce mujoco static-hold", ExitCode.WRONG_INPUT, True),
        ("reproduce mujoco:contact:default slope-hold", ExitCode.WRONG_INPUT, True),
    ],
)  # fmt: skip
def test_a_hostile_reason_is_shown_and_not_obeyed(line, code, shown, tmp_path, capsys, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    grid = "[grid]\nfriction_ratio = [0.3]\nfrequency_ratio = [0.9]"
    (tmp_path / "own.toml").write_text(f'engines = ["mujoco"]\n{grid}\n')
    name, *words = line.replace("OUT", str(tmp_path)).split()
    ended = run(name, *words, *([] if name == "reproduce" else ["--workers=1"]), f"--store={tmp_path / 'a.sqlite'}")
    printed = capsys.readouterr()
    assert ended == code if code is not None else ended in (ExitCode.DONE, ExitCode.FAILED)
    assert not shown or "\\x1b[2J" in "".join((printed.out + printed.err).split())
    check_texts(tmp_path, printed.out + printed.err)


MISFITS = {
    "run stopping-distance --engine mujoco": ('"finished"', "no series slip, slip_velocity, slid; allowed: "),
    "run free-decay --engine mujoco": ('"finished"', "no series rest, offsets, swing, energy; allowed: "),
    "run slope-hold --engine mujoco:contact:default": ('"finished"', "no series time, from the start, "),
    "run unit-cell --engine mujoco": ('"finished"', "status = finished; allowed: "),
    "run den-hartog --engine mujoco": ('"converged"', "stuck_fraction has 0 numbers; allowed: 1"),
    "run graded-chain --engine mujoco": ('"converged"', "stuck_fraction has 0 numbers; allowed: 7"),
    "run modulated-normal-force --engine mujoco:contact": (
        f'"converged", "stuck_fraction": {[0.5] * 7}, "creep": {[0.0] * 7}',
        "open_fraction has 0 numbers; allowed: 7",
    ),
}


@pytest.mark.parametrize("line", MISFITS)
def test_a_result_that_its_task_cannot_have_is_refused_where_nothing_is_run(
    line, tmp_path, capsys, monkeypatch
) -> None:
    """As its author may write it; the control is a store without any."""
    status, fault = MISFITS[line]
    answer = f'{{"status": {status}, "series": {{"unknown": [1e308]}}}}'
    monkeypatch.chdir(tmp_path)
    Path("own.toml").write_text('engines = ["mujoco"]\n[grid]\nfriction_ratio = [0.3]\nfrequency_ratio = [0.9]\n')
    ResultStore(Path("a.sqlite")).close()
    words = [*line.split(), "--no-run", "--store=a.sqlite"]
    assert run(*words) in (ExitCode.DONE, ExitCode.FAILED)
    capsys.readouterr()
    monkeypatch.setattr(ResultStore, "_answers", lambda _store, keys: dict.fromkeys(keys, answer.encode()))
    assert run(*words) == ExitCode.WRONG_INPUT
    error = capsys.readouterr().err
    assert error.startswith("error: store a.sqlite has a result that no ")
    assert fault in error
    assert error.count("\n") == 1


@pytest.mark.parametrize("level", [1e308, -1e308])
def test_numbers_that_no_motion_has_are_compared(tmp_path, level, capsys) -> None:
    results = [replace(with_bound(1.0), transmittance=complex(level, imaginary)) for imaginary in (1.0, level)]
    stores = [
        str(write_store(tmp_path / name, {CASE: own}))
        for name, own in zip(("a.sqlite", "b.sqlite"), results, strict=True)
    ]
    assert run("compare", *stores) == ExitCode.FAILED
    assert run("compare", stores[0], stores[0]) == ExitCode.DONE
