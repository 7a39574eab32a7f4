"""MuJoCo's LuGre friction, which its direct-current motor has: bristles that bend, in every cell, with a memory."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from engines.interface.law import Constant, Law
from engines.interface.presets import Preset
from engines.mujoco.joint import CompiledLane, add_chain, add_masses, new_spec
from engines.mujoco.simulation import MuJoCoSimulation
from engines.mujoco.yielding import deflections_at, yield_stiffness
from engines.shared.kernel_lane import Kernel, KernelLane, keep
from engines.shared.units import Units
from reference_lcp.chain.mass_in_mass import Chain
from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.trajectory import State
from reference_lcp.validation import FloatArray


def bristle_damping(chain: Chain, time_step: float, phase: float, damping_ratio: float) -> FloatArray:
    """Give σ_1 [N s/m], shape (n,), with which bristles swing at this part of critical damping."""
    return 2 * damping_ratio * phase / time_step / (1 / chain.outer_mass + 1 / chain.inner_mass)


def compiled_bristles(lane: Lane, preset: Preset) -> CompiledLane:
    """Compile a lane as `compiled_joints`, with a motor that takes no input, in each cell, for its dry friction."""
    units = Units.named(preset["units"], lane)
    chain, time_step = units.scaled(lane.chain), lane.time_step / units.time
    stiffness = yield_stiffness(chain, time_step, preset["bristle_phase"])
    damping = bristle_damping(chain, time_step, preset["bristle_phase"], preset["bristle_damping"])
    spec = new_spec(time_step, preset)
    for cell in range(chain.cells):
        add_masses(spec, chain, cell)
    add_chain(spec, chain)
    for cell, bound in enumerate(chain.friction_bound.tolist()):
        _add_motor(spec, f"inner {cell}", [stiffness[cell], damping[cell], bound, bound, 1.0])
    return CompiledLane(lane, units, spec.compile())


def _add_motor(spec: Any, joint: str, lugre: Sequence[float]) -> None:
    """Add a motor of σ_0, σ_1, F_C, F_S and v_S; without a bound it has its memory, and no part in the motion."""
    import mujoco

    motor = spec.add_actuator(target=joint, trntype=mujoco.mjtTrn.mjTRN_JOINT)
    *bristles, kinetic, static, speed = lugre
    if kinetic == 0:
        motor.gear[0] = 0.0
        kinetic = static = 1.0
    motor.set_to_dcmotor(
        motorconst=[0.0, 0.0], resistance=1.0, lugre=[*bristles, kinetic, static, speed], ctrlspec=NO_INPUT
    )


NO_INPUT = 16
"""MuJoCo's ``input="none"``."""


class BristleSimulation(MuJoCoSimulation):
    """Lanes whose internal state is the deflection z of every bristle [m], shape (lanes, n).

    Friction is that of the motors, of the start of each step.
    """

    def __init__(self, compiled: Sequence[CompiledLane]):
        super().__init__(compiled)
        self._recorded = ("qpos", "qvel", "act", "actuator_force")
        own = np.stack([model.actuator_dynprm[1:, BRISTLE_STIFFNESS] for model in self._models])
        self._stiffness = own * np.array([[unit.force / unit.length] for unit in self._units])

    def _set_internal_state(self, state: State, start: int) -> None:
        each = zip(self.lanes, self._stiffness, strict=True)
        given = [deflections_at(state.subset([k]), lane, start, own) for k, (lane, own) in enumerate(each)]
        self._batch.bind("act")[:] = np.stack(given) / self._length

    def _state(self, part: Callable[[str], FloatArray]) -> State:
        return replace(super()._state(part), internal_state=part("act") * self._length)

    def _friction(self, index: int, record: Mapping[str, FloatArray]) -> FloatArray:
        rubs = self.lanes[index].chain.friction_bound > 0
        return np.where(rubs, record["actuator_force"][index][:, 1:], 0.0) * self._units[index].force


BRISTLE_STIFFNESS = 5
"""Where `actuator_dynprm` has σ_0."""


def bristle(preset: Preset) -> Law:
    """Give the law of bristles."""
    return Law(
        formula=(
            "λ = −(σ_0 z + σ_1 (w + a z)), a = −σ_0 |w| / F; q̇⁺ = q̇ + h M⁻¹ (f(t) e_1 − C q̇ − K q + W λ), "
            "q⁺ = q + h q̇⁺, z⁺ = e^(a h) z + w (e^(a h) − 1) / a; "
            "σ_0 = m_red (θ / h)², σ_1 = 2 ζ θ m_red / h, 1 / m_red = 1 / m_o + 1 / m_i"
        ),
        constants={
            "θ": Constant(preset["bristle_phase"], "", "bristle_phase, and so σ_0"),
            "ζ": Constant(preset["bristle_damping"], "", "bristle_damping, and so σ_1"),
        },
        model=lambda lane, constants: BristleLane(lane, constants["θ"], constants["ζ"]),
    )


class BristleLane(KernelLane):
    """One chain under one drive; bristles in every contact that swing by `phase` in a step, with a damping ratio."""

    def __init__(self, lane: Lane, phase: float, damping_ratio: float):
        super().__init__(lane)
        self._stiffness = yield_stiffness(lane.chain, lane.time_step, phase)
        self._damping = bristle_damping(lane.chain, lane.time_step, phase, damping_ratio)

    def _integrate(self, state: State, start: int, steps: int, record: FloatArray) -> State:
        lane = self.lane
        motion = np.concatenate([state.positions[0], state.velocities[0]])
        deflection = deflections_at(state, lane, start, self._stiffness)
        given = self._force, self._masses, (self._stiffness, self._damping, lane.chain.friction_bound, lane.time_step)
        advance_bristles(motion, deflection, lane.loads(start, steps), *given, record)
        position, velocity = np.split(motion[None], 2, axis=1)
        return State(position, velocity, deflection[None])


@Kernel
def advance_bristles(
    motion: Any, deflection: Any, loads: Any, force_matrix: Any, masses: Any, numbers: Any, record: Any
) -> None:
    """Take a step for each load; `motion`, shape (4n,), and `deflection`, shape (n,), end in the last state."""
    stiffness, damping, bounds, h = numbers
    cells = deflection.size
    count = 2 * cells
    force, friction = np.empty(count), np.zeros(cells)
    for step in range(loads.size):
        np.dot(force_matrix, motion, force)
        force[0] += loads[step]
        for cell in range(cells):
            if bounds[cell] > 0.0:
                slip, bent = motion[count + cells + cell] - motion[count + cell], deflection[cell]
                rate = -stiffness[cell] * abs(slip) / bounds[cell]
                friction[cell] = -(stiffness[cell] * bent + damping[cell] * (slip + rate * bent))
                decay = np.exp(rate * h)
                lasting = (decay - 1.0) / rate if rate < 0.0 else h
                deflection[cell] = decay * bent + slip * lasting
                force[cell] -= friction[cell]
                force[cells + cell] += friction[cell]
        for i in range(count):
            motion[count + i] += h * force[i] / masses[i]
            motion[i] += h * motion[count + i]
        if record.shape[0] > 0:
            keep(record[step], motion[:count], motion[count:], friction, 1.0)
