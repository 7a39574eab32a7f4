"""What the store knows of other scenarios: outcomes of what was run in full, and of nothing else."""

from collections.abc import Iterable, Iterator
from dataclasses import replace
from pathlib import Path

import pytest

from multibody_xval.engines.interface.variant import Variant
from multibody_xval.reports.data.catalogue import Outcome, catalogue_outcomes
from multibody_xval.reports.data.report import Report
from multibody_xval.reports.export.tables import catalogue_table
from multibody_xval.reports.page.render import page, sections
from multibody_xval.reports.page.sections import Catalogue
from multibody_xval.scenarios.catalogue.base import run_with_predictions
from multibody_xval.scenarios.catalogue.registry import CATALOGUE
from multibody_xval.scenarios.runs.evaluator import Evaluator, StoredResults
from multibody_xval.scenarios.runs.executor import InProcessExecutor
from multibody_xval.scenarios.runs.result import Result
from multibody_xval.scenarios.runs.store import ResultStore
from multibody_xval.scenarios.runs.task import Task
from multibody_xval.scenarios.verdicts.steady_case import REFERENCE
from tests.reports.conftest import MISSING, RUNS

DEFAULT = Variant("mujoco", "joint", "default")


@pytest.fixture(scope="module")
def store(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Holds one scenario, of two variants, one of which deviates as its law says."""
    file = tmp_path_factory.mktemp("store") / "results.sqlite"
    with ResultStore(file) as kept:
        run_with_predictions(CATALOGUE["breakaway"], [RUNS, DEFAULT], Evaluator(kept, InProcessExecutor()))
    return file


def test_a_scenario_that_was_run_has_its_outcomes_and_others_are_left_out(store: Path) -> None:
    with ResultStore(store) as kept:
        known = catalogue_outcomes([REFERENCE, RUNS, DEFAULT, MISSING], kept)
    assert set(known) == {"breakaway"}
    own = known["breakaway"]
    assert RUNS in own
    assert MISSING not in own, "it was not run"
    assert set(own[RUNS]) == {Outcome.AGREES}
    assert next(iter(own[DEFAULT])) is Outcome.MODELLED, "it creeps before it breaks away, as its law does"


def test_a_variant_that_deviates_is_left_out_where_nobody_has_run_its_law(tmp_path: Path) -> None:
    with ResultStore(tmp_path / "results.sqlite") as kept:
        CATALOGUE["breakaway"].run([RUNS, DEFAULT], Evaluator(kept, InProcessExecutor()))
        known = catalogue_outcomes([RUNS, DEFAULT], kept)
    assert list(known["breakaway"]) == [RUNS]


def test_a_store_without_scenarios_has_no_section(report: Report, tmp_path: Path) -> None:
    with ResultStore(tmp_path / "empty.sqlite") as kept:
        assert catalogue_outcomes([REFERENCE, RUNS], kept) == {}
    assert "Other scenarios" not in [part.title for part in sections(report)]


def test_of_a_variant_that_a_store_knows_nothing_of_one_task_a_scenario_is_looked_up(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked: list[Task] = []
    read = ResultStore.results

    def noted(store: ResultStore, tasks: Iterable[Task]) -> Iterator[Result | None]:
        tasks = list(tasks)
        asked.extend(tasks)
        return read(store, tasks)

    monkeypatch.setattr(ResultStore, "results", noted)
    with ResultStore(tmp_path / "empty.sqlite") as kept:
        assert catalogue_outcomes([REFERENCE, RUNS, DEFAULT], kept) == {}
        looked_up = len(asked)
        for scenario in CATALOGUE.values():
            scenario.run([REFERENCE, RUNS, DEFAULT], StoredResults(kept))
    runnable = [task.variant in (RUNS, DEFAULT) and task.unsupported_reason() is None for task in asked]
    assert sum(runnable[:looked_up]) <= 2 * len(CATALOGUE), "one each of them and of a scenario, or none"
    assert sum(runnable[looked_up:]) > 10 * len(CATALOGUE), "judging every case looks up many more"


def test_cells_show_the_worst_outcome_with_its_number_and_tell_all(report: Report) -> None:
    counts = {Outcome.UNMODELLED: 2, Outcome.AGREES: 10}
    shown = replace(report, catalogue={"breakaway": {RUNS: counts}, "unit-cell": {REFERENCE: {Outcome.AGREES: 3}}})
    html = page("A page", [Catalogue(shown)]).html
    assert '<td class="outcome unmodelled" title="2 unmodelled, 10 agrees">✗ 2</td>' in html
    assert '<td class="outcome agrees" title="3 agrees">✓</td>' in html
    assert '<td class="outcome " title="not known"></td>' in html
    table = catalogue_table(shown.catalogue)
    assert table.loc[0, ["scenario", "engine", "unmodelled", "agrees"]].tolist() == ["breakaway", "mujoco", 2, 10]
