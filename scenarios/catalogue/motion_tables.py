"""What runs of scenarios went through, as tables: rows of motions, transitions of steady states."""

from collections.abc import Collection, Iterable, Iterator, Sequence

import pandas as pd

from multibody_xval.scenarios import result_tables
from multibody_xval.scenarios.catalogue.scenario import Scenario
from multibody_xval.scenarios.model import Case, Run
from multibody_xval.scenarios.result_tables import CONFIG, full_name, names_of
from multibody_xval.scenarios.store import Stored

RUN = ["scenario", "case", "configuration", *CONFIG, "version", "steps"]
"""Columns that say what a row belongs to."""


def series(scenarios: Iterable[Scenario], stored: Sequence[Stored], configurations: Collection[str]) -> pd.DataFrame:
    """Give every number of the motions of configurations, rows counted from one.

    Columns: those of `RUN`, ``series`` (what is followed), ``row`` and ``value``.
    """
    rows = [
        (*about, name, row, value)
        for about, (_, _, result) in _asked(scenarios, stored, configurations)
        for name, values in result.series.items()
        for row, value in enumerate(values, 1)
    ]
    return pd.DataFrame(rows, columns=[*RUN, "series", "row", "value"])


def transitions(
    scenarios: Iterable[Scenario], stored: Sequence[Stored], configurations: Collection[str]
) -> pd.DataFrame:
    """Give every change between stick and slip in the steady states of configurations.

    Columns: those of `RUN`, ``cell``, ``time`` over the period and the new ``mode``.
    """
    rows = [
        (*about, *change)
        for about, own in _asked(scenarios, stored, configurations)
        if isinstance(own.run.case, Case)
        for change in own.result.transitions
    ]
    return pd.DataFrame(rows, columns=[*RUN, *result_tables.CHANGE])


def _asked(
    scenarios: Iterable[Scenario], stored: Sequence[Stored], configurations: Collection[str]
) -> Iterator[tuple[tuple[object, ...], Stored]]:
    """Give the results of scenarios, each with the values of `RUN`."""
    own = [row for row in stored if full_name(row.run.config) in configurations]
    for scenario in scenarios:
        for config in dict.fromkeys(row.run.config for row in own):
            names: dict[Run, str] = {run: name for name, run in scenario.own_runs(config).items()}
            for row in own:
                if row.run in names:
                    own_names = names_of(config).values()
                    yield (scenario.name, names[row.run], *own_names, row.version, row.run.steps), row
