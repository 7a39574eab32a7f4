"""Steps of a linear scheme with friction that is wrong after it is solved, or a state that is wrong after the step."""

from dataclasses import dataclass
from typing import Any

import numba
import numpy as np

from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.trajectory import State
from reference_lcp.stepping.linear_implicit import LinearImplicitLane, LinearStep, ScalarFriction
from reference_lcp.stepping.linear_implicit_kernel import solve_contacts
from reference_lcp.validation import FloatArray

NOISE_BITS = 2.0**38
"""Over the displacement scale: what is left of a position below its 38th bit is as good as random."""


@dataclass(frozen=True, kw_only=True)
class StepErrors:
    """What is wrong with a step.

    Parameters
    ----------
    forward, backward
        Factors on the impulse of a contact that slides, where it is positive and where it is negative.
    quantum
        Positions are rounded to multiples of it, over the displacement scale; velocities alike; zero for no rounding.
    noise
        Largest error that is added to a position, over the displacement scale; decided by the state's last bits.
    single
        Whether the state is rounded to single precision.
    """

    forward: float = 1.0
    backward: float = 1.0
    quantum: float = 0.0
    noise: float = 0.0
    single: bool = False


class WrongLane(LinearImplicitLane):
    """One chain whose steps are wrong.

    Parameters
    ----------
    lane
        The lane.
    step
        The linear part of a step.
    errors
        What is wrong with it.
    """

    def __init__(self, lane: Lane, step: LinearStep, errors: StepErrors):
        super().__init__(lane, step, ScalarFriction.coulomb(lane.chain.cells))
        self._errors = errors

    def _integrate(self, state: State, start: int, steps: int, record: FloatArray) -> FloatArray:
        """Run the kernel; gives positions and velocities at the end, shape (2, 2n)."""
        lane, step, errors = self.lane, self._step, self._errors
        bounds = step.length * lane.chain.friction_coefficient * lane.preloads(start, steps)
        motion = np.vstack([state.positions[0], state.velocities[0]])
        scale = lane.drive.displacement_scale(lane.chain)
        _advance(
            motion,
            lane.loads(start, steps + 1),
            np.ascontiguousarray(bounds),
            (step.state, step.load, step.response, step.coupling),
            (step.length, step.end_weight),
            (errors.forward, errors.backward),
            (errors.quantum * scale, errors.quantum * scale * lane.chain.resonator_frequency, errors.noise * scale),
            (errors.single, NOISE_BITS / scale),
            record,
        )
        return motion


@numba.njit(cache=True, error_model="numpy")
def _advance(
    motion: Any, loads: Any, bounds: Any, matrices: Any, numbers: Any, slide: Any, sizes: Any, kinds: Any, record: Any
) -> None:
    """Advance one lane in place; `record` is (steps, 5n), or has no rows when nothing is kept."""
    state_matrix, load_matrix, response, coupling = matrices
    length, weight = numbers
    cells = coupling.shape[0]
    count = 2 * cells
    none = np.zeros(cells)
    impulses, state = np.zeros(cells), np.empty(2 * count)
    state[:count], state[count:] = motion[1], motion[0]
    before = np.empty(count)
    for step in range(bounds.shape[0]):
        free = state_matrix @ state + load_matrix[:, 0] * loads[step] + load_matrix[:, 1] * loads[step + 1]
        solve_contacts(free[count:], coupling, bounds[step], (none, none, none), impulses)
        for i in range(cells):
            if abs(impulses[i]) >= bounds[step, i]:
                impulses[i] *= slide[0] if impulses[i] > 0 else slide[1]
        before[:] = state[:count]
        state[:count] = free[:count] + response @ impulses
        state[count:] += length * (weight * state[:count] + (1 - weight) * before)
        _spoil(state, sizes, kinds)
        if record.shape[0] > 0:
            record[step, :count] = state[count:]
            record[step, count : 2 * count] = state[:count]
            record[step, 2 * count :] = impulses / length
    motion[0], motion[1] = state[count:], state[:count]


@numba.njit(cache=True, error_model="numpy")
def _spoil(state: Any, sizes: Any, kinds: Any) -> None:
    """Round a state in place, velocities first, and add noise to its positions."""
    quantum, quantum_of_velocity, noise = sizes
    single, bits = kinds
    count = state.size // 2
    for i in range(state.size):
        if i >= count and noise > 0:
            fine = state[i] * bits
            state[i] += noise * (2 * (fine - np.floor(fine)) - 1)
        step = quantum_of_velocity if i < count else quantum
        if step > 0:
            state[i] = step * np.rint(state[i] / step)
        if single:
            state[i] = np.float64(np.float32(state[i]))
