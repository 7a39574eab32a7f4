"""Contract and scenarios notice engines with one error each, and let the same engines pass without it."""

import subprocess
import sys
from xml.etree import ElementTree

import pytest

from multibody_xval.engines.interface.variant import Variant
from multibody_xval.scenarios.catalogue.all_scenarios import SCENARIOS
from tests.mutations.catalogue import MUTANTS
from tests.scenarios.in_this_process import deviating, judged

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
"""What the contract has to notice."""

ELSEWHERE: list[Error] = [
    ("coefficient-quarters", 0.1),
    ("coefficient-high", 0.1),
    ("drive-slow", 0.1),
    ("dashpots-cut", 0.1),
    ("steps-many", 0.1),
    ("clock-single", 1.0),
    ("start-leaks", 0.1),
    ("steps-late", 0.1),
    ("advance-short", 1.0),
]
"""What the contract has to notice where the usual places show nothing; scenarios all but the last, which none shows."""

NOT_SHORT = ELSEWHERE[:-1]

ABILITIES: dict[str, list[Error]] = {
    "static-above-kinetic": [("static-ratio", 0.1), ("static-kinetic", 0.1)],
    "direction": [("direction-pyramid", 0.1)],
    "modulated-normal-force": [("flight-load", 0.1)],
}
"""What the scenario of an ability has to notice."""

UNIT_CELL: list[Error] = [
    ("excused", 10.0),
    ("bound", 0.01),
    ("inner-mass", 0.01),
    ("chain-damping", 1.0),
    ("siconos-bound", 0.01),
    ("recorded-friction", 2.0),
]
"""What a single scenario has to notice."""


def wrong(errors: list[Error]) -> list[Variant]:
    return [MUTANTS[name].variant(size) for name, size in errors]


def sound(errors: list[Error]) -> list[Variant]:
    return list(dict.fromkeys(MUTANTS[name].variant(0) for name, _ in errors))


def label(error: Error) -> str:
    return f"{error[0]}-{error[1]:g}"


def noticed(names: list[str], errors: list[Error]) -> set[Variant]:
    """Engines with these errors, and without any, of which a number of one of the scenarios deviates."""
    variants = [*wrong(errors), *sound(errors)]
    return {each for each in variants if any(deviating(judged(SCENARIOS[name], each)) for name in names)}


@pytest.fixture(scope="module")
def broken_clauses(install, tmp_path_factory: pytest.TempPathFactory) -> set[str]:
    """Names of the tests of the contract that fail, of every engine with an error and of every one without."""
    file = tmp_path_factory.mktemp("contract") / "junit.xml"
    variants = [*wrong(CONTRACT + ELSEWHERE), *sound(CONTRACT + ELSEWHERE)]
    names = [option for variant in variants for option in ("--xval-engine", variant.engine)]
    options = ["-q", "-p", "no:cacheprovider", "--override-ini=addopts=", "--tb=no", f"--junitxml={file}"]
    command = [sys.executable, "-m", "pytest", "--pyargs", "multibody_xval.engines.contract", *options, *names]
    done = subprocess.run(command, env=install("mutations").environment, capture_output=True, text=True, check=False)
    assert done.returncode == pytest.ExitCode.TESTS_FAILED, done.stdout[-1000:] + done.stderr[-1000:]
    cases = ElementTree.parse(file).getroot().iter("testcase")
    return {case.attrib["name"] for case in cases if {part.tag for part in case} & {"failure", "error"}}


def is_of(variant: Variant, test: str) -> bool:
    """Whether a test, ``clause[ENGINE]`` or ``clause[ENGINE-formulation-preset…]``, is one of a variant's engine."""
    starts = (f"{variant.engine}]", f"{variant.engine}-joint-", f"{variant.engine}-contact-")
    return test.partition("[")[2].startswith(starts)


@pytest.mark.slow
@pytest.mark.parametrize("error", CONTRACT + ELSEWHERE, ids=label)
def test_contract_notices_the_error_and_passes_the_engine_without_it(broken_clauses, error: Error) -> None:
    assert any(is_of(wrong([error])[0], clause) for clause in broken_clauses)
    assert not [clause for clause in broken_clauses if is_of(sound([error])[0], clause)]


@pytest.mark.slow
def test_scenarios_notice_what_is_wrong_elsewhere_in_the_ranges_or_after_long_use() -> None:
    assert noticed(["wide-range", "long-run"], NOT_SHORT) == set(wrong(NOT_SHORT))


@pytest.mark.slow
@pytest.mark.parametrize(("scenario", "errors"), ABILITIES.items())
def test_scenario_of_an_ability_notices_what_is_wrong_there_alone(scenario: str, errors: list[Error]) -> None:
    assert noticed([scenario], errors) == set(wrong(errors))


def test_unit_cell_notices_what_is_wrong_with_one_cell_whatever_excuse_is_stated() -> None:
    assert noticed(["unit-cell"], UNIT_CELL) == set(wrong(UNIT_CELL))
