"""Steps with more contacts than freedoms, each with a solution; as a program, what Lemke's method makes of them.

``python -m tests.reference_lcp.lcp.redundant_contacts`` solves 10,000 and prints a table.

Friction is bounded by a pyramid: with corners D = (d_1, …, d_m) of every contact, β >= 0 and a multiplier σ,

    0 <= Λ ⟂ g_N/Δt + W_Nᵀ q⁺ >= 0,    0 <= β ⟂ Dᵀ q⁺ + σ >= 0,    0 <= σ ⟂ μ Λ − Σ β >= 0.

The matrix is copositive, and as q⁺ = 0 opens no contact there is a solution (Anitescu and Potra 1997, theorem 3.2).
"""

import sys
from collections import Counter

import numpy as np

from reference_lcp.lcp.lemke import LemkeStatus, lemke

SIZES = {4: 4000, 10: 4000, 25: 2000}
"""Numbers of contacts, and how many problems of each are solved."""

NOISE = (0.0, 1e-9, 1e-3, 0.1)
"""Sizes of the random parts that tilt the normals, which would be parallel."""

WRONG = 1e-9
"""Natural residual, over the largest velocity and impulse, from which on an answer is wrong."""


def pyramid_step(mass, normals, tangents, velocity, *, gap_rate=0.0, friction=0.3, facets=4):
    """Matrix and vector of a step; `normals` has shape (f, c), `tangents` (f, 2 c), two for each contact in turn."""
    count = normals.shape[1]
    angles = 2 * np.pi * np.arange(facets) / facets
    corners = np.kron(np.eye(count), np.stack([np.cos(angles), np.sin(angles)]))
    directions = np.hstack([normals, tangents @ corners])
    ones, none = np.kron(np.eye(count), np.ones((facets, 1))), np.zeros((count, count))
    motion = np.hstack([directions.T @ np.linalg.solve(mass, directions), np.vstack([none, ones])])
    bounds = np.hstack([friction * np.eye(count), -ones.T, none])
    free = directions.T @ velocity
    free[:count] += gap_rate
    return np.vstack([motion, bounds]), np.concatenate([free, np.zeros(count)])


def frames(rng, count, axis, noise):
    """Normals near `axis` and two tangents of each, shape (count, 3, 3)."""
    normals = axis + noise * rng.standard_normal((count, 3))
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    first = np.cross(normals, np.roll(axis, 1))
    first /= np.linalg.norm(first, axis=1)[:, None]
    return np.stack([normals, first, np.cross(normals, first)], axis=1)


def hinged_boxes(rng, count, *, noise=0.0, friction=0.3, lowest=-0.5):
    """Two boxes on hinges, face to face: two freedoms, contacts at random heights from `lowest` on."""
    points = np.column_stack(
        [1e-3 * rng.standard_normal(count), rng.uniform(lowest, 0.6, count), rng.uniform(-0.5, 0.5, count)]
    )
    normal_and_tangents = frames(rng, count, np.array([1.0, 0, 0]), noise)
    rates = np.empty((2, count, 3))
    for body, (hinge, sign) in enumerate(((-1.0, -1), (1.0, 1))):
        turned = np.cross([0, 0, 1.0], points - [hinge, 0, 0])
        rates[body] = sign * np.einsum("ij,ikj->ik", turned, normal_and_tangents)
    velocity = np.array([1.0, -1.3])
    velocity *= -np.sign((rates[:, :, 0].T @ velocity).mean())
    return pyramid_step(
        np.diag([0.7, 0.9]), rates[:, :, 0], rates[:, :, 1:].reshape(2, -1), velocity, friction=friction
    )


def body_on_a_plane(rng, count, *, noise=0.0, friction=0.3):
    """A body with six freedoms on points of one plane, some of them still off it, that slides, spins and falls."""
    points = np.column_stack([rng.uniform(-1, 1, (count, 2)), np.full(count, -0.5)])
    normal_and_tangents = frames(rng, count, np.array([0, 0, 1.0]), noise)
    arms = np.cross(points[:, None], normal_and_tangents)
    rates = np.concatenate([normal_and_tangents, arms], axis=2).transpose(2, 0, 1)
    root = rng.standard_normal((6, 6))
    velocity = rng.standard_normal(6) - 2 * np.eye(6)[2]
    gaps = rng.uniform(0, 1, count) * (rng.uniform(size=count) < 0.3)
    return pyramid_step(
        root @ root.T + np.eye(6), rates[:, :, 0], rates[:, :, 1:].reshape(6, -1), velocity, gap_rate=gaps,
        friction=friction,
    )  # fmt: skip


def random_step(seed, count):
    """One of the above, with friction of 0, 0.3 or 1 and normals that are parallel, nearly so, or not."""
    rng = np.random.default_rng([seed, count])
    make = (hinged_boxes, body_on_a_plane)[seed % 2]
    noise, friction = rng.choice(NOISE), rng.choice((0.0, 0.3, 1.0))
    return (make.__name__, noise, friction), make(rng, count, noise=noise, friction=friction)


def is_wrong(M, q, z) -> bool:
    """Whether z is no solution."""
    return np.max(np.abs(np.minimum(z, M @ z + q))) > WRONG * max(np.max(np.abs(q)), np.max(z))


def outcome(M, q) -> str:
    """Status of a problem, or that its solution is wrong."""
    result = lemke(M, q)
    return "wrong" if result.solved and is_wrong(M, q, result.z) else result.status.name


def main() -> None:
    """Print how many problems of each size end in which way, and which kinds are left open."""
    left_open = Counter()
    for count, problems in SIZES.items():
        ends = Counter()
        for seed in range(problems):
            kind, (M, q) = random_step(seed, count)
            end = outcome(M, q)
            ends[end] += 1
            left_open[kind] += end != LemkeStatus.SOLVED.name
        print(f"{count} contacts, {problems} problems: {dict(ends)}")
    for (name, noise, friction), problems in (+left_open).items():
        print(f"left open: {problems} of {name}, normals tilted by {noise:g}, friction {friction:g}")


if __name__ == "__main__":
    sys.exit(main())
