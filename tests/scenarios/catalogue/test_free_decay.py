"""Free decay: the friction oscillator's closed form, the exact motion, engines that are right and wrong."""

from dataclasses import replace

import numpy as np
import pytest

from multibody_xval.scenarios.catalogue.chains.free_decay import (
    FREE_DECAY,
    OSCILLATOR,
    half_width,
    loss_a_cycle,
    offsets,
    rest_time,
)
from multibody_xval.scenarios.model import EXACT, Run
from multibody_xval.scenarios.ruler.judge import AGREES
from tests.scenarios.in_this_process import OTHER, SHARES, deviating, judged, judged_copy, result_of


def exact_run(case):
    return Run(EXACT, case, 8 * case.rows)


def test_oscillator_of_the_scenario_decays_by_the_closed_form() -> None:
    """Let go at 1, with F / k = 0.06: turns at 0.88, 0.76, … 0.04, where it stays, after eight half cycles."""
    run = exact_run(OSCILLATOR)
    exact = result_of(run)
    assert exact.series["offsets"][0] == pytest.approx(0.04, abs=1e-4)
    assert rest_time(exact, run) == pytest.approx(4, abs=0.03)
    assert loss_a_cycle(np.array(exact.series["swing"])) == pytest.approx(4 * 0.06, rel=1e-4)
    # springs of the rest state hold (1/25)² of the energy
    assert exact.series["energy"][0] == pytest.approx(0.04**2, abs=2e-4)
    assert half_width(run) == pytest.approx(0.06)


@pytest.mark.parametrize("name", FREE_DECAY.cases)
def test_contacts_come_to_rest_inside_their_dead_bands_before_the_end(name) -> None:
    run = exact_run(FREE_DECAY.cases[name])
    exact = result_of(run)
    assert 0 < exact.series["rest"][0] < 0.9 * run.case.time
    left = np.max(np.abs(offsets(exact, run)))
    assert 0.01 < left <= 1


@pytest.mark.needs("mujoco")
def test_mujoco_decays_as_the_exact_motion_does() -> None:
    table = judged(FREE_DECAY, SHARES)
    assert len(table) == 8 + 7 + 7
    assert set(table.verdict) == {AGREES}


@pytest.mark.parametrize("config", [SHARES, OTHER])
def test_friction_that_is_too_large_by_a_twentieth_is_found(config) -> None:
    """It stops earlier and elsewhere, and loses more in a cycle."""
    table = judged_copy(FREE_DECAY, config, lambda case: replace(case, friction_ratio=1.05 * case.friction_ratio))
    wrong = table[[own in deviating(table) for own in zip(table.case, table.quantity, strict=True)]]
    by_name = wrong.set_index(["case", "quantity"])
    assert by_name.value["friction oscillator", "loss a cycle"] == pytest.approx(1.05, rel=1e-3)
    assert ("inner masses let go", "offsets") in by_name.index
