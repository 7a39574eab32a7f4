"""A slip that is shorter than what a period repeats to counts as a stick: what single precision cannot tell."""

import dataclasses

import pytest

from multibody_xval.scenarios.catalogue.all_scenarios import SCENARIOS
from multibody_xval.scenarios.catalogue.stick_slip import as_resolved
from multibody_xval.scenarios.compute.steady import MOST_PERIODS
from multibody_xval.scenarios.model import REFERENCE, Case, Config, Result, Status
from reference_lcp.chain.simulation import PeriodicOrbit
from reference_lcp.observables.stick_slip import stuck_fraction
from reference_lcp.steady.neighbours import beside_euler
from tests.installed import each_engine
from tests.scenarios.in_this_process import judged

GRADED, STEPS = SCENARIOS["graded-chain"], 400
CASE = GRADED.cases["η_r 0.6"]


def orbit_of(config: Config) -> PeriodicOrbit:
    assert isinstance(CASE, Case)
    simulation = config.build([CASE.lane(STEPS)])
    try:
        tolerance = config.capabilities.residual
        return beside_euler(simulation, STEPS, tolerance=tolerance, max_periods=MOST_PERIODS)[0]
    finally:
        simulation.close()


@pytest.mark.parametrize("name", each_engine(["box2d3", "newton", "pybullet", "rapier", "sapien"]))
def test_single_precision_hides_a_slip_of_a_graded_chain_that_its_motion_has(name: str) -> None:
    """Cell 2 slips for three steps, by 4e-6 of the amplitude; a slip counts if it is longer than four residuals."""
    config, expected = Config.parse(name), stuck_fraction(orbit_of(REFERENCE))
    orbit = orbit_of(config)
    single = config.capabilities.precision == "single"
    assert stuck_fraction(orbit)[1] - expected[1] == pytest.approx(6 / STEPS if single else 0.0, abs=1e-12)
    exact = dataclasses.replace(orbit, residual=0.0)
    assert stuck_fraction(exact) == pytest.approx(expected, rel=0, abs=1e-12)


@pytest.mark.parametrize(("residual", "sticks", "changes"), [(1e-7, 0.5, 4), (1e-5, 0.6, 2), (0.1, 1.0, 0)])
def test_what_is_expected_of_an_engine_has_the_slips_that_its_residual_can_tell(residual, sticks, changes) -> None:
    """A slip by 1e-6 of the amplitude from 0.1 to 0.2 of the period, and one by 0.2."""
    transitions = ((1, 0.1, "forward slip"), (1, 0.2, "stick"), (1, 0.5, "backward slip"), (1, 0.9, "stick"))
    motion = Result(
        status=Status.PERIODIC, stuck=(0.5,), transitions=transitions, series={"travels": (1e-6, 0.0, 0.2, 0.0)}
    )
    read = as_resolved(motion, residual)
    assert read.stuck == pytest.approx([sticks])
    assert len(read.transitions) == changes


@pytest.mark.parametrize("name", each_engine(["box2d3", "newton", "rapier", "sapien"]))
def test_engines_of_single_precision_agree_on_a_graded_chain(name: str) -> None:
    """The reference's slip of three steps is read as their residuals let theirs be read."""
    assert set(judged(GRADED, Config(name)).verdict) == {"agrees"}
