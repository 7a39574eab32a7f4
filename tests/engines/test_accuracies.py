"""What presets state of themselves, held against the recorded numbers: accuracies, and whether searches end."""

import cmath
import csv
import math
from collections import defaultdict
from dataclasses import replace

import pytest

from multibody_xval.engines.interface.presets import Preset
from multibody_xval.engines.interface.registry import engine_names
from multibody_xval.engines.interface.variant import variants_of
from multibody_xval.scenarios.compute.batch import run_batch
from multibody_xval.scenarios.model import REFERENCE, Case, Config, Result, Run, Status
from multibody_xval.scenarios.result_tables import points as table_of
from multibody_xval.scenarios.ruler.exact_values import ruler
from multibody_xval.scenarios.ruler.judge import AGREES, DEVIATES, TOO_LARGE, judged
from multibody_xval.scenarios.store import Stored
from reference_lcp.errors import ParameterError
from tests.golden.record import FOLDER, HEADLINE, points, run_at

MOST_FAILING = 1
"""Headline points at which a preset that does not settle may have a steady state all the same."""

WRITTEN = 2e-6
"""Part of an amplitude that the digits of recorded levels and phases leave open."""

JUDGED = [
    own
    for name in engine_names()
    for own in variants_of(name, optional=True)
    if "chain" in own.preset.judged and name != REFERENCE.engine
]


def recorded(name: str) -> list[dict[str, str]]:
    """Rows of an engine's recorded steady states; none of one that was not there."""
    file = FOLDER / "steady" / f"{name}.csv"
    return list(csv.DictReader(file.read_text(encoding="utf-8").splitlines())) if file.exists() else []


def as_result(row: dict[str, str]) -> Result:
    """Read a recorded row."""
    if row["status"] != Status.PERIODIC:
        return Result(status=Status(row["status"]))
    ratio = cmath.rect(10 ** (float(row["level_db"]) / 20), math.radians(float(row["phase_deg"])))
    return Result(status=Status.PERIODIC, transmittance=ratio, residual=0.0, periods=1)


def test_presets_settle_that_have_a_steady_state_at_two_headline_points() -> None:
    counts: dict[str, int] = defaultdict(int)
    for name in engine_names():
        for row in recorded(name):
            counts[row["config"]] += row["point"].startswith(HEADLINE) and row["status"] == "periodic"
    assert len(counts) > 70
    wrong = {
        name: count for name, count in counts.items() if Config.parse(name).preset.settles != (count > MOST_FAILING)
    }
    assert wrong == {}


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


@pytest.fixture(scope="module")
def ruled() -> list[Stored]:
    """Results of the ruler at the recorded points, without those of long chains and light damping."""
    runs = [run_at(REFERENCE, name) for name, point in points().items() if point["set"] != "long"]
    return [Stored(run, "", run_batch([run])[0]) for run in ruler((own.case, own.steps) for own in runs)]


@pytest.mark.slow
def test_recorded_numbers_of_judged_presets_agree_at_the_accuracy_that_they_state(ruled) -> None:
    """A preset without a stated accuracy shares the scheme, or is as close to the exact value as the scheme is."""
    names = {str(own) for own in JUDGED}
    known = {own.run.case for own in ruled}
    stored = [
        Stored(run, "", as_result(row))
        for own in {own.engine for own in JUDGED}
        for row in recorded(own)
        if row["config"] in names and (run := run_at(Config.parse(row["config"]), row["point"])).case in known
    ]
    table = table_of([*ruled, *stored])
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
    config = Config("drake")
    places = [(case, case.steps()) for case in CASES]
    ruled = [Stored(run, "", run_batch([run])[0]) for run in ruler(places)]

    def verdicts(factor: float) -> list[str]:
        changed = [replace(case, **{fault: factor * getattr(case, fault)}) for case, _ in places]
        results = run_batch([Run(config, case, steps) for case, (_, steps) in zip(changed, places, strict=True)])
        own = [Stored(Run(config, *place), "", result) for place, result in zip(places, results, strict=True)]
        table = judged(table_of([*ruled, *own]))
        return table[table.engine == "drake"].verdict.tolist()

    assert DEVIATES not in verdicts(1.0)
    assert verdicts(1.01).count(DEVIATES) >= len(CASES) // 2
