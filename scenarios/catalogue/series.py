"""Series of motions in one table: what is drawn, and what numbers are read from."""

from collections.abc import Iterable

import pandas as pd

from multibody_xval.scenarios.catalogue.scenario import Scenario
from multibody_xval.scenarios.result_tables import CONFIG, full_name
from multibody_xval.scenarios.store import Stored

COLUMNS = ["scenario", "case", "configuration", *CONFIG, "version", "steps", "series", "row", "value"]


def series(scenario: Scenario, stored: Iterable[Stored]) -> pd.DataFrame:
    """Give every number of every series of a scenario's runs, rows counted from one: columns `COLUMNS`."""
    known = list(stored)
    configs = dict.fromkeys(own.run.config for own in known)
    names = {run: name for config in configs for name, run in scenario.own_runs(config).items()}
    rows = [
        (scenario.name, names[run], full_name(run.config), run.config.engine, str(run.config.formulation),
         run.config.preset_name, version, run.steps, name, row, value)
        for run, version, result in known
        if run in names
        for name, values in result.series.items()
        for row, value in enumerate(values, 1)
    ]  # fmt: skip
    return pd.DataFrame(rows, columns=COLUMNS)
