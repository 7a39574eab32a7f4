"""A slip that is shorter than what a period repeats to counts as a stick: what single precision cannot tell."""

import dataclasses

import pytest

from multibody_xval.scenarios.catalogue.all_scenarios import SCENARIOS
from multibody_xval.scenarios.compute.steady import MOST_PERIODS
from multibody_xval.scenarios.model import REFERENCE, Case, Config
from reference_lcp.chain.simulation import PeriodicOrbit
from reference_lcp.observables.stick_slip import stuck_fraction
from reference_lcp.steady.neighbours import beside_euler
from tests.installed import each_engine

CASE, STEPS = SCENARIOS["graded-chain"].cases["η_r 0.6"], 400


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
