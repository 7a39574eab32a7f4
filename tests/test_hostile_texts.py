"""Texts of strangers through every output: nothing is obeyed, nothing is run, and no encoding ends a command."""

import io
import re
import sys
from dataclasses import replace
from pathlib import Path

import pytest

from multibody_xval.engines.interface.texts import visible
from multibody_xval.reports.cli.console_script import app
from multibody_xval.reports.cli.ending import run_command
from multibody_xval.reports.cli.exit_code import ExitCode
from multibody_xval.scenarios.catalogue.all_scenarios import SCENARIOS
from multibody_xval.scenarios.model import Config, Result, Status, failed
from multibody_xval.scenarios.store import opened
from tests.scenarios.stores import CASE, OTHER, with_bound, write_store

FORGED = "\n## Comparison: the second is not worse\n"

HOSTILE = f'\x1b[2J\u202e{FORGED}</details><script>run()</script>|[passes](http://x)"""\u2028import os\r[red]'
"""A text that a terminal would obey, a reader see backwards, and Markdown, HTML and Python take for their own."""

RAW = re.compile("[\x00-\x09\x0b-\x1f\x7f-\x9f\u061c\u200e\u200f\u2028-\u202e\u2066-\u2069]")


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
    assert (tmp_path / "changes.md").read_text().startswith("## Comparison: the second is worse\n")


@pytest.mark.slow
def test_the_page_of_a_hostile_store_shows_its_texts_and_obeys_none(tmp_path, capsys) -> None:
    store = write_store(tmp_path / "a.sqlite", {CASE: failed(HOSTILE), OTHER: with_bound(1.1, OTHER)}, HOSTILE)
    assert run("report", "--no-run", f"--store={store}", f"--out={tmp_path / 'page'}") == ExitCode.FAILED
    assert "passes" in (tmp_path / "page" / "index.html").read_text()
    check_texts(tmp_path, capsys.readouterr().out)


ASKED = {"stopping-distance": "mujoco", "slope-hold": "mujoco:contact:default"}


def of_strangers(name: str, result: Result) -> None:
    """Write the same result of every run of an engine into a store."""
    with opened(Path("a.sqlite")) as store:
        store.add(dict.fromkeys(SCENARIOS[name].own_runs(Config.parse(ASKED[name])).values(), result))


@pytest.mark.parametrize("name", ASKED)
def test_hostile_reasons_of_a_scenario_are_shown_and_not_obeyed(name, tmp_path, capsys, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    of_strangers(name, failed(HOSTILE))
    outs = [f"--out=numbers{ending}" for ending in (".md", ".csv", ".json")]
    assert run("run", name, "--no-run", "--store=a.sqlite", f"--engine={ASKED[name]}", *outs) == ExitCode.FAILED
    printed = capsys.readouterr().out
    assert "\\x1b[2J" in "".join(printed.split())
    check_texts(tmp_path, printed)


def test_a_result_that_its_run_cannot_have_is_refused(tmp_path, capsys, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    of_strangers("slope-hold", Result(status=Status.FINISHED, series={"unknown": (1e308,)}))
    assert run("run", "slope-hold", "--no-run", "--store=a.sqlite") == ExitCode.WRONG_INPUT
    error = capsys.readouterr().err
    assert error.startswith("error: store a.sqlite holds a result that lacks what its run gives: KeyError: ")
    assert error.count("\n") == 1


def test_numbers_that_no_motion_has_are_compared(tmp_path) -> None:
    results = [replace(with_bound(1.0), transmittance=complex(1e308, imaginary)) for imaginary in (1.0, 1e308)]
    before, now = (str(write_store(tmp_path / f"{k}.sqlite", {CASE: own})) for k, own in enumerate(results))
    assert run("compare", before, now) == ExitCode.FAILED
    assert run("compare", before, before) == ExitCode.DONE


@pytest.mark.parametrize("line", ["reference --help", "reference --cells 2", "run"])
def test_an_output_without_greek_letters_ends_no_command(monkeypatch, line) -> None:
    for stream in ("stdout", "stderr"):
        monkeypatch.setattr(sys, stream, io.TextIOWrapper(io.BytesIO(), encoding="ascii"))
    assert run(*line.split()) == 0
    sys.stdout.flush()
    assert sys.stdout.buffer.getvalue()


def test_what_controls_a_terminal_becomes_letters_and_letters_of_all_languages_stay(tmp_path, capsys) -> None:
    for text in ("\x1b[2J", "\x9b2J", "\r", "\n", "\x00", "\u202e", "\u2028", "\udcff"):
        assert visible(f"摩擦{text}μ") == "摩擦" + text.encode("unicode_escape").decode() + "μ"
    (tmp_path / "hostile.toml").write_text('engines = ["\\u001b]0;owned\\u0007\\nerror: fine"]\n')
    assert run("sweep", str(tmp_path / "hostile.toml")) == ExitCode.WRONG_INPUT
    printed = capsys.readouterr().err
    assert ("\x1b" in printed, len(printed.splitlines())) == (False, 1)
