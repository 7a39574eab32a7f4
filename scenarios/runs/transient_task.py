"""Tasks with a transient: a chain, the motion of its base, its initial state, its length."""

import dataclasses
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import lru_cache
from typing import Annotated, Any, Self

import numpy as np
from pydantic import Field, PlainSerializer, PlainValidator

from multibody_xval.engines.interface.presets import Formulation, NormalForce
from multibody_xval.scenarios.runs.parameters import ChainRatios, Ratio, left_out
from multibody_xval.scenarios.runs.task import ChainTask
from reference_lcp.chain.drives import HarmonicForce, MovingBase, StillBase
from reference_lcp.chain.mass_in_mass import Chain
from reference_lcp.chain.preload import CONSTANT
from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.trajectory import State
from reference_lcp.chain.transient import RecordedBase
from reference_lcp.defaults import FRICTION_COEFFICIENT, LARGEST_PHASE_STEP
from reference_lcp.errors import ParameterError, checked_choice
from reference_lcp.validation import FloatArray, checked_count, checked_scalar

SHAPES = ("undeformed", "stretched", "inner masses displaced")
"""Where a motion may start, always from rest.

``stretched``: every chain spring by the same length, as far as the last cell is moved by the displacement
scale, inner springs unstretched. ``inner masses displaced``: all of them by the displacement scale, outer ones not.
"""

SERIES = {
    "response": ("response",),
    "decay": ("rest", "offsets", "swing", "energy"),
    "slip": ("slip", "slip_velocity", "slid"),
}
"""Names of the series by what is recorded of a motion: see `multibody_xval.scenarios.runs.transient`."""

RECORDED = tuple(SERIES)

STRETCH = 4096
"""Steps that are in memory at once."""


_Base = Annotated[
    MovingBase | HarmonicForce | StillBase,
    PlainValidator(lambda base: base),
    PlainSerializer(lambda base: base.parameters()),
]
"""Written with the hash of its samples where it follows a record."""


@dataclass(frozen=True, kw_only=True)
class TransientTask(ChainTask):
    """The motion of one chain from an initial state, by one variant; its friction ratio refers to U0 = 0.01 m."""

    base: _Base
    """How the base moves, or which force acts on the first cell."""
    time_step: float
    """dt [s], > 0, with dt ω_max <= 0.4 for the highest natural frequency of the chain."""
    steps: int
    every: int = 1
    """One row in so many steps is kept; it divides the steps."""
    shape: str = SHAPES[0]
    recorded: str = RECORDED[0]
    stretch: Annotated[int, left_out(STRETCH)] = STRETCH
    """Most steps of one run: the motion takes as many runs as it needs."""

    @property
    def series(self) -> Mapping[str, int]:
        """Name and length of what is kept of the motion."""
        rows, cells = self.steps // self.every, self.cells
        lengths = {"rest": 1, "offsets": cells, "energy": 4}
        return {name: lengths.get(name, rows) for name in SERIES[self.recorded]}

    def __post_init__(self) -> None:
        checked_choice("shape", self.shape, SHAPES)
        checked_count("stretch", self.stretch)
        checked_choice("recorded", self.recorded, RECORDED)
        if checked_count("steps", self.steps) % checked_count("every", self.every):
            raise ParameterError(f"every = {self.every} does not divide steps = {self.steps}; allowed: divisors")
        largest = LARGEST_PHASE_STEP / self.chain.highest_natural_frequency
        if checked_scalar("time_step", self.time_step, "> 0") > largest * (1 + 1e-12):
            raise ParameterError(
                f"time_step = {self.time_step:g} s is outside its range; allowed: <= {largest:.4g} s, "
                f"{LARGEST_PHASE_STEP} over the highest natural frequency"
            )
        if isinstance(self.base, RecordedBase):
            self.base.check_time_step(self.time_step)

    def lane(self) -> Lane:
        """Build the chain under its drive."""
        return Lane(self.chain, self.base, self.time_step)

    def unsupported_reason(self) -> str | None:
        """Give the reason why the variant cannot represent the lane; ``None`` without one."""
        return self.variant.preset.unsupported_reason(self.lane(), str(self.variant))

    def initial_state(self) -> State:
        """Give the state that the motion starts from, a batch of one lane."""
        positions = initial_positions(self.chain, self.shape, self.base.displacement_scale(self.chain))
        return State(positions[None], np.zeros((1, positions.size)))

    def refined(self, factor: int) -> Self:
        """Give the task of the same motion with `factor` times as many steps; rows stay at the same times."""
        return dataclasses.replace(
            self, time_step=self.time_step / factor, steps=self.steps * factor, every=self.every * factor
        )

    def row_times(self) -> FloatArray:
        """Times of the rows that are kept [s], shape (steps / every,)."""
        return self.time_step * np.arange(self.every, self.steps + 1, self.every, dtype=np.float64)


def initial_positions(chain: Chain, shape: str, length: float) -> FloatArray:
    """Positions of one of `SHAPES` [m], shape (2n,), outer masses first; `length` [m] is its size."""
    cells = chain.cells
    row = np.arange(1, cells + 1) / cells
    outer = row if checked_choice("shape", shape, SHAPES) == "stretched" else np.zeros(cells)
    inner = {"undeformed": np.zeros(cells), "stretched": row, "inner masses displaced": np.ones(cells)}[shape]
    return length * np.concatenate([outer, inner])


CARRIER_MASSES = 20.0
"""Masses of the block that the carrier has: it moves by 4e-4 of the way in which a block stops in 0.25 s."""

CARRIER_FREQUENCY = 80.0
"""√(k_c / m_o) of the carrier on its base [rad/s]: far above what moves it, and resolved by steps of 5 ms."""

CARRIER_DAMPING = 0.1
"""c_c / (2 √(k_c m_o)) of the carrier: what begins to shake it dies out in a few tenths of a second."""


@dataclass(frozen=True, kw_only=True)
class Block:
    """A block on a carrier: the inner mass of a chain of one cell, and its outer mass, which stands on the base."""

    mass: float
    """Of the block [kg]."""
    normal_force: float
    """λ_N that presses it on the carrier [N]."""
    stiffness: float
    """Of the spring k_i that pulls it to its place on the carrier [N/m]."""
    carrier_frequency: float = CARRIER_FREQUENCY
    """√(k_c / m_o) of the carrier on its base [rad/s]."""
    carrier_damping: float = CARRIER_DAMPING
    """c_c / (2 √(k_c m_o)) of the carrier."""

    @property
    def bound(self) -> float:
        """Largest friction μ λ_N [N]."""
        return FRICTION_COEFFICIENT * self.normal_force

    @lru_cache(maxsize=1000)  # noqa: B019 - a block is a few numbers, of which a scenario has some dozens
    def chain(self) -> Chain:
        """Build the chain of one cell."""
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
    """The motion of a block on its carrier; its slip is recorded, and ratios have no part in it."""

    block: Block
    slip: float = 0.0
    """By how much the block is moved on the carrier at first [m]."""
    slip_velocity: float = 0.0
    """Velocity of the block on the carrier at first [m/s]."""
    direction: Annotated[float, left_out(0.0)] = 0.0
    """Angle by which the row is turned in the plane of the contact [rad]."""
    carrier_velocity: float = 0.0
    """Velocity of the carrier at first [m/s]."""
    static_ratio: Annotated[float, left_out(1.0)] = 1.0
    """μ_s / μ_k >= 1 of the contact; μ λ_N of the block is the friction of a slip."""
    recorded: str = "slip"
    friction_ratio: Annotated[Ratio, Field(exclude=True)] = 0.0
    ratios: Annotated[ChainRatios, Field(exclude=True)] = field(default_factory=lambda: ChainRatios(cells=1))

    @property
    def chain(self) -> Chain:
        """Build the chain of one cell."""
        return self.block.chain()

    @property
    def preloaded(self) -> bool:
        """Whether the contact is free across the row."""
        contact = self.variant.formulation == Formulation.CONTACT
        return contact and self.variant.preset.represents(NormalForce.LIFTING)

    def content(self) -> dict[str, Any]:
        """Everything that the result depends on: also whether the contact is free."""
        return super().content() | ({"contact": "free"} if self.preloaded else {})

    def lane(self) -> Lane:
        """Build the chain under its drive; where a contact can be free across the row, it is pressed by a force."""
        return Lane(
            self.chain,
            self.base,
            self.time_step,
            CONSTANT if self.preloaded else None,
            direction=self.direction,
            static_ratio=self.static_ratio,
        )

    def initial_state(self) -> State:
        """Give the state that the motion starts from, a batch of one lane."""
        velocities = [self.carrier_velocity, self.carrier_velocity + self.slip_velocity]
        return State(np.array([[0.0, self.slip]]), np.array([velocities]))
