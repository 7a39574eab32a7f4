"""The suite computes what it computed before: three steady states an engine, drawn anew each day; and edges of curves.

``python -m tests.golden.record`` and ``python -m tests.golden.compare`` do it for all numbers.
"""

import datetime
import random
from pathlib import Path

import pytest

from multibody_xval.engines.interface.registry import engine, engine_names
from multibody_xval.scenarios.compute.batch import run_batch
from multibody_xval.scenarios.model import REFERENCE, Config
from tests.golden import compare
from tests.golden.record import FOLDER, points, run_at, steady_numbers

SAMPLE = 3
"""Steady states of each engine a day."""

CHEAP = ("grid", "off", "modulated")
"""Sets of operating points that take less than a second with every engine."""

RECORDED = compare.rows(FOLDER, "steady/*.csv", ("config", "point"))


def sample(name: str) -> list[tuple[str, str]]:
    """Draw configurations and points at which an engine has a steady state."""
    settled = [
        (config, point)
        for (config, point), row in RECORDED.items()
        if config.split(":")[0] == name and row["status"] == "periodic" and points()[point]["set"] in CHEAP
    ]
    return random.Random(datetime.date.today().toordinal()).sample(settled, min(SAMPLE, len(settled)))


def test_every_engine_with_presets_has_recorded_points():
    recorded = {config.split(":")[0] for config, _ in RECORDED}
    assert recorded >= {name for name in engine_names() if engine(name).unavailable_reason() is None}


@pytest.mark.parametrize("name", sorted({config.split(":")[0] for config, _ in RECORDED}))
def test_steady_states_are_those_recorded(name: str):
    missing = engine(name).unavailable_reason()
    if missing:
        pytest.skip(missing)
    for config, point in sample(name):
        own, of_reference = (run_batch([run_at(each, point)])[0] for each in (Config.parse(config), REFERENCE))
        now = {key: str(value) for key, value in steady_numbers(own, of_reference.amplification).items()}
        assert compare.steady(RECORDED[config, point], now) == "", (config, point)


@pytest.mark.parametrize(
    ("pattern", "column", "value"),
    [
        ("steady/mujoco.csv", "level_db", "-1.001"),
        ("steady/mujoco.csv", "phase_deg", "12.5"),
        ("steady/mujoco.csv", "status", "not periodic"),
        ("scenarios/mujoco.csv", "value", "17.5"),
        ("edges.csv", "frequency_ratio", "0.86"),
        ("reference.csv", "proven_db", "-37.21086779342775192313"),
    ],
)
def test_another_number_is_a_difference(pattern: str, column: str, value: str, tmp_path: Path):
    file = tmp_path / pattern
    file.parent.mkdir(exist_ok=True)
    lines = (FOLDER / pattern).read_text(encoding="utf-8").splitlines()
    cells = lines[1].split(",")
    cells[lines[0].split(",").index(column)] = value
    for second, count in ((",".join(cells), 1), (lines[1], 0)):
        file.write_text("\n".join([lines[0], second, *lines[2:]]), encoding="utf-8")
        assert len(list(compare.differences(FOLDER, tmp_path))) == count
