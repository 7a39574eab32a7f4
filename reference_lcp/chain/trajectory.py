"""States of chains and the trajectories that lead from one state to the next."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from reference_lcp.errors import ParameterError
from reference_lcp.validation import FloatArray


@dataclass(frozen=True)
class State:
    """Positions and velocities of a batch of lanes at one instant."""

    positions: FloatArray
    """Absolute displacements [m], shape (lanes, 2n), outer masses first."""
    velocities: FloatArray
    """Absolute velocities [m/s], same shape."""
    internal_state: FloatArray | None = None
    """What a history-dependent friction law carries beside these (the anchor of a bristle, say), shape (lanes, k).

    ``None`` for laws without any, and for a fresh start. Where there are several values a contact, the first of every
    contact, then the second: values of a kind share their size in the periodicity residual. Where contacts open, the
    gap of every contact [m], then its rate [m/s].
    """

    def __post_init__(self) -> None:
        if np.ndim(self.positions) != 2 or np.shape(self.positions) != np.shape(self.velocities):
            shapes = f"{np.shape(self.positions)} and {np.shape(self.velocities)}"
            raise ParameterError(f"positions and velocities have shapes {shapes}; allowed: both (lanes, 2n)")

    @classmethod
    def at_rest(cls, lanes: int, cells: int) -> Self:
        """Undeformed and still."""
        return cls(np.zeros((lanes, 2 * cells)), np.zeros((lanes, 2 * cells)))

    def normal_state(self, cells: int) -> tuple[FloatArray, FloatArray]:
        """Give g_N [m] and its rate [m/s], shape (lanes, n), where contacts open; closed and still at a fresh start."""
        lanes = self.positions.shape[0]
        internal_state = np.zeros((lanes, 2 * cells)) if self.internal_state is None else self.internal_state
        if internal_state.shape != (lanes, 2 * cells):
            raise ParameterError(
                f"the internal state has the shape {internal_state.shape}; allowed: {(lanes, 2 * cells)}"
            )
        return internal_state[:, :cells].copy(), internal_state[:, cells:].copy()

    @classmethod
    def stack(cls, states: Sequence[Self]) -> Self:
        """Join batches along their lanes; those without internal state among others that have one get zeros."""
        widths = {state.internal_state.shape[1] for state in states if state.internal_state is not None}
        joined = [
            np.zeros((state.positions.shape[0], width)) if state.internal_state is None else state.internal_state
            for width in widths
            for state in states
        ]
        return cls(
            np.concatenate([state.positions for state in states]),
            np.concatenate([state.velocities for state in states]),
            np.concatenate(joined) if joined else None,
        )

    def check_fits(self, lanes: int, freedoms: int) -> None:
        """Raise a `ParameterError` unless this is a state of so many lanes, of chains of half as many cells."""
        if self.positions.shape != (lanes, freedoms):
            raise ParameterError(f"the state has the shape {self.positions.shape}; allowed: {(lanes, freedoms)}")

    def subset(self, lanes: Sequence[int] | NDArray[np.intp]) -> "State":
        """Give the lanes of these indices."""
        internal_state = None if self.internal_state is None else self.internal_state[lanes]
        return State(self.positions[lanes], self.velocities[lanes], internal_state)


@dataclass(frozen=True)
class Trajectory:
    """The motion of one lane over consecutive steps.

    Row k belongs to the end of step k: the initial state is not repeated, so that the rows of
    consecutive runs join without overlap and one period of N steps has exactly N samples.
    """

    time: FloatArray
    """Ends of the steps [s], shape (steps,)."""
    positions: FloatArray
    """Absolute [m], shape (steps, 2n), outer masses first."""
    velocities: FloatArray
    """Absolute [m/s], likewise."""
    friction: FloatArray
    """λ_T during the step that ends at each row, as it acts on the inner mass [N], shape (steps, n)."""
    normal_force: FloatArray
    """λ_N during the step [N], shape (steps, n)."""
    internal_state: FloatArray | None = None
    """Internal state of the friction law at the end, shape (k,), or ``None``."""
    normal_gap: FloatArray | None = None
    """g_N [m] at the end of each step, shape (steps, n); ``None`` where contacts cannot open."""
    friction_coefficient: FloatArray | None = None
    """μ of every contact, shape (n,), by which stick and slip are read; ``None`` of an engine, whose lane has it."""
    changes: Sequence[Any] | None = None
    """Transitions at their exact times, of a motion that was followed from event to event."""
    slip: FloatArray | None = None
    """ġ_T of every contact [m/s], shape (steps, c), of bodies that are no chain; else it is v̇_i − u̇_i."""

    @property
    def cells(self) -> int:
        """Number of cells n."""
        return self.friction.shape[1]

    @property
    def steps(self) -> int:
        """Number of steps."""
        return self.time.shape[0]

    @property
    def end(self) -> State:
        """State at the last row, as a batch of one lane; the next run starts from it."""
        internal_state = None if self.internal_state is None else self.internal_state[None, :]
        return State(self.positions[-1:], self.velocities[-1:], internal_state)

    @property
    def outer_positions(self) -> FloatArray:
        """u_i [m], shape (steps, n)."""
        return self.positions[:, : self.cells]

    @property
    def inner_positions(self) -> FloatArray:
        """v_i [m], shape (steps, n)."""
        return self.positions[:, self.cells :]

    @property
    def relative_velocity(self) -> FloatArray:
        """ġ_T [m/s], shape (steps, n)."""
        if self.slip is not None:
            return self.slip
        return self.velocities[:, self.cells :] - self.velocities[:, : self.cells]
