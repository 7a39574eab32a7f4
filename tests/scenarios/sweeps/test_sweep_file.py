"""A sweep file: what may stand in it, its runs, and errors that name file, key, value and what is allowed."""

import datetime
import math
import re
import tomllib
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from typing import Any

import pandas as pd
import pytest

from multibody_xval.scenarios.model import EXACT, REFERENCE, Case, Config, Run
from multibody_xval.scenarios.sweeps.file import EXAMPLE, read_sweep, sweep_of
from multibody_xval.scenarios.sweeps.plan import Sweep
from reference_lcp.defaults import CHAIN_STIFFNESS
from reference_lcp.errors import ParameterError

GRID: dict[str, Any] = {"friction_ratio": [0.3], "frequency_ratio": [0.9]}


def swept(**changes: Any) -> Sweep:
    return sweep_of({"engines": ["reference"], "grid": GRID, **changes})


def test_the_example_is_read_and_written_again() -> None:
    sweep = sweep_of(tomllib.loads(EXAMPLE))
    assert sweep.points == 3 * 3 * 14
    assert sweep_of(sweep.model_dump(exclude_none=True)) == sweep


def test_runs_are_those_of_the_engines_and_of_the_ruler() -> None:
    sweep = swept(engines=["mujoco"], grid={**GRID, "cells": [1, 2]})
    cases = [Case(friction_ratio=0.3, frequency_ratio=0.9, cells=cells) for cells in (1, 2)]
    runs = sweep.runs()
    assert [run for run in runs if run.config == Config("mujoco")] == [
        Run(Config("mujoco"), case, case.steps(400)) for case in cases
    ]
    assert sum(run.config == REFERENCE for run in runs) == 4 * len(cases)
    assert {run.case for run in runs if run.config == EXACT} <= set(cases)


def test_with_one_more_configuration_all_else_stays_and_the_order_too() -> None:
    sweep = sweep_of(tomllib.loads(EXAMPLE) | {"engines": ["mujoco"]})
    assert sweep.configs == (Config("mujoco"),)
    more = sweep.with_config(REFERENCE)
    assert more.configs == (REFERENCE, Config("mujoco"))
    assert (more.axes, more.places) == (sweep.axes, sweep.places)
    assert more.with_config(REFERENCE) == more


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
    proposed = {run.case for run in sweep.runs(pd.DataFrame(rows))}
    assert len(proposed) == len(begun) - 1
    assert sweep_of(sweep.model_dump(exclude_none=True)) == sweep


ENDS = {"first": 0.5, "last": 1.5}


def axis(**values: Any) -> dict[str, Any]:
    return {"grid": GRID | values}


def curve(**changes: float) -> dict[str, Any]:
    return axis(frequency_ratio={**ENDS, "accuracy_db": 1.0} | changes)


WRONG: list[tuple[dict[str, Any], str]] = [
    (axis(friction_ratio=[-1.0]), "grid.friction_ratio = -1 is outside its range; allowed: >= 0, 1e-"),
    ({"grid": {"friction_ratio": [0.3]}}, "grid.frequency_ratio is missing; allowed: at least one value"),
    (axis(mas_ratio=[1.0]), "grid.mas_ratio is unknown; allowed: friction_ratio, "),
    (axis(cells=[2.5]), "grid.cells = 2.5 is not a whole number; allowed: >= 1"),
    (axis(mass_ratio=2.5), "grid.mass_ratio = 2.5; allowed: a list"),
    (axis(mass_ratio=["x"]), "grid.mass_ratio.0 = 'x'; allowed: a number"),
    (axis(mass_ratio=ENDS), "grid.mass_ratio.points is missing; allowed: as `multibody-xval example` shows"),
    (axis(mass_ratio={**ENDS, "steps": 3}), "grid.mass_ratio.steps is unknown; allowed: first, last, points"),
    (
        axis(mass_ratio={**ENDS, "point": 3}),
        "grid.mass_ratio.point is unknown; allowed: first, last, points; did you mean points?",
    ),
    (axis(mass_ratio={**ENDS, "points": 1}), "grid.mass_ratio.points = 1; allowed: >= 2"),
    (
        axis(mass_ratio={**ENDS, "points": 3, "first": "x"}),
        "grid.mass_ratio.first = 'x'; allowed: a number",
    ),
    (
        axis(mass_ratio={**ENDS, "accuracy_db": 1.0}),
        "grid.mass_ratio has an accuracy; allowed: of frequency_ratio only",
    ),
    (curve(accuracy_db=0.0), "grid.frequency_ratio.accuracy_db = 0.0; allowed: > 0"),
    (curve(first=0.0), "grid.frequency_ratio.first = 0.0; allowed: > 0"),
    (curve(last=0.2), "grid.frequency_ratio.last = 0.2; allowed: > first = 0.5"),
    (
        curve(points=3),
        "grid.frequency_ratio.points is unknown; allowed: first, last, accuracy_db, least_spacing, most_points",
    ),
    ({"grid": [0.3]}, "grid = [0.3]; allowed: a table with friction_ratio, frequency_ratio, cells"),
    (
        {"chain": {"mass_ratio": "x"}},
        "chain.mass_ratio = 'x'; allowed: a number",
    ),
    ({"chain": {"mass_ratio": [1.0, "x"]}}, "chain.mass_ratio.1 = 'x'; allowed: a number"),
    ({"chain": {"mass_ratio": [1.0, 2.0]}}, "chain.mass_ratio has 2 values and the chain 7 cells; allowed: one number"),
    ({"chain": {"mass": 1.0}}, "chain.mass is unknown; allowed: cells, "),
    ({"chain": {"cells": 0}}, "chain.cells = 0 is outside its range; allowed: whole numbers >= 1, up to 100000"),
    ({"drive": {"kind": "forse"}}, "drive.kind = 'forse'; allowed: 'base' or 'force'"),
    ({"drive": {"amplitude": 0.0}}, "drive.amplitude = 0.0; allowed: > 0"),
    ({"drive": {"amplitud": 1.0}}, "drive.amplitud is unknown; allowed: kind, amplitude; did you mean amplitude?"),
    ({"drive": 3}, "drive = 3; allowed: a table with kind, amplitude"),
    ({"steps_per_period": 3}, "steps_per_period = 3; allowed: >= 16"),
    ({"steps_per_period": 20.5}, "steps_per_period = 20.5; allowed: a whole number"),
    (
        {"steps": 400},
        "steps is unknown; allowed: engines, grid, chain, drive, tolerances, steps_per_period; did you mean steps_",
    ),
    ({"engines": ["nope"]}, "engine = 'nope' is unknown; allowed: reference"),
    ({"engines": "mujoco"}, "engines = 'mujoco'; allowed: a list"),
    ({"engines": [1]}, "engines.0 = 1; allowed: a name in quotes"),
    ({"tolerances": {"transmittance_db": 0.0}}, "tolerances.transmittance_db = 0.0; allowed: > 0"),
    ({"tolerances": {}}, "tolerances.transmittance_db is missing; allowed: as "),
]


@pytest.mark.parametrize(("change", "message"), WRONG, ids=[message for _, message in WRONG])
def test_errors_name_key_value_and_range(change: dict[str, Any], message: str) -> None:
    with pytest.raises(ParameterError, match=f"^{re.escape(message)}"):
        swept(**change)


def test_a_key_that_is_misspelt_comes_before_one_that_is_missing() -> None:
    with pytest.raises(ParameterError, match=r"^engine is unknown; .*; did you mean engines\?$"):
        sweep_of({"engine": ["reference"], "grid": GRID})
    with pytest.raises(ParameterError, match=r"^grid is missing; allowed: as `multibody-xval example` shows"):
        sweep_of({"engines": ["reference"]})


def test_what_is_no_table_is_no_sweep() -> None:
    with pytest.raises(ParameterError, match=r"^a sweep = \[1\]; allowed: a table with engines, grid, chain, "):
        sweep_of([1])  # as a stranger's dataset may have it


ODD: list[Any] = [True, "x", -1, 0, 2.5, 1e300, math.nan, [], [[1.0]], ["x"], {}, {"x": 1}, datetime.date(2020, 1, 1)]


def changed(content: Any, value: Any) -> Iterator[Any]:
    """Give data with a value in place of each part of it."""
    yield value
    for key, own in content.items() if isinstance(content, dict) else ():
        for inner in changed(own, value):
            yield {**content, key: inner}


@pytest.mark.parametrize("value", ODD, ids=str)
def test_an_odd_value_anywhere_is_told_in_one_plain_line(value: Any) -> None:
    content = {
        **tomllib.loads(EXAMPLE), "tolerances": {"transmittance_db": 0.1},
        "grid": {**GRID, "mass_ratio": {**ENDS, "points": 3}, "frequency_ratio": {**ENDS, "accuracy_db": 1.0}},
    }  # fmt: skip
    told = set()
    for odd in changed(content, value):
        if isinstance(odd, dict) and len(odd) > 2:
            with suppress(Told):
                told.add(message_of(odd))
    assert len(told) > 5
    for line in told:
        assert "; allowed: " in line
        assert "\n" not in line
        assert not re.search("nput should|valid|permitted|pydantic", line), line


class Told(Exception):
    """Nothing was told: the value may stand there."""


def message_of(content: dict[str, Any]) -> str:
    try:
        sweep_of(content)
    except ParameterError as problem:
        return str(problem)
    raise Told


def test_errors_name_the_file(tmp_path: Path) -> None:
    file = tmp_path / "own.toml"
    file.write_text(EXAMPLE.replace("cells = 7", "cells = 0"))
    with pytest.raises(ParameterError, match=r"own\.toml: chain\.cells = 0.*>= 1"):
        read_sweep(file)
    file.write_text("[grid")
    with pytest.raises(ParameterError, match=r"own\.toml is no TOML"):
        read_sweep(file)
