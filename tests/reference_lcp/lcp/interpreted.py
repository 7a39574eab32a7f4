"""Solve the collection and write every result into the file given: a process of its own may do it without numba."""

import sys

import numpy as np

from reference_lcp.lcp.lemke import lemke
from tests.reference_lcp.lcp.test_lemke_collection import CASES

LARGEST = 20
"""Variables of the largest problem: Python takes seconds for one of fifty."""


def solved_collection():
    """Solution, pivots, status and basis of every case, one after the other in one array."""
    results = [lemke(M, q) for M, q in CASES.values() if q.size <= LARGEST]
    return np.concatenate(
        [np.concatenate([one.z, one.w, one.basic, [one.pivots, one.residual, hash_of(one.status)]]) for one in results]
    )


def hash_of(status) -> float:
    """A number for a status that is the same in every process."""
    return float(sum(status.encode()))


if __name__ == "__main__":
    np.save(sys.argv[1], solved_collection())
