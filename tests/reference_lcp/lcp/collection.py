"""A collection of complementarity problems: of the literature, of known worst cases, and families of random ones.

Solvable are all problems with a P-matrix, and those with a copositive-plus matrix (positive semidefinite
ones among them) wherever w = M z + q >= 0, z >= 0 has any solution at all (Cottle, Pang, Stone 1992,
theorems 3.3.7 and 3.8.6).
"""

import numpy as np


def friction_matrix(delassus):
    """[[G, I], [−I, 0]]: copositive-plus for positive semidefinite G."""
    one, zero = np.eye(len(delassus)), np.zeros_like(delassus)
    return np.block([[delassus, one], [-one, zero]])


def murty_worst_case(n):
    return np.eye(n) + 2 * np.tril(np.ones((n, n)), -1), -np.cumsum(2.0 ** np.arange(n - 1, -1, -1))


def fathi_worst_case(n):
    """Positive definite and symmetric: L Lᵀ of Murty's triangle (Fathi 1979)."""
    M, _ = murty_worst_case(n)
    return M @ M.T, -np.ones(n)


def obstacle_problem(n):
    """A string over an obstacle: tridiagonal Z-matrix, the smallest of free boundary problems."""
    M = 2 * np.eye(n) - np.eye(n, k=1) - np.eye(n, k=-1)
    return M, M @ np.sin(np.linspace(0, 7, n)) + 0.01


def programme(n, curvature):
    """Conditions of min ½ p xᵀ x − cᵀ x, A x <= b, x >= 0: bisymmetric, copositive-plus; skew-symmetric for p = 0."""
    A = np.add.outer(np.arange(1, n + 1), np.arange(n)) % 4 - 1.0
    c = np.arange(n) - n / 3
    M = np.block([[curvature * np.eye(n), A.T], [-A, np.zeros((n, n))]])
    return M, np.concatenate([-c, np.ones(n)])


def named():
    yield "Murty 2.8", [[1, -1, -1, -1], [-1, 1, -1, -1], [1, 1, 2, 0], [1, 1, 0, 2]], [3, 5, -9, -5]
    yield "Murty 2.9", [[-1, 0, -3], [1, -2, -5], [-2, -1, -2]], [-3, -2, -1]
    yield "Murty 2.11", [[-1.5, 2], [-4, 4]], [-5, 17]
    yield "Kostreva 1", [[1, 2, 0], [0, 1, 2], [2, 0, 1]], [-1, -1, -1]
    yield "Kostreva 2", [[1, -1, 3], [2, -1, 3], [-1, -2, 0]], [-1, -1, -1]
    yield "Murty 1.1", [[2, 1], [1, 2]], [-5, -6]
    yield "Cottle, Pang, Stone 4.3.3", [[0, -1, 2], [2, 0, -2], [-1, 1, 0]], [-3, 6, -1]
    yield "q >= 0", [[-1, 0], [0, -1]], [1, 0]
    yield "solution of zeros", [[1, 0], [0, 1]], [-1, 0]
    yield "a single variable", [[2]], [-4]
    yield "w = -1", [[0]], [-1]
    yield "zero matrix, zero vector", np.zeros((3, 3)), np.zeros(3)
    yield "zero matrix, no solution", np.zeros((3, 3)), [1, 0, -1]
    yield "rank one, no solution", np.ones((2, 2)) - [[0, 2], [2, 0]], [-1, -1]
    yield "rank one, degenerate", np.ones((4, 4)), [-1, -1, -1, -1]
    yield "open contact beside a sliding one", [[1.14, -0.19, 0], [-1.17, 1.96, 1], [1, -1, 0]], [1e-3, -3e-5, 0]
    for n in (2, 4, 6, 8):
        yield f"Murty's worst case {n}", *murty_worst_case(n)
        yield f"Fathi's worst case {n}", *fathi_worst_case(n)
    for n in (3, 6, 10, 25):
        yield f"obstacle {n}", *obstacle_problem(n)
    for n in (1, 2, 3, 4, 5):
        yield f"quadratic programme {n}", *programme(n, 1)
        yield f"linear programme {n}", *programme(n, 0)
    for n in (2, 4, 6, 8):
        yield f"Hilbert {n}", 1 / (1 + np.add.outer(np.arange(n), np.arange(n))), -np.ones(n)


def random_p(rng, n):
    """Nonsymmetric P-matrix: positive definite plus skew, rows and columns scaled by positive numbers."""
    root, skew = rng.normal(size=(2, n, n))
    M = root @ root.T / n + 0.1 * np.eye(n) + skew - skew.T
    return rng.uniform(0.5, 2, (n, 1)) * M * rng.uniform(0.5, 2, n), 5 * rng.normal(size=n)


def random_psd(rng, n):
    """Positive semidefinite of half rank."""
    root = rng.normal(size=(n, (n + 1) // 2))
    return root @ root.T, rng.normal(size=n)


def random_solvable_psd(rng, n):
    """Positive semidefinite with a solution built in."""
    M, _ = random_psd(rng, n)
    split = rng.uniform(size=n) < 0.5
    z, w = rng.uniform(0, 2, size=(2, n))
    return M, np.where(split, w, 0) - M @ np.where(split, 0, z)


def random_friction(rng, n):
    """Friction of coupled contacts, rigid ones with singular G among them."""
    contacts = max(1, n // 2)
    root = rng.normal(size=(contacts, rng.integers(1, contacts + 2)))
    bounds = rng.uniform(0, 2, contacts) * (rng.uniform(size=contacts) < 0.8)
    return friction_matrix(root @ root.T), np.concatenate([3 * rng.normal(size=contacts), bounds])


def degenerate_integer(rng, n):
    """Positive semidefinite of small integers with ties everywhere."""
    root = rng.integers(-1, 2, size=(n, n)).astype(float)
    return root @ root.T, rng.integers(-2, 3, size=n).astype(float)


def frictional_step(rng, n):
    """Equation (7) for contacts that share a body, some open, friction that follows the normal force."""
    contacts = max(1, n // 3)
    w_n, w_t = rng.normal(size=(2, 3 * contacts, contacts))
    normal, coupled, tangential = w_n.T @ w_n, w_n.T @ w_t, w_t.T @ w_t
    mu, one, zero = 0.2 * np.eye(contacts), np.eye(contacts), np.zeros((contacts, contacts))
    M = np.block(
        [[normal - coupled @ mu, coupled, zero], [coupled.T - tangential @ mu, tangential, one], [2 * mu, -one, zero]]
    )
    gaps = np.where(rng.uniform(size=contacts) < 0.5, 1e-3 * rng.uniform(size=contacts), -1e-6)
    return M, np.concatenate([gaps, 1e-5 * rng.normal(size=contacts), np.zeros(contacts)])


def ill_conditioned(rng, n):
    """Positive definite, condition numbers from 1e8 to 1e10."""
    directions, _ = np.linalg.qr(rng.normal(size=(n, n)))
    M = directions * np.logspace(0, -rng.uniform(8, 10), n) @ directions.T
    return M, M @ rng.normal(size=n)


def badly_scaled(rng, n):
    """A P-matrix in units up to 1e8 apart, row by row and column by column."""
    M, q = random_p(rng, n)
    rows, columns = 10 ** rng.uniform(-8, 8, size=(2, n))
    return rows[:, None] * M * columns, rows * q


FAMILIES = {
    "P": random_p,
    "PSD": random_psd,
    "PSD with a solution": random_solvable_psd,
    "friction": random_friction,
    "degenerate integers": degenerate_integer,
    "equation 7": frictional_step,
    "ill-conditioned": ill_conditioned,
    "badly scaled": badly_scaled,
}
SIZES = (1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 10, 9, 8, 7, 6, 5, 4, 14, 20, 30, 3, 2, 6, 8, 50)
ALWAYS_SOLVABLE = {"P", "PSD with a solution", "ill-conditioned", "badly scaled"}


CASES = {name: (np.array(M, dtype=float), np.array(q, dtype=float)) for name, M, q in named()} | {
    f"{family} {index}: n = {n}": make(np.random.default_rng([number, index]), n)
    for number, (family, make) in enumerate(FAMILIES.items())
    for index, n in enumerate(SIZES)
}
