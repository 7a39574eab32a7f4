"""Coordinates and forces that engines with forces of the adapter's share."""

import numpy as np
import pytest

from multibody_xval.engines.interface.presets import Option, Preset
from multibody_xval.engines.shared.coordinates import CarriedCoordinates, ChainCoordinates, JointCoordinates
from multibody_xval.engines.shared.force_loop import LARGEST_MOTION, ExplicitForcesLane, Step
from reference_lcp.chain.trajectory import State
from tests.engines.scheme_oracle import AMPLITUDE, ROUND_OFF, distance, random_state, scheme, uneven_lane, unstable_lane

CARRIED = CarriedCoordinates(np.array([True, False, False, True, True, False, True]))


class ByHand(ExplicitForcesLane):
    """The closed solution of a contact in the coordinates of a body each: what an engine is expected to do."""

    def _begin(self, motion: np.ndarray) -> Step:
        chain, dt = self._chain, self._time_step
        position, velocity = np.split(motion, 2)
        masses, directions = np.diag(chain.mass_matrix), chain.contact_directions
        self._friction = np.zeros(chain.cells)

        def step(force: np.ndarray) -> None:
            velocity[:] += dt * force / masses
            needed = -(directions.T @ velocity) / (dt * (1 / chain.outer_mass + 1 / chain.inner_mass))
            self._friction = np.clip(needed, -chain.friction_bound, chain.friction_bound)
            velocity[:] += dt * (directions @ self._friction) / masses
            position[:] += dt * velocity

        return step

    def _contacts(self) -> np.ndarray:
        return self._friction


@pytest.mark.parametrize("coordinates", [*ChainCoordinates, JointCoordinates(), CARRIED])
def test_forces_do_the_same_work_in_every_coordinate(coordinates) -> None:
    """f · δq is a number that knows no coordinates; and these are undone, for one row and for many."""
    chain, rng = uneven_lane().chain, np.random.default_rng(2)
    position, velocity, shift = absolute = rng.normal(size=(3, 14))
    force = -chain.stiffness_matrix @ position - chain.damping_matrix @ velocity
    motion = np.concatenate([coordinates.of(position), coordinates.of(velocity)])
    assert coordinates.force_matrix(chain) @ motion @ coordinates.of(shift) == pytest.approx(force @ shift, rel=1e-12)
    load = np.zeros(14)
    load[coordinates.loaded] = 1.0
    assert load @ coordinates.of(shift) == pytest.approx(shift[0], rel=1e-12)
    np.testing.assert_allclose(coordinates.absolute(coordinates.of(absolute)), absolute, rtol=0, atol=1e-14)


@pytest.mark.parametrize("units", ["SI", "lane"])
def test_the_loop_takes_the_steps_of_the_scheme(units: str) -> None:
    lane, state = uneven_lane(), random_state()
    run = ByHand(lane, Preset("", {"units": Option(units, None, "")})).run(state, 0, 400)
    assert distance(lane, state, run) < ROUND_OFF
    np.testing.assert_allclose(run.friction, scheme(lane, state, 400)[2], rtol=0, atol=1e-8)


def test_a_chain_that_diverges_stops_and_repeats_its_last_row() -> None:
    run = ByHand(unstable_lane(), Preset("", {"units": Option("lane", None, "")})).run(State.at_rest(1, 7), 0, 400)
    assert np.max(np.abs(run.positions[-1])) > LARGEST_MOTION * AMPLITUDE / 2
    assert np.array_equal(run.positions[-1], run.positions[100])
    assert np.all(np.isfinite(run.positions))
