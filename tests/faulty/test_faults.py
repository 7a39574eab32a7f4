"""Copies of Euler's scheme with one fault each are refused by every command, and the sound copy agrees.

No scenario sees every fault: `SEEN_BY` says which one sees those that the unit cell cannot show.
"""

from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path
from xml.etree import ElementTree

import pandas as pd
import pytest

import multibody_xval as xval
from multibody_xval.engines.interface.registry import registered_names
from multibody_xval.reports.cli.console_script import app
from multibody_xval.reports.cli.ending import run_command
from multibody_xval.reports.cli.exit_code import ExitCode
from multibody_xval.scenarios.ruler.judge import AGREES, DEVIATES
from tests.faulty.engines import FAULTS, PREFIX
from tests.faulty.faults import SEEN
from tests.faulty.sizes import SIZED, is_noticed

UNIT, UNEQUAL, THROWN = "unit-cell", "disordered-chain", "stopping-distance"

ALIKE, MOVED = ("alike", "reversed"), ("push", "drift")
SEEN_BY: Mapping[str, str] = {
    **dict.fromkeys((*ALIKE, "one-mass", "one-bound"), UNEQUAL),
    **dict.fromkeys(MOVED, THROWN),
}
"""The scenario that sees a fault which the unit cell does not: of cells that differ, of a place that is kept."""

HIDDEN = (*MOVED, "single")
"""Faults that hide in the error of a time step beside the exact motion."""

NO_NUMBERS = {"noise": "not periodic", **dict.fromkeys(("nan", "shape", "complex", "whole", "clock"), "failed")}
"""Verdict on all numbers of an engine that gives none."""

WRONG = [*(name for name in SEEN if name != "sound"), "kilogram-force"]

OF_PERIODS = [name for name in WRONG if name not in (*ALIKE, *MOVED, "half")]
"""Faults that change the transmittance of a chain of cells that are alike; recorded friction is no part of it."""

QUICK = ("inner-mass", "bound", "inner-spring", "long-step", "late", "lag", "nan", "kilogram-force", "reversed", "push")

SHARED, OTHER = "tuned", "other"
"""Presets of every engine of the family: one says that it shares the scheme, one is judged beside the exact motion."""


def chosen(names: Sequence[str]):
    """Let all but a few be slow."""
    return [name if name in QUICK else pytest.param(name, marks=pytest.mark.slow) for name in names]


def named(name: str, preset: str = SHARED) -> str:
    return f"{PREFIX}{name}:joint:{preset}"


@pytest.fixture(scope="module", autouse=True)
def faulty_engines(install):
    """Tests of this file see the faulty engines; all others do not."""
    with install("faulty").visible():
        yield


@pytest.fixture(scope="module")
def store(here, tmp_path_factory) -> Path:
    """A results file of all commands: the ruler is computed once."""
    return tmp_path_factory.mktemp("faulty") / "results.sqlite"


def test_every_fault_is_an_engine() -> None:
    registered = {name.removeprefix(PREFIX) for name in registered_names() if name.startswith(PREFIX)}
    assert registered == {*FAULTS, "takes"}


def run(scenario: str, name: str, store: Path) -> int:
    return run_command(app, ["run", scenario, f"--engine={named(name)}", f"--store={store}"])


def checked(scenario: str, name: str, store: Path, preset: str = SHARED) -> pd.DataFrame:
    table = xval.check(scenario, named(name, preset), store=store)
    assert table.judged.all()
    return table


@pytest.mark.parametrize("name", chosen(WRONG))
def test_run_fails_by_a_fault_and_check_finds_it_at_equal_steps_and_beside_the_exact_motion(store, name: str) -> None:
    scenario = SEEN_BY.get(name, UNIT)
    assert run(scenario, name, store) == ExitCode.FAILED
    for preset in (SHARED,) if name in HIDDEN else (SHARED, OTHER):
        verdicts = set(checked(scenario, name, store, preset).verdict)
        assert verdicts == {NO_NUMBERS[name]} if name in NO_NUMBERS else DEVIATES in verdicts


@pytest.mark.parametrize("scenario", [UNIT, UNEQUAL, THROWN])
def test_run_and_check_agree_with_the_sound_copy(store: Path, scenario: str) -> None:
    """At equal steps it is at a fiftieth of what is allowed."""
    assert run(scenario, "sound", store) == ExitCode.DONE
    assert set(checked(scenario, "sound", store, OTHER).verdict) == {AGREES}
    table = checked(scenario, "sound", store)
    assert set(table.verdict) == {AGREES}
    assert (table.distance / table.allowed).max() < 0.02


@pytest.mark.parametrize("fault", SIZED)
def test_a_millionth_of_a_fault_is_noticed_beside_the_reference_at_equal_steps(fault: str) -> None:
    assert not is_noticed(UNIT, SHARED, fault, 1e-10)
    assert is_noticed(UNIT, SHARED, fault, 1e-6)


def compared(before: str, now: str, store: Path) -> int:
    return run_command(app, ["compare", f"--engine={before}", f"--engine={now}", f"--store={store}"])


def test_compare_finds_nothing_between_presets_with_the_same_steps(store: Path) -> None:
    assert compared(named("sound"), named("sound", OTHER), store) == ExitCode.DONE


@pytest.mark.parametrize("name", ["bound", "late", "kilogram-force", "nan"])
def test_compare_fails_where_an_engine_has_become_wrong(store: Path, name: str) -> None:
    assert compared(named("sound"), named(name), store) == ExitCode.FAILED


@pytest.mark.slow  # a page with as many engines
def test_report_fails_by_every_fault_and_finds_nothing_wrong_with_the_sound_copy(tmp_path: Path, capsys) -> None:
    file, names = tmp_path / "sweep.toml", [*OF_PERIODS, "sound"]
    grid = "[grid]\nfriction_ratio = [0.3, 0.9]\nfrequency_ratio = [0.47, 1.03]\n"
    file.write_text(f"engines = {list(map(named, names))}\n{grid}")
    assert run_command(app, ["report", f"--sweep={file}", f"--out={tmp_path / 'page'}"]) == ExitCode.FAILED
    printed = capsys.readouterr().out
    assert [name for name in names if f"{named(name)}: " not in printed] == ["sound"]


def shown(failed: Mapping[str, set[str]]) -> str:
    """Give the rows of docs/theory/agreement.md: clauses that fewest faults turn red come first."""
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
    file, engines = tmp_path / "junit.xml", [part for name in SEEN for part in ("--xval-engine", f"{PREFIX}{name}")]
    usual = f"-m pytest -q -n 0 -p no:cacheprovider --junitxml={file} -k joint-tuned --pyargs"
    install("faulty").run(*usual.split(), "multibody_xval.engines.contract", *engines, code=1)
    failed: dict[str, set[str]] = {name: set() for name in SEEN}
    for case in ElementTree.parse(file).getroot().iter("testcase"):
        if {part.tag for part in case} & {"failure", "error"}:
            clause, _, engine = case.attrib["name"].partition(f"[{PREFIX}")
            failed[engine.removesuffix("]").partition("-joint-")[0]].add(clause)
    print(shown(failed))
    assert {name for name, clauses in failed.items() if not clauses} == {"sound"}
