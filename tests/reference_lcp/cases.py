"""Chains and numbers that several tests share."""

import numpy as np

from reference_lcp import (
    Chain,
    CompiledSimulation,
    HarmonicBase,
    Lane,
    PeriodicOrbit,
    Preload,
    periodic_orbits,
    simulate_system,
)
from reference_lcp.chain.drives import PeriodicDrive
from reference_lcp.steady.error_bar import ErrorBar, error_bar_of
from reference_lcp.steady.neighbours import PeriodInverse

EXACT_DB = {
    (0.1, 0.6): 7.865,
    (0.3, 0.6): -0.147,
    (0.3, 0.9): -9.561,
    (0.6, 0.9): -3.553,
    (0.6, 1.3): -15.244,
    (1.0, 0.9): 0.600,
}
"""Transmittance at (friction ratio, frequency ratio) of the canonical case by event-driven integration."""

STANDING = np.asarray(1e14)
"""A mass [kg] so heavy that it stands still: it moves by 1e-14 of what the other one does."""


def one_cell(bound: float = 0.0, **parameters) -> Chain:
    """A cell of unit masses and springs with this friction bound, but for the parameters that are given."""
    unit = dict.fromkeys(("outer_mass", "inner_mass", "chain_stiffness", "inner_stiffness"), 1.0)
    return Chain(cells=1, normal_force=np.asarray(bound), friction_coefficient=np.ones(1), **(unit | parameters))


def driven(frequency_ratio: float, **ratios) -> tuple[Chain, HarmonicBase]:
    """A chain of these ratios, and a base that drives it at its default amplitude."""
    chain = Chain.from_ratios(**ratios)
    return chain, HarmonicBase.from_ratio(chain, frequency_ratio)


def canonical_lane(friction_ratio: float, frequency_ratio: float, **ratios) -> Lane:
    """A point of figure 3, or of chains with other ratios too, with 400 steps per period."""
    return Lane.periodic(*driven(frequency_ratio, friction_ratio=friction_ratio, **ratios), 400)


def orbit_of(lane: Lane, **limits) -> PeriodicOrbit:
    """The periodic orbit of Euler's scheme."""
    return periodic_orbits(CompiledSimulation([lane]), round(lane.drive.period / lane.time_step), **limits)[0]


def euler_orbit(
    chain: Chain, drive: PeriodicDrive, steps: int, preload: Preload | None = None, **limits
) -> PeriodicOrbit:
    """The same with so many steps per period."""
    return orbit_of(Lane.periodic(chain, drive, steps, preload), **limits)


def error_bar(orbits, place: int = 0) -> ErrorBar:
    """The error bar of one of the orbits of a chain, by ascending numbers of steps."""
    return error_bar_of(orbits, place, float(PeriodInverse.of([orbits[place]]).amplification[0]))


def random_chain(rng: np.random.Generator, cells: int) -> Chain:
    """A chain whose cells all differ, damped or nearly not, with friction from none to strong."""
    return Chain(
        cells=cells,
        outer_mass=rng.uniform(0.5, 2, cells),
        inner_mass=rng.uniform(0.1, 2, cells),
        chain_stiffness=rng.uniform(200, 2000, cells),
        inner_stiffness=rng.uniform(200, 2000, cells),
        chain_damping=rng.uniform(0, 2, cells),
        inner_damping=rng.uniform(0, 1, cells),
        normal_force=rng.uniform(0, 10, cells),
        friction_coefficient=rng.uniform(0, 1, cells),
    )


def moved(system, time_step, steps, position=None, velocity=None):
    """The motion of a frictional system over so many steps, from rest at zero unless said otherwise."""
    still = np.zeros(system.freedoms)
    start = {"position": still if position is None else position, "velocity": still if velocity is None else velocity}
    return simulate_system(system, **start, time_step=time_step, steps=steps)


def fitted_order(errors) -> float:
    """Order of convergence over halvings of the time step."""
    return -np.polyfit(np.arange(len(errors)), np.log2(errors), 1)[0]


def natural_residual(M, q, z) -> float:
    """‖min(z, M z + q)‖∞: zero if and only if z solves LCP(q, M)."""
    return float(np.max(np.abs(np.minimum(z, np.asarray(M) @ z + np.asarray(q))), initial=0.0))
