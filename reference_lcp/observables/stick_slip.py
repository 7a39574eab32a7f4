"""Stick and slip: modes, transitions and stuck fraction of every contact over one period, which is cyclic."""

from collections.abc import Sequence
from enum import StrEnum
from typing import TYPE_CHECKING, Any, NamedTuple, Protocol, TypeAlias

import numpy as np
from numpy.typing import NDArray

from reference_lcp.chain.trajectory import Trajectory
from reference_lcp.errors import ParameterError, shown
from reference_lcp.validation import FloatArray, checked_scalar

if TYPE_CHECKING:
    from reference_lcp.chain.simulation import PeriodicOrbit

STICK_MARGIN = 1e-6
"""A contact sticks while |λ_T| < (1 − STICK_MARGIN) μ λ_N: far above the round-off with which engines hold the force at
its bound, far below any stick that matters. A law that only tends to the bound is read with a wider margin."""

SHORTEST_STICK = 2
"""Steps that a stick lasts at least: where the slip turns round, the scheme ends the step in between at rest."""

UNREPEATED_SLIP = 4
"""A slip travels farther than this many residuals of its orbit; a shorter one, which need not come again, is a stick.

Over a period that repeats to the residual r, the two masses of a cell come back to within 2 r of each other.
"""

IMPACT_STEPS = 2
"""Steps over which a scheme spreads the impact of a landing, which holds a contact for no time: they count to what
follows. In the first, equation (7) lets the gap close at the end of the step; in the second it takes the velocity."""

OPEN = 1e-9
"""A contact is open while λ_N is at most this part of its mean: far above round-off, far below any preload."""

MATCHING_WINDOW = 0.02
"""Largest distance of two matching transitions over the period: eight steps of 400.

Far more than the scheme's error of a step or two, far less than what separates two of one kind in figure 3.
"""

TimedTransition = tuple[int, float, str]
"""A `Transition` as results hold it."""


class Mode(StrEnum):
    """The three cases of Coulomb's law, equation (1)."""

    STICK = "stick"
    FORWARD = "forward slip"
    BACKWARD = "backward slip"


MODE_OF_SIGN = {0: Mode.STICK, 1: Mode.FORWARD, -1: Mode.BACKWARD}


class Transition(NamedTuple):
    """A change of the mode of one contact."""

    cell: int
    """From 1."""
    time: float
    """When the new mode begins [s], from the start of the period."""
    kind: Mode
    """The new mode."""


class Steady(Protocol):
    """A steady state."""

    @property
    def orbit(self) -> "PeriodicOrbit":
        """One period."""


AnyMotion: TypeAlias = "PeriodicOrbit | Trajectory | Steady"


def contact_modes(motion: AnyMotion, stick_margin: float = STICK_MARGIN) -> NDArray[np.int8]:
    """Mode of every contact in every step: −1 backward slip, 0 stick, +1 forward slip; shape (steps, n).

    The force decides (equation 1): a stick leaves `stick_margin`, in (0, 1), of the bound at least. A contact without
    friction, or an open one, never sticks; the sign of its relative velocity gives its direction. Of bodies, which
    may have static friction, a contact sticks too where its relative velocity is zero.
    """
    motion = _motion_of(motion)
    orbit, trajectory = (None, motion) if isinstance(motion, Trajectory) else (motion, motion.trajectory)
    coefficient, rubbing = _friction_of(motion)
    bound, slip = (coefficient * trajectory.normal_force).T, trajectory.relative_velocity.T
    direction = np.where(bound > 0, -trajectory.friction.T, slip)
    rows = (direction > 0).astype(np.int8) - (direction < 0)
    rows[np.abs(trajectory.friction.T) < (1 - stick_margin) * bound] = 0
    if trajectory.slip is not None:
        rows[(slip == 0) & (bound > 0)] = 0
    if orbit is not None and orbit.lane.preload is not None:
        for row, opened in zip(rows, _open(orbit).T, strict=True):
            for landing in np.flatnonzero(~opened & np.roll(opened, 1)):
                impact = np.arange(landing, landing + IMPACT_STEPS) % row.size
                row[impact] = row[(landing + IMPACT_STEPS) % row.size]
    for row in rows:
        _drop_short_sticks(row, cyclic=orbit is not None)
    if orbit is not None:
        shortest = UNREPEATED_SLIP * orbit.residual * orbit.lane.drive.displacement_scale(orbit.lane.chain)
        for contact in np.flatnonzero(rubbing):
            _drop_short_slips(rows[contact], slip[contact] * orbit.lane.time_step, shortest)
    return rows.T


def _motion_of(motion: AnyMotion) -> "PeriodicOrbit | Trajectory":
    """Give the period of a steady state, and a motion as it is."""
    own: Any = getattr(motion, "orbit", motion)
    if not isinstance(own, Trajectory) and not hasattr(own, "trajectory"):
        raise ParameterError(f"{shown(motion)} is no motion; allowed: a steady state, an orbit or a trajectory")
    found: PeriodicOrbit | Trajectory = own
    return found


def _friction_of(motion: "PeriodicOrbit | Trajectory") -> tuple[FloatArray, NDArray[np.bool_]]:
    """Coefficients of friction, and which contacts have any."""
    if not isinstance(motion, Trajectory):
        return motion.lane.chain.friction_coefficient, motion.lane.chain.friction_bound > 0
    coefficient = motion.friction_coefficient
    if coefficient is None:
        raise ParameterError(
            "a trajectory without friction_coefficient has no modes; allowed: an orbit, or one with it: "
            "dataclasses.replace(trajectory, friction_coefficient=chain.friction_coefficient)"
        )
    return coefficient, (coefficient > 0) & np.any(motion.normal_force > 0, axis=0)


def _phases(
    row: NDArray[np.int8], *, cyclic: bool = True
) -> tuple[NDArray[np.intp], NDArray[np.intp], NDArray[np.int8]]:
    """First steps of the uninterrupted modes of a motion or a cycle, their numbers of steps, and the modes."""
    begins = row != np.roll(row, 1)
    begins[0] |= not cyclic
    starts = np.flatnonzero(begins)
    return starts, np.diff(starts, append=starts[:1] + row.size), row[starts]


def _drop_short_sticks(row: NDArray[np.int8], *, cyclic: bool) -> None:
    """Turn sticks of fewer than `SHORTEST_STICK` steps into the slip that follows, in place."""
    starts, lengths, modes = _phases(row, cyclic=cyclic)
    if starts.size:
        following = np.append(modes[1:], modes[0] if cyclic else modes[-1])
        modes = np.where((modes == 0) & (lengths < SHORTEST_STICK), following, modes)
        row[:] = np.roll(np.repeat(modes, lengths), starts[0])


def _drop_short_slips(row: NDArray[np.int8], way: FloatArray, shortest: float) -> None:
    """Turn slips of a cycle into stick that travel less than `shortest` [m], in place; `way` [m] is of every step."""
    starts, lengths, modes = _phases(row)
    if starts.size:
        modes = np.where(np.abs(_travelled(way, starts)) < shortest, 0, modes)
        row[:] = np.roll(np.repeat(modes, lengths), starts[0])


def _travelled(way: FloatArray, starts: NDArray[np.intp]) -> FloatArray:
    """Add up the way [m] of the steps of each phase of a cycle; there is one at least."""
    distances: FloatArray = np.add.reduceat(np.roll(way, -starts[0]), starts - starts[0])
    return distances


def transitions(motion: AnyMotion, stick_margin: float = STICK_MARGIN) -> list[Transition]:
    """Changes of mode over a motion, by contact and then by time.

    A motion that was followed from event to event has their exact times; of others they are those of steps. A period
    is cyclic: a mode that begins with its first step is a transition at time zero if the last step had another one.
    Contacts without friction have none.

    Parameters
    ----------
    motion
        A steady state, an orbit, or the trajectory of `simulate`, `simulate_system` or `EventDrivenSystem.motion`.
    stick_margin
        As in `contact_modes`.

    Raises
    ------
    ParameterError
        If it is no motion, or a trajectory that does not say its coefficients of friction.
    """
    known = motion.changes if isinstance(motion, Trajectory) else getattr(motion, "transitions", None)
    if known is not None:
        return list(known)
    return transitions_between(contact_modes(motion, stick_margin), _motion_of(motion))


def transitions_between(modes: NDArray[np.int8], motion: "PeriodicOrbit | Trajectory") -> list[Transition]:
    """Changes between the modes of a motion, see `transitions` and `contact_modes`."""
    _, rubbing = _friction_of(motion)
    if isinstance(motion, Trajectory):
        return mode_changes(modes, np.append(motion.time[:1], motion.time[:-1]), rubbing, cyclic=False)
    return mode_changes(modes, motion.lane.time_step * np.arange(len(modes)), rubbing, cyclic=True)


def travels_between(modes: NDArray[np.int8], orbit: "PeriodicOrbit") -> FloatArray:
    """Distances [m] that contacts slip in the phases that `transitions_between` begin; zero where they stick."""
    _, rubbing = _friction_of(orbit)
    ways = np.where(modes == 0, 0.0, np.abs(orbit.trajectory.relative_velocity) * orbit.lane.time_step)
    travelled = [np.zeros(0)]
    for cell in np.flatnonzero(rubbing):
        starts, _, _ = _phases(modes[:, cell])
        if starts.size:
            travelled.append(_travelled(ways[:, cell], starts))
    return np.concatenate(travelled)


def mode_changes(
    modes: NDArray[np.int8], starts: NDArray[np.floating], rubs: NDArray[np.bool_], *, cyclic: bool
) -> list[Transition]:
    """Changes from one row of `modes` (rows, n), which begin at `starts` [s], to the next; of contacts that rub."""
    rows = np.ascontiguousarray(modes.T)
    changed = rows != np.roll(rows, 1, axis=1)
    changed[~rubs] = False
    if not cyclic:
        changed[:, 0] = False
    cells, steps = np.nonzero(changed)
    changes = zip((cells + 1).tolist(), starts[steps].tolist(), rows[cells, steps].tolist(), strict=True)
    return [Transition(cell, time, MODE_OF_SIGN[sign]) for cell, time, sign in changes]


def stuck_fraction(motion: AnyMotion, stick_margin: float = STICK_MARGIN) -> FloatArray:
    """Part of the steps in which each contact sticks, shape (n,).

    A contact sticks in a step whose friction leaves `stick_margin`, in (0, 1), of the friction limit at least.
    """
    return np.mean(contact_modes(motion, stick_margin) == 0, axis=0)


def open_fraction(orbit: "PeriodicOrbit") -> FloatArray:
    """Part of the period that each contact is open, shape (n,); none is where there is nothing to press it."""
    return np.mean(_open(orbit), axis=0)


def largest_gap(orbit: "PeriodicOrbit") -> FloatArray:
    """Largest g_N of each contact over the period [m], shape (n,); zero where contacts cannot open."""
    gap = orbit.trajectory.normal_gap
    return np.zeros(orbit.trajectory.cells) if gap is None else np.max(gap, axis=0)


def creep_velocity(orbit: "PeriodicOrbit", stick_margin: float = STICK_MARGIN) -> FloatArray:
    """Largest |ġ_T| of each contact while it sticks [m/s], shape (n,); zero if it never does."""
    stuck = contact_modes(orbit, stick_margin) == 0
    inside = stuck & np.roll(stuck, 1, axis=0) & np.roll(stuck, -1, axis=0)
    return np.max(np.abs(orbit.trajectory.relative_velocity), axis=0, where=inside, initial=0.0)


def dissipated_energy(orbit: "PeriodicOrbit") -> FloatArray:
    """Energy that each contact turns into heat over one period [J], shape (n,): −Σ λ_T ġ_T Δt."""
    power = orbit.trajectory.friction * orbit.trajectory.relative_velocity
    return -np.sum(power, axis=0) * orbit.lane.time_step


def _open(orbit: "PeriodicOrbit") -> NDArray[np.bool_]:
    """Say in which steps which contacts are open, shape (steps, n)."""
    mean = orbit.lane.chain.normal_force
    return (orbit.trajectory.normal_force <= OPEN * mean) & (mean > 0)


class TransitionMatch(NamedTuple):
    """How the transitions of one simulation fit to those of another."""

    errors: dict[TimedTransition, float]
    """Time of the observed transition less that of the expected one, over the period, by the expected
    one; those that were not observed within `MATCHING_WINDOW` are left out."""
    spurious: list[TimedTransition]
    """Observed transitions that were not expected."""


def match_transitions(
    observed: Sequence[TimedTransition], expected: Sequence[TimedTransition], period: float
) -> TransitionMatch:
    """Pair transitions of the same cell to the same mode, one to one, the closest in cyclic time first."""
    checked_scalar("period", period, "> 0")
    of_kind: dict[tuple[int, str], list[tuple[float, int]]] = {}
    for f, (cell, time, kind) in enumerate(observed):
        of_kind.setdefault((cell, kind), []).append((time, f))
    near = [
        (((other_time - time) / period + 0.5) % 1.0 - 0.5, f, e)
        for e, (cell, time, kind) in enumerate(expected)
        for other_time, f in of_kind.get((cell, kind), ())
    ]
    partner: dict[int, float] = {}
    taken: set[int] = set()
    for error, f, e in sorted(near, key=lambda candidate: (abs(candidate[0]), candidate[2], candidate[1])):
        if abs(error) > MATCHING_WINDOW:
            break
        if e not in partner and f not in taken:
            partner[e] = error
            taken.add(f)
    errors = {expected[e]: partner[e] for e in sorted(partner, key=lambda e: expected[e])}
    return TransitionMatch(errors, [transition for f, transition in enumerate(observed) if f not in taken])
