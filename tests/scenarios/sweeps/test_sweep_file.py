"""A sweep file: what may stand in it, its runs, and errors that name file, key, value and what is allowed."""

import re
from typing import Any

import pytest

from multibody_xval.scenarios.model import REFERENCE, Case, Config, Run
from multibody_xval.scenarios.sweeps.file import sweep_of
from multibody_xval.scenarios.sweeps.plan import Sweep
from reference_lcp.defaults import CHAIN_STIFFNESS
from reference_lcp.errors import ParameterError

GRID: dict[str, Any] = {"friction_ratio": [0.3], "frequency_ratio": [0.9]}


def swept(**changes: Any) -> Sweep:
    return sweep_of({"engines": ["reference"], "grid": GRID, **changes})


def test_runs_are_those_of_the_engines_and_of_the_ruler() -> None:
    sweep = swept(engines=["mujoco"], grid={**GRID, "cells": [1, 2]})
    runs = sweep.runs()
    own = [Case(friction_ratio=0.3, frequency_ratio=0.9, cells=cells) for cells in (1, 2)]
    assert [run for run in runs if run.config == Config("mujoco")] == [
        Run(Config("mujoco"), case, case.steps(400)) for case in own
    ]
    assert sum(run.config == REFERENCE for run in runs) == 4 * len(own)
    assert sweep_of(sweep.model_dump(exclude_none=True)) == sweep


def test_a_range_is_even_lists_are_by_cell_forces_are_in_newton_and_steps_may_be_varied() -> None:
    ends = {"first": 0.5, "last": 1.5, "points": 3}
    sweep = swept(grid={**GRID, "frequency_ratio": ends}, chain={"cells": 2, "mass_ratio": [1.0, 2.0]})
    assert sweep.axes["frequency_ratio"] == (0.5, 1.0, 1.5)
    assert sweep.places[0].case.mass_ratio == (1.0, 2.0)
    force = swept(drive={"kind": "force", "amplitude": 3.0})
    assert force.places[0].case.displacement == 3.0 / CHAIN_STIFFNESS
    runs = swept(engines=["mujoco"], grid={**GRID, "steps_per_period": [2000, 4000]}).runs()
    assert [run.steps for run in runs if run.config.engine == "mujoco"] == [2000, 4000]


ENDS = {"first": 0.5, "last": 1.5}


def axis(**values: Any) -> dict[str, Any]:
    return {"grid": GRID | values}


def curve(**changes: float) -> dict[str, Any]:
    return axis(frequency_ratio={**ENDS, "accuracy_db": 1.0} | changes)


WRONG: list[tuple[dict[str, Any], str]] = [
    (
        axis(frequency_ratio=[0.9, 0.9]),
        "grid.frequency_ratio = [0.9, 0.9]; allowed: at least one value, none of them twice",
    ),
    ({"grid": {"friction_ratio": [0.3]}}, "grid.frequency_ratio is missing; allowed: at least one value"),
    (axis(mass_ratio={**ENDS, "point": 3}), "grid.mass_ratio.point is unknown; allowed: first, last, points; did you"),
    (
        axis(frequency_ratio={**ENDS, "accuracy": 0.5}),
        "grid.frequency_ratio.accuracy is unknown; allowed: first, last, points, accuracy_db; did you mean accuracy_db",
    ),
    ({"engines": ["reference:joint:exact"]}, "engines = reference:joint:exact cannot be swept: its transmittance is "),
    (axis(mass_ratio={**ENDS, "accuracy_db": 1.0}), "grid.mass_ratio has an accuracy; allowed: of frequency_ratio"),
    (curve(last=0.2), "grid.frequency_ratio.last = 0.2; allowed: > first = 0.5"),
    (curve() | {"chain": {"cells": 3000}}, "cells = 3000 with an accuracy of frequency_ratio, "),
    ({"chain": {"mass_ratio": [1.0, "x"]}}, "chain.mass_ratio.1 = 'x'; allowed: a number"),
    ({"chain": {"mass_ratio": [1.0, 2.0]}}, "chain.mass_ratio has 2 values and the chain 7 cells; allowed: one number"),
    ({"tolerances": {}}, "tolerances.transmittance_db is missing; allowed: as "),
]


@pytest.mark.parametrize(("change", "message"), WRONG, ids=[message for _, message in WRONG])
def test_errors_name_key_value_and_range(change: dict[str, Any], message: str) -> None:
    with pytest.raises(ParameterError, match=f"^{re.escape(message)}"):
        swept(**change)
