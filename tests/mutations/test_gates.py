"""Every gate stops the engines that it should, and lets the same engines pass without their error."""

from collections.abc import Iterator

import pytest

from engines.interface.variant import Variant
from scenarios.catalogue.registry import CATALOGUE
from scenarios.runs.store import opened_store
from tests.mutations.catalogue import MUTANTS
from tests.mutations.gates import LEFT_OUT, NEEDED, SCENARIO_NAMES, ContractGate, ReportGate, ScenarioGate, is_of
from tests.scenarios.in_process import evaluator

Error = tuple[str, float]
"""A mutant and its size."""

CONTRACT: list[Error] = [
    ("force-drive", 1.0),
    ("force-drive", 1e-4),
    ("force-late", 1.0),
    ("base-late", 1.0),
    ("start-forgotten", 1.0),
    ("coefficient-ignored", 1.0),
    ("coefficient-of-cell-1", 1.0),
    ("coefficient-mean", 0.1),
    ("bound-of-amplitude", 1.0),
    ("bound-of-stiffness", 1.0),
    ("cells-swapped", 0.1),
    ("chain-damping", 0.1),
    ("outer-mass", 0.005),
    ("kinetic", 0.05),
    ("siconos-bound", 0.01),
    ("siconos-kinetic", 0.01),
    ("siconos-zone", 1e-3),
    ("siconos-zone", 1e-4),
    ("siconos-softness", 1e-3),
    ("siconos-base-dashpot", 1.0),
    ("drake-base-dashpot", 1.0),
    ("mujoco-bound", 0.01),
    ("pybullet-damping", 9.0),
    ("exudyn-zone", 9.0),
    ("single", 1.0),
    ("noise", 1e-6),
    ("recorded-friction", 2.0),
    ("gaps-forgotten", 1.0),
    ("bristles-forgotten", 1.0),
    ("preload-late", 1.0),
    ("implicit", 1.0),
    ("static-ratio", 0.1),
    ("static-kinetic", 0.1),
    ("gap", 0.1),
    ("flight-load", 0.1),
]
"""What the contract has to stop."""

ELSEWHERE: list[Error] = [
    ("coefficient-quarters", 0.1),
    ("coefficient-high", 0.1),
    ("drive-slow", 0.1),
    ("dashpots-cut", 0.1),
    ("steps-many", 0.1),
    ("clock-single", 1.0),
    ("start-leaks", 0.1),
    ("steps-late", 0.1),
]
"""What contract and scenarios have to stop where the usual places show nothing."""

ABILITIES: dict[str, list[Error]] = {
    "static-above-kinetic": [("static-ratio", 0.1), ("static-kinetic", 0.1)],
    "direction": [("direction-pyramid", 0.1)],
    "inclined-chain": [("inclination", 0.1), ("inclined-bound", 0.1)],
    "modulated-normal-force": [("flight-load", 0.1)],
}
"""What the scenario of an ability has to stop."""

SCENARIOS: list[Error] = [
    ("excused", 10.0),
    ("bound", 0.1),
    ("chain-damping", 1.0),
    ("pybullet-damping", 9.0),
    ("mujoco-bound", 0.1),
    ("recorded-friction", 2.0),
]
"""What a single scenario has to stop."""

REPORT: list[Error] = [
    ("bound", 0.1),
    ("chain-damping", 0.1),
    ("outer-mass", 0.005),
    ("kinetic", 0.05),
    ("base-late", 1.0),
    ("mujoco-bound", 0.1),
    ("pybullet-damping", 9.0),
    ("siconos-bound", 0.01),
]
"""What a small report has to stop."""


def wrong(errors: list[Error]) -> list[Variant]:
    return [MUTANTS[name].variant(size) for name, size in errors]


def sound(errors: list[Error]) -> list[Variant]:
    return list(dict.fromkeys(MUTANTS[name].variant(0) for name, _ in errors))


def label(error: Error) -> str:
    return f"{error[0]}-{error[1]:g}"


@pytest.fixture(scope="module")
def stopped_by_contract() -> set[Variant]:
    return ContractGate().caught([*wrong(CONTRACT), *sound(CONTRACT)])


@pytest.fixture(scope="module")
def running() -> Iterator:
    with opened_store(None) as store, evaluator(store) as running:
        yield running


@pytest.mark.slow
@pytest.mark.parametrize("error", CONTRACT, ids=label)
def test_contract_stops_the_engine_and_not_its_sound_twin(stopped_by_contract, error: Error) -> None:
    assert wrong([error])[0] in stopped_by_contract
    assert sound([error])[0] not in stopped_by_contract


@pytest.mark.slow
def test_contract_stops_what_a_single_unit_and_a_single_friction_cannot_show() -> None:
    errors = [("force-drive", 1.0), ("coefficient-ignored", 1.0), ("bound-of-amplitude", 1.0), ("siconos-bound", 0.01)]
    assert ContractGate().caught([*wrong(errors), *sound(errors)]) == set(wrong(errors))


@pytest.mark.slow
def test_contract_stops_what_is_wrong_elsewhere_in_the_ranges_or_after_long_use() -> None:
    errors = [*ELSEWHERE, ("advance-short", 1.0)]
    assert ContractGate().caught([*wrong(errors), *sound(errors)]) == set(wrong(errors))


@pytest.mark.slow
def test_scenarios_stop_what_is_wrong_elsewhere_in_the_ranges_or_after_long_use(running) -> None:
    found = ScenarioGate(running, ["wide-range", "long-run"]).caught([*wrong(ELSEWHERE), *sound(ELSEWHERE)])
    assert found == set(wrong(ELSEWHERE))


@pytest.mark.slow
@pytest.mark.parametrize(("scenario", "errors"), ABILITIES.items())
def test_scenario_of_an_ability_stops_what_is_wrong_there_alone(running, scenario: str, errors: list[Error]) -> None:
    found = ScenarioGate(running, [scenario]).caught([*wrong(errors), *sound(errors)])
    assert found == set(wrong(errors))


def test_every_scenario_is_a_gate_or_has_a_reason_not_to_be() -> None:
    assert {*SCENARIO_NAMES, *LEFT_OUT} == set(CATALOGUE)
    assert not set(SCENARIO_NAMES) & set(LEFT_OUT)
    assert set(NEEDED) <= set(SCENARIO_NAMES)


def test_scenario_stops_what_no_law_predicts(running) -> None:
    assert ScenarioGate(running, ["unit-cell"]).caught([*wrong(SCENARIOS), *sound(SCENARIOS)]) == set(wrong(SCENARIOS))


@pytest.mark.slow
def test_report_stops_what_its_points_and_edges_show(running) -> None:
    report = ReportGate(running, (0.3,), (0.62, 0.7, 0.8, 0.9, 1.0, 1.1, 1.3, 1.5))
    assert report.caught([*wrong(REPORT), *sound(REPORT)]) == set(wrong(REPORT))


def test_failed_clause_is_that_of_the_engine_with_this_name() -> None:
    assert is_of("mutant@bound@1", "test_of_an_engine[mutant@bound@1]")
    assert is_of("mutant@bound@1", "test_of_a_variant[mutant@bound@1-joint-tuned-0.9]")
    assert not is_of("mutant@bound@1", "test_of_a_variant[mutant@bound@1e-07-joint-tuned]")
    assert not is_of("mutant@bound@1", "test_of_an_engine[mutant@bound@1e-07]")
