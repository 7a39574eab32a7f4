"""Chains under a harmonic drive: what is right agrees, and each kind of mistake is found by the scenario for it."""

from dataclasses import replace

import numpy as np
import pytest

from multibody_xval.engines.shared.wide_range import DESIGN
from multibody_xval.scenarios.catalogue.all_scenarios import SCENARIOS
from multibody_xval.scenarios.catalogue.chains import steady_states as chains
from multibody_xval.scenarios.model import EXACT, REFERENCE, Case, Config
from multibody_xval.scenarios.ruler.judge import AGREES
from reference_lcp.defaults import CHAIN_STIFFNESS
from tests.scenarios.catalogue.steady_runs import OTHER, SHARES, deviating, judged_copy, only

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
    assert deviating(table) >= {"transmittance", "missed", "spurious", "stuck fraction"}


def test_numbers_of_the_disordered_chain_are_said_cell_by_cell() -> None:
    scenario = SCENARIOS["disordered-chain"]
    assert f"seed {chains.DISORDER_SEED}" in scenario.source
    lines = dict(line.split(" = ") for line in scenario.details)
    for case in scenario.cases.values():
        chain = case.chain
        built = {
            "mass_ratio": chain.inner_mass / chain.outer_mass,
            "outer_mass_ratio": chain.outer_mass,
            "chain_stiffness_ratio": chain.chain_stiffness / CHAIN_STIFFNESS,
        }
        for name, values in built.items():
            assert values.tolist() == pytest.approx([float(value) for value in lines[name].strip("[]").split()])
        assert np.unique(chain.friction_bound).size == chain.cells
    assert set(lines) == {*built, "stiffness_ratio", "damping_ratio", "friction_ratio"}


def test_exact_motions_are_run_of_short_chains_that_are_not_proven() -> None:
    long = [run for run in chains.LONG_CHAIN.runs([OTHER]) if run.config == EXACT]
    assert long == []  # fifty cells are proven too
    exact = {run.case for run in chains.UNIT_CELL.runs([OTHER]) if run.config == EXACT}
    assert exact == set(chains.UNIT_CELL.cases.values())  # of their transitions


def test_points_of_the_design_have_their_own_steps() -> None:
    runs = chains.WIDE_RANGE.own_runs(REFERENCE).values()
    assert [run.steps for run in runs] == [point.steps for point in DESIGN]
    for run, point in zip(runs, DESIGN, strict=True):
        assert run.case.chain.friction_bound.tolist() == pytest.approx(point.chain.friction_bound.tolist())
        assert run.case.chain.inner_damping.tolist() == pytest.approx(point.chain.inner_damping.tolist())
