"""Numbers of scenarios that are computed in this process: of engines, and of copies of the scheme that are wrong."""

from collections.abc import Callable
from dataclasses import replace
from functools import cache

import pandas as pd

from multibody_xval.scenarios.cases.motions import BlockMotion
from multibody_xval.scenarios.catalogue.numbers import numbers
from multibody_xval.scenarios.catalogue.scenario import Scenario
from multibody_xval.scenarios.compute.batch import run_batch
from multibody_xval.scenarios.model import REFERENCE, AnyCase, Config, Result, Run
from multibody_xval.scenarios.store import Stored

SHARES, OTHER = Config("mujoco"), Config("pybullet", preset_name="default")
"""A preset that shares the scheme, and one that does not and states no accuracy: copies are said to be theirs."""


def only(scenario: Scenario, *parts: str) -> Scenario:
    """Give the cases whose names hold one of these."""
    few = {name: case for name, case in scenario.cases.items() if any(part in name for part in parts)}
    return replace(scenario, cases=few)


@cache
def result_of(run: Run) -> Result:
    """Run once."""
    return run_batch([run])[0]


def judged_copy(
    scenario: Scenario,
    config: Config,
    change: Callable[[AnyCase], AnyCase] = lambda case: case,
    spoil: Callable[[Result], Result] = lambda result: result,
) -> pd.DataFrame:
    """Judge a copy of the scheme that runs changed cases, or whose results are spoilt."""
    runs = scenario.runs([config])
    copies = {run: Run(REFERENCE, change(run.case), run.steps) for run in runs if run.config == config}
    stored = [Stored(run, "1", spoil(result_of(copies[run])) if run in copies else result_of(run)) for run in runs]
    return numbers(scenario, stored, [config])


def judged(scenario: Scenario, config: Config) -> pd.DataFrame:
    """Judge an engine."""
    own = [run for run in scenario.runs([config]) if run.config == config]
    ruler = [Stored(run, "1", result_of(run)) for run in scenario.runs([config]) if run.config != config]
    return numbers(scenario, [*ruler, *(Stored(run, "1", run_batch([run])[0]) for run in own)], [config])


def pressed(factor: float) -> Callable[[AnyCase], AnyCase]:
    """Press a block harder by a factor, so that friction is as much too large."""
    return lambda case: changed_block(case, normal_force=factor)


def changed_block(case: AnyCase, **factors: float) -> AnyCase:
    """Multiply numbers of a block by factors."""
    assert isinstance(case, BlockMotion), "a block"
    return replace(case, block=replace(case.block, **{name: own * getattr(case.block, name)
                                                      for name, own in factors.items()}))  # fmt: skip
