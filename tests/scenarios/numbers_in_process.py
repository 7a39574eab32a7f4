"""Numbers of a scenario that are computed in this process, where an engine may be spoilt."""

import pandas as pd

from multibody_xval.scenarios.catalogue.numbers import numbers
from multibody_xval.scenarios.catalogue.scenario import Scenario
from multibody_xval.scenarios.compute.batch import run_batch
from multibody_xval.scenarios.judge import DEVIATES
from multibody_xval.scenarios.model import Config
from multibody_xval.scenarios.pool import batches
from multibody_xval.scenarios.result_tables import full_name
from multibody_xval.scenarios.store import Stored


def computed_numbers(scenario: Scenario, *configs: Config) -> pd.DataFrame:
    """Give what `numbers` gives of configurations."""
    ran = [(batch, run_batch(batch)) for batch in batches(scenario.runs(configs))]
    stored = [Stored(run, "1", result) for batch, results in ran for run, result in zip(batch, results, strict=True)]
    return numbers(scenario, stored)


def deviating(scenario: Scenario, *configs: Config) -> set[Config]:
    """Give the configurations of which a number deviates."""
    table = computed_numbers(scenario, *configs)
    names = set(table[table.verdict == DEVIATES].configuration)
    return {config for config in configs if full_name(config) in names}
