"""Steady states of scenarios as an engine would give them that is right, but for what a test makes wrong."""

from collections.abc import Callable
from dataclasses import replace
from functools import cache

import pandas as pd

from multibody_xval.scenarios.catalogue.numbers import numbers
from multibody_xval.scenarios.catalogue.scenario import Scenario
from multibody_xval.scenarios.compute.batch import run_batch
from multibody_xval.scenarios.model import REFERENCE, Case, Config, Result, Run
from multibody_xval.scenarios.store import Stored

SHARES, OTHER = Config("mujoco"), Config("drake")
"""Judged presets: one that shares the scheme, and one that does not."""


@cache
def result_of(run: Run) -> Result:
    """Run once, though many tests ask for the same."""
    return run_batch([run])[0]


def only(scenario: Scenario, *names: str) -> Scenario:
    """Give a scenario with some of its cases."""
    return replace(scenario, cases={name: scenario.cases[name] for name in names})


def judged_copy(
    scenario: Scenario,
    config: Config = SHARES,
    changed: Callable[[Case], Case] = lambda case: case,
    spoilt: Callable[[Result], Result] = lambda result: result,
) -> pd.DataFrame:
    """Judge a copy of the scheme that steps changed cases, said to be a configuration, whose results are spoilt."""
    runs = [run for run in scenario.runs([config]) if run.config != config]
    ruler = [Stored(run, "1", result_of(run)) for run in runs]
    own = [
        Stored(run, "1", spoilt(result_of(Run(REFERENCE, changed(run.of(Case)), run.steps))))
        for run in scenario.own_runs(config).values()
    ]
    table = numbers(scenario, [*ruler, *own])
    return table[table.engine == config.engine]


def deviating(table: pd.DataFrame) -> set[str]:
    """Give the quantities that deviate in any case."""
    return set(table[table.verdict == "deviates"].quantity)
