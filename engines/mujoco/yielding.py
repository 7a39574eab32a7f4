"""MuJoCo's springs that yield: in every cell one beside the inner spring, a Jenkins element with a memory."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from engines.interface.law import Constant, Law
from engines.interface.presets import Preset
from engines.mujoco.joint import CompiledLane, add_chain, add_masses, new_spec, set_spring
from engines.mujoco.simulation import MuJoCoSimulation
from engines.shared.kernel_lane import Kernel, KernelLane, keep
from engines.shared.units import Units
from reference_lcp.chain.mass_in_mass import Chain
from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.trajectory import State
from reference_lcp.errors import ParameterError
from reference_lcp.schemes.linear_implicit import LinearStep
from reference_lcp.validation import FloatArray


def yield_stiffness(chain: Chain, time_step: float, phase: float) -> FloatArray:
    """Give k_s [N/m], shape (n,): a stuck contact oscillates by the angle `phase` in a step."""
    return (phase / time_step) ** 2 / (1 / chain.outer_mass + 1 / chain.inner_mass)


def deflections_at(state: State, lane: Lane, start: int, stiffness: FloatArray) -> FloatArray:
    """Give the deflection x [m] of every spring, shape (n,), at most where it yields.

    Without a history a spring holds the load that it meets, and is bent by one step of the slip: unloaded, it would let
    go of a stuck contact, and ring.
    """
    chain = lane.chain
    internal_state = state.internal_state
    if internal_state is None:
        position, velocity = state.positions[0], state.velocities[0]
        pull = -chain.stiffness_matrix @ position - chain.damping_matrix @ velocity
        pull[0] += lane.loads(start, 1)[0]
        outer, inner = np.split(pull / np.diag(chain.mass_matrix), 2)
        holding = (inner - outer) / (1 / chain.outer_mass + 1 / chain.inner_mass)
        deflection = holding / stiffness + lane.time_step * (chain.contact_directions.T @ velocity)
    elif internal_state.shape == (1, chain.cells):
        deflection = internal_state[0]
    else:
        shapes = f"{internal_state.shape}; allowed: {(1, chain.cells)}"
        raise ParameterError(f"the internal state of a lane has the shape {shapes}")
    limit = chain.friction_bound / stiffness
    return np.clip(deflection, -limit, limit)


def compiled_springs(lane: Lane, preset: Preset) -> CompiledLane:
    """Compile a lane as `compiled_joints`, with a tendon that yields, in each cell, in place of its dry friction."""
    units = Units.named(preset["units"], lane)
    chain, time_step = units.scaled(lane.chain), lane.time_step / units.time
    stiffness = yield_stiffness(chain, time_step, preset["spring_phase"])
    spec = new_spec(time_step, preset)
    for cell in range(chain.cells):
        add_masses(spec, chain, cell)
        tendon = spec.add_tendon(springlength=[0, 0])
        set_spring(tendon, stiffness[cell], 0.0)
        tendon.springyield = 1.0  # a cell without friction has its memory too
        tendon.wrap_joint(f"inner {cell}", 1)
    add_chain(spec, chain)
    model = spec.compile()
    model.tendon_springyield[: chain.cells] = chain.friction_bound / stiffness
    return CompiledLane(lane, units, model)


class YieldingSimulation(MuJoCoSimulation):
    """Lanes whose internal state is the deflection of every spring [m], shape (lanes, n).

    Deflections, unlike the lengths at which the springs are slack, stay valid when a search of periodic orbits moves
    all masses. Friction is that of the springs at the end of each step.
    """

    def __init__(self, compiled: Sequence[CompiledLane]):
        super().__init__(compiled)
        self._recorded = ("qpos", "qvel", "plastic")
        cells = self.lanes[0].chain.cells
        own = np.stack([model.tendon_stiffness[:cells] for model in self._models])
        self._stiffness = own * np.array([[unit.force / unit.length] for unit in self._units])

    def _set_internal_state(self, state: State, start: int) -> None:
        """Set where the springs are slack: MuJoCo keeps two ends a tendon, which are one here."""
        each = zip(self.lanes, self._stiffness, strict=True)
        given = [deflections_at(state.subset([k]), lane, start, own) for k, (lane, own) in enumerate(each)]
        deflection = np.stack(given)
        slack = self._batch.bind("qpos")[:, 1 :: self._joints] - deflection / self._length
        self._batch.bind("plastic")[:] = np.repeat(slack, 2, axis=1)

    def _state(self, part: Callable[[str], FloatArray]) -> State:
        deflection = self._deflection(part("qpos"), part("plastic")) * self._length
        return replace(super()._state(part), internal_state=deflection)

    def _friction(self, index: int, record: Mapping[str, FloatArray]) -> FloatArray:
        deflection = self._deflection(record["qpos"][index], record["plastic"][index]) * self._units[index].length
        return -self._stiffness[index] * deflection

    def _deflection(self, qpos: FloatArray, plastic: FloatArray) -> FloatArray:
        return qpos[..., 1 :: self._joints] - plastic[..., ::2]


def yielding_spring(preset: Preset) -> Law:
    """Give the law of a spring that yields."""
    return Law(
        formula=(
            "q̇⁺ = q̇ + h M⁻¹ (f(t) e_1 − C q̇ − K q − W k_s x), q⁺ = q + h q̇⁺, x⁺ = clip(x + h w⁺, ±F / k_s), "
            "k_s = m_red (θ / h)², 1 / m_red = 1 / m_o + 1 / m_i"
        ),
        constants={"θ": Constant(preset["spring_phase"], "", "spring_phase, and so stiffness and springyield")},
        model=lambda lane, constants: YieldingLane(lane, constants["θ"]),
    )


class YieldingLane(KernelLane):
    """One chain under one drive; every contact is a spring that oscillates by `phase` in a step, and a slider."""

    def __init__(self, lane: Lane, phase: float):
        super().__init__(lane)
        chain, step = lane.chain, LinearStep.explicit(lane.chain, lane.time_step)
        count = 2 * chain.cells
        self._stiffness = yield_stiffness(chain, lane.time_step, phase)
        self._matrices = step.state[:count], step.load[:count, 0], -lane.time_step * step.response * self._stiffness

    def _integrate(self, state: State, start: int, steps: int, record: FloatArray) -> State:
        lane = self.lane
        motion = np.vstack([state.positions[0], state.velocities[0]])
        deflection = deflections_at(state, lane, start, self._stiffness)
        limit = lane.chain.friction_bound / self._stiffness
        matrix, load, response = map(np.ascontiguousarray, self._matrices)
        loads = lane.loads(start, steps)
        advance(motion, deflection, loads, matrix, load, response, lane.time_step, limit, record)
        record[:, 2 * motion.shape[1] :] *= -self._stiffness
        return State(motion[:1], motion[1:], deflection[None])


@Kernel
def advance(
    motion: Any, deflection: Any, loads: Any, state: Any, load: Any, response: Any, length: Any, limit: Any, record: Any
) -> None:
    """Take a step for each load; `motion`, shape (2, 2n), and `deflection`, shape (n,), end in the last state."""
    size, cells = motion.shape[1], deflection.size
    keeps = record.shape[0] > 0
    free = motion[1].copy()
    for step in range(loads.size):
        for i in range(size):
            free[i] = load[i] * loads[step]
            for j in range(size):
                free[i] += state[i, j] * motion[1, j] + state[i, size + j] * motion[0, j]
            for j in range(cells):
                free[i] += response[i, j] * deflection[j]
        for i in range(size):
            motion[1, i] = free[i]
            motion[0, i] += length * free[i]
        for i in range(cells):
            slipped = deflection[i] + length * (free[cells + i] - free[i])
            deflection[i] = min(max(slipped, -limit[i]), limit[i])
        if keeps:
            keep(record[step], motion[0], motion[1], deflection, 1.0)
