"""The contract between whatever advances chains in time and whatever reads the motion."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum
from typing import Protocol, Self, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from reference_lcp.chain.drives import Drive, PeriodicDrive
from reference_lcp.chain.mass_in_mass import Chain
from reference_lcp.chain.preload import Preload
from reference_lcp.chain.trajectory import State, Trajectory
from reference_lcp.defaults import FEWEST_STEPS_PER_PERIOD, LARGEST_PHASE_STEP, MINIMUM_STEPS_PER_PERIOD
from reference_lcp.errors import ParameterError
from reference_lcp.validation import MOST_STEPS, FloatArray, check_record_size, checked_count, checked_scalar


@dataclass(frozen=True)
class Lane:
    """One chain under one drive, advanced with one time step."""

    chain: Chain
    drive: Drive
    time_step: float
    """dt [s], > 0."""
    preload: Preload | None = None
    """How the normal force changes in time; ``None`` where it is constant."""
    static_ratio: float = 1.0
    """μ_s / μ_k >= 1 of all contacts, with the chain's coefficient of friction as μ_k."""

    def __post_init__(self) -> None:
        object.__setattr__(self, "time_step", checked_scalar("time_step", self.time_step, "> 0"))
        if checked_scalar("static_ratio", self.static_ratio) < 1:
            raise ParameterError(f"static_ratio = {self.static_ratio:g}; allowed: >= 1")

    @classmethod
    def periodic(
        cls,
        chain: Chain,
        drive: PeriodicDrive,
        steps_per_period: int,
        preload: Preload | None = None,
    ) -> Self:
        """Divide the period of the drive into `steps_per_period` steps."""
        checked_count("steps_per_period", steps_per_period, FEWEST_STEPS_PER_PERIOD, MOST_STEPS)
        return cls(chain, drive, drive.period / steps_per_period, preload)

    @property
    def one_coefficient(self) -> bool:
        """Whether friction at rest is that of motion: then friction is monotone."""
        return self.static_ratio == 1 and self.chain.one_coefficient

    @property
    def opens(self) -> bool:
        """Whether contacts can open; then a state carries the gaps, see `State.normal_state`."""
        return self.preload is not None and self.preload.opens

    def preloads(self, start: int, steps: int) -> FloatArray:
        """N at the *start* of each step [N], negative where contacts are pulled open, shape (steps, n).

        Where contacts stay closed this is λ_N.
        """
        mean = self.chain.normal_force
        if self.preload is None:
            return np.broadcast_to(mean, (steps, self.chain.cells))
        time = self.time_step * np.arange(start, start + steps, dtype=np.float64)
        return self.preload.factor(time)[:, None] * mean

    def loads(self, start: int, steps: int) -> FloatArray:
        """Force on cell 1 at the *start* of each step [N], shape (steps,), as equation (5) takes h."""
        return self.drive.load(self.chain, self.time_step * np.arange(start, start + steps, dtype=np.float64))

    def times(self, start: int, steps: int) -> FloatArray:
        """Ends of the steps [s], shape (steps,)."""
        return self.time_step * np.arange(start + 1, start + steps + 1, dtype=np.float64)


def steps_per_period_for(chain: Chain, drive: PeriodicDrive, minimum: int = MINIMUM_STEPS_PER_PERIOD) -> int:
    """Give the number of steps a period that keeps dt ω_max <= 0.4, at least `minimum`, at most what a record holds."""
    checked_count("steps_per_period", minimum, FEWEST_STEPS_PER_PERIOD, MOST_STEPS)
    stable = drive.period * chain.highest_natural_frequency / LARGEST_PHASE_STEP
    if stable > MOST_STEPS:
        fastest = f"a natural frequency of {chain.highest_natural_frequency:.4g} rad/s"
        slow = f"a period of {drive.period:.4g} s with {fastest}"
        other = f"as with a frequency {stable / MOST_STEPS:.3g} times as high, or masses and springs that differ less"
        raise ParameterError(f"{slow} needs {stable:.3g} steps; allowed: <= {MOST_STEPS}, {other}")
    steps = max(minimum, math.ceil(stable))
    check_record_size(chain.freedoms // 2, steps)
    return steps


def check_one_coefficient(lanes: Sequence[Lane], name: str) -> None:
    """Raise a `ParameterError` if static friction of a lane is above kinetic friction; `name` has no such."""
    for lane in lanes:
        if lane.static_ratio != 1:
            raise ParameterError(f"static_ratio = {lane.static_ratio:g}: {name} has one coefficient; allowed: 1")


@runtime_checkable
class Simulation(Protocol):
    """A batch of lanes that an engine has built and can advance.

    There is no hidden state: what a run does follows from the state that goes in, so that two runs
    of 100 steps equal one of 200.
    """

    lanes: tuple[Lane, ...]

    def run(self, state: State, start: int, steps: int) -> list[Trajectory]:
        """Advance every lane from `state` at step index `start`; give one trajectory a lane."""
        ...

    def advance(self, state: State, start: int, steps: int) -> State:
        """Advance every lane as `run` does, but give the final state only."""
        ...

    def subset(self, lanes: Sequence[int] | NDArray[np.intp]) -> "Simulation":
        """Give a simulation of the lanes of these indices."""
        ...

    def close(self) -> None:
        """Free what the engine holds; the simulation is not used afterwards."""
        ...


def common_cells(lanes: Sequence[Lane]) -> int:
    """Give the number of cells that all lanes, one at least, share."""
    lengths = {lane.chain.freedoms // 2 for lane in lanes}
    if len(lengths) != 1:
        raise ParameterError(f"a batch holds chains of {sorted(lengths)} cells; allowed: one length, at least one lane")
    return lengths.pop()


class OrbitStatus(StrEnum):
    """How the search for a periodic orbit ended."""

    CONVERGED = "converged"
    PERIOD_LIMIT = "period limit"
    DIVERGED = "diverged"


@dataclass(frozen=True)
class PeriodicOrbit:
    """One period of the steady state of one lane."""

    lane: Lane
    """The chain, its drive and the time step."""
    trajectory: Trajectory
    """One period, one row a step, starting at phase zero of the drive."""
    residual: float
    """max(|Δ position| / s, |Δ velocity| / (s ω), |Δ internal state| / its size) over one plain period.

    s is the displacement scale of the drive and ω its angular frequency; for the size see `StateScales`.
    """
    periods: int
    """Periods that were simulated to find it, the certifying one included."""
    status: OrbitStatus
    """Whether the tolerance has been reached."""
    multiple: int = 1
    """Periods of the drive after which the motion repeats, if the search has looked for it.

    More than one for a subharmonic response, 0 where no repetition was found.
    """
    reason: str = ""
    """Whether it attracts, of a chain with a cell without dashpot, see `reference_lcp.steady.attraction`."""

    @property
    def converged(self) -> bool:
        """Whether the tolerance has been reached."""
        return self.status is OrbitStatus.CONVERGED
