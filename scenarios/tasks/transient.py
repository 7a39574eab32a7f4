"""Tasks with a transient: a chain, the motion of its base, its initial state, its length."""

import dataclasses
from dataclasses import dataclass
from typing import Annotated, Self

import numpy as np
from pydantic import PlainSerializer, PlainValidator

from reference_lcp.chain.harmonic import HarmonicForce, MovingBase, StillBase
from reference_lcp.chain.mass_in_mass import Chain
from reference_lcp.chain.record import RecordedBase
from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.step_limits import LARGEST_PHASE_STEP
from reference_lcp.chain.trajectory import State
from reference_lcp.refusal import ParameterError, checked_choice
from reference_lcp.validation import FloatArray, checked_count, checked_scalar
from scenarios.tasks.task import Task

SHAPES = ("undeformed", "stretched", "inner masses displaced")
"""Where a motion may start, always from rest.

``stretched``: every chain spring by the same length, as far as the last cell is moved by the displacement
scale, inner springs unstretched. ``inner masses displaced``: all of them by the displacement scale, outer ones not.
"""

RECORDED = ("response", "decay", "slip", "contact modes")
"""What may be recorded of a motion: see `scenarios.execution.computation.transient`."""


_Base = Annotated[
    MovingBase | HarmonicForce | StillBase,
    PlainValidator(lambda base: base),
    PlainSerializer(lambda base: base.parameters()),
]
"""Written with the hash of its samples where it follows a record."""


@dataclass(frozen=True, kw_only=True)
class TransientTask(Task):
    """The motion of one chain from an initial state, by one variant.

    Parameters
    ----------
    variant, ratios, friction_ratio
        As for `Task`; the base amplitude U0 of the friction ratio is 0.01 m.
    base
        How the base moves, or which force acts on the first cell.
    time_step
        dt [s], > 0, with dt ω_max <= 0.4 for the highest natural frequency of the chain.
    steps
        How many, >= 1.
    every
        One row in so many steps is kept; it divides the steps.
    shape
        One of `SHAPES`.
    recorded
        One of `RECORDED`.

    Raises
    ------
    ParameterError
        If a value is outside its range.
    """

    base: _Base
    time_step: float
    steps: int
    every: int = 1
    shape: str = SHAPES[0]
    recorded: str = RECORDED[0]

    def __post_init__(self) -> None:
        checked_choice("shape", self.shape, SHAPES)
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
