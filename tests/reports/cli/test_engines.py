"""``multibody-xval engines``: capabilities as data."""

import json

import pytest

from multibody_xval.engines.interface.registry import engine_names
from multibody_xval.engines.mujoco import MuJoCo
from multibody_xval.engines.pybullet import PyBullet
from multibody_xval.reports.cli.ending import run_command
from multibody_xval.reports.cli.engines import app


def test_json_describes_every_registered_engine(capsys: pytest.CaptureFixture[str]) -> None:
    assert run_command(app, ["--json"]) == 0
    rows = {row["engine"]: row for row in json.loads(capsys.readouterr().out)}
    assert list(rows) == engine_names()
    for row in rows.values():
        assert (row["version"] is None) == (row["missing"] is not None)
        assert "tuned" in row["presets"]["joint"]
        assert row["licence"]
    assert rows["mujoco"]["normal_force"]["joint"]["tuned"] == "modulated"
    assert rows["mujoco"]["normal_force"]["contact"]["tuned"] == "modulated until contacts open"


def test_texts_of_a_plugin_neither_colour_nor_move_the_table(capsys, monkeypatch) -> None:
    monkeypatch.setattr(PyBullet, "version", lambda _self: "[red]3\x1b[2J")
    monkeypatch.setattr(MuJoCo, "unavailable_reason", lambda _self: "no\x1b[2J wheel")
    assert run_command(app, []) == 0
    printed = capsys.readouterr().out
    assert "\x1b" not in printed
    assert "[red]3" in printed
    assert r"mujoco: no\x1b[2J wheel" in printed
