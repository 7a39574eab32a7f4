"""Steady states of a chain under a periodic drive, and its motion from an initial state, in one call each."""

import cmath
import dataclasses
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import overload

import numpy as np

from reference_lcp.chain.drives import Drive, PeriodicDrive
from reference_lcp.chain.linear_response import frictionless_response
from reference_lcp.chain.mass_in_mass import Chain
from reference_lcp.chain.simulation import Lane, OrbitStatus, PeriodicOrbit, Simulation, steps_per_period_for
from reference_lcp.chain.trajectory import State, Trajectory
from reference_lcp.defaults import DEFAULT_PERIODS, DEFAULT_RESIDUAL, EXACT_RESIDUAL, MINIMUM_STEPS_PER_PERIOD
from reference_lcp.errors import ParameterError, checked_choice, shown
from reference_lcp.exact.event_driven import EventDrivenSimulation
from reference_lcp.exact.exact_orbit import exact_orbit
from reference_lcp.lcp.systems import MassSpringSystem
from reference_lcp.observables.stick_slip import (
    STICK_MARGIN,
    Transition,
    contact_modes,
    transitions_between,
    travels_between,
)
from reference_lcp.observables.transmittance import complex_transmittance, decibel
from reference_lcp.schemes.euler import CompiledSimulation, LemkeSimulation
from reference_lcp.steady.error_bar import ErrorBar, measured_error_bar
from reference_lcp.steady.orbits import periodic_orbits
from reference_lcp.system_state import SystemSteadyState, system_steady_state
from reference_lcp.validation import FloatArray, check_record_size, checked_array, checked_count, checked_scalar

SOLVERS: Mapping[str, Callable[[list[Lane]], Simulation]] = MappingProxyType(
    {"compiled": CompiledSimulation, "lemke": LemkeSimulation, "exact": EventDrivenSimulation}
)
"""Solvers by name: the Euler scheme as compiled closed form and by Lemke's method, and the exact motion."""

LONGEST_CHAINS = {"the solver 'lemke'": 100, "the solver 'exact'": 500, "an error bar": 1000}
"""Most cells, where that is less than of any chain: a period of Lemke's method takes 12 s there, a search for the exact
motion minutes, both grow at least with the square of the cells; error bars have matrices of four rows a cell."""

WHOLE_PERIOD = 1 - 1e-9
"""Stuck fraction from which on a contact sticks all the time: sums of durations have an error of round-off."""


@dataclass(frozen=True, repr=False)
class SteadyState:
    """A steady state and what is read from it; printed as one line."""

    orbit: PeriodicOrbit
    """One period and its residual."""
    transmittance_db: float
    """20 log10 of the last outer mass's fundamental amplitude over the displacement scale."""
    phase: float
    """By which that fundamental is ahead of the drive's sine [rad], in (−π, π]."""
    stuck_fraction: FloatArray
    """Part of the period that each contact sticks, shape (n,)."""
    transitions: list[Transition]
    """Changes between stick and slip over the period."""
    travels: FloatArray
    """Distance [m] that a contact slips in the phase that each transition begins; zero where it sticks."""
    error_bar: ErrorBar | None = None
    """Error of the step, of the residual and of round-off; ``None`` if it was not requested, or there is none."""

    @classmethod
    def of(cls, orbit: PeriodicOrbit, stick_margin: float = STICK_MARGIN) -> "SteadyState":
        """Read the observables of an orbit; for `stick_margin` see `contact_modes`."""
        modes, ratio = contact_modes(orbit, stick_margin), complex_transmittance(orbit)
        reading = np.mean(modes == 0, axis=0), transitions_between(modes, orbit), travels_between(modes, orbit)
        return cls(orbit, decibel(abs(ratio)), cmath.phase(ratio), *reading)

    def __repr__(self) -> str:
        """Say in one line what the last mass does, with its error bar, and which contacts stick."""
        status = "" if self.orbit.converged else f"not certified ({self.orbit.status}): "
        numbers = f"{status}{self._level} dB, phase {self.phase:.3f} rad, {self.orbit.periods} periods"
        whole = np.count_nonzero(self.stuck_fraction >= WHOLE_PERIOD)
        some = np.count_nonzero(self.stuck_fraction) - whole
        sticking = f"of {self.stuck_fraction.size} contacts {whole} stick, {some} stick and slip"
        return f"<SteadyState {numbers}; {sticking}>".replace("-", "−")

    @property
    def _level(self) -> str:
        """The transmittance to the first digit of its error bar, which is rounded up."""
        bar = self.error_bar
        if bar is not None and not bar.resolved:
            return f"below {bar.floor_db:.0f}"
        if bar is None or not 0 < bar.transmittance_db < math.inf:
            return f"{self.transmittance_db:.4g}"
        digits = max(0, -math.floor(math.log10(bar.transmittance_db)))
        error = math.ceil(bar.transmittance_db * 10**digits) / 10**digits
        return f"{self.transmittance_db:.{digits}f} ± {error:.{digits}f}"


@overload
def steady_state(
    chain: Chain, drive: PeriodicDrive, *, steps_per_period: int = ..., solver: str | None = ...,
    tolerance: float | None = ..., max_periods: int = ..., with_error_bar: bool = ...,
) -> SteadyState: ...  # fmt: skip


@overload
def steady_state(
    chain: MassSpringSystem, drive: float | None = None, *, steps_per_period: int = ..., solver: str | None = ...,
    tolerance: float | None = ..., max_periods: int = ..., with_error_bar: bool = ...,
) -> SystemSteadyState: ...  # fmt: skip


def steady_state(
    chain: Chain | MassSpringSystem,
    drive: PeriodicDrive | float | None = None,
    *,
    steps_per_period: int = MINIMUM_STEPS_PER_PERIOD,
    solver: str | None = None,
    tolerance: float | None = None,
    max_periods: int = DEFAULT_PERIODS,
    with_error_bar: bool = True,
) -> SteadyState | SystemSteadyState:
    """Find the steady state of a chain under a drive, or of a system, whose forces and motions repeat.

    Parameters
    ----------
    chain, drive
        What moves, and what moves it; of a `MassSpringSystem` in place of the drive the time [s] after which all of it
        repeats, which need not be given if that is the longest of its periods.
    steps_per_period
        Fewest steps a period, >= 16; more are taken where dt ω_max <= 0.4 requires them.
    solver
        ``"compiled"``, the Euler scheme, the default for a chain; ``"lemke"``, the same by Lemke's method, for a chain
        only; or ``"exact"``, the motion from event to event, the default for a system.
    tolerance
        Periodicity residual to reach; `DEFAULT_RESIDUAL`, or `EXACT_RESIDUAL` for the exact
        solver, unless given.
    max_periods
        Periods after which the search gives up.
    with_error_bar
        Measure the error too, by two finer steps (some four times the work); the exact solver has none.

    Raises
    ------
    ParameterError
        If an argument is outside its range; of a system, if a body floats, nothing repeats, or motions grow for ever.
    """
    if isinstance(chain, MassSpringSystem):
        if not isinstance(drive, int | float | None):
            raise ParameterError(f"drive = {shown(drive)} of a system; allowed: a period [s] or None")
        return system_steady_state(
            chain, drive, steps_per_period=steps_per_period, solver=solver or "exact", tolerance=tolerance,
            max_periods=max_periods, with_error_bar=with_error_bar,
        )  # fmt: skip
    if not isinstance(drive, PeriodicDrive):
        raise ParameterError(f"drive = {shown(drive)} does not repeat; allowed: HarmonicBase, HarmonicForce")
    solver = solver or "compiled"
    build = _solver(solver, chain)
    if with_error_bar and solver != "exact":
        _check_length("an error bar", chain)
    steps = steps_per_period_for(chain, drive, steps_per_period)
    if solver == "exact":
        residual = EXACT_RESIDUAL if tolerance is None else tolerance
        return exact_steady_state(
            chain, drive, steps_per_period=steps_per_period, tolerance=residual, max_periods=max_periods
        )
    residual = DEFAULT_RESIDUAL if tolerance is None else tolerance
    simulation = build([Lane.periodic(chain, drive, steps)])
    state = SteadyState.of(periodic_orbits(simulation, steps, tolerance=residual, max_periods=max_periods)[0])
    if with_error_bar:
        bar = measured_error_bar(state.orbit, tolerance=residual, max_periods=max_periods)
        state = dataclasses.replace(state, error_bar=bar)
    return state


def _solver(name: str, chain: Chain) -> Callable[[list[Lane]], Simulation]:
    """Give what builds a simulation by the solver of a name, if it takes a chain of that length."""
    build = SOLVERS[checked_choice("solver", name, list(SOLVERS))]
    _check_length(f"the solver {name!r}", chain)
    return build


def _check_length(name: str, chain: Chain) -> None:
    """Refuse a chain with friction that is too long for something; without friction all are as fast as they can be."""
    longest = LONGEST_CHAINS.get(name, chain.cells)
    if chain.cells > longest and chain.friction_bound.any():
        raise ParameterError(f"cells = {chain.cells} is more than {name} takes; allowed: <= {longest}, or without it")


def exact_steady_state(
    chain: Chain,
    drive: PeriodicDrive,
    *,
    steps_per_period: int = MINIMUM_STEPS_PER_PERIOD,
    tolerance: float = EXACT_RESIDUAL,
    max_periods: int = DEFAULT_PERIODS,
) -> SteadyState:
    """Find the steady state of `chain` under `drive` by event-driven integration, without friction in closed form.

    Transmittance, stuck fractions and times of transitions carry no error of a time step or of
    sampling: what is left is round-off and the periodicity residual.

    Parameters
    ----------
    chain, drive
        What moves, and what moves it.
    steps_per_period
        Rows of the orbit's trajectory; nothing else depends on it.
    tolerance
        Periodicity residual to reach.
    max_periods
        Periods after which the search gives up.

    Raises
    ------
    ParameterError
        If an argument is outside its range, or the drive is not harmonic.
    """
    checked_scalar("tolerance", tolerance, "> 0")
    checked_count("max_periods", max_periods)
    _solver("exact", chain)
    lane = Lane.periodic(chain, drive, steps_per_period)
    if isinstance(drive, PeriodicDrive) and chain.damped and not chain.friction_bound.any():
        return _frictionless(lane, drive)
    orbit, period = exact_orbit(
        chain, drive, steps_per_period=steps_per_period, tolerance=tolerance, max_periods=max_periods
    )
    ratio = period.complex_transmittance
    modes, travels = (period.stuck_fraction, period.transitions), np.array(period.travels)
    return SteadyState(orbit, decibel(abs(ratio)), cmath.phase(ratio), *modes, travels)


def _frictionless(lane: Lane, drive: PeriodicDrive) -> SteadyState:
    """Sample the harmonic response of a chain without friction; its residual is round-off."""
    chain, times = lane.chain, lane.times(0, round(drive.period / lane.time_step))
    amplitudes, scale = frictionless_response(chain, drive), drive.displacement_scale(chain)
    motion = amplitudes * np.exp(1j * drive.angular_frequency * times)[:, None]
    forces = np.zeros((times.size, chain.cells)), lane.preloads(0, times.size)
    trajectory = Trajectory(times, motion.imag, (1j * drive.angular_frequency * motion).imag, *forces)
    ratio, residual = amplitudes[chain.cells - 1] / scale, float(np.max(np.abs(motion[-1] - amplitudes))) / scale
    orbit = PeriodicOrbit(lane, trajectory, residual, 1, OrbitStatus.CONVERGED)
    return SteadyState(orbit, decibel(abs(ratio)), cmath.phase(ratio), np.zeros(chain.cells), [], np.empty(0))


def simulate(
    chain: Chain,
    drive: Drive,
    *,
    time_step: float,
    steps: int,
    positions: FloatArray | None = None,
    velocities: FloatArray | None = None,
    solver: str = "compiled",
) -> Trajectory:
    """Advance one chain from an initial state, by the Euler scheme of equation (5) unless the solver is exact.

    Parameters
    ----------
    chain, drive
        What moves, and what moves it.
    time_step
        Δt [s].
    steps
        Number of steps.
    positions, velocities
        Initial state [m], [m/s], shape (2n,), outer masses first; at rest without them.
    solver
        ``"compiled"``, ``"lemke"`` or ``"exact"``.

    Raises
    ------
    ParameterError
        If an argument is outside its range.
    """
    build = _solver(solver, chain)
    check_record_size(chain.cells, checked_count("steps", steps))
    rest, given = np.zeros(2 * chain.cells), {"positions": positions, "velocities": velocities}
    start = [checked_array(f"initial {name}", rest if values is None else values) for name, values in given.items()]
    for name, array in zip(given, start, strict=True):
        if array.shape != rest.shape:
            raise ParameterError(f"initial {name} have shape {array.shape}; allowed: {rest.shape}")
    simulation = build([Lane(chain, drive, time_step)])
    motion = simulation.run(State(start[0][None, :], start[1][None, :]), 0, steps)[0]
    return dataclasses.replace(motion, friction_coefficient=chain.friction_coefficient)
