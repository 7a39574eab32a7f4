"""Mutants that move as they should, and record or keep something else."""

from dataclasses import replace

import numpy as np

from engines.interface.variant import Variant
from engines.mutants.altered import AlteredSimulation, of_records
from engines.mutants.drives import WHOLE
from engines.mutants.mutant import Mutant, Original
from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.trajectory import State, Trajectory

SIGN = (2.0, 1.0, 0.1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7)
"""From the opposite sign."""


def _friction(run: Trajectory, size: float) -> Trajectory:
    return replace(run, friction=(1 - size) * run.friction)


def _late_friction(run: Trajectory, size: float) -> Trajectory:
    late = np.vstack([run.friction[:1], run.friction[:-1]])
    return replace(run, friction=run.friction + size * (late - run.friction))


def _velocities(run: Trajectory, size: float) -> Trajectory:
    return replace(run, velocities=(1 + size) * run.velocities)


def _normal_force(run: Trajectory, size: float) -> Trajectory:
    return replace(run, normal_force=(1 + size) * run.normal_force)


def _last_position(run: Trajectory, size: float) -> Trajectory:
    cell = np.arange(run.positions.shape[1]) == run.cells - 1
    return replace(run, positions=run.positions * np.where(cell, 1 + size, 1.0))


def _without_internal_state(original: Original, lanes: tuple[Lane, ...], size: float) -> AlteredSimulation:
    """Begin every run from a fresh friction: bristles undeformed, contacts closed."""

    def forgotten(state: State) -> State:
        return State(state.positions, state.velocities) if size else state

    return AlteredSimulation(original.build(lanes), lanes, state=forgotten)


RECORDS = (
    Mutant(name="recorded-friction", error="recorded friction × (1 − s)", build=of_records(_friction), sizes=SIGN),
    Mutant(
        name="recorded-friction-late",
        error="recorded friction, s of the way to that of the step before",
        build=of_records(_late_friction),
    ),
    Mutant(name="recorded-velocity", error="recorded velocities × (1 + s)", build=of_records(_velocities)),
    Mutant(name="recorded-position", error="recorded position of the last cell × (1 + s)",
           build=of_records(_last_position)),
    Mutant(name="recorded-normal-force", error="recorded normal force × (1 + s)", build=of_records(_normal_force)),
    Mutant(name="gaps-forgotten", error="contacts that are closed at the start of every run",
           build=_without_internal_state, sizes=WHOLE),
    Mutant(name="bristles-forgotten", error="bristles that are undeformed at the start of every run",
           build=_without_internal_state, sizes=WHOLE, of=Variant("exudyn-bristle")),
)  # fmt: skip
