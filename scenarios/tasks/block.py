"""Tasks with one block that is pressed on a carrier: the contact of one cell, in SI units."""

from dataclasses import dataclass, field
from typing import Annotated, Any

import numpy as np
from pydantic import Field

from engines.interface.presets import Formulation, NormalForce
from reference_lcp.chain.canonical import FRICTION_COEFFICIENT
from reference_lcp.chain.mass_in_mass import Chain
from reference_lcp.chain.preload import Preload
from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.trajectory import State
from scenarios.tasks.parameters import ChainRatios, Ratio
from scenarios.tasks.transient import TransientTask

CARRIER_MASSES = 20.0
"""Masses of the block that the carrier has: it moves by 4e-4 of the way in which a block stops in 0.25 s."""

CARRIER_FREQUENCY = 80.0
"""√(k_c / m_o) of the carrier on its base [rad/s]: far above what moves it, and resolved by steps of 5 ms."""

CARRIER_DAMPING = 0.1
"""c_c / (2 √(k_c m_o)) of the carrier: what begins to shake it dies out in a few tenths of a second."""

PRESSED = Preload(modulation=0.0, angular_frequency=1.0)
"""A force that presses a contact whose masses are free to part, as a body rests on the ground."""


@dataclass(frozen=True, kw_only=True)
class Block:
    """A block on a carrier: the inner mass of a chain of one cell, and its outer mass, which stands on the base.

    Parameters
    ----------
    mass
        Of the block [kg].
    normal_force
        λ_N that presses it on the carrier [N].
    stiffness
        Of the spring k_i that pulls it to its place on the carrier [N/m].
    carrier_frequency
        √(k_c / m_o) of the carrier on its base [rad/s].
    carrier_damping
        c_c / (2 √(k_c m_o)) of the carrier.
    """

    mass: float
    normal_force: float
    stiffness: float
    carrier_frequency: float = CARRIER_FREQUENCY
    carrier_damping: float = CARRIER_DAMPING

    @property
    def bound(self) -> float:
        """Largest friction μ λ_N [N]."""
        return FRICTION_COEFFICIENT * self.normal_force

    def chain(self) -> Chain:
        """Build the chain of one cell.

        Raises
        ------
        ParameterError
            If a parameter is outside its range.
        """
        carrier = CARRIER_MASSES * self.mass
        return Chain(
            cells=1,
            outer_mass=np.asarray(carrier),
            inner_mass=np.asarray(self.mass),
            chain_stiffness=np.asarray(carrier * self.carrier_frequency**2),
            chain_damping=np.asarray(2 * self.carrier_damping * carrier * self.carrier_frequency),
            inner_stiffness=np.asarray(self.stiffness),
            normal_force=np.asarray(self.normal_force),
            friction_coefficient=np.asarray(FRICTION_COEFFICIENT),
        )


@dataclass(frozen=True, kw_only=True)
class BlockTask(TransientTask):
    """The motion of a block on its carrier.

    Parameters
    ----------
    block
        What moves.
    slip
        By how much the block is moved on the carrier at first [m].
    slip_velocity
        Velocity of the block on the carrier at first [m/s].
    direction
        Angle by which the row is turned in the plane of the contact [rad].
    carrier_velocity
        Velocity of the carrier at first [m/s].
    static_ratio
        μ_s / μ_k >= 1 of the contact; μ λ_N of the block is the friction of a slip.
    variant, base, time_step, steps, every
        As for `TransientTask`. What is recorded is the slip at the rows that are kept; ratios have no part in it.
    """

    block: Block
    slip: float = 0.0
    slip_velocity: float = 0.0
    direction: Annotated[float, Field(exclude_if=lambda value: value == 0)] = 0.0
    carrier_velocity: float = 0.0
    static_ratio: Annotated[float, Field(exclude_if=lambda value: value == 1)] = 1.0
    recorded: str = "slip"
    friction_ratio: Annotated[Ratio, Field(exclude=True)] = 0.0
    ratios: Annotated[ChainRatios, Field(exclude=True)] = field(default_factory=lambda: ChainRatios(cells=1))

    @property
    def chain(self) -> Chain:
        """Build the chain of one cell."""
        return self.block.chain()

    def content(self) -> dict[str, Any]:
        """Everything that the result depends on: also whether the contact is free, and the options for that."""
        if not self._free:
            return super().content()
        options = self.variant.preset.modulated().options
        return super().content() | {
            "contact": "free", "options": {name: repr(option.value) for name, option in sorted(options.items())}
        }  # fmt: skip

    def lane(self) -> Lane:
        """Build the chain under its drive; where a contact can be free across the row, it is pressed by a force."""
        return Lane(
            self.chain,
            self.base,
            self.time_step,
            PRESSED if self._free else None,
            direction=self.direction,
            static_ratio=self.static_ratio,
        )

    def unsupported_reason(self) -> str | None:
        """Give the reason why the variant cannot represent the lane; ``None`` without one."""
        return self.variant.preset.unsupported_reason(self.lane(), str(self.variant))

    @property
    def _free(self) -> bool:
        contact = self.variant.formulation == Formulation.CONTACT
        return contact and self.variant.preset.represents(NormalForce.LIFTING)

    def initial_state(self) -> State:
        """Give the state that the motion starts from, a batch of one lane."""
        velocities = [self.carrier_velocity, self.carrier_velocity + self.slip_velocity]
        return State(np.array([[0.0, self.slip]]), np.array([velocities]))
