"""Every fault makes `run` end with 1, `check` give a number that deviates, and clauses of the contract red.

No scenario sees every fault: `SEEN_BY` says which one sees those that the unit cell cannot show. The sound copy passes
everywhere.
"""

from collections import Counter
from collections.abc import Mapping
from pathlib import Path
from xml.etree import ElementTree

import pandas as pd
import pytest

import multibody_xval as xval
from multibody_xval.reports.cli.console_script import app
from multibody_xval.reports.cli.ending import run_command
from multibody_xval.reports.cli.exit_code import ExitCode
from multibody_xval.scenarios.catalogue.chains.steady_states import UNIT_CELL
from multibody_xval.scenarios.ruler.judge import AGREES, DEVIATES
from tests.faulty.faults import SEEN
from tests.faulty.sizes import SIZED, is_noticed

UNIT, UNEQUAL, THROWN = "unit-cell", "disordered-chain", "stopping-distance"

SEEN_BY: Mapping[str, str] = {
    **dict.fromkeys(("alike", "reversed"), UNEQUAL),
    **dict.fromkeys(("push", "drift"), THROWN),
}
"""The scenario that sees a fault which the unit cell does not: of cells that differ, of a place that is kept."""

UNSEEN = {UNIT: tuple(SEEN_BY), UNEQUAL: ("push", "drift"), THROWN: ("half", "alike", "reversed")}
"""Faults that a scenario does not see."""

WRONG = [name for name in SEEN if name != "sound"]

QUICK = ("inner-mass", "bound", "inner-spring", "long-step", "late", "nan", "reversed", "push")


def chosen(names):
    """Let all but a few be slow."""
    return [name if name in QUICK else pytest.param(name, marks=pytest.mark.slow) for name in names]


def named(name: str) -> str:
    return f"faulty-{name}:joint:tuned"


@pytest.fixture(scope="module")
def store(here, tmp_path_factory) -> Path:
    """A results file of all scenarios: the ruler is computed once."""
    return tmp_path_factory.mktemp("scenarios") / "results.sqlite"


def run(scenario: str, name: str, store: Path) -> int:
    return run_command(app, ["run", scenario, f"--engine={named(name)}", f"--store={store}"])


def checked(scenario: str, name: str, store: Path) -> pd.DataFrame:
    table = xval.check(scenario, named(name), store=store)
    assert table.judged.all()
    return table


NO_NUMBERS = {"noise": "not periodic", "nan": "failed", "shape": "failed", "complex": "failed", "whole": "failed",
              "clock": "failed"}  # fmt: skip
"""Verdict on all numbers of an engine that gives none."""


@pytest.mark.parametrize("name", chosen(WRONG))
def test_run_fails_by_a_fault_and_check_gives_its_verdict(store: Path, name: str) -> None:
    scenario = SEEN_BY.get(name, UNIT)
    assert run(scenario, name, store) == ExitCode.FAILED
    verdicts = set(checked(scenario, name, store).verdict)
    assert verdicts == {NO_NUMBERS[name]} if name in NO_NUMBERS else DEVIATES in verdicts


@pytest.mark.parametrize("scenario", [UNIT, UNEQUAL, THROWN])
def test_run_and_check_agree_with_the_sound_copy(store: Path, scenario: str) -> None:
    assert run(scenario, "sound", store) == ExitCode.DONE
    assert set(checked(scenario, "sound", store).verdict) == {AGREES}


@pytest.mark.slow
@pytest.mark.parametrize(("scenario", "name"), [(scenario, name) for scenario in UNSEEN for name in UNSEEN[scenario]])
def test_a_scenario_does_not_see_what_it_does_not_ask_for(store: Path, scenario: str, name: str) -> None:
    assert run(scenario, name, store) == ExitCode.DONE


UNNOTICED, NOTICED = 1e-10, 1e-6
"""Sizes of a fault that pass, and that are found: as parts of the number, or of the period for the time of the base."""


@pytest.mark.parametrize("fault", SIZED)
def test_a_millionth_of_a_fault_is_noticed_beside_the_reference_at_equal_steps(fault: str) -> None:
    assert not is_noticed(UNIT_CELL, "tuned", fault, UNNOTICED)
    assert is_noticed(UNIT_CELL, "tuned", fault, NOTICED)


CONTRACT = "multibody_xval.engines.contract"


def red(install, names: list[str], file: Path, *options: str) -> dict[str, set[str]]:
    """Run clauses of the contract for engines of the family; gives those that fail, by engine."""
    engines = [part for name in names for part in ("--xval-engine", f"faulty-{name}")]
    usual = ["-m", "pytest", "-q", "-n", "0", "-p", "no:cacheprovider", f"--junitxml={file}", "--pyargs", CONTRACT]
    install("faulty").run(*usual, *options, *engines, code=1)
    failed: dict[str, set[str]] = {name: set() for name in names}
    for case in ElementTree.parse(file).getroot().iter("testcase"):
        if {part.tag for part in case} & {"failure", "error"}:
            clause, _, engine = case.attrib["name"].partition("[faulty-")
            failed[engine.removesuffix("]").partition("-joint-")[0]].add(clause)
    return failed


def test_pytest_is_red_by_a_fault_and_green_for_the_sound_copy(install, tmp_path: Path) -> None:
    clauses = "joint-tuned and (cells_that_differ or a_step_in_si_units or stays_there)"
    failed = red(install, ["sound", *QUICK], tmp_path / "junit.xml", "-k", clauses)
    assert {name for name, clauses in failed.items() if not clauses} == {"sound"}


def shown(failed: Mapping[str, set[str]]) -> str:
    """Give the rows of docs/noticed_faults.md: clauses that fewest faults turn red come first."""
    often = Counter(clause for clauses in failed.values() for clause in clauses)
    rows = []
    for name, clauses in failed.items():
        rarest = sorted(clauses, key=lambda clause: (often[clause], clause))
        said = "; ".join(clause.removeprefix("test_").replace("_", " ") for clause in rarest[:3])
        more = f"; {len(rarest) - 3} more" if len(rarest) > 3 else ""
        rows.append(f"| {name} | {SEEN[name].what} | {len(rarest)} | {said}{more} |")
    return "\n".join(rows)


@pytest.mark.slow  # the whole contract for as many engines
def test_the_contract_is_red_by_every_fault_and_green_for_the_sound_copy(install, tmp_path: Path) -> None:
    failed = red(install, list(SEEN), tmp_path / "junit.xml", "-k", "joint-tuned")
    print(shown(failed))
    assert {name for name, clauses in failed.items() if not clauses} == {"sound"}
