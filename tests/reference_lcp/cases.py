"""Chains and numbers that several tests share."""

import numpy as np

from reference_lcp import Chain

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
