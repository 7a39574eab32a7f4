"""Scenarios that are asked: their runs are computed or read, and become numbers."""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

import pandas as pd

from multibody_xval.scenarios.catalogue.all_scenarios import SCENARIOS
from multibody_xval.scenarios.catalogue.numbers import numbers
from multibody_xval.scenarios.catalogue.scenario import Scenario
from multibody_xval.scenarios.model import EXACT, REFERENCE
from multibody_xval.scenarios.running.evaluate import Means, computed, newest, stored_results
from reference_lcp.errors import ParameterError, checked_choice

ALL_SCENARIOS = "all"
"""Name of all scenarios together."""


def named_scenarios(names: Sequence[str]) -> list[Scenario]:
    """Give the scenarios of these names, each once.

    Raises
    ------
    ParameterError
        If there is none of a name.
    """
    known = [checked_choice("scenario", name, [*SCENARIOS, ALL_SCENARIOS]) for name in dict.fromkeys(names)]
    return list(SCENARIOS.values()) if ALL_SCENARIOS in known else [SCENARIOS[name] for name in known]


def answers(scenarios: Sequence[Scenario], engines: Sequence[str], means: Means) -> pd.DataFrame:
    """Run what scenarios ask of engines, and give their judged numbers; see `numbers` for its columns.

    Raises
    ------
    ParameterError
        If an engine is unknown or not installed, or the store is no store.
    RunError
        If the store cannot be written.
    """
    configs = {own.name: own.configs(engines) for own in scenarios}
    runs = [run for own in scenarios for run in own.runs(configs[own.name])]
    what = scenarios[0].name if len(scenarios) == 1 else f"{len(scenarios)} scenarios"
    known = computed(runs, means, what)
    with _readable(means.store):
        return pd.concat([numbers(own, known, configs[own.name]) for own in scenarios], ignore_index=True)


def stored_answers(scenarios: Sequence[Scenario], engines: Sequence[str], store: Path) -> pd.DataFrame:
    """Give the numbers of what a store holds, of all engines in it where none is named; nothing is run.

    The verdict on what it lacks is `NOT_RUN`. Of several versions of an engine those of the installed one are given,
    or else the last.

    Raises
    ------
    ParameterError
        If the file is no store, or holds nothing of these scenarios.
    """
    known = newest(stored_results(store))
    there = [config for config in dict.fromkeys(run.config for run in known) if config not in (REFERENCE, EXACT)]
    tables = []
    for own in scenarios:
        asked = own.configs(engines) if engines else there
        configs = [config for config in asked if any(run in known for run in own.own_runs(config).values())]
        with _readable(store):
            tables.append(numbers(own, known.values(), configs))
    table = pd.concat(tables, ignore_index=True)
    if table.empty:
        names = ", ".join(own.name for own in scenarios)
        raise ParameterError(f"store {store} holds no results of {names}; allowed: without --no-run, to run them")
    return table


@contextmanager
def _readable(store: Path | None) -> Iterator[None]:
    """Refuse results of a file that anybody may have written, and that lack what their runs give."""
    try:
        yield
    except (LookupError, ValueError, TypeError) as problem:
        if store is None or isinstance(problem, ParameterError):
            raise
        what = f"holds a result that lacks what its run gives: {type(problem).__name__}: {problem}"
        raise ParameterError(f"store {store} {what}; allowed: what this suite writes") from problem
