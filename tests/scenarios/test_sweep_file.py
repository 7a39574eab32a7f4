"""A sweep file: what may stand in it, its runs, and errors that name file, key, value and what is allowed."""

import tomllib
from pathlib import Path
from typing import Any

import pandas as pd
import pytest

from multibody_xval.scenarios.model import EXACT, REFERENCE, Case, Config, Run
from multibody_xval.scenarios.sweep_file import EXAMPLE, content_of, read_sweep, sweep_of
from multibody_xval.scenarios.sweep_plan import Sweep
from reference_lcp.defaults import CHAIN_STIFFNESS
from reference_lcp.errors import ParameterError

GRID: dict[str, Any] = {"friction_ratio": [0.3], "frequency_ratio": [0.9]}


def swept(**changes: Any) -> Sweep:
    return sweep_of({"engines": ["reference"], "grid": GRID, **changes})


def test_the_example_is_read_and_written_again() -> None:
    sweep = sweep_of(tomllib.loads(EXAMPLE))
    assert sweep.points == 3 * 3 * 14
    assert sweep_of(content_of(sweep)) == sweep


def test_runs_are_those_of_the_engines_and_of_the_ruler() -> None:
    sweep = swept(engines=["mujoco"], grid={**GRID, "cells": [1, 2]})
    cases = [Case(friction_ratio=0.3, frequency_ratio=0.9, cells=cells) for cells in (1, 2)]
    runs = sweep.runs()
    assert [run for run in runs if run.config == Config("mujoco")] == [
        Run(Config("mujoco"), case, case.steps(400)) for case in cases
    ]
    assert sum(run.config == REFERENCE for run in runs) == 4 * len(cases)
    assert {run.case for run in runs if run.config == EXACT} <= set(cases)


def test_the_amplitude_of_a_force_is_said_in_newton() -> None:
    force = swept(drive={"kind": "force", "amplitude": 3.0})
    assert force.places[0].case.displacement == 3.0 / CHAIN_STIFFNESS
    assert swept(drive={"kind": "force"}).places[0].case.displacement == swept().places[0].case.displacement


def test_a_range_is_even_and_lists_are_by_cell() -> None:
    ends = {"first": 0.5, "last": 1.5, "points": 3}
    sweep = swept(grid={**GRID, "frequency_ratio": ends}, chain={"cells": 2, "mass_ratio": [1.0, 2.0]})
    assert sweep.axes["frequency_ratio"] == (0.5, 1.0, 1.5)
    assert sweep.places[0].case.mass_ratio == (1.0, 2.0)


def test_steps_may_be_varied() -> None:
    runs = swept(engines=["mujoco"], grid={**GRID, "steps_per_period": [2000, 4000]}).runs()
    assert [run.steps for run in runs if run.config.engine == "mujoco"] == [2000, 4000]


def test_an_adaptive_sweep_begins_before_it_proposes() -> None:
    adaptive = {"first": 0.5, "last": 1.5, "accuracy_db": 1.0}
    sweep = swept(grid={**GRID, "frequency_ratio": adaptive}, chain={"cells": 1})
    begun = {run.case for run in sweep.runs()}
    assert {0.5, 1.5} <= {case.frequency_ratio for case in begun}
    rows = [
        {"config": REFERENCE, "curve": sweep.places[0].case, "case": case, "steps": case.steps(400),
         "frequency_ratio": case.frequency_ratio, "status": "periodic", "transmittance_db": 0.0}
        for case in begun
    ]  # fmt: skip
    proposed = {run.case for run in sweep.propose(pd.DataFrame(rows))}
    assert len(proposed) == len(begun) - 1
    assert sweep_of(content_of(sweep)) == sweep


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"grid": {**GRID, "friction_ratio": [-1.0]}}, r"grid\.friction_ratio = -1 .*allowed: >= 0"),
        ({"grid": {"friction_ratio": [0.3]}}, r"grid\.frequency_ratio is missing"),
        ({"grid": {**GRID, "mas_ratio": [1.0]}}, r"grid\.mas_ratio is unknown.*mass_ratio"),
        ({"grid": {**GRID, "cells": [2.5]}}, r"grid\.cells = 2\.5 is not a whole number; allowed: >= 1"),
        ({"grid": {**GRID, "friction_ratio": {"first": 1.0, "last": 2.0}}}, r"grid\.friction_ratio\.points is missing"),
        ({"chain": {"mass_ratio": "x"}}, r"chain\.mass_ratio = 'x'"),
        ({"chain": {"mass_ratio": [1.0, 2.0]}}, r"chain\.mass_ratio has 2 values and the chain 7 cells"),
        ({"drive": {"amplitude": 0.0}}, r"drive\.amplitude = 0\.0; .*greater than 0"),
        ({"steps_per_period": 3}, r"steps_per_period = 3; .*16"),
        ({"engines": ["nope"]}, r"'nope' is unknown; allowed: reference"),
        ({"tolerances": {"transmittance_db": 0.0}}, r"tolerances\.transmittance_db = 0\.0"),
        ({"colour": 1}, r"colour is unknown"),
    ],
)
def test_errors_name_key_value_and_range(change: dict[str, Any], message: str) -> None:
    with pytest.raises(ParameterError, match=message):
        swept(**change)


def test_errors_name_the_file(tmp_path: Path) -> None:
    file = tmp_path / "own.toml"
    file.write_text(EXAMPLE.replace("cells = 7", "cells = 0"))
    with pytest.raises(ParameterError, match=r"own\.toml: chain\.cells = 0.*>= 1"):
        read_sweep(file)
    file.write_text("[grid")
    with pytest.raises(ParameterError, match=r"own\.toml is no TOML"):
        read_sweep(file)
