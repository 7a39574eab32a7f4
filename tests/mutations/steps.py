"""Mutants with another friction than Coulomb's, another order of the step, or another arithmetic than they claim."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numba
import numpy as np

from multibody_xval.engines.interface.presets import NormalForce
from multibody_xval.engines.interface.variant import Variant
from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.trajectory import State
from reference_lcp.schemes.linear_implicit import LinearImplicitLane, LinearStep, ScalarFriction
from reference_lcp.schemes.linear_implicit_kernel import solve_contacts
from reference_lcp.schemes.sequential import LaneModel, SequentialSimulation
from reference_lcp.validation import FloatArray
from tests.mutations.altered import Built
from tests.mutations.mutant import SCHEME, Mutant, Original

NOISE_BITS = 2.0**38
"""Over the displacement scale: what is left of a position below its 38th bit is as good as random."""


@dataclass(frozen=True, kw_only=True)
class StepErrors:
    """What is wrong with a step."""

    forward: float = 1.0
    backward: float = 1.0
    """Factors on the impulse of a contact that slides, where it is positive and where it is negative."""
    quantum: float = 0.0
    """Positions are rounded to multiples of it, over the displacement scale; velocities alike; zero for no rounding."""
    noise: float = 0.0
    """Largest error that is added to a position, over the displacement scale; decided by the state's last bits."""
    single: bool = False
    """Whether the state is rounded to single precision."""


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
    none = np.zeros((3, cells))
    impulses, state = np.zeros(cells), np.empty(2 * count)
    state[:count], state[count:] = motion[1], motion[0]
    before = np.empty(count)
    for step in range(bounds.shape[0]):
        free = state_matrix @ state + load_matrix[:, 0] * loads[step] + load_matrix[:, 1] * loads[step + 1]
        solve_contacts(free[count:], coupling, bounds[step], none, impulses)
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


SICONOS = Variant("siconos")


def _modelled(model: Callable[[Lane, float, float], LaneModel]) -> Built:
    """Build lanes one by one, by their lane, the original's θ (zero for equation (5)), and the size."""

    def build(original: Original, lanes: tuple[Lane, ...], size: float) -> SequentialSimulation:
        theta = 0.0 if original.law is None else original.law.constants["θ"].value
        return SequentialSimulation([model(lane, theta, size) for lane in lanes])

    return build


def _step(lane: Lane, theta: float) -> LinearStep:
    if theta:
        return LinearStep.theta(lane.chain, lane.time_step, theta)
    return LinearStep.explicit(lane.chain, lane.time_step)


def _with_errors(errors: Callable[[float], StepErrors]) -> Built:
    return _modelled(lambda lane, theta, size: WrongLane(lane, _step(lane, theta), errors(size)))


def _soft(lane: Lane, theta: float, size: float) -> LinearImplicitLane:
    """Give friction a softness, as a part of its own inverse mass."""
    step = _step(lane, theta)
    return LinearImplicitLane(lane, step, ScalarFriction.coulomb(lane.chain.cells, size * np.diag(step.coupling)))


def _zone(lane: Lane, theta: float, size: float) -> LinearImplicitLane:
    """Give friction a smooth zone, as a part of the speed s ω_r."""
    speed = size * lane.drive.displacement_scale(lane.chain) * lane.chain.resonator_frequency
    return LinearImplicitLane(lane, _step(lane, theta), ScalarFriction.smooth(lane.chain.cells, speed))


def _growing(lane: Lane, theta: float, size: float) -> LinearImplicitLane:
    """Let friction grow with the slip velocity beyond its bound, by a part of what stops a contact in a step."""
    step = _step(lane, theta)
    return LinearImplicitLane(lane, step, ScalarFriction.coulomb(lane.chain.cells, 0.0, size / np.diag(step.coupling)))


def _partly_implicit(lane: Lane, _: float, size: float) -> LinearImplicitLane:
    """Take a part of springs and dashpots at the end of the step."""
    chain, h = lane.chain, lane.time_step
    matrix = chain.mass_matrix + size * (h * chain.damping_matrix + h**2 * chain.stiffness_matrix)
    velocity = chain.mass_matrix - (1 - size) * h * chain.damping_matrix
    return _frictional(lane, LinearStep.of(chain, h, matrix, velocity, (1.0, 0.0)))


def _positions_first(lane: Lane, _: float, size: float) -> LinearImplicitLane:
    """Advance positions by a part of the velocity at the start of the step."""
    chain, h = lane.chain, lane.time_step
    velocity = chain.mass_matrix - h * chain.damping_matrix
    return _frictional(lane, LinearStep.of(chain, h, chain.mass_matrix, velocity, (1.0, 0.0), end_weight=1 - size))


def _against_the_ground(lane: Lane, _: float, size: float) -> LinearImplicitLane:
    """Slow every mass down, by a part of its momentum in 1 / ω_r."""
    chain, h = lane.chain, lane.time_step
    damping = chain.damping_matrix + size * chain.resonator_frequency * chain.mass_matrix
    return _frictional(lane, LinearStep.of(chain, h, chain.mass_matrix, chain.mass_matrix - h * damping, (1.0, 0.0)))


def _frictional(lane: Lane, step: LinearStep) -> LinearImplicitLane:
    return LinearImplicitLane(lane, step, ScalarFriction.coulomb(lane.chain.cells))


def _named(name: str, error: str, build: Built, *, of: Variant = SCHEME, size: float = 1.0) -> Mutant:
    return Mutant(name=name, error=error, build=build, of=of, size=size, normal_force=NormalForce.MODULATED)


_KINETIC = _with_errors(lambda size: StepErrors(forward=1 - size, backward=1 - size))

STEPS = (
    _named("kinetic", "friction × (1 − s) where a contact slides", _KINETIC),
    _named("one-sided", "friction × (1 + s) in slip one way", _with_errors(lambda s: StepErrors(forward=1 + s))),
    _named("softness", "friction softened by s", _modelled(_soft)),
    _named("zone", "friction with a zone of s U0 ω_r", _modelled(_zone)),
    _named("viscous", "friction that grows beyond its bound by s", _modelled(_growing)),
    _named("siconos-kinetic", "Siconos' friction × (1 − s) where a contact slides", _KINETIC, of=SICONOS),
    _named("siconos-softness", "Siconos' friction softened by s", _modelled(_soft), of=SICONOS),
    _named("siconos-zone", "Siconos' friction with a zone of s U0 ω_r", _modelled(_zone), of=SICONOS),
    _named("implicit", "springs and dashpots implicit by a part s", _modelled(_partly_implicit)),
    _named("positions-first", "positions advanced by old velocities by a part s", _modelled(_positions_first)),
    _named("ground-damping", "masses slowed against the ground at s ω_r", _modelled(_against_the_ground)),
    _named("rounding", "state rounded to multiples of s", _with_errors(lambda s: StepErrors(quantum=s)),
           size=0.1),
    _named("noise", "noise of s U0 on positions", _with_errors(lambda s: StepErrors(noise=s)),
           size=0.1),
    _named("single", "single precision that is called double",
           _with_errors(lambda s: StepErrors(single=bool(s)))),
)  # fmt: skip
