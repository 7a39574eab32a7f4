"""``multibody-xval engines``: capabilities as data."""

import json

import pytest

from multibody_xval.engines.interface.registry import engine_names
from multibody_xval.engines.mujoco import MuJoCo
from multibody_xval.engines.pybullet import PyBullet
from multibody_xval.reports.cli.engines import app
from reference_lcp.process import run_command


def printed_by(capsys: pytest.CaptureFixture[str], *arguments: str) -> str:
    """Give what a command prints, in one line."""
    assert run_command(app, list(arguments)) == 0
    return " ".join(capsys.readouterr().out.split())


def test_json_describes_every_registered_engine(capsys: pytest.CaptureFixture[str]) -> None:
    rows = json.loads(printed_by(capsys, "--json"))
    assert [row["engine"] for row in rows] == engine_names()
    for row in rows:
        assert (row["version"] is None) == (row["missing"] is not None)
        assert "tuned" in row["presets"]["joint"]
        assert row["licence"]
    normal_force = {row["engine"]: row["normal_force"] for row in rows}
    assert normal_force["mujoco"]["joint"]["tuned"] == "modulated"
    assert normal_force["mujoco"]["contact"]["tuned"] == "modulated until contacts open"
    assert normal_force["siconos"]["joint"]["tuned"] == "constant"


def test_texts_of_a_plugin_neither_colour_nor_move_the_table(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(PyBullet, "version", lambda _self: "[red]3\x1b[2J")
    monkeypatch.setattr(MuJoCo, "unavailable_reason", lambda _self: "no\x1b[2J wheel")
    assert run_command(app, []) == 0
    printed = capsys.readouterr().out
    assert "\x1b" not in printed
    assert "[red]3" in printed
    assert r"mujoco: no\x1b[2J wheel" in printed
