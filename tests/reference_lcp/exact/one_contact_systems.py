"""Chains of masses with one dry contact: against a wall, between two masses, or against the base that moves them."""

from collections.abc import Callable

import numpy as np

from reference_lcp import FrictionContact, Harmonic, MassSpringSystem, Spring

PLACES = ("wall", "mass", "base")

Frictional = Callable[[float], MassSpringSystem]
"""Gives the system with a friction [N]."""


def oscillator(frequency_ratio: float, friction: float = 0.0, *, joined: bool = False) -> MassSpringSystem:
    """A mass on a spring under a force of amplitude one, or, relative to it, on a base that also rubs: m = k = 1."""
    amplitude = frequency_ratio**2 if joined else 1.0
    return MassSpringSystem(
        masses=np.ones(1), springs=[Spring(0, None, 1.0)], friction=[FrictionContact(0, None, 1.0, friction)],
        forces={0: Harmonic(amplitude=amplitude, angular_frequency=frequency_ratio)},
    )  # fmt: skip


def random_chain(seed: int, place: str) -> Frictional:
    """One to six masses in a row, all different, damped or not; a force on the first, or a base of amplitude one."""
    rng = np.random.default_rng([seed, PLACES.index(place)])
    n = int(rng.choice([2, 5, 6] if place == "mass" else [1, 2, 5]))
    masses, stiffness = rng.uniform(0.5, 2, (2, n))
    damping = rng.uniform(0, 0.1, n) * rng.integers(2)
    springs = [Spring(k, k - 1 if k else None, stiffness[k], damping[k]) for k in range(n)]
    rubbing = rng.permutation(n).tolist()
    omega, phase = rng.uniform(0.2, 2.5), rng.uniform(0, 2 * np.pi)
    sizes = masses * omega**2 if place == "base" else np.eye(n)[0]
    forces = {k: Harmonic(amplitude=a, angular_frequency=omega, phase=phase) for k, a in enumerate(sizes) if a}

    def with_friction(friction: float) -> MassSpringSystem:
        contact = FrictionContact(rubbing[0], rubbing[1] if place == "mass" else None, 1.0, friction)
        return MassSpringSystem(masses=masses, springs=springs, friction=[contact], forces=forces)

    return with_friction
