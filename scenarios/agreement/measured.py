"""What comes of checks: all runs are planned, computed in worker processes, and judged; a crash is a result."""

import os
from collections import defaultdict
from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

from multibody_xval.scenarios.agreement.checks import Check
from multibody_xval.scenarios.catalogue.numbers import numbers
from multibody_xval.scenarios.catalogue.scenario import Scenario
from multibody_xval.scenarios.model import Result
from multibody_xval.scenarios.result_tables import now
from multibody_xval.scenarios.running.pool import run_missing
from multibody_xval.scenarios.running.processes import local
from multibody_xval.scenarios.store import opened

Row = Mapping[str, Any]
"""One judged number; see `catalogue.numbers`."""


class Measured(NamedTuple):
    """The result of a check, and its judged numbers."""

    check: Check
    result: Result
    rows: list[Row]


Key = tuple[str, str]
"""Configuration and case."""


def measured(checks: Sequence[Check]) -> dict[Key, Measured]:
    """Run and judge checks, by their configuration and case."""
    runs = [run for check in checks for run in check.runs]
    with local(os.cpu_count() or 1) as pool, opened(None) as store:
        results = run_missing(runs, store, pool)
    stored, rows = now(results), defaultdict[Key, list[Row]](list)
    for scenario, own in _by_scenario(checks):
        table = numbers(scenario, stored, list(dict.fromkeys(check.config for check in own)))
        for row in table.to_dict("records"):
            rows[row["configuration"], row["case"]].append({str(name): value for name, value in row.items()})
    return {key(check): Measured(check, results[check.run], rows[key(check)]) for check in checks}


def key(check: Check) -> Key:
    """Give what a check is found by."""
    config = check.config
    return ":".join([config.engine, config.formulation, config.preset_name]), check.case


def _by_scenario(checks: Sequence[Check]) -> list[tuple[Scenario, list[Check]]]:
    groups: dict[int, tuple[Scenario, list[Check]]] = {}
    for check in checks:
        groups.setdefault(id(check.scenario), (check.scenario, []))[1].append(check)
    return list(groups.values())
