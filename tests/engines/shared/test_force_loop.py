"""Coordinates and forces that engines with forces of the adapter's share, and what they cost."""

import numpy as np
import pytest

from multibody_xval.engines.interface.presets import Option, Preset
from multibody_xval.engines.shared.coordinates import CarriedCoordinates, ChainCoordinates, JointCoordinates
from multibody_xval.engines.shared.force_loop import LARGEST_MOTION, ExplicitForcesLane, Step
from reference_lcp.chain.trajectory import State
from tests.engines.scheme_oracle import (
    AMPLITUDE,
    STEPS,
    assert_equals_scheme,
    lane_of,
    random_state,
    uneven_lane,
    unstable_lane,
)
from tests.installed import each_engine

NAMES = each_engine(["dart", "pymunk", "box2d", "pinocchio", "rapier", "sapien", "drake", "ode", "siconos"])

Coordinates = ChainCoordinates | CarriedCoordinates | JointCoordinates

CARRIED = CarriedCoordinates(np.array([True, False, False, True, True, False, True]))

every_coordinate = pytest.mark.parametrize("coordinates", [*ChainCoordinates, JointCoordinates(), CARRIED])


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


def in_units(name: str) -> Preset:
    return Preset("", {"units": Option(name, None, "")})


@every_coordinate
def test_coordinates_are_undone_for_one_row_and_for_many(coordinates: Coordinates) -> None:
    absolute = np.random.default_rng(1).normal(size=(5, 14))
    there = coordinates.of(absolute)
    assert np.array_equal(there[2], coordinates.of(absolute[2]))
    back = coordinates.absolute(there)
    assert np.array_equal(back[2], coordinates.absolute(there[2]))
    np.testing.assert_allclose(back, absolute, rtol=0, atol=1e-14)


@every_coordinate
def test_forces_do_the_same_work_in_every_coordinate(coordinates: Coordinates) -> None:
    """f · δq is a number that knows no coordinates."""
    chain = uneven_lane().chain
    rng = np.random.default_rng(2)
    position, velocity, shift = rng.normal(size=(3, 14))
    force = -chain.stiffness_matrix @ position - chain.damping_matrix @ velocity
    motion = np.concatenate([coordinates.of(position), coordinates.of(velocity)])
    forces = coordinates.force_matrix(chain) @ motion
    assert forces @ coordinates.of(shift) == pytest.approx(force @ shift, rel=1e-12)
    load = np.zeros(14)
    load[coordinates.loaded] = 1.0
    assert load @ coordinates.of(shift) == pytest.approx(shift[0], rel=1e-12)


def test_the_heavier_mass_of_a_cell_carries_the_other() -> None:
    chain = lane_of(mass_ratio=[0.5, 1.0, 2.0, 0.1, 3.0, 1.0, 10.0]).chain
    coordinates = CarriedCoordinates.of_chain(chain)
    carriers, carried = np.split(coordinates.exchanged(np.concatenate([chain.outer_mass, chain.inner_mass])), 2)
    assert np.all(carriers >= carried)
    assert coordinates.sign.tolist() == [1, 1, -1, 1, -1, 1, -1]


@pytest.mark.parametrize("units", ["SI", "lane"])
def test_the_loop_takes_the_steps_of_the_scheme(units: str) -> None:
    lane, state = uneven_lane(), random_state()
    model = ByHand(lane, in_units(units))
    assert_equals_scheme(lane, state, model.run(state, 0, STEPS))
    end = model.advance(state, 0, STEPS)
    assert np.array_equal(end.positions, model.run(state, 0, STEPS).positions[-1:])


def test_a_lane_that_diverges_stops_and_repeats_its_last_row() -> None:
    unstable = unstable_lane()
    model = ByHand(unstable, in_units("lane"))
    run = model.run(State.at_rest(1, 7), 0, 400)
    assert np.max(np.abs(run.positions[-1])) > LARGEST_MOTION * AMPLITUDE / 2
    assert np.all(np.isfinite(run.positions))
    assert np.array_equal(run.positions[-1], run.positions[100])
    assert run.friction.shape == (400, 7)
