"""What presets state of themselves, held against the recorded numbers: accuracies, and whether searches end."""

import cmath
import math
from dataclasses import replace

import pandas as pd
import pytest

from multibody_xval.engines.interface.presets import Preset
from multibody_xval.engines.interface.registry import engine_names
from multibody_xval.engines.interface.variant import variants_of
from multibody_xval.scenarios.compute.batch import run_batch
from multibody_xval.scenarios.model import REFERENCE, Case, Config, Result, Run, Status
from multibody_xval.scenarios.result_tables import now
from multibody_xval.scenarios.result_tables import points as table_of
from multibody_xval.scenarios.ruler.exact_values import ruler
from multibody_xval.scenarios.ruler.judge import AGREES, DEVIATES, TOO_LARGE, judged
from reference_lcp.errors import ParameterError
from tests.golden.compare import rows
from tests.golden.record import FOLDER, HEADLINE, LONG, points, run_at

MOST_FAILING = 1
"""Headline points at which a preset that does not settle may have a steady state all the same."""

WRITTEN = 2e-6
"""Part of an amplitude that the digits of recorded levels and phases leave open."""

RECORDED = rows(FOLDER, "steady")


def test_presets_settle_that_have_a_steady_state_at_two_headline_points() -> None:
    found = (RECORDED.point.str.startswith(HEADLINE) & (RECORDED.status == "periodic")).groupby(RECORDED.config).sum()
    assert len(found) > 70
    assert [name for name, own in found.items() if Config.parse(name).preset.settles != (own > MOST_FAILING)] == []


@pytest.mark.parametrize(
    ("stated", "says"),
    [
        (
            {"accuracy": {"transmittance": 0.02}, "accuracy_reason": "soft"},
            "accuracy = 0.02 of transmittance; allowed: 0",
        ),
        ({"accuracy": {"transmittance": 0.01}}, "accuracy_reason is empty"),
    ],
)
def test_an_accuracy_is_at_most_that_which_hides_no_fault_and_has_a_reason(stated, says) -> None:
    with pytest.raises(ParameterError, match=says):
        Preset("Of a plugin.", **stated)


def as_result(row) -> Result:
    """Read a recorded row."""
    if row.status != Status.PERIODIC:
        return Result(status=Status(row.status))
    ratio = cmath.rect(10 ** (float(row.level_db) / 20), math.radians(float(row.phase_deg)))
    return Result(status=Status.PERIODIC, transmittance=ratio, residual=0.0, periods=1)


def ruled(places) -> dict[Run, Result]:
    """Results of the ruler at cases with their steps."""
    return {run: run_batch([run])[0] for run in ruler(places)}


@pytest.mark.slow
def test_recorded_numbers_of_judged_presets_agree_at_the_accuracy_that_they_state() -> None:
    """A preset without a stated accuracy shares the scheme, or is as close to the exact value as the scheme is."""
    every = (own for name in engine_names() if name != REFERENCE.engine for own in variants_of(name, optional=True))
    names = {str(own) for own in every if "chain" in own.preset.judged}
    recorded = RECORDED[RECORDED.config.isin(names) & ~RECORDED.point.str.startswith(LONG)]
    results = {run_at(Config.parse(own.config), own.point): as_result(own) for own in recorded.itertuples()}
    known = ruled(place for name, place in points().items() if not name.startswith(LONG))
    table = table_of(now(known | results))
    table = judged(table.assign(gives_way=table.gives_way + WRITTEN * table.ratio.abs()))
    own = table[table.judged & (table.status == "periodic")]
    assert len(own) > 1000
    assert own[~own.verdict.isin([AGREES, TOO_LARGE])].filter(["configuration", "frequency_ratio", "verdict"]).empty


CASES = [
    Case(friction_ratio=own, frequency_ratio=eta) for own, eta in ((0.2, 0.62), (0.36, 1.24), (0.7, 0.92), (0.5, 0.55))
]


@pytest.mark.slow
@pytest.mark.needs("drake")
@pytest.mark.parametrize("fault", ["mass_ratio", "friction_ratio", "stiffness_ratio"])
def test_a_hundredth_of_a_mass_a_bound_or_a_spring_is_found_within_a_stated_accuracy(fault) -> None:
    places = [(case, case.steps()) for case in CASES]
    known = ruled(places)

    def verdicts(factor: float) -> pd.Series:
        changed = [
            Run(Config("drake"), replace(case, **{fault: factor * getattr(case, fault)}), n) for case, n in places
        ]
        own = [Run(Config("drake"), *place) for place in places]
        table = judged(table_of(now(known | dict(zip(own, run_batch(changed), strict=True)))))
        return table[table.engine == "drake"].verdict

    assert DEVIATES not in set(verdicts(1.0))
    assert (verdicts(1.01) == DEVIATES).sum() >= len(CASES) // 2
