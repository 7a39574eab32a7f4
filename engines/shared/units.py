"""Units in which a lane's numbers are near one.

Engines compare positions, velocities, masses and impulses with fixed numbers: the smallest pivot, the
largest acceleration, the largest joint velocity. A chain of nanograms or one driven at a gigahertz would
meet them in SI units. In a lane's own units it does not, and what an engine computes does not depend on
the units of the chain. Every unit is a power of two, so that converting is exact.
"""

import dataclasses
import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Self

import numpy as np

from reference_lcp.chain.mass_in_mass import Chain
from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.trajectory import State
from reference_lcp.errors import ParameterError, checked_choice
from reference_lcp.validation import FloatArray

LIGHT = 2.0**-20
"""Light unit of mass over the lane's own: what an engine takes for no force at all is a millionth of what it was."""


@dataclass(frozen=True)
class Units:
    """Powers of two near the displacement scale, the outer mass and the time step of a lane."""

    length: float
    mass: float
    time: float
    """Units [m], [kg], [s]."""

    @classmethod
    def named(cls, name: str, lane: Lane) -> Self:
        """Give ``"SI"`` units, the ``"lane"``'s own, or with a mass unit so ``"light"`` that forces are large numbers.

        A setting that an engine takes in seconds or metres per second means what its manual says in SI units only.
        """
        checked_choice("units", name, ("SI", "lane", "light"))
        if name == "SI":
            return cls(1.0, 1.0, 1.0)
        units = cls.of(lane)
        return dataclasses.replace(units, mass=units.mass * LIGHT) if name == "light" else units

    @classmethod
    def in_steps(cls, name: str, lane: Lane) -> Self:
        """As `named`, but the lane's own have its time step as the unit of time, which is no power of two."""
        units = cls.named(name, lane)
        return units if name == "SI" else dataclasses.replace(units, time=lane.time_step)

    @classmethod
    def of(cls, lane: Lane) -> Self:
        """Choose the units of `lane`."""
        length = lane.drive.displacement_scale(lane.chain)
        mass = float(np.exp(np.mean(np.log(lane.chain.outer_mass))))
        return cls(power_of_two(length), power_of_two(mass), power_of_two(lane.time_step))

    @property
    def velocity(self) -> float:
        """Unit of velocity [m/s]."""
        return self.length / self.time

    @property
    def force(self) -> float:
        """Unit of force [N]."""
        return self.mass * self.length / self.time**2

    def gaps(self, lane: Lane, state: State) -> FloatArray:
        """Give the gaps and their rates in a state of one lane, shape (2, n); zeros where contacts stay closed."""
        if not lane.opens:
            return np.zeros((2, lane.chain.cells))
        gap, speed = state.normal_state(lane.chain.cells)
        return np.concatenate([gap / self.length, speed / self.velocity])

    def normal_state(self, gap: FloatArray, speed: FloatArray) -> FloatArray:
        """Give gaps and their rates, shape (n,), as `State.normal_state` reads them in SI units."""
        return np.concatenate([gap * self.length, speed * self.velocity])

    def state(self, position: FloatArray, velocity: FloatArray, internal_state: FloatArray | None = None) -> State:
        """Give a state in SI units of motions, shape (rows, 2n), and the internal state of one row, in SI units."""
        internal = None if internal_state is None else internal_state[None]
        return State(position * self.length, velocity * self.velocity, internal)

    def scaled(self, chain: Chain) -> Chain:
        """Give `chain` with its parameters in these units."""
        stiffness, damping = self.mass / self.time**2, self.mass / self.time
        return dataclasses.replace(
            chain,
            outer_mass=chain.outer_mass / self.mass,
            inner_mass=chain.inner_mass / self.mass,
            chain_stiffness=chain.chain_stiffness / stiffness,
            inner_stiffness=chain.inner_stiffness / stiffness,
            chain_damping=chain.chain_damping / damping,
            inner_damping=chain.inner_damping / damping,
            normal_force=chain.normal_force / self.force,
        )


def power_of_two(value: float) -> float:
    """Give the power of two next below or at `value`."""
    return math.ldexp(1.0, math.frexp(value)[1] - 1)


def check_mass_ratio(lanes: Sequence[Lane], largest: float, title: str) -> None:
    """Refuse chains with an inner mass over `largest` times its outer one, which single precision loses beside it."""
    ratio = max(float(np.max(lane.chain.inner_mass / lane.chain.outer_mass)) for lane in lanes)
    if ratio > largest:
        raise ParameterError(
            f"inner mass over outer mass = {ratio:g}; allowed: at most {largest:g} in {title}, of single precision"
        )
