"""The exact motion of a chain and the steady state of a user's own simulation of it, for tests of a user's own."""

import inspect
import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import wraps
from types import TracebackType
from typing import Any, ParamSpec

import numpy as np
import pytest

from multibody_xval.scenarios.cases.chain_ratios import ChainRatios
from multibody_xval.scenarios.model import Case
from reference_lcp.chain.mass_in_mass import Chain
from reference_lcp.chain.simulation import Lane, OrbitStatus, PeriodicOrbit
from reference_lcp.chain.trajectory import State, Trajectory
from reference_lcp.defaults import MINIMUM_STEPS_PER_PERIOD
from reference_lcp.errors import ParameterError, shown
from reference_lcp.observables.transmittance import complex_transmittance
from reference_lcp.one_call import exact_steady_state
from reference_lcp.schemes.sequential import LaneModel, SequentialSimulation
from reference_lcp.steady.neighbours import beside_euler
from reference_lcp.validation import FloatArray, checked_count, checked_scalar

__tracebackhide__ = True
"""Of pytest: failures show the lines of a user's test and simulation, and not those of this module."""

RESIDUAL = 1e-6
"""By how much a period may differ from the one before, over the amplitude of the base: 1e-5 dB of it."""

MOST_PERIODS = 100
"""Periods of a search."""

P = ParamSpec("P")

Step = Callable[[FloatArray, FloatArray, float], tuple[Any, Any]]
"""Takes positions [m] and velocities [m/s], outer masses first, and the force on the first mass [N], at the start of a
step; gives positions and velocities at its end."""


@dataclass(frozen=True)
class PeriodicMotion:
    """One period of a steady state, and the chain that it is of."""

    case: Case
    transmittance_db: float
    """20 log10 of the amplitude of the last outer mass over that of the base [dB]."""
    phase_deg: float
    """By which the last outer mass is ahead of the base [°]."""
    positions: FloatArray
    """At the ends of steps [m], outer masses first, shape (steps, 2n)."""

    @property
    def chain(self) -> Chain:
        """Give masses [kg], springs [N/m], dashpots [N s/m] and bounds of friction [N], an entry a cell."""
        return self.case.setting[0]

    @property
    def steps(self) -> int:
        """Give the steps of the period."""
        return len(self.positions)

    @property
    def time_step(self) -> float:
        """Give the time of a step [s]."""
        return self.case.setting[1].period / self.steps


def with_short_errors(function: Callable[P, PeriodicMotion]) -> Callable[P, PeriodicMotion]:
    """Let errors show no line of the suite, but those of a user's own function, if it has begun."""

    @wraps(function)
    def called(*args: P.args, **named: P.kwargs) -> PeriodicMotion:
        try:
            return function(*args, **named)
        except Exception as problem:
            trace = problem.__traceback__
            parts: list[TracebackType] = []
            while trace is not None:
                parts.append(trace)
                trace = trace.tb_next
            own = max(n for n, part in enumerate(parts) if part.tb_frame.f_code.co_filename == __file__)
            begun = parts[own].tb_frame.f_code.co_name == _Stepped.run.__name__
            raise problem.with_traceback(parts[own].tb_next if begun else None) from None

    return called


@with_short_errors
def exact_motion(
    friction_ratio: float = 0.3,
    frequency_ratio: float = 0.9,
    cells: int = 1,
    steps: int = MINIMUM_STEPS_PER_PERIOD,
    **ratios: Any,
) -> PeriodicMotion:
    """Find the steady state of a chain on a moving base without an error of a time step.

    Parameters
    ----------
    friction_ratio, frequency_ratio, cells
        Of the chain; `ratios` are its other parameters, as in a sweep file, such as ``mass_ratio=2``.
    steps
        Rows of the motion, and steps per period of the simulation that it is compared with.

    Raises
    ------
    ParameterError
        If a number is outside its range.
    """
    for name in ratios:
        if name not in ChainRatios.__dataclass_fields__:
            allowed = ", ".join(["frequency_ratio", "steps", *ChainRatios.__dataclass_fields__])
            raise ParameterError(f"exact_motion has no argument {name!r}; allowed: {allowed}")
    case = Case(friction_ratio=friction_ratio, frequency_ratio=frequency_ratio, cells=cells, **ratios)
    state = exact_steady_state(*case.setting, steps_per_period=case.steps(checked_count("steps", steps)))
    return PeriodicMotion(case, state.transmittance_db, math.degrees(state.phase), state.orbit.trajectory.positions)


@with_short_errors
def steady_state_of(simulation: Step | FloatArray, exact: PeriodicMotion, residual: float = RESIDUAL) -> PeriodicMotion:
    """Find the steady state of a user's own simulation of a chain; the test fails where there is none.

    Parameters
    ----------
    simulation
        A function that advances the chain by a step of ``exact.time_step``, see `Step`; or positions [m] at the ends of
        steps, of two periods or more, shape (rows, 2n), of which the last period is taken.
    exact
        The exact motion of the same chain.
    residual
        By how much a period may differ from the one before, over the amplitude of the base.
    """
    checked_scalar("residual", residual, "> 0")
    orbit = _searched(simulation, exact, residual) if callable(simulation) else _given(simulation, exact, residual)
    ratio = complex_transmittance(orbit)
    level = 20 * math.log10(abs(ratio)) if ratio else -math.inf
    return PeriodicMotion(exact.case, level, math.degrees(np.angle(ratio)), orbit.trajectory.positions)


def _check_takes_three(step: Step) -> None:
    """Refuse a function that cannot be called with what a step is given."""
    try:
        signature = inspect.signature(step)
    except ValueError:  # some functions in C have none
        return
    try:
        signature.bind(None, None, None)
    except TypeError:
        raise ParameterError(
            f"simulation takes {len(signature.parameters)} arguments, {signature}; it is called with 3: positions, "
            "velocities, force"
        ) from None


def _searched(step: Step, exact: PeriodicMotion, residual: float) -> PeriodicOrbit:
    """Search from the steady state of Euler's scheme."""
    _check_takes_three(step)
    model = _Stepped(exact.case.lane(exact.steps), step)
    (orbit,) = beside_euler(SequentialSimulation([model]), exact.steps, tolerance=residual, max_periods=MOST_PERIODS)
    if not orbit.converged:
        pytest.fail(
            f"no periodic steady state after {orbit.periods} periods: they differ by {orbit.residual:.2g} of the "
            f"base's amplitude; allowed: {residual:g}",
            pytrace=False,
        )
    return orbit


def _given(positions: FloatArray, exact: PeriodicMotion, residual: float) -> PeriodicOrbit:
    """Take the last of the periods that are given."""
    rows, steps = np.asarray(positions, dtype=float), exact.steps
    width = 2 * exact.case.cells
    if rows.ndim != 2 or rows.shape[1] != width or len(rows) < 2 * steps:
        raise ParameterError(f"positions have the shape {rows.shape}; allowed: ({2 * steps} or more, {width})")
    lane = exact.case.lane(steps)
    last, before = rows[-steps:], rows[-2 * steps : -steps]
    off = float(np.max(np.abs(last - before))) / lane.drive.displacement_scale(lane.chain)
    if not off <= residual:
        pytest.fail(
            f"the last two periods differ by {off:.2g} of the base's amplitude; allowed: {residual:g}", pytrace=False
        )
    still = np.zeros((steps, exact.case.cells))
    run = Trajectory(lane.times(0, steps), last, np.zeros_like(last), still, still)
    return PeriodicOrbit(lane, run, off, len(rows) // steps, OrbitStatus.CONVERGED)


class _Stepped(LaneModel):
    """A chain that a user's function advances."""

    def __init__(self, lane: Lane, step: Step):
        self.lane, self._step = lane, step

    def run(self, state: State, start: int, steps: int) -> Trajectory:
        """Advance step by step."""
        rows, x, v = [], state.positions[0].copy(), state.velocities[0].copy()
        for load in self.lane.loads(start, steps).tolist():
            x, v = _checked(self._step(x.copy(), v.copy(), load), x.shape)
            rows.append((x, v))
        positions, velocities = (np.array(own) for own in zip(*rows, strict=True))
        still = np.zeros((steps, self.lane.chain.cells))
        return Trajectory(self.lane.times(start, steps), positions, velocities, still, still)


def _checked(given: Any, shape: tuple[int, ...]) -> tuple[FloatArray, FloatArray]:
    """Give what a user's step has returned, if it is positions and velocities, each a finite number a mass."""
    if not isinstance(given, tuple | list | np.ndarray) or len(given) != 2:
        raise ParameterError(f"the step gives {shown(given)}; allowed: positions, velocities")
    position, velocity = (np.array(own, dtype=float) for own in given)
    for own in (position, velocity):
        if own.shape != shape or not np.isfinite(own).all():
            raise ParameterError(f"the step gives {shown(own.tolist())}; allowed: {shape[0]} finite numbers")
    return position, velocity
