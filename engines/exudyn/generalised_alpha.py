"""Exudyn's implicit integrator as a model: generalised alpha with friction laws whose equations are solved exactly.

A substep of length h begins with positions q, velocities v, accelerations a and the algorithmic accelerations ã, and
ends with

    b = −α_m/(1−α_m) ã + α_f/(1−α_m) a,
    q⁺ = q + h v + h² ((½−β) ã + β (b + c a⁺)),   v⁺ = v + h ((1−γ) ã + γ (b + c a⁺)),   ã⁺ = b + c a⁺,
    M a⁺ + C v⁺ + K q⁺ + W φ⁺ = f(t+h) e_1,

with c = (1−α_f)/(1−α_m) and φ = −λ the forces of the connectors. A run begins with ã = a, those of its first state.
"""

from dataclasses import astuple, dataclass

import numpy as np

from engines.exudyn.friction_models import ContactNumbers
from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.trajectory import State, Trajectory
from reference_lcp.stepping.sequential import LaneModel
from reference_lcp.validation import FloatArray


@dataclass(frozen=True)
class IntegrationRule:
    """The numbers of the integrator; see the module.

    Parameters
    ----------
    algorithmic, previous, current
        −α_m/(1−α_m), α_f/(1−α_m) and c.
    beta, gamma
        β and γ.
    """

    algorithmic: float
    previous: float
    current: float
    beta: float
    gamma: float

    @classmethod
    def trapezoidal(cls) -> "IntegrationRule":
        """Give Newmark's rule with β = ¼ and γ = ½."""
        return cls(0.0, 0.0, 1.0, 0.25, 0.5)

    @classmethod
    def of_radius(cls, radius: float) -> "IntegrationRule":
        """Give generalised alpha with this spectral radius at infinite frequency (Chung and Hulbert, 1993)."""
        mass, force = (2 * radius - 1) / (radius + 1), radius / (radius + 1)
        gamma = 0.5 + force - mass
        rest = 1 - mass
        return cls(-mass / rest, force / rest, (1 - force) / rest, 0.25 * (gamma + 0.5) ** 2, gamma)


class GeneralisedAlphaLane(LaneModel):
    """One chain under one drive, advanced as Exudyn does; contacts keep no more than their slip velocity.

    Parameters
    ----------
    lane
        The chain, its drive and the time step.
    rule
        The integrator.
    numbers
        The friction of its contacts.
    substeps
        Substeps a time step.
    """

    def __init__(self, lane: Lane, rule: IntegrationRule, numbers: ContactNumbers, substeps: int):
        self.lane = lane
        self._numbers, self._substeps = numbers, substeps
        self._friction = numbers.kind, numbers.tolerance, np.vstack([numbers.bound, numbers.first, numbers.second])
        chain, h = lane.chain, lane.time_step / substeps
        self._rule = (h, substeps, *astuple(rule))
        place, speed = rule.current * h * h * rule.beta, rule.current * h * rule.gamma
        inverse = np.linalg.inv(chain.mass_matrix + speed * chain.damping_matrix + place * chain.stiffness_matrix)
        response = inverse @ chain.contact_directions
        self._inverse_mass = np.linalg.inv(chain.mass_matrix)
        self._matrices = (
            np.ascontiguousarray(-(inverse @ chain.stiffness_matrix).T),
            np.ascontiguousarray(-(inverse @ chain.damping_matrix).T),
            np.ascontiguousarray(inverse[:, 0]),
            np.ascontiguousarray(response.T),
            chain.contact_directions.T @ response,
        )

    def run(self, state: State, start: int, steps: int) -> Trajectory:
        """Advance from `state` at step index `start`."""
        size = 2 * self.lane.chain.cells
        record = np.empty((steps, 5 * self.lane.chain.cells))
        end = self._integrate(state, start, steps, record)
        return Trajectory(
            self.lane.times(start, steps),
            record[:, :size],
            record[:, size : 2 * size],
            record[:, 2 * size :],
            self.lane.preloads(start, steps),
            None if end.internal_state is None else end.internal_state[0],
        )

    def advance(self, state: State, start: int, steps: int) -> State:
        """Advance as `run` does, and keep the end only."""
        return self._integrate(state, start, steps, np.empty((0, 5 * self.lane.chain.cells)))

    def _accelerations(self, motion: FloatArray, forces: FloatArray, load: float) -> FloatArray:
        """Give the accelerations of a state, whose contacts have forces φ."""
        chain = self.lane.chain
        elastic = chain.stiffness_matrix @ motion[0] + chain.damping_matrix @ motion[1]
        rest = -(elastic + chain.contact_directions @ forces)
        rest[0] += load
        accelerations: FloatArray = self._inverse_mass @ rest
        return accelerations

    def _contacts_at(self, state: State, load: float) -> FloatArray:
        """Give what contacts keep at the start of a run, shape (2, n), with `load` [N] on cell 1."""
        slip = self.lane.chain.contact_directions.T @ state.velocities[0]
        return np.vstack([slip, np.zeros_like(slip)])

    def _internal_state(self, positions: FloatArray, contacts: FloatArray) -> FloatArray | None:
        """Give the internal state at the end of a run, shape (1, k)."""
        return None

    def _integrate(self, state: State, start: int, steps: int, record: FloatArray) -> State:
        """Run the kernel; a run begins with new accelerations, as Exudyn's do."""
        from engines.exudyn.generalised_alpha_kernel import advance, forces  # numba is imported once something moves

        lane, (length, parts) = self.lane, self._rule[:2]
        times = length * np.arange(start * parts, (start + steps) * parts + 1, dtype=np.float64)
        loads = lane.drive.load(lane.chain, times)
        motion = np.vstack([state.positions[0], state.velocities[0]])
        contacts = self._contacts_at(state, float(loads[0]))
        kind, tolerance, rows = self._friction
        first = self._accelerations(motion, forces(motion, contacts, kind, rows), float(loads[0]))
        advance(motion, contacts, first, loads, self._matrices, self._rule, kind, rows, tolerance, record)
        return State(motion[:1], motion[1:], self._internal_state(motion[0], contacts))
