"""Copies of Euler's scheme with one fault each are refused, and the sound copy agrees: through pool, ruler and command.

With ``-s`` the table of all faults is printed: at how many points each is found.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import pandas as pd
import pytest

from multibody_xval.engines.interface.registry import registered_names
from multibody_xval.reports.cli.console_script import app
from multibody_xval.reports.cli.ending import run_command
from multibody_xval.reports.cli.exit_code import ExitCode
from multibody_xval.scenarios.edges import judged_edges, propose
from multibody_xval.scenarios.model import Case, Config, Run
from multibody_xval.scenarios.result_tables import points
from multibody_xval.scenarios.ruler.exact_values import ruler
from multibody_xval.scenarios.ruler.judge import AGREES, DEVIATES, failures, judged
from multibody_xval.scenarios.running.evaluate import Means, computed
from tests.faulty.engines import FAULTS, PREFIX
from tests.faulty.faults import SEEN

PLACES = ((0.17, 0.73), (0.3, 0.47), (0.42, 1.24), (0.9, 1.03), (0.23, 0.94), (0.61, 0.83), (0.12, 0.61))
"""Friction and frequency ratios off the usual grids, where contacts stick and slip."""

UNEQUAL = Case(friction_ratio=0.3, frequency_ratio=1.07, friction_profile=(1.0, 0.5, 2.0, 1.5, 0.7, 1.2, 0.9))

CASES = [*(Case(friction_ratio=friction, frequency_ratio=frequency) for friction, frequency in PLACES), UNEQUAL]

STEPS = 400

SHARED, OTHER = "tuned", "other"
"""Presets of every engine of the family: one says that it shares the scheme, one is judged beside the exact motion."""

NOT_IN_TRANSMITTANCE = {
    "push": "a constant force moves a chain of linear springs aside, and nothing else",
    "drift": "springs hold what is moved in every step: it is aside, and moves as it should",
    "half": "recorded friction is not part of the transmittance",
}
"""Faults that leave the fundamental of the last mass as it is: sweeps do not find them, `run` and the contract do."""

FOUND = [name for name in SEEN if name not in ("sound", *NOT_IN_TRANSMITTANCE)]

ENDS: Mapping[str, str] = {
    **dict.fromkeys(("noise", "single"), "not periodic"),
    **dict.fromkeys(("nan", "shape", "complex", "whole", "clock"), "failed"),
}
"""What becomes of every point, where that is not a steady state that deviates."""

SEEN_IN_ONE_CASE = ("alike", "reversed")
"""Faults that change nothing where all cells are alike."""


def config(name: str, preset: str = SHARED) -> Config:
    return Config(f"faulty-{name}", preset_name=preset)


@pytest.fixture(scope="module")
def table(faulty_engines) -> pd.DataFrame:
    """Judged points of all engines; as the presets of one have the same steps, the other's are copied."""
    runs = [Run(config(name), case, STEPS) for name in SEEN for case in CASES]
    stored = computed([*runs, *ruler((case, STEPS) for case in CASES)], Means(workers=2))
    copies = [
        own._replace(run=replace(own.run, config=replace(own.run.config, preset_name=OTHER)))
        for own in stored
        if own.run.config.engine.startswith("faulty-")
    ]
    found = judged(points([*stored, *copies]))
    print(shown(found))
    return found


def shown(table: pd.DataFrame) -> str:
    """Give the number of points at which each fault is found, beside the reference and beside the exact motion."""
    own = table[table.engine.str.startswith("faulty-")]
    found = (own.verdict != AGREES).groupby([own.engine, own.preset]).sum().unstack()
    largest = (own.distance / own.allowed).groupby([own.engine, own.preset]).max().unstack()
    largest.columns = [f"{name}: distance over allowed" for name in largest]
    return pd.concat([found, largest], axis=1).to_string(float_format="{:.3g}".format)


def of(table: pd.DataFrame, name: str, preset: str) -> pd.DataFrame:
    return table[table.config == config(name, preset)]


def test_every_fault_is_an_engine() -> None:
    registered = {name.removeprefix(PREFIX) for name in registered_names() if name.startswith(PREFIX)}
    assert registered == {*FAULTS, "takes"}


def test_the_sound_copy_is_at_a_hundredth_of_what_is_allowed(table) -> None:
    own = of(table, "sound", SHARED)
    assert own.verdict.tolist() == [AGREES] * len(CASES)
    assert (own.distance / own.allowed).max() < 0.01
    assert failures(table[table.engine == "faulty-sound"]) == []


@pytest.mark.parametrize("name", FOUND)
def test_a_fault_is_found_at_equal_steps_and_beside_the_exact_motion(table, name: str) -> None:
    """There, where a fault may hide in the error of a step, one of eight points is enough."""
    own = of(table, name, SHARED)
    wrong = own[own.case == UNEQUAL] if name in SEEN_IN_ONE_CASE else own
    assert set(wrong.verdict) <= ({ENDS[name]} if name in ENDS else {DEVIATES, "not periodic"})
    assert name in ENDS or (wrong.verdict == DEVIATES).mean() > 0.75
    assert len(failures(own)) == len(failures(of(table, name, OTHER))) == 1


@pytest.mark.parametrize("name", NOT_IN_TRANSMITTANCE)
def test_what_leaves_the_fundamental_as_it_is_agrees(table, name: str) -> None:
    assert set(of(table, name, SHARED).verdict) == {AGREES}


@pytest.mark.slow  # 40 points of an engine, and the exact motion at each edge
def test_edges_of_a_band_show_a_bound_that_is_off_by_a_hundredth() -> None:
    grid = [Case(friction_ratio=0.3, frequency_ratio=round(0.5 + 0.05 * k, 6)) for k in range(17)]
    engines = {"sound": AGREES, "bound": DEVIATES}
    runs = [Run(config(name), case, STEPS) for name in engines for case in grid]
    stored = computed([*runs, *ruler((case, STEPS) for case in grid)], Means(workers=2), then=[("edges", propose)])
    edges = judged_edges(points(stored))
    own = edges[edges.engine.str.startswith("faulty-") & (edges.edge == "lower")]
    assert own.groupby("engine").verdict.unique().map(list).to_dict() == {
        f"faulty-{name}": [verdict] for name, verdict in engines.items()
    }


@pytest.fixture(scope="module")
def store(tmp_path_factory) -> Path:
    """A results file that the commands of this module share: the ruler is computed once."""
    return tmp_path_factory.mktemp("commands") / "results.sqlite"


def compared(before: Config, now: Config, store: Path) -> int:
    return run_command(app, ["compare", f"--engine={before}", f"--engine={now}", f"--store={store}", "--workers=2"])


def test_compare_finds_nothing_between_presets_with_the_same_steps(store) -> None:
    assert compared(config("sound"), config("sound", OTHER), store) == ExitCode.DONE


COMPARED = [name for name in FOUND if name not in SEEN_IN_ONE_CASE]

QUICK = ("bound", "nan")


@pytest.mark.parametrize(
    "name", [name if name in QUICK else pytest.param(name, marks=pytest.mark.slow) for name in COMPARED]
)
def test_compare_fails_where_an_engine_has_become_wrong(store, name: str) -> None:
    assert compared(config("sound"), config(name), store) == ExitCode.FAILED


SWEEP = """
engines = {engines}
[grid]
friction_ratio = [0.3, 0.9]
frequency_ratio = [0.47, 1.03]
"""


def reported(names: Sequence[str], folder: Path, capsys) -> tuple[int, str]:
    """Run a report; gives its exit code and what it prints."""
    file = folder / "sweep.toml"
    file.write_text(SWEEP.format(engines=[f"faulty-{name}:joint:tuned" for name in names]))
    code = run_command(app, ["report", f"--sweep={file}", f"--out={folder / 'page'}", "--workers=2"])
    return code, capsys.readouterr().out


@pytest.mark.slow  # a page with as many engines
def test_report_fails_by_every_fault(tmp_path: Path, capsys) -> None:
    names = [name for name in FOUND if name not in SEEN_IN_ONE_CASE]
    code, printed = reported(names, tmp_path, capsys)
    assert code == ExitCode.FAILED
    assert [name for name in names if f"faulty-{name}:joint:tuned: " not in printed] == []


@pytest.mark.slow
def test_report_finds_nothing_wrong_with_the_sound_copy(tmp_path: Path, capsys) -> None:
    code, printed = reported(["sound"], tmp_path, capsys)
    assert code == ExitCode.DONE, printed
    assert "faulty-sound:joint:tuned: " not in printed
