"""One period of a steady state in full, for the few points at which it is drawn."""

from dataclasses import dataclass, field
from typing import Self

import numpy as np
from numpy.typing import NDArray

from multibody_xval.scenarios.runs.result import NamedNumbers, Result, ResultStatus
from reference_lcp.chain.simulation import PeriodicOrbit
from reference_lcp.observables.stick_slip import contact_modes
from reference_lcp.validation import FloatArray

_EMPTY = np.empty((0, 0))

ARRAYS = ("outer", "inner", "friction", "modes")
"""Names of what is recorded, a number a step and cell each."""


@dataclass(frozen=True)
class RecordedPeriod:
    """One period, non-dimensional, or the reason why there is none.

    Row k belongs to the time (k + 1) / steps of the period.
    """

    reason: str = ""
    """Why there is no steady state to be drawn; empty if there is one."""
    outer: FloatArray = field(default_factory=_EMPTY.copy)
    inner: FloatArray = field(default_factory=_EMPTY.copy)
    """Displacements over the displacement scale U0, as those of the outer masses; shape (steps, n)."""
    friction: FloatArray = field(default_factory=_EMPTY.copy)
    """λ_T over the bound μ λ_N of each contact, over k_c U0 where that is zero; shape (steps, n)."""
    modes: NDArray[np.int8] = field(default_factory=lambda: _EMPTY.astype(np.int8))
    """−1 backward slip, 0 stick, +1 forward slip; shape (steps, n)."""

    @property
    def known(self) -> bool:
        """Whether there is a steady state."""
        return not self.reason

    @property
    def relative(self) -> FloatArray:
        """Displacement of the inner mass relative to the outer one, over U0; shape (steps, n)."""
        return self.inner - self.outer

    @classmethod
    def of(cls, orbit: PeriodicOrbit, stick_margin: float) -> Self:
        """Read an orbit; for `stick_margin` see `contact_modes`."""
        chain, trajectory = orbit.lane.chain, orbit.trajectory
        scale = orbit.lane.drive.displacement_scale(chain)
        bound = np.where(chain.friction_bound > 0, chain.friction_bound, chain.chain_stiffness * scale)
        return cls(
            outer=trajectory.outer_positions / scale,
            inner=trajectory.inner_positions / scale,
            friction=trajectory.friction / bound,
            modes=contact_modes(orbit, stick_margin),
        )

    @classmethod
    def of_result(cls, result: Result) -> Self:
        """Read the result of a task that records it."""
        if result.status in (ResultStatus.BLOCKED, ResultStatus.MISSING):
            return cls(result.reason)
        if not result.converged:
            return cls(f"{result.status} after {result.periods} periods, residual {result.residual:.1e}")
        shape = result.steps_per_period, -1
        outer, inner, friction, modes = (np.reshape(result.series[name], shape) for name in ARRAYS)
        return cls("", outer, inner, friction, modes.astype(np.int8))

    def to_series(self) -> NamedNumbers:
        """Give the arrays as numbers by name, row after row."""
        return {name: tuple(getattr(self, name).ravel().tolist()) for name in ARRAYS}
