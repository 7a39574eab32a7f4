"""Mutants that are right at the usual places, and wrong elsewhere in the ranges or after long use."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from multibody_xval.engines.shared.wide_range import LONG_USE, MANY_RUNS
from reference_lcp.chain.mass_in_mass import Chain
from reference_lcp.chain.simulation import Lane, Simulation
from reference_lcp.chain.trajectory import State, Trajectory
from reference_lcp.validation import FloatArray
from tests.mutations.altered import Built, of_chains, of_lanes
from tests.mutations.errors import AlteredDrive, with_bound
from tests.mutations.mutant import Mutant, Original

HIGH_COEFFICIENT, LOW_FREQUENCY, HIGH_DAMPING, MANY_STEPS = 0.8, 0.3, 0.1, 900
"""Friction coefficient, η_r, ζ and steps a period up to which, or from which on, they are right."""


@dataclass(frozen=True)
class _SingleClock(AlteredDrive):
    """A drive whose clock has single precision."""

    def load(self, chain: Chain, time: FloatArray) -> FloatArray:
        return self.drive.load(chain, time.astype(np.float32).astype(np.float64))


def _with_single_clock(lane: Lane, size: float) -> Lane:
    return replace(lane, drive=_SingleClock(lane.drive)) if size else lane


def _rounded(chain: Chain, size: float) -> FloatArray:
    given = chain.friction_coefficient
    return given + size * (np.rint(4 * given) / 4 - given)


def _high(chain: Chain, size: float) -> FloatArray:
    return chain.friction_coefficient * np.where(chain.friction_coefficient > HIGH_COEFFICIENT, 1 + size, 1.0)


def _clipped(damping: str, stiffness: str, mass: str) -> Callable[[Chain, float], FloatArray]:
    """Cut a dashpot off above a damping ratio, by a part s of what is above."""

    def change(chain: Chain, size: float) -> FloatArray:
        largest = 2 * HIGH_DAMPING * np.sqrt(getattr(chain, stiffness) * getattr(chain, mass))
        values = getattr(chain, damping)
        return values - size * np.maximum(values - largest, 0.0)

    return change


def _where(wrong: Callable[[Lane, float], bool]) -> Built:
    """Build the bound of friction × (1 + s) in periodic lanes of some frequencies ω / ω_r or steps a period."""

    def change(lane: Lane, size: float) -> Lane:
        omega = getattr(lane.drive, "angular_frequency", None)
        return lane if omega is None or not wrong(lane, omega) else with_bound(lane, 1 + size)

    return of_lanes(change)


@dataclass
class _Used:
    """A simulation that others of the same lanes take over from, or that spoils what it is given."""

    simulation: Simulation
    size: float
    later: Simulation
    """Takes over after `LONG_USE` steps."""
    leaks: bool = False
    """After `MANY_RUNS` runs, a part of the last end is in every start."""
    short: bool = False
    """`advance` stops a step before its end."""
    runs: int = 0
    last: dict[str, State] = field(default_factory=dict)

    @property
    def lanes(self) -> tuple[Lane, ...]:
        return self.simulation.lanes

    def _at(self, start: int) -> Simulation:
        return self.later if start >= LONG_USE else self.simulation

    def _start(self, state: State) -> State:
        self.runs += 1
        left = self.last.get("end")
        if not self.leaks or self.runs <= MANY_RUNS or left is None or left.positions.shape != state.positions.shape:
            return state
        return replace(state, positions=state.positions + self.size * left.positions)

    def run(self, state: State, start: int, steps: int) -> list[Trajectory]:
        runs = self._at(start).run(self._start(state), start, steps)
        self.last["end"] = State.stack([run.end for run in runs])
        return runs

    def advance(self, state: State, start: int, steps: int) -> State:
        taken = max(1, steps - 1) if self.short and self.size else steps
        self.last["end"] = self._at(start).advance(self._start(state), start, taken)
        return self.last["end"]

    def subset(self, lanes: Sequence[int] | NDArray[np.intp]) -> "_Used":
        return replace(self, simulation=self.simulation.subset(lanes), later=self.later.subset(lanes), last={})

    def close(self) -> None:
        self.simulation.close()
        self.later.close()


def _used(*, wrong_later: bool = False, **errors: Any) -> Built:
    def build(original: Original, lanes: tuple[Lane, ...], size: float) -> _Used:
        later = [with_bound(lane, 1 + size) if wrong_later else lane for lane in lanes]
        return _Used(original.build(lanes), size, original.build(later), **errors)

    return build


RANGES = (
    Mutant(
        name="coefficient-quarters",
        error="μ, s of the way to the next quarter",
        build=of_chains(friction_coefficient=_rounded),
    ),
    Mutant(
        name="coefficient-high",
        error=f"bound × (1 + s) where μ > {HIGH_COEFFICIENT}",
        build=of_chains(friction_coefficient=_high),
    ),
    Mutant(
        name="drive-slow",
        error=f"bound × (1 + s) where η_r < {LOW_FREQUENCY}",
        build=_where(lambda lane, omega: omega < LOW_FREQUENCY * lane.chain.resonator_frequency),
    ),
    Mutant(
        name="dashpots-cut",
        error=f"ζ above {HIGH_DAMPING}, s of the way back to it",
        build=of_chains(
            chain_damping=_clipped("chain_damping", "chain_stiffness", "outer_mass"),
            inner_damping=_clipped("inner_damping", "inner_stiffness", "inner_mass"),
        ),
    ),
    Mutant(
        name="steps-many",
        error=f"bound × (1 + s) with more than {MANY_STEPS} steps a period",
        build=_where(lambda lane, omega: 2 * np.pi / omega > (MANY_STEPS + 0.5) * lane.time_step),
    ),
    Mutant(name="clock-single", error="a clock in single precision", build=of_lanes(_with_single_clock)),
    Mutant(name="advance-short", error="`advance` is one step short", build=_used(short=True)),
    Mutant(
        name="start-leaks",
        error=f"after {MANY_RUNS} runs, s of the last end in every start",
        build=_used(leaks=True),
    ),
    Mutant(
        name="steps-late",
        error=f"bound × (1 + s) after {LONG_USE} steps",
        build=_used(wrong_later=True),
    ),
)
