"""The one way to a steady state: from that of Euler's scheme, by accelerated periods, certified by a plain one."""

import cmath
from collections.abc import Sequence

import numpy as np

from multibody_xval.engines.interface.engine import SteadyStateSolver
from multibody_xval.scenarios.compute.checked import CheckedSimulation, check_trajectory
from multibody_xval.scenarios.compute.groups import by_groups
from multibody_xval.scenarios.model import REFERENCE, Case, Config, Result, Run, Status, failed
from reference_lcp.chain.simulation import Lane, OrbitStatus, PeriodicOrbit
from reference_lcp.defaults import DEFAULT_PERIODS
from reference_lcp.observables.stick_slip import (
    creep_velocity,
    largest_gap,
    open_fraction,
)
from reference_lcp.observables.transmittance import complex_transmittance
from reference_lcp.one_call import SteadyState
from reference_lcp.steady.neighbours import beside_euler, residual_amplification
from reference_lcp.steady.orbits import periodic_orbits

MOST_PERIODS = 60
"""Periods of a search: engines that settle on the paper's chain take 2 to 55, and those that have not settled by then
have not after 100 either."""

LIGHT_DAMPING = 0.005
"""Damping ratio below which motions ring longer than `MOST_PERIODS`, and searches may take `DEFAULT_PERIODS`."""

LONG_CHAIN = 10
"""Cells above which they may take as long."""


def steady_states(runs: Sequence[Run]) -> list[Result]:
    """Find the steady states of runs that share configuration, steps and number of cells.

    Those whose normal force swings are searched apart: where contacts move across, that is part of every lane's state.
    """
    return by_groups(runs, lambda run: run.of(Case).modulation > 0, _together)


def _together(runs: Sequence[Run]) -> list[Result]:
    config, steps = runs[0].config, runs[0].steps
    cases = [run.of(Case) for run in runs]
    limit = most_periods(config, cases)
    return [_read(config, *found) for found in _found(config, [case.lane(steps) for case in cases], steps, limit)]


def _found(
    config: Config, lanes: Sequence[Lane], steps: int, limit: int
) -> list[tuple[PeriodicOrbit, SteadyState | None]]:
    """Search the periodic orbit of every lane; of the exact motion also what its events say between the steps."""
    simulation, tolerance = config.build(lanes), config.capabilities.residual
    try:
        if isinstance(simulation, SteadyStateSolver):
            states = simulation.steady_states(steps)
            for lane, state in zip(lanes, states, strict=True):
                check_trajectory(state.orbit.trajectory, lane, 0, steps)
            return [(state.orbit, state) for state in states]
        if config.engine == REFERENCE.engine:
            orbits = periodic_orbits(simulation, steps, tolerance=tolerance)
        else:
            orbits = beside_euler(CheckedSimulation(simulation), steps, tolerance=tolerance, max_periods=limit)
        return [(orbit, None) for orbit in orbits]
    finally:
        simulation.close()


def most_periods(config: Config, cases: Sequence[Case]) -> int:
    """Give the limit on periods: long chains, light damping and single precision take longer."""
    slow = any(case.cells > LONG_CHAIN or np.min(case.damping_ratio) < LIGHT_DAMPING for case in cases)
    return DEFAULT_PERIODS if slow or config.capabilities.precision != "double" else MOST_PERIODS


def _read(config: Config, orbit: PeriodicOrbit, known: SteadyState | None) -> Result:
    """Read the numbers of a period, by its steps where nothing more is known; one that has diverged has none."""
    if orbit.status is OrbitStatus.DIVERGED or not np.isfinite(orbit.residual):
        return failed(f"the motion diverges, or is not finite, in period {orbit.periods} of the search")
    margin, lane = config.preset.stick_margin, orbit.lane
    scale = lane.drive.displacement_scale(lane.chain)
    period = lane.time_step * orbit.trajectory.steps
    swings = lane.preload is not None
    state = known or SteadyState.of(orbit, margin)
    return Result(
        status=Status.PERIODIC if orbit.converged else Status.NOT_PERIODIC,
        transmittance=complex_transmittance(orbit) if known is None else _ratio(known),
        residual=orbit.residual,
        amplification=residual_amplification(orbit) if config == REFERENCE else float("nan"),
        periods=orbit.periods,
        multiple=orbit.multiple,
        stuck=tuple(state.stuck_fraction.tolist()),
        transitions=tuple((own.cell, own.time / period, str(own.kind)) for own in state.transitions),
        stick_velocity=float(np.max(creep_velocity(orbit, margin)) * period / (2 * np.pi * scale)),
        open_fraction=tuple(open_fraction(orbit).tolist()) if swings else (),
        largest_gap=tuple((largest_gap(orbit) / scale).tolist()) if swings else (),
        series={"travels": tuple((state.travels / scale).tolist())},
        reason=orbit.reason,
    )


def _ratio(state: SteadyState) -> complex:
    """Give T, of the exact motion from its events and not from its steps."""
    return cmath.rect(10 ** (state.transmittance_db / 20), state.phase)
