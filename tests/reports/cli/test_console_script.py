"""Short commands: completion, `--version`, `engines` and `truth check`."""

import json
from importlib import metadata
from pathlib import Path

import pytest

from multibody_xval.engines.exudyn import ExudynBristle
from multibody_xval.engines.interface.registry import engine_names
from multibody_xval.engines.mujoco import MuJoCo
from multibody_xval.reports.cli.console_script import COMMANDS, app
from multibody_xval.reports.cli.ending import run_command
from multibody_xval.reports.cli.run import STUDIES
from multibody_xval.scenarios.catalogue.all_scenarios import SCENARIOS

SCREEN = 40
"""Lines of a terminal of 80 columns that nobody has made smaller."""

HELPS = [
    "",
    *COMMANDS,
    *(f"run {name}" for name in [*STUDIES, *SCENARIOS, "all"]),
    *map("truth {}".format, ("list", "show", "check")),
]
"""Every command; without words, the list of them."""


@pytest.mark.parametrize("words", HELPS)
def test_help_of_every_command_fits_one_screen_and_has_an_example(words: str, capsys, monkeypatch) -> None:
    monkeypatch.setenv("COLUMNS", "80")
    assert run_command(app, [*words.split(), "--help"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert len(lines) <= SCREEN
    assert max(map(len, lines)) <= 80
    assert sum("Example: multibody-xval" in line for line in lines) == 1


def test_a_shell_completes_scenarios_and_engines(capsys, monkeypatch) -> None:
    monkeypatch.setenv("_MULTIBODY_XVAL_COMPLETE", "complete_bash")
    monkeypatch.setenv("COMP_WORDS", "multibody-xval run unit-cell --engine exudyn")
    monkeypatch.setenv("COMP_CWORD", "4")
    with pytest.raises(SystemExit):
        run_command(app, [])
    assert capsys.readouterr().out.split() == ["exudyn-bristle", "exudyn-regularised"]


def test_version_is_that_of_the_distribution(capsys: pytest.CaptureFixture[str]) -> None:
    assert run_command(app, ["--version"]) == 0
    assert capsys.readouterr().out == f"multibody-xval {metadata.version('multibody-xval')}\n"


def test_json_describes_every_registered_engine(capsys: pytest.CaptureFixture[str]) -> None:
    assert run_command(app, ["engines", "--json"]) == 0
    rows = {row["engine"]: row for row in json.loads(capsys.readouterr().out)}
    assert list(rows) == engine_names()
    for row in rows.values():
        assert (row["version"] is None) == (row["missing"] is not None)
        assert "tuned" in row["presets"]["joint"]
        assert row["licence"]
    assert rows["mujoco"]["normal_force"]["joint"]["tuned"] == "modulated"
    assert rows["mujoco"]["normal_force"]["contact"]["tuned"] == "modulated until contacts open"


def test_texts_of_a_plugin_neither_colour_nor_move_the_table(capsys, monkeypatch) -> None:
    monkeypatch.setattr(ExudynBristle, "version", lambda _self: "[red]3\x1b[2J")
    monkeypatch.setattr(MuJoCo, "unavailable_reason", lambda _self: "no\x1b[2J wheel")
    assert run_command(app, ["engines"]) == 0
    printed = capsys.readouterr().out
    assert "\x1b" not in printed
    assert "[red]3" in printed
    assert r"mujoco: no\x1b[2J wheel" in printed


@pytest.mark.usefixtures("here")
@pytest.mark.parametrize(
    ("line", "option", "names"),
    [
        ("run laws --engine mujoco:joint:default", "--out", ("a.md", "b.csv", "c.md")),
        ("run unit-cell --engine reference --store new.sqlite", "--series", ("a.csv", "b.csv")),
        ("reference --cells 1 --frequency-ratio 0.9", "--plot", ("a.svg", "b.pdf")),
        ("sweep sweep.toml", "--out", ("a.nc", "b.csv")),
    ],
)
def test_every_file_that_is_named_is_written(line, option, names, tmp_path, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("sweep.toml").write_text(
        'engines = ["reference"]\n[grid]\nfriction_ratio = [0.3]\nfrequency_ratio = [0.9]\n[chain]\ncells = 1\n'
    )
    assert run_command(app, [*line.split(), *(word for name in names for word in (option, name))]) == 0
    assert [name for name in names if not Path(name).is_file()] == []
