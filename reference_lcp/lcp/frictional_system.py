"""Any frictional system, advanced step by step by equation (7) in full."""

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from reference_lcp.lcp.static_friction import solve_stick_slip_step
from reference_lcp.lcp.time_step import ContactImpulses, FrictionalStep, StepFailed, advanced
from reference_lcp.validation import FloatArray, checked_array, checked_count, checked_scalar


class FrictionalSystem(Protocol):
    """Anything with unilateral frictional contacts that gives the data of equation (7).

    M, h, the gaps and the directions may depend on time, position and velocity; all are taken at the
    start of the step. A gap is given as it is at that position, not as the step before predicted it:
    so a curved or moving surface leaves no drift. Normal forces are resolved, unless the step gives them.
    """

    @property
    def freedoms(self) -> int:
        """Number of freedoms f."""
        ...

    @property
    def contacts(self) -> int:
        """Number of contacts c."""
        ...

    def step(self, time: float, position: FloatArray, velocity: FloatArray, time_step: float) -> FrictionalStep:
        """Give the data of the step that starts at `time` [s] with `position` and `velocity`, shape (f,)."""
        ...


@dataclass(frozen=True)
class SystemTrajectory:
    """The motion of a frictional system over consecutive steps; row k belongs to the end of step k.

    Parameters
    ----------
    time
        Ends of the steps [s], shape (steps,).
    positions, velocities
        u and q, shape (steps, f).
    normal_force, friction
        λ_N >= 0 and λ_T [N] during the step that ends at each row, shape (steps, c).
    normal_gap, relative_velocity
        g_N [m] and ġ_T [m/s] at the end of the step as equation (6) gives them, shape (steps, c); g_N is NaN where
        the normal force is given.
    """

    time: FloatArray
    positions: FloatArray
    velocities: FloatArray
    normal_force: FloatArray
    friction: FloatArray
    normal_gap: FloatArray
    relative_velocity: FloatArray


def simulate_system(
    system: FrictionalSystem,
    *,
    position: ArrayLike,
    velocity: ArrayLike,
    time_step: float,
    steps: int,
    start: int = 0,
) -> SystemTrajectory:
    """Advance `system` by equations (5) and (7), Lemke's method in every step.

    Parameters
    ----------
    system
        What moves.
    position, velocity
        u and q at the start, shape (f,).
    time_step
        Δt [s], > 0.
    steps
        Number of steps, >= 1.
    start
        Index of the first step, >= 0: the motion starts at time ``start * time_step``.

    Raises
    ------
    StepFailed
        If the LCP of a step is not solved; the message names the step and its time.
    ParameterError
        If an argument is outside its range or does not fit the system.
    """
    dt = checked_scalar("time_step", time_step, "> 0")
    state, shape = {"position": position, "velocity": velocity}, (system.freedoms,)
    u, q = (checked_array(name, value, shape=shape).copy() for name, value in state.items())
    first = checked_count("start", start, 0)
    ends = np.arange(first + 1, first + checked_count("steps", steps) + 1, dtype=np.float64)
    record = _empty(dt * ends, system)
    basis = None
    for row in range(record.time.size):
        step = system.step(dt * (first + row), u, q, dt)
        impulses = _solved_step(step, basis, first + row)
        u, q = advanced(step, impulses, u)
        basis = impulses.basic
        _write(record, row, u, q, impulses, dt)
    return record


def _solved_step(step: FrictionalStep, basis: NDArray[np.bool_] | None, index: int) -> ContactImpulses:
    """Solve one step, and name it in the error where that fails."""
    try:
        return solve_stick_slip_step(step, warm_start=basis)
    except StepFailed as failure:
        raise StepFailed(f"step {index} at t = {index * step.time_step:.6g} s: {failure}") from failure


def _empty(time: FloatArray, system: FrictionalSystem) -> SystemTrajectory:
    motion, contact = (time.size, system.freedoms), (time.size, system.contacts)
    shapes = (motion, motion, contact, contact, contact, contact)
    return SystemTrajectory(time, *(np.empty(shape) for shape in shapes))


def _write(
    record: SystemTrajectory, row: int, u: FloatArray, q: FloatArray, impulses: ContactImpulses, time_step: float
) -> None:
    record.positions[row], record.velocities[row] = u, q
    record.normal_force[row] = impulses.normal / time_step
    record.friction[row] = impulses.tangential / time_step
    record.normal_gap[row] = np.nan if impulses.normal_gap is None else impulses.normal_gap
    record.relative_velocity[row] = impulses.relative_velocity
