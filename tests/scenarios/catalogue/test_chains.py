"""Chains under a harmonic drive: what is right agrees, and each kind of mistake is found by the scenario for it."""

from dataclasses import replace

import pytest

from multibody_xval.scenarios.catalogue.chains import steady_states as chains
from multibody_xval.scenarios.model import Case, Config
from multibody_xval.scenarios.ruler.judge import AGREES
from tests.scenarios.in_this_process import OTHER, SHARES, judged_copy, only, quantities

SMALL = {
    "figure3": only(chains.FIGURE3, "friction 0.6, η_r 0.9"),
    "long-chain": only(chains.LONG_CHAIN, "15 cells"),
    "wide-range": replace(
        chains.WIDE_RANGE, cases={name: case for name, case in chains.WIDE_RANGE.cases.items() if case.cells < 5}
    ),
}


def stronger(factor: float):
    def changed(case: Case) -> Case:
        return replace(case, friction_ratio=factor * case.friction_ratio)

    return changed


@pytest.mark.parametrize("config", [SHARES, OTHER])
@pytest.mark.parametrize("name", SMALL)
def test_a_sound_copy_of_the_scheme_agrees(name, config) -> None:
    table = judged_copy(SMALL[name], config)
    assert set(table.verdict) == {AGREES}
    assert table.case.tolist() == list(SMALL[name].cases)


@pytest.mark.parametrize("name", SMALL)
def test_friction_that_is_a_thousandth_too_strong_is_found_at_equal_steps(name) -> None:
    table = judged_copy(SMALL[name], SHARES, stronger(1.001))
    assert set(table.verdict) == {"deviates"}


def test_friction_that_is_a_twentieth_too_strong_is_found_next_to_the_exact_motion() -> None:
    """Of a preset that states no accuracy, next to the error of the step alone."""
    table = judged_copy(chains.UNIT_CELL, Config("pybullet", preset_name="default"), stronger(1.05))
    found = table[(table.quantity == "transmittance") & (table.verdict == "deviates")]
    assert found.case.tolist() == list(chains.UNIT_CELL.cases)


def test_cells_in_the_wrong_order_deviate_on_the_graded_chain() -> None:
    def backwards(case: Case) -> Case:
        return replace(case, friction_ratio=case.friction_ratio[::-1])

    table = judged_copy(only(chains.GRADED_CHAIN, "η_r 0.6"), OTHER, backwards)
    assert quantities(table) >= {"transmittance", "missed", "spurious", "stuck fraction"}
