"""Speed: of the compiled scheme, of Lemke's method, of the paper's figure 3 and of long chains; what a point costs.

A peer of a point is harmonic balance as it is usually written: the slip of every contact is a sum of odd harmonics of
the drive; friction is taken in time, and brought back (T. M. Cameron and J. H. Griffin, J. Appl. Mech. 56, 1989).
Coulomb's law is smoothed, λ = −μ λ_N ẇ / √(ẇ² + ε²), and Newton's method follows the solution while ε falls.
"""

import itertools
import time
import timeit
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np

from reference_lcp.chain.drives import HarmonicBase, StillBase
from reference_lcp.chain.linear_response import frictionless_response, frictionless_transmittance
from reference_lcp.chain.mass_in_mass import Chain
from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.trajectory import State
from reference_lcp.defaults import CELLS, MINIMUM_STEPS_PER_PERIOD
from reference_lcp.exact.exact_orbit import exact_orbit
from reference_lcp.lcp.lemke import lemke
from reference_lcp.lcp.time_step import assemble
from reference_lcp.observables.transmittance import decibel, transmittance
from reference_lcp.schemes.euler import CompiledSimulation, LemkeSimulation, chain_step
from reference_lcp.steady.error_bar import measured_error_bars
from reference_lcp.steady.orbits import periodic_orbits
from reference_lcp.validation import FloatArray

FIGURE3_FRICTION_RATIOS = (0.0, 0.1, 0.2, 0.3, 0.4, 0.6, 1.0, 2.0, 5.0)
FIGURE3_FREQUENCY_RATIOS = tuple(float(ratio) for ratio in np.linspace(0.1, 3.0, 146))
BENCH_LANES = 64
PERIODS_OF_A_SAMPLE = 100
SAMPLES = 7
CHAIN_LENGTHS = (7, 100, 1_000, 10_000, 100_000)
SUBNORMAL = 1e-310  # m, below the normal numbers
CELL_STEPS_OF_A_SAMPLE = 10_000_000
LCPS_OF_A_SAMPLE = 1_000

POINTS = tuple(itertools.product((0.1, 0.3, 1.0), (0.5, 0.7, 0.9, 1.1, 1.4)))

HARMONIC_BALANCE = "harmonic balance"
"""Name of the method."""

HARMONICS = 8  # odd ones, 1 to 15
BALANCE_SAMPLES = 128  # phases of a period at which friction is taken
SMOOTHING = 1e-4  # ε over ω times the displacement scale; it begins at one
FACTOR = 3.0  # by which ε falls from stage to stage; its root where Newton's method has failed
LEAST_FACTOR = 1.05  # at which the point is given up
MOST_ITERATIONS = 40  # Newton steps of a stage
BALANCED = 1e-8  # largest residual of the slip, over the displacement scale, that ends a stage
SHORTEST_STEP = 1e-3  # part of a Newton step below which a stage is given up


def canonical_lane(friction_ratio: float, frequency_ratio: float, cells: int = CELLS) -> Lane:
    """One point of figure 3 at the coarsest time step allowed."""
    chain = Chain.from_ratios(cells=cells, friction_ratio=friction_ratio)
    return Lane.periodic(chain, HarmonicBase.from_ratio(chain, frequency_ratio), MINIMUM_STEPS_PER_PERIOD)


def bench() -> dict[str, Any]:
    """Measure on one core, in seconds: 64 lanes of 7 cells, the points of figure 3, and 7 cells by Lemke's method."""
    _compile()
    seconds, worst, points = _figure3()
    step_seconds, lcp_seconds = _lemke()
    return {
        "cell_steps_per_second": _cell_steps_per_second(),
        "figure3_seconds": seconds,
        "figure3_worst_residual": worst,
        "figure3_points": points,
        "lemke_step_seconds": step_seconds,
        "lemke_seconds": lcp_seconds,
    }


def _lemke() -> tuple[float, float]:
    """Seconds for one step of the canonical chain with Lemke's method, and for one of its LCPs without warm start."""
    lane, steps = canonical_lane(0.3, 0.9), MINIMUM_STEPS_PER_PERIOD
    # After one period from rest some contacts stick and some slip.
    state = CompiledSimulation([lane]).advance(State.at_rest(1, lane.chain.cells), 0, steps)
    simulation = LemkeSimulation([lane])
    start = state.positions[0], state.velocities[0]
    problem = assemble(chain_step(lane.chain, *start, 0.0, lane.time_step, lane.chain.normal_force))
    lemke(*problem)
    return (
        _best(lambda: simulation.advance(state, 0, steps)) / steps,
        _best(lambda: [lemke(*problem) for _ in range(LCPS_OF_A_SAMPLE)]) / LCPS_OF_A_SAMPLE,
    )


def bench_cells(lengths: Sequence[int] = CHAIN_LENGTHS) -> list[dict[str, float]]:
    """Measure what chains of several lengths cost, one lane each, on one core; bytes leave out the table of loads.

    Each of them moves, begins at rest, or dies out without a drive among numbers that are `SUBNORMAL`.
    """
    _compile()
    rows: list[dict[str, float]] = []
    for cells in lengths:
        lane = canonical_lane(0.3, 0.9, cells)
        simulation, steps = CompiledSimulation([lane]), max(100, CELL_STEPS_OF_A_SAMPLE // cells)
        rest = State.at_rest(1, cells)
        state = simulation.advance(rest, 0, 100)
        still = CompiledSimulation([Lane(lane.chain, StillBase(), lane.time_step)])
        dying = State(rest.positions + SUBNORMAL, rest.velocities)
        runs = {"": (simulation, state), "from_rest_": (simulation, rest), "dying_out_": (still, dying)}
        row: dict[str, float] = {"cells": cells}
        for name, (run, start) in runs.items():
            row[f"{name}seconds_per_cell_step"] = _best(partial(run.advance, start, 0, steps)) / (cells * steps)
        row["bytes"] = simulation.nbytes - 8 * steps + state.positions.nbytes + state.velocities.nbytes
        rows.append(row | {"highest_natural_frequency": lane.chain.highest_natural_frequency})
    return rows


def _best(work: Callable[[], object], timer: Callable[[], float] = timeit.default_timer) -> float:
    """Seconds of the fastest of several runs: the one that was disturbed least."""
    return min(timeit.repeat(work, number=1, repeat=SAMPLES, timer=timer))


def _compile() -> None:
    periodic_orbits(CompiledSimulation([canonical_lane(0.3, 0.9)]), MINIMUM_STEPS_PER_PERIOD, max_periods=10)


def _cell_steps_per_second() -> float:
    lanes = [canonical_lane(0.3, ratio) for ratio in np.linspace(0.3, 1.6, BENCH_LANES)]
    simulation = CompiledSimulation(lanes)
    cells = lanes[0].chain.cells
    state = simulation.advance(State.at_rest(len(lanes), cells), 0, MINIMUM_STEPS_PER_PERIOD)

    def periods() -> None:
        nonlocal state
        for _ in range(PERIODS_OF_A_SAMPLE):
            state = simulation.advance(state, 0, MINIMUM_STEPS_PER_PERIOD)

    return len(lanes) * cells * MINIMUM_STEPS_PER_PERIOD * PERIODS_OF_A_SAMPLE / _best(periods)


def _figure3() -> tuple[float, float, int]:
    """Seconds, worst residual and number of points of the whole figure."""
    begin = timeit.default_timer()
    chains = [Chain.from_ratios(friction_ratio=friction) for friction in FIGURE3_FRICTION_RATIOS if friction > 0]
    with_friction = [
        Lane.periodic(chain, HarmonicBase.from_ratio(chain, frequency), MINIMUM_STEPS_PER_PERIOD)
        for chain in chains
        for frequency in FIGURE3_FREQUENCY_RATIOS
    ]
    orbits = periodic_orbits(CompiledSimulation(with_friction), MINIMUM_STEPS_PER_PERIOD)
    curve = [decibel(transmittance(orbit)) for orbit in orbits]
    chain = Chain.from_ratios()
    curve += [
        decibel(frictionless_transmittance(chain, HarmonicBase.from_ratio(chain, frequency)))
        for frequency in FIGURE3_FREQUENCY_RATIOS
    ]
    seconds = timeit.default_timer() - begin
    return seconds, max(orbit.residual for orbit in orbits), len(curve)


def bench_points(points: Sequence[tuple[float, float]] = POINTS) -> list[dict[str, Any]]:
    """Measure cost and error of several methods at points (friction, frequency ratio), once they are compiled.

    Costs are processor time. A point has failed where harmonic balance finds nothing, or the scheme's steady state is
    not certified.
    """
    lanes = [canonical_lane(*point) for point in points]

    def exactly(some: Sequence[Lane]) -> list[float]:
        return [decibel(transmittance(exact_orbit(lane.chain, lane.drive)[0])) for lane in some]  # type: ignore[arg-type]

    exactly(lanes[:1])  # compiled
    begin = time.process_time()
    exact = np.array(exactly(lanes))
    seconds = (time.process_time() - begin) / len(lanes)
    steps = MINIMUM_STEPS_PER_PERIOD

    def scheme(*, with_bars: bool) -> list[list[float]]:
        orbits = periodic_orbits(CompiledSimulation(lanes), steps)
        bars = [[bar.transmittance_db for bar in measured_error_bars(orbits)]] if with_bars else []
        return [[decibel(transmittance(orbit)) if orbit.converged else np.nan for orbit in orbits], *bars]

    def balance() -> list[list[float]]:
        return [[decibel(balanced_transmittance(lane, steps)) for lane in lanes]]

    def measured(method: str, work: Callable[[], list[list[float]]]) -> dict[str, Any]:
        levels, *bars = np.array(work())
        return _row(
            method, _best(work, time.process_time) / len(lanes), np.abs(levels - exact), bars[0] if bars else None
        )

    return [
        measured(f"scheme, {steps} steps", partial(scheme, with_bars=False)),
        measured("scheme with error bar", partial(scheme, with_bars=True)),
        measured(HARMONIC_BALANCE, balance),
        _row("exact", seconds, np.zeros(len(lanes)), None),
    ]


def _row(method: str, seconds: float, errors: FloatArray, bars: FloatArray | None) -> dict[str, Any]:
    return {
        "method": method,
        "seconds_per_point": seconds,
        "failed": int(np.sum(np.isnan(errors))),
        "median_error_db": float(np.nanmedian(errors)),
        "largest_error_db": float(np.nanmax(errors)),
        "median_bar_db": None if bars is None else float(np.median(bars)),
        "covered": None if bars is None else float(np.mean(errors <= bars)),
    }


@dataclass(frozen=True)
class _Balance:
    """The equation w = a + G λ(w) for the Fourier coefficients w of all slips, shape (2H, n).

    The first H rows are real parts c', the other ones imaginary parts c" of Σ Re(c exp(ihωt)). `influence` is G, shape
    (2H, n, 2H, n), `free` is a, `basis` takes coefficients to samples, and `rates` those of the slip to samples of its
    velocity.
    """

    free: FloatArray
    influence: FloatArray
    basis: FloatArray
    rates: FloatArray
    bound: FloatArray

    @classmethod
    def of(cls, lane: Lane, omega: float) -> "_Balance":
        chain, orders = lane.chain, np.arange(1, 2 * HARMONICS, 2)
        w = chain.contact_directions
        dynamic = [
            chain.stiffness_matrix + 1j * h * omega * chain.damping_matrix - (h * omega) ** 2 * chain.mass_matrix
            for h in orders
        ]
        compliance = np.array([w.T @ np.linalg.solve(matrix, w) for matrix in dynamic])
        influence = np.zeros((2 * HARMONICS, chain.cells, 2 * HARMONICS, chain.cells))
        for h, block in enumerate(compliance):
            influence[h, :, h], influence[h, :, HARMONICS + h] = block.real, -block.imag
            influence[HARMONICS + h, :, h], influence[HARMONICS + h, :, HARMONICS + h] = block.imag, block.real
        free = np.zeros((2 * HARMONICS, chain.cells))
        slip = -1j * (w.T @ frictionless_response(chain, lane.drive))  # type: ignore[arg-type]
        free[0], free[HARMONICS] = slip.real, slip.imag
        phases = 2 * np.pi * np.arange(BALANCE_SAMPLES)[:, None] / BALANCE_SAMPLES * orders
        cosine, sine = np.cos(phases), np.sin(phases)
        rates = np.hstack([-sine, -cosine]) * np.tile(orders * omega, 2)
        return cls(free, influence, np.hstack([cosine, -sine]), rates, chain.friction_bound)

    def friction(self, slip: FloatArray, smoothing: float) -> FloatArray:
        """Coefficients of friction, shape (2H, n)."""
        velocity = self.rates @ slip
        force = -self.bound * velocity / np.sqrt(velocity**2 + smoothing**2)
        return self.basis.T @ force * (2 / BALANCE_SAMPLES)

    def residual(self, slip: FloatArray, smoothing: float) -> FloatArray:
        """W − a − G λ(w), shape (2H, n)."""
        return slip - self.free - np.tensordot(self.influence, self.friction(slip, smoothing))

    def newton_step(self, slip: FloatArray, residual: FloatArray, smoothing: float) -> FloatArray:
        """Change of w that solves the linearised equation."""
        slope = -self.bound * smoothing**2 / np.sqrt((self.rates @ slip) ** 2 + smoothing**2) ** 3
        jacobian = np.zeros(self.influence.shape)
        for cell, column in enumerate(slope.T):
            own = self.basis.T @ (column[:, None] * self.rates) * (2 / BALANCE_SAMPLES)
            jacobian[..., cell] = -self.influence[..., cell] @ own
        matrix = jacobian.reshape(slip.size, slip.size) + np.eye(slip.size)
        change = np.linalg.solve(matrix, -residual.ravel())
        return np.asarray(change.reshape(slip.shape), dtype=np.float64)

    def solved(self, slip: FloatArray, smoothing: float, tolerance: float) -> FloatArray | None:
        """Slip that solves the equation, by damped Newton steps from another one; ``None`` where they do not end."""
        residual = self.residual(slip, smoothing)
        for _ in range(MOST_ITERATIONS):
            if np.max(np.abs(residual)) <= tolerance:
                return slip
            step, part = self.newton_step(slip, residual, smoothing), 1.0
            while np.linalg.norm(after := self.residual(slip + part * step, smoothing)) >= np.linalg.norm(residual):
                part /= 2
                if part < SHORTEST_STEP:
                    return None
            slip, residual = slip + part * step, after
        return None

    def followed(self, velocity: float, tolerance: float) -> FloatArray | None:
        """Slip at the last ε, followed from ε = `velocity`; ``None`` where it is lost."""
        slip, smoothing, factor = self.solved(self.free, velocity, tolerance), 1.0, FACTOR
        while slip is not None and smoothing > SMOOTHING:
            smaller = max(smoothing / factor, SMOOTHING)
            following = self.solved(slip, smaller * velocity, tolerance)
            if following is not None:
                slip, smoothing = following, smaller
                continue
            factor **= 0.5
            if factor < LEAST_FACTOR:
                return None
        return slip


def balanced_transmittance(lane: Lane, steps_per_period: int) -> float:
    """Transmittance of a chain under a harmonic drive by harmonic balance; NaN where Newton's method fails."""
    omega, scale = 2 * np.pi / (lane.time_step * steps_per_period), lane.drive.displacement_scale(lane.chain)
    balance = _Balance.of(lane, omega)
    slip = balance.followed(omega * scale, BALANCED * scale)
    if slip is None:
        return float("nan")
    force = balance.friction(slip, SMOOTHING * omega * scale)
    chain = lane.chain
    dynamic = chain.stiffness_matrix + 1j * omega * chain.damping_matrix - omega**2 * chain.mass_matrix
    first = chain.contact_directions @ (force[0] + 1j * force[HARMONICS])
    motion = -1j * frictionless_response(chain, lane.drive) + np.linalg.solve(dynamic, first)  # type: ignore[arg-type]
    return float(np.abs(motion[chain.cells - 1]) / scale)
