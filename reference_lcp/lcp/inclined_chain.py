"""The mass-in-mass chain with the normal direction of its contacts resolved: preload, lift-off, landing.

The inner mass of cell i moves in the plane: v_i along the row, y_i across it. The outer mass, guided
along the row, carries a flat face inclined by α to the row, with tangent t = (cos α, sin α) and normal
n = (−sin α, cos α). With (v_i − u_i, y_i) the place of the inner mass relative to the outer one,

    g_N = −sin α (v_i − u_i) + cos α y_i        ġ_T = cos α (v̇_i − u̇_i) + sin α ẏ_i.

An actuator between the two masses of the cell presses the inner mass against the face, along n, with

    N_i(t) = N0_i (1 + a_i sin(Ω t + φ)),

N0_i being the chain's `normal_force`; where a_i > 1 it pulls the inner mass off the face for a part of
each cycle. Springs, dashpots and the drive are the chain's and act along the row. So equation (4) reads

    M ü = f − K u − C u̇ − W_N N(t) + W_N λ_N + W_T λ_T,     M = diag(m_o, m_i, m_i).

The spring k_i now loads and unloads the contact, and G_NT = W_Nᵀ M⁻¹ W_T = −sin α cos α / m_o couples
normal and tangential direction. With α = 0 and a = 0 there is no motion across the row: λ_N = N0, and
along the row the motion is that of the chain with a given normal force.
"""

import dataclasses
import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from reference_lcp.chain.harmonic import Drive
from reference_lcp.chain.mass_in_mass import Chain
from reference_lcp.chain.preload import preload_factor
from reference_lcp.lcp.time_step import FrictionalStep
from reference_lcp.refusal import ParameterError
from reference_lcp.validation import FloatArray, checked_per_cell, checked_scalar


@dataclass(frozen=True, eq=False, kw_only=True)
class InclinedChain:
    """A chain whose contacts can open and close; a `FrictionalSystem` of 3n freedoms and n contacts.

    Positions are u_1 … u_n, v_1 … v_n, y_1 … y_n [m], see the module's equations; all zero at rest,
    with closed contacts.

    Parameters
    ----------
    chain
        Masses, springs, dashpots, μ, and the mean preload N0 as its `normal_force` [N].
    drive
        What sets it in motion.
    inclination
        α [rad] of the contact faces to the row, −π/2 < α < π/2.
    modulation
        a >= 0, a number or one a cell; stored with shape (n,).
    modulation_frequency, modulation_phase
        Ω > 0 [rad/s] and φ [rad].

    Raises
    ------
    ParameterError
        If a value is not finite, outside its range, or of the wrong shape.
    """

    chain: Chain
    drive: Drive
    inclination: float = 0.0
    modulation: FloatArray = dataclasses.field(default_factory=lambda: np.zeros(()))
    modulation_frequency: float = 1.0
    modulation_phase: float = 0.0

    def __post_init__(self) -> None:
        if abs(checked_scalar("inclination", self.inclination)) >= math.pi / 2:
            raise ParameterError(f"inclination = {self.inclination:g} is outside its range; allowed: (-pi/2, pi/2)")
        checked_scalar("modulation_frequency", self.modulation_frequency, "> 0")
        checked_scalar("modulation_phase", self.modulation_phase)
        modulation = checked_per_cell("modulation", self.modulation, self.contacts, ">= 0")
        object.__setattr__(self, "modulation", modulation)

    @property
    def freedoms(self) -> int:
        """3n."""
        return 3 * self.chain.cells

    @property
    def contacts(self) -> int:
        """n, one contact a cell."""
        return self.chain.cells

    def preload(self, time: float) -> FloatArray:
        """N(t) of each cell [N], shape (n,); negative where the actuator pulls."""
        factor = preload_factor(time, self.modulation, self.modulation_frequency, self.modulation_phase)
        return self.chain.normal_force * factor

    @cached_property
    def mass_matrix(self) -> FloatArray:
        """M [kg], shape (3n, 3n)."""
        return np.diag(np.concatenate([self.chain.outer_mass, self.chain.inner_mass, self.chain.inner_mass]))

    @cached_property
    def normal_directions(self) -> FloatArray:
        """W_N = (∂g_N/∂u)ᵀ, shape (3n, n)."""
        return self._directions(-math.sin(self.inclination), math.cos(self.inclination))

    @cached_property
    def tangential_directions(self) -> FloatArray:
        """W_T = (∂ġ_T/∂u̇)ᵀ, shape (3n, n)."""
        return self._directions(math.cos(self.inclination), math.sin(self.inclination))

    def force(self, time: float, position: FloatArray, velocity: FloatArray) -> FloatArray:
        """All forces but the contacts': h = f − K u − C u̇ − W_N N(t) [N], shape (3n,)."""
        along = 2 * self.chain.cells
        force = -self.normal_directions @ self.preload(time)
        force[:along] -= self.chain.stiffness_matrix @ position[:along] + self.chain.damping_matrix @ velocity[:along]
        force[0] += float(self.drive.load(self.chain, np.asarray(time)))
        return force

    def step(self, time: float, position: FloatArray, velocity: FloatArray, time_step: float) -> FrictionalStep:
        """Equation (7)'s data for the step that starts at `time` [s]; the faces are flat and move with the masses."""
        still = np.zeros(self.contacts)
        return FrictionalStep(
            mass_matrix=self.mass_matrix,
            force=self.force(time, position, velocity),
            velocity=velocity,
            time_step=time_step,
            normal_directions=self.normal_directions,
            tangential_directions=self.tangential_directions,
            tangential_directions_of_position=np.zeros((self.freedoms, self.contacts)),
            normal_motion=still,
            tangential_motion=still,
            normal_gap=self.normal_directions.T @ position,
            relative_velocity=self.tangential_directions.T @ velocity,
            friction_coefficient=self.chain.friction_coefficient,
        )

    def _directions(self, along: float, across: float) -> FloatArray:
        """Directions of the contacts, from their parts along and across the row."""
        identity = np.eye(self.contacts)
        return np.vstack([-along * identity, along * identity, across * identity])
