"""Hostile input: seeded mutations of sweep files and command lines are planned, or refused in one line."""

import random
import re
from pathlib import Path
from typing import Any

import pytest
import typer

import reference_lcp.one_call
from multibody_xval.reports.cli.console_script import app
from multibody_xval.reports.cli.ending import run_command
from multibody_xval.reports.cli.exit_code import ExitCode
from multibody_xval.scenarios.sweeps.file import EXAMPLE

NESTED = "[" * 3000 + "]" * 3000

VALUES = (
    *("9" * digits for digits in (19, 4301)),
    *("nan", "-inf", "1e-320", "1e-160", "1e308", "-0.0", "0", "1", "-1", "1e400", "1" + "0" * 30, "0xffffffff", "2.5"),
    *("true", '""', '"\\u0000"', f'"{"x" * 400}"', '"reference"', '"mujocko"', "[]", "[[]]", NESTED, "[nan]", "[1, 1]"),
    *("{}", "{ first = 1 }", "1979-05-27", "07:32:00", "{ first = 1e-320, last = 1e308, points = 2 }"),
    "{ first = 1.6, last = 0.3, points = 5 }", "{ first = nan, last = 1, points = 3 }",
    "{ first = 0.3, last = 1.6, points = 1" + "0" * 30 + " }", "{ first = 0.3, last = 1.6, accuracy_db = 1e-300 }",
    "{ first = 0.3, last = 1.6, accuracy_db = 0.5, least_spacing = 1e-320, most_points = 1" + "0" * 30 + " }",
)  # fmt: skip
"""What is written in place of a value, as TOML."""


SWEEPS = (
    EXAMPLE,
    """engines = ["mujoco", "reference"]
[grid]
friction_ratio = { first = 0.0, last = 1.0, points = 5 }
frequency_ratio = { first = 0.3, last = 1.6, accuracy_db = 0.5, least_spacing = 5e-5, most_points = 500 }
steps_per_period = [400, 800]
[chain]
outer_mass_ratio = [1.0, 0.9, 1.1]
[drive]
kind = "force"
amplitude = 100.0
""",
)

LINES = (
    "reference --friction-ratio 0.3 --frequency-ratio 0.9 --cells 7 --max-periods 100 --tolerance 1e-9",
    "sweep sweep.toml --store a.sqlite --out a.nc --workers 2 --time-limit 60",
    "sweep sweep.toml --no-run --out a.csv --store sweep.sqlite --scheduler tcp://127.0.0.1:1",
    "run unit-cell --engine reference --store a.sqlite --out a.md --workers 1 --time-limit 9",
    "run record --record quake.csv --engine mujoco:joint --out a.json --store b.sqlite",
    "run accuracy --engine mujoco:joint --store a.sqlite --out a.csv --workers 1",
    "report --out report --quick --engine mujoco --store a.sqlite --workers 1 --time-limit 10",
    "report --data sweep.nc --out report",
    "compare sweep.sqlite sweep.sqlite --db 0.1 --strict --out a.csv",
)

WORDS = (
    *("9" * 4301, "1e308", "1e-320", "nan", "inf", "-1", "0", "1" + "0" * 30, "2.5", "x" * 5000, "a/" * 3000, "", " "),
    *("\x00", "a\x00b.nc", "\n", "é\udcff", "[red]", "%s", "--", "-", "=1+1", "sweep.toml", "folder", "missing/x.csv"),
    *("/dev/null", "/dev/full", "/proc/1/mem", "mujocko", "mujoco:glue", "::", "all", "a:b:c:d", ":memory:"),
    *("tcp://nowhere:99999999", "--json", "--quick", "--no-run", "--help", "--out", "--store", "--engine", "--db"),
)
"""What is written in place of a word of a command line."""


class Planned(typer.Exit):
    """Ends a command where its work would begin."""


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, here: None) -> Path:
    """A folder with a sweep and a record, in which no command works: it ends with exit code 0 instead."""

    def planned(*_: Any, **__: Any) -> Any:
        raise Planned(0)

    monkeypatch.chdir(tmp_path)
    (tmp_path / "folder").mkdir()
    (tmp_path / "sweep.toml").write_text(EXAMPLE)
    (tmp_path / "quake.csv").write_text("0,0\n0.1,1\n0.2,0\n0.3,2\n0.4,1\n")
    monkeypatch.setattr("multibody_xval.scenarios.running.evaluate.run_missing", planned)
    for name in ("periodic_orbits", "exact_orbit", "measured_error_bar"):
        monkeypatch.setattr(reference_lcp.one_call, name, planned)
    return tmp_path


def mutated_file(draw: random.Random) -> str:
    """A sweep file with one to three faults: another value behind a key, a character that is another one, or a cut."""
    text = draw.choice(SWEEPS)
    for _ in range(draw.choice((1, 1, 1, 2, 3))):
        if draw.random() < 0.75:
            lines = text.splitlines()
            place = draw.choice([number for number, line in enumerate(lines) if " = " in line] or [0])
            lines[place] = f"{lines[place].removeprefix('# ').partition(' = ')[0]} = {draw.choice(VALUES)}"
            text = "\n".join(lines)
        else:
            place, character = draw.randrange(len(text)), draw.choice('\x00\x7f\ud800[]{}"=.,#\n 09é\U0001f600')
            text = draw.choice((text[:place], text[:place] + character + text[place + 1 :]))
    return text


def mutated_line(draw: random.Random) -> list[str]:
    """A command line with one to three faults."""
    name, *words = draw.choice(LINES).split()
    for _ in range(draw.choice((1, 1, 1, 2, 3))):
        place, word = draw.randrange(len(words) + 1), draw.choice(WORDS)
        words[place : place + 1] = draw.choice(([word], [word], [word], [], [*words[place : place + 1], word]))
    return [name, *words]


def refusal(words: list[str], capsys: pytest.CaptureFixture[str]) -> str | None:
    """Run a command line; gives what is wrong with how it ended, ``None`` if nothing is."""
    code = run_command(app, words)
    error = capsys.readouterr().err
    lines = [line for line in error.splitlines() if line.startswith("error: ")]
    plain = len(lines) == 1 and len(error) < 2000 and not re.search("Traceback|nput should|pydantic", error)
    return None if code == 0 or (code == ExitCode.WRONG_INPUT and plain) else f"exit code {code}: {error:.200}"


@pytest.mark.parametrize("seeds", [range(60), pytest.param(range(60, 1000), marks=pytest.mark.slow)], ids=str)
def test_mutated_sweep_files_and_command_lines_are_planned_or_refused(folder, capsys, seeds) -> None:
    problems = {}
    for seed in seeds:
        content = mutated_file(random.Random(seed))
        (folder / "mine.toml").write_text(content, encoding="utf-8", errors="surrogatepass")
        problems[seed, "file"] = refusal(["sweep", "mine.toml", "--store", f"{seed}.sqlite"], capsys)
        problems[seed, "line"] = refusal(mutated_line(random.Random(seed)), capsys)
    assert {seed: problem for seed, problem in problems.items() if problem} == {}
