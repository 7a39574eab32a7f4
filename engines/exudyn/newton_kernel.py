"""The compiled steps of Exudyn's own Newton iteration, in which the path decides between several solutions of a step.

The iteration keeps the matrix of earlier steps while it contracts. A step in which it fails is taken again, in halves;
they begin with the matrix, and with the algorithmic accelerations, that the failed one has left.

`chain`, shape (3, 2n, 2n), holds the matrices M, C and K; `numbers`, shape (2, n), μ λ_N and the widths of the zones
[m/s]; `limits` the relative and the absolute tolerance [N], the smallest velocity that differences are taken from
[m/s], the error [N] at which a disc is corrected no more, and the smallest substep, over h. `newton`, shape
(2n + 2, 2n), is kept from one iteration to the next: the inverse of the matrix, and in two more rows the rates of
friction in it, [0, :2n], and the speed per place times the scale of its step, [1, 0]. `flags` say whether the matrix
has to be made anew, and whether the last iteration has begun again.
"""

from typing import Any

import numba
import numpy as np

from multibody_xval.engines.exudyn.step_kernel import keep, zone_friction
from multibody_xval.engines.exudyn.step_model import DISC_CORRECTIONS

ITERATIONS = 25
"""Exudyn's newton.maxIterations: one that needs more has failed."""

WITH_ONE_MATRIX, BEFORE_EVERY_MATRIX = 8, 15
"""Iterations after which the next one has a new matrix, and after which every one has: Exudyn's
newton.maxModifiedNewtonIterations, and with maxModifiedNewtonRestartIterations."""

CONTRACTION, DIVERGENCE = 0.5, 2.0
"""Residual over the last one from which the matrix is made anew, Exudyn's newton.modifiedNewtonContractivity, and from
which the iteration begins again."""

DIFFERENCE = 1e-7
"""Of a velocity, by which friction is differentiated: Exudyn's numericalDifferentiation.relativeEpsilon."""

RECOVERY_STEPS, RECOVERY_ITERATIONS = 10, 7
"""Halved steps, the last of so few iterations and corrections, after which steps are doubled: Exudyn's
adaptiveStepRecoverySteps and adaptiveStepRecoveryIterations."""

ROUND_OFF = 1e-9
"""Of a step, by which the end of a run, and of what sensors wait for, may be missed."""


@numba.njit(cache=True, error_model="numpy", forceinline=True)
def friction_at(slip: Any, last: Any, bound: Any, zone: Any, parabolic: Any) -> Any:
    """Give φ of a connector; or of a disc, which is in its zone by the slip velocity of the last correction."""
    if not parabolic:
        return zone_friction(slip, bound, zone)
    part = slip / zone
    if last == 0 or slip == 0:
        return 0.0
    return bound * part * (2 - abs(part)) if abs(last) <= zone else bound * np.sign(last)


@numba.njit(cache=True, error_model="numpy", forceinline=True)
def frictions(slip: Any, last: Any, numbers: Any, parabolic: Any) -> Any:
    """Give φ of all contacts."""
    friction = np.empty(slip.size)
    for i in range(slip.size):
        friction[i] = friction_at(slip[i], last[i], numbers[0, i], numbers[1, i], parabolic)
    return friction


@numba.njit(cache=True, error_model="numpy", forceinline=True)
def _squares(values: Any) -> Any:
    """Give the sum of the squares."""
    total = 0.0
    for value in values:
        total += value * value
    return total


@numba.njit(cache=True, error_model="numpy", forceinline=True)
def _copy(values: Any, place: Any) -> None:
    """Copy a row."""
    for i in range(values.size):
        place[i] = values[i]


@numba.njit(cache=True, error_model="numpy", forceinline=True)
def _evaluate(
    motion: Any, chain: Any, load: Any, last: Any, numbers: Any, parabolic: Any, residual: Any, friction: Any
) -> Any:
    """Give the residual of the equations of motion, friction, and the sum of the squares of the first."""
    cells = last.size
    for i in range(2 * cells):
        residual[i] = 0.0
        for j in range(2 * cells):
            residual[i] += chain[0, i, j] * motion[2, j] + chain[1, i, j] * motion[1, j] + chain[2, i, j] * motion[0, j]
    residual[0] -= load
    for i in range(cells):
        slip = motion[1, cells + i] - motion[1, i]
        friction[i] = friction_at(slip, last[i], numbers[0, i], numbers[1, i], parabolic)
        residual[i] -= friction[i]
        residual[cells + i] += friction[i]
    return _squares(residual)


@numba.njit(cache=True, error_model="numpy")
def _make_matrix(
    velocity: Any,
    friction: Any,
    chain: Any,
    sizes: Any,
    last: Any,
    numbers: Any,
    limits: Any,
    parabolic: Any,
    newton: Any,
) -> None:
    """Make the matrix anew, with friction differentiated as Exudyn does, by one velocity at a time."""
    cells = last.size
    scale, speed, acceleration = sizes
    matrix = np.empty((2 * cells, 2 * cells))
    for i in range(2 * cells):
        for j in range(2 * cells):
            matrix[i, j] = scale * (acceleration * chain[0, i, j] + speed * chain[1, i, j] + chain[2, i, j])
    for i in range(cells):
        for mass in (i, cells + i):
            kept, change = velocity[mass], DIFFERENCE * max(abs(velocity[mass]), limits[2])
            velocity[mass] = kept + change
            slip = velocity[cells + i] - velocity[i]
            velocity[mass] = kept
            moved = friction_at(slip, last[i], numbers[0, i], numbers[1, i], parabolic)
            rate = (moved - friction[i]) / change
            matrix[i, mass] -= scale * speed * rate
            matrix[cells + i, mass] += scale * speed * rate
            newton[2 * cells, mass] = rate
    newton[2 * cells + 1, 0] = scale * speed
    inverse = np.linalg.inv(matrix)
    for i in range(2 * cells):
        _copy(inverse[i], newton[i])


@numba.njit(cache=True, error_model="numpy", forceinline=True)
def _turning(friction: Any, before: Any, change: Any, scale: Any, newton: Any) -> Any:
    """Give the sum of the squares of the residuals of the discs' rotation, which friction acts on, too."""
    cells, total = friction.size, 0.0
    for i in range(cells):
        predicted = newton[2 * cells, i] * change[i] + newton[2 * cells, cells + i] * change[cells + i]
        total += (friction[i] - before[i] + newton[2 * cells + 1, 0] / scale * predicted) ** 2
    return total


@numba.njit(cache=True, error_model="numpy")
def _iterate(
    motion: Any,
    begin: Any,
    chain: Any,
    load: Any,
    sizes: Any,
    last: Any,
    numbers: Any,
    limits: Any,
    parabolic: Any,
    newton: Any,
    flags: Any,
) -> Any:
    """Find the end of a step from `motion`, in place, and from `begin` where that has to begin again.

    Gives the number of iterations, 0 where they fail.
    """
    scale, speed, acceleration = sizes
    residual, change = np.empty(begin.shape[1]), np.empty(begin.shape[1])
    friction, before = np.empty(last.size), np.empty(last.size)
    first = _evaluate(motion, chain, load, last, numbers, parabolic, residual, friction)
    first = max(np.sqrt(first + parabolic * _squares(friction)), 2 * limits[1])
    previous, every, flags[1] = first, False, False
    for count in range(1, ITERATIONS + 1):
        if flags[0] or every:
            _make_matrix(motion[1], friction, chain, sizes, last, numbers, limits, parabolic, newton)
            flags[0] = False
        for i in range(change.size):
            change[i] = 0.0
            for j in range(change.size):
                change[i] += newton[i, j] * (scale * residual[j])
            motion[0, i] -= change[i]
            motion[1, i] -= speed * change[i]
            motion[2, i] -= acceleration * change[i]
        _copy(friction, before)
        size = _evaluate(motion, chain, load, last, numbers, parabolic, residual, friction)
        size = np.sqrt(size + parabolic * _turning(friction, before, change, scale, newton))
        if count == 1 and size > first:
            first = previous = size
        if size <= limits[0] * first or size <= limits[1]:
            return count
        contraction, previous = size / previous, size
        flags[0] = flags[0] or (not every and count > WITH_ONE_MATRIX)
        every = every or count > BEFORE_EVERY_MATRIX
        if not every and contraction > CONTRACTION and count > 2:
            flags[0], every = True, flags[1]
            if every or contraction > DIVERGENCE:
                previous, flags[1] = first, True
                _copy(begin.ravel(), motion.ravel())
                _evaluate(motion, chain, load, last, numbers, parabolic, residual, friction)
    return 0


@numba.njit(cache=True, error_model="numpy", forceinline=True)
def _predict(motion: Any, algorithmic: Any, acceleration: Any, length: Any, rule: Any, begin: Any, base: Any) -> None:
    """Give the end of a step without acceleration, and what its algorithmic accelerations are then."""
    beta, gamma = rule[5], rule[6]
    for i in range(base.size):
        before, after = algorithmic[i], rule[2] * algorithmic[i] + rule[3] * acceleration[i]
        begin[0, i] = motion[0, i] + length * motion[1, i] + length * length * ((0.5 - beta) * before + beta * after)
        begin[1, i] = motion[1, i] + length * ((1 - gamma) * before + gamma * after)
        begin[2, i], base[i] = 0.0, after


@numba.njit(cache=True, error_model="numpy", forceinline=True)
def _correct(velocity: Any, last: Any, numbers: Any, parabolic: Any) -> Any:
    """Let discs take the slip velocities that they have; give the largest change of friction, 0 of connectors."""
    error = 0.0
    for i in range(last.size):
        slip = velocity[last.size + i] - velocity[i]
        before = friction_at(slip, last[i], numbers[0, i], numbers[1, i], parabolic)
        last[i] = slip
        error = max(error, abs(friction_at(slip, slip, numbers[0, i], numbers[1, i], parabolic) - before))
    return error


@numba.njit(cache=True, error_model="numpy")
def _take(
    motion: Any,
    begin: Any,
    chain: Any,
    load: Any,
    sizes: Any,
    last: Any,
    numbers: Any,
    limits: Any,
    parabolic: Any,
    newton: Any,
    flags: Any,
) -> Any:
    """Find the end of a step, as `_iterate`, and correct discs there.

    Gives the iterations of the last correction, 0 where they fail; how many corrections; and whether anything has begun
    from `begin`.
    """
    iterations, corrections, begun_again, error = 1, 0, False, np.inf
    while iterations > 0 and error > limits[3] and corrections < DISC_CORRECTIONS:
        if corrections > 0:
            _copy(begin.ravel(), motion.ravel())
        iterations = _iterate(motion, begin, chain, load, sizes, last, numbers, limits, parabolic, newton, flags)
        begun_again = begun_again or flags[1] or corrections > 0
        if iterations > 0:
            error = _correct(motion[1], last, numbers, parabolic)
        corrections += 1
    return iterations, corrections, begun_again


@numba.njit(cache=True, error_model="numpy", forceinline=True)
def _load_at(place: Any, loads: Any, wave: Any, length: Any) -> Any:
    """Give the load at a time, in substeps: of a harmonic drive, or between those of its substeps."""
    if wave[2] > 0:
        phase = wave[2] * (wave[3] + place * length)
        return wave[0] * np.sin(phase) + wave[1] * np.cos(phase)
    before = min(int(place), loads.size - 2)
    return loads[before] + (place - before) * (loads[before + 1] - loads[before])


@numba.njit(cache=True, error_model="numpy")
def advance(
    motion: Any,
    first: Any,
    loads: Any,
    wave: Any,
    chain: Any,
    rule: Any,
    parabolic: Any,
    numbers: Any,
    limits: Any,
    record: Any,
) -> None:
    """Advance positions, velocities and slip velocities of discs, the rows of `motion`, from the accelerations `first`.

    `record` is (steps, 5n), or has no rows when nothing is kept; it is written as sensors of Exudyn do, after steps.
    """
    h, parts, cells = rule[0], rule[1], numbers.shape[1]
    acceleration, algorithmic, left = first.copy(), first.copy(), first.copy()
    newton, flags = np.zeros((2 * cells + 2, 2 * cells)), np.array([True, False])
    moved, begin, last = np.empty((3, 2 * cells)), np.empty((3, 2 * cells)), np.empty(cells)
    base, used = np.empty(2 * cells), np.empty(2 * cells)
    place, part, since, row, count = 0.0, 1.0, 0, 0, loads.size - 1
    while place < count - ROUND_OFF:
        part = min(part, count - place)
        length, end = part * h, place + part
        _copy(motion[2, :cells], last)
        sizes = rule[5] * length * length, rule[6] / (rule[5] * length), 1 / (rule[4] * rule[5] * length * length)
        load = _load_at(end, loads, wave, h)
        _predict(motion, algorithmic, acceleration, length, rule, begin, base)
        _predict(motion, left, acceleration, length, rule, moved, used)
        iterations, corrections, begun_again = _take(
            moved, begin, chain, load, sizes, last, numbers, limits, parabolic, newton, flags
        )
        if begun_again:
            _copy(base, used)
        if iterations == 0:
            _copy(used, left)
            part, since = 0.5 * part, 0
            if part < limits[4]:
                motion.fill(np.nan)
                return
            continue
        place, since = end, since + 1
        _copy(last, motion[2])
        for i in range(2 * cells):
            motion[0, i], motion[1, i], acceleration[i] = moved[0, i], moved[1, i], moved[2, i]
            algorithmic[i] = left[i] = used[i] + rule[4] * acceleration[i]
        if row < record.shape[0] and place >= (row + 1) * parts * (1 - ROUND_OFF):
            keep(motion, frictions(last, last, numbers, parabolic), record[row])
            row += 1
        if since >= RECOVERY_STEPS and iterations + corrections <= RECOVERY_ITERATIONS:
            part, since = min(1.0, 2 * part), 0
