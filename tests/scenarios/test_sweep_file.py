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


VALUES = "a list of numbers, such as [0.1, 0.3], or { first = 0.3, last = 1.6, points = 14 }"
FORMS = "allowed: first, last, points, or first, last, accuracy_db, least_spacing, most_points"
ENDS = {"first": 0.5, "last": 1.5}
DECIBEL = "a number > 0, up to 1000"


def axis(**values: Any) -> dict[str, Any]:
    return {"grid": GRID | values}


def curve(**changes: float) -> dict[str, Any]:
    return axis(frequency_ratio={**ENDS, "accuracy_db": 1.0} | changes)


WRONG: list[tuple[dict[str, Any], str]] = [
    (axis(friction_ratio=[-1.0]), "grid.friction_ratio = -1 is outside its range; allowed: >= 0, 1e-"),
    ({"grid": {"friction_ratio": [0.3]}}, "grid.frequency_ratio is missing; allowed: at least one value"),
    (axis(mas_ratio=[1.0]), "grid.mas_ratio is unknown; allowed: friction_ratio, "),
    (axis(mas_ratio="x"), "grid.mas_ratio is unknown; allowed: friction_ratio, "),
    (axis(cells=[2.5]), "grid.cells = 2.5 is not a whole number; allowed: >= 1"),
    (axis(mass_ratio=2.5), f"grid.mass_ratio = 2.5; allowed: {VALUES}"),
    (axis(mass_ratio=["x"]), "grid.mass_ratio.0 = 'x'; allowed: a number"),
    (axis(mass_ratio=ENDS), "grid.mass_ratio.points is missing; allowed: a whole number from 2 to"),
    (axis(mass_ratio={**ENDS, "steps": 3}), f"grid.mass_ratio.steps is unknown; {FORMS}"),
    (axis(mass_ratio={**ENDS, "point": 3}), f"grid.mass_ratio.point is unknown; {FORMS}; did you mean points?"),
    (axis(mass_ratio={**ENDS, "points": 1}), "grid.mass_ratio.points = 1; allowed: a whole number from 2 to"),
    (
        axis(mass_ratio={**ENDS, "points": 3, "first": "x"}),
        "grid.mass_ratio.first = 'x'; allowed: a number from -1e+12 to",
    ),
    (
        axis(mass_ratio={**ENDS, "accuracy_db": 1.0}),
        "grid.mass_ratio has an accuracy; allowed: of frequency_ratio only",
    ),
    (curve(accuracy_db=0.0), f"grid.frequency_ratio.accuracy_db = 0.0; allowed: {DECIBEL}"),
    (curve(first=0.0), "grid.frequency_ratio.first = 0.0; allowed: a number > 0, up"),
    (curve(last=0.2), "grid.frequency_ratio.last = 0.2; allowed: > first = 0.5"),
    (curve(points=3), f"grid.frequency_ratio.points does not go with the other keys; {FORMS}"),
    ({"grid": [0.3]}, "grid = [0.3]; allowed: a table with friction_ratio and frequency_ratio"),
    (
        {"chain": {"mass_ratio": "x"}},
        "chain.mass_ratio = 'x'; allowed: a number, or a list with a number for every cell",
    ),
    ({"chain": {"mass_ratio": [1.0, "x"]}}, "chain.mass_ratio.1 = 'x'; allowed: a number"),
    ({"chain": {"mass_ratio": [1.0, 2.0]}}, "chain.mass_ratio has 2 values and the chain 7 cells; allowed: one number"),
    ({"chain": {"mass": 1.0}}, "chain.mass is unknown; allowed: cells, "),
    ({"chain": {"cells": 0}}, "chain.cells = 0 is outside its range; allowed: whole numbers >= 1, up to 100000"),
    ({"drive": {"kind": "forse"}}, 'drive.kind = \'forse\'; allowed: "base" or "force"'),
    ({"drive": {"amplitude": 0.0}}, "drive.amplitude = 0.0; allowed: a number > 0, up to 1e+24"),
    ({"drive": {"amplitud": 1.0}}, "drive.amplitud is unknown; allowed: kind, amplitude; did you mean amplitude?"),
    ({"drive": 3}, "drive = 3; allowed: a table with kind and amplitude"),
    ({"steps_per_period": 3}, "steps_per_period = 3; allowed: a whole number from 16 to 1000000"),
    ({"steps_per_period": 20.5}, "steps_per_period = 20.5; allowed: a whole number from 16 to 1000000"),
    (
        {"steps": 400},
        "steps is unknown; allowed: engines, steps_per_period, grid, chain, drive, tolerances; did you mean steps_",
    ),
    ({"engines": ["nope"]}, "engine = 'nope' is unknown; allowed: reference"),
    ({"engines": "mujoco"}, "engines = 'mujoco'; allowed: at least one name in quotes, such as "),
    ({"engines": [1]}, 'engines.0 = 1; allowed: a name in quotes, such as "mujoco"'),
    ({"tolerances": {"transmittance_db": 0.0}}, f"tolerances.transmittance_db = 0.0; allowed: {DECIBEL}"),
    ({"tolerances": {}}, f"tolerances.transmittance_db is missing; allowed: {DECIBEL}"),
]


@pytest.mark.parametrize(("change", "message"), WRONG, ids=[message for _, message in WRONG])
def test_errors_name_key_value_and_range(change: dict[str, Any], message: str) -> None:
    with pytest.raises(ParameterError, match=f"^{re.escape(message)}"):
        swept(**change)


def test_a_key_that_is_misspelt_comes_before_one_that_is_missing() -> None:
    with pytest.raises(ParameterError, match=r"^engine is unknown; .*; did you mean engines\?$"):
        sweep_of({"engine": ["reference"], "grid": GRID})
    with pytest.raises(ParameterError, match=r"^grid is missing; allowed: a table with friction_ratio"):
        sweep_of({"engines": ["reference"]})


def test_what_is_no_table_is_no_sweep() -> None:
    with pytest.raises(ParameterError, match=r"^a sweep = \[1\]; allowed: a table with engines and grid$"):
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
