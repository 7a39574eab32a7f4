"""Numbers of a scenario that are computed in this process, where an engine may be spoilt."""

from collections.abc import Sequence

import pandas as pd

from multibody_xval.scenarios.catalogue.numbers import numbers
from multibody_xval.scenarios.catalogue.scenario import Scenario
from multibody_xval.scenarios.compute.batch import run_batch
from multibody_xval.scenarios.judge import DEVIATES
from multibody_xval.scenarios.model import Config, Run
from multibody_xval.scenarios.pool import batches
from multibody_xval.scenarios.result_tables import full_name
from multibody_xval.scenarios.store import Stored


def computed_here(runs: Sequence[Run], *_: object) -> list[Stored]:
    """Run everything; what is given beside the runs, such as a file of results, has no part in it."""
    ran = [(batch, run_batch(batch)) for batch in batches(runs)]
    return [Stored(run, "1", result) for batch, results in ran for run, result in zip(batch, results, strict=True)]


def computed_numbers(scenario: Scenario, *configs: Config) -> pd.DataFrame:
    """Give what `numbers` gives of configurations."""
    return numbers(scenario, computed_here(scenario.runs(configs)))


def deviating(scenario: Scenario, *configs: Config) -> set[Config]:
    """Give the configurations of which a number deviates."""
    table = computed_numbers(scenario, *configs)
    names = set(table[table.verdict == DEVIATES].configuration)
    return {config for config in configs if full_name(config) in names}
