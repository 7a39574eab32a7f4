"""A store that somebody proposes: a part of it is computed again, and what does not come out is named."""

import dataclasses

import pytest

from reference_lcp.errors import ParameterError
from reference_lcp.process import run_command
from reports.cli.console_script import app
from scenarios.runs.executor import run_batch
from scenarios.runs.store import ResultStore
from scenarios.verdicts.computed_again import compared_again, sampled
from tests.scenarios.runs.builders import steady

TASKS = [steady(eta) for eta in (0.5, 0.6, 0.7, 0.8, 0.9)]


@pytest.fixture(scope="module")
def results():
    return run_batch(TASKS)


def store_of(folder, results):
    file = folder / "proposed.sqlite"
    with ResultStore(file) as store:
        store.keep(zip(TASKS, results, strict=True))
    return file


def test_what_was_computed_comes_out_again(tmp_path, results, capsys):
    file = store_of(tmp_path, results)
    assert run_command(app, ["store", "again", str(file), "--part", "0.5", "--workers", "1"]) == 0
    assert capsys.readouterr().out == "3 of its steady states computed again: 0 differ\n"


def test_a_number_that_was_changed_is_found(tmp_path, results, capsys):
    false = [*results[:-1], dataclasses.replace(results[-1], transmittance_db=results[-1].transmittance_db + 0.1)]
    file = store_of(tmp_path, false)
    assert run_command(app, ["store", "again", str(file), "--part", "1", "--workers", "1"]) == 1
    first, last = capsys.readouterr().out.splitlines()
    assert first.startswith("reference: {")
    assert "'frequency_ratio': 0.9" in first
    assert last == "5 of its steady states computed again: 1 differ"


def test_the_draw_is_that_of_its_seed(tmp_path, results):
    file = store_of(tmp_path, results)
    draws = [[task.frequency_ratio for task, _ in sampled(file, 0.4, seed)] for seed in (1, 1, 2, 3, 4)]
    assert draws[0] == draws[1]
    assert len({tuple(draw) for draw in draws}) > 1
    assert {len(draw) for draw in draws} == {2}
    assert len(sampled(file, 1e-9, 0)) == 1


def test_a_point_that_no_longer_converges_differs(results):
    lost = dataclasses.replace(results[0], status="period limit")
    assert len(compared_again([(TASKS[0], results[0])], lambda _tasks: [lost]).beyond) == 1


def test_a_store_without_steady_states_is_refused(tmp_path):
    with ResultStore(tmp_path / "empty.sqlite"):
        pass
    with pytest.raises(ParameterError, match=r"has no steady state that can be computed here"):
        sampled(tmp_path / "empty.sqlite", 0.5, 0)
