"""The suite computes what it computed before: three steady states an engine, drawn anew each day."""

import datetime
from pathlib import Path

import pandas as pd
import pytest

from multibody_xval.engines.interface.registry import engine, engine_names
from multibody_xval.scenarios.compute.batch import run_batch
from multibody_xval.scenarios.model import REFERENCE, Config
from multibody_xval.scenarios.result_tables import now
from multibody_xval.scenarios.result_tables import points as table_of
from tests.golden.compare import main, rows
from tests.golden.record import FOLDER, LONG, run_at, steady_numbers, write
from tests.installed import each_engine

SAMPLE = 3
RECORDED = rows(FOLDER, "steady")
ENGINES = RECORDED.config.str.split(":").str[0]


def test_every_engine_with_presets_has_recorded_points() -> None:
    assert {*ENGINES} >= {name for name in engine_names() if engine(name).unavailable_reason() is None}


@pytest.mark.parametrize("name", each_engine(sorted({*ENGINES})))
def test_steady_states_are_those_recorded(name: str, tmp_path: Path, capsys) -> None:
    settled = RECORDED[(name == ENGINES) & (RECORDED.status == "periodic") & ~RECORDED.point.str.startswith(LONG)]
    drawn = settled.sample(SAMPLE, random_state=datetime.date.today().toordinal())
    asked = [(Config.parse(own), point) for own, point in zip(drawn.config, drawn.point, strict=True)]
    runs = {run_at(config, point): None for own, point in asked for config in (own, REFERENCE)}
    table = steady_numbers(table_of(now({run: run_batch([run])[0] for run in runs})))
    write(tmp_path, "steady", name, table[[own in asked for own in zip(table.config, table.point, strict=True)]])
    code, said = main(FOLDER, tmp_path), capsys.readouterr().out
    assert code == 0, said
    assert f"{SAMPLE} rows compared" in said


@pytest.mark.parametrize(
    ("file", "column", "value"),
    [
        ("steady/mujoco.csv", "level_db", "-1.001"),
        ("steady/mujoco.csv", "phase_deg", "12.5"),
        ("edges/mujoco.csv", "frequency_ratio", "0.86"),
        ("scenarios/pybullet.csv", "value", "inf"),  # which it has in rows of joints that never stop, too
    ],
)
def test_another_number_is_a_difference(file: str, column: str, value: str, tmp_path: Path, capsys) -> None:
    table = pd.read_csv(FOLDER / file, dtype=str, keep_default_na=False)
    (tmp_path / file).parent.mkdir()
    for wrong in (True, False):
        changed = table.assign(**{column: table[column].where(table.index != 0, value)}) if wrong else table
        changed.to_csv(tmp_path / file, index=False)
        assert main(FOLDER, tmp_path) == wrong
        assert f"{len(table)} rows compared" in capsys.readouterr().out
