"""Vectors of eight numbers in compiled code do what NumPy does with eight numbers, on processors of any width."""

import os
import subprocess
import sys
from pathlib import Path

import numba
import numpy as np
import pytest
from llvmlite.binding import get_host_cpu_features
from numpy.testing import assert_array_equal

from reference_lcp import Chain, CompiledSimulation, Lane, State, StillBase
from reference_lcp.schemes.vectors import (
    WIDTH,
    after,
    before,
    chosen,
    clipped,
    gathered,
    multiply_add,
    set_vector,
    vector_at,
)

A, B = np.random.default_rng(0).normal(size=(2, WIDTH))
EXACT = np.arange(1.0, 1 + WIDTH)  # products and sums of small integers are not rounded
ROWS, PLACES = np.random.default_rng(1).normal(size=(4, 4)), np.array([8, 0, 0, 4, 12, 8, 4, 0])

EXPECTED = {
    "sum": A + B,
    "difference": A - B,
    "product": A * B,
    "opposite": -A,
    "product and sum": 2 * EXACT**2 + EXACT,
    "clipped": np.clip(A, -np.abs(B), np.abs(B)),
    "chosen": np.where(B > 0, A, EXACT),
    "before": np.roll(A, 1),
    "after": np.roll(A, -1),
    "gathered": ROWS[PLACES // 4, 3],
}


@numba.njit
def operations(numbers, rows, places, given):
    a, b, size, c = vector_at(numbers, 0), vector_at(numbers, 8), vector_at(numbers, 16), vector_at(numbers, 24)
    set_vector(given, 0, a + b)
    set_vector(given, 8, a - b)
    set_vector(given, 16, a * b)
    set_vector(given, 24, -a)
    set_vector(given, 32, multiply_add(c, c + c, c))
    set_vector(given, 40, clipped(a, size))
    set_vector(given, 48, chosen(b, a, c))
    set_vector(given, 56, before(a))
    set_vector(given, 64, after(a))
    set_vector(given, 72, gathered(rows, places, 3))


def test_an_operation_acts_on_every_number_as_numpy_does() -> None:
    given = np.zeros((len(EXPECTED), WIDTH))
    operations(np.concatenate([A, B, np.abs(B), EXACT]), ROWS, PLACES, given.reshape(-1))
    for name, row in zip(EXPECTED, given, strict=True):
        assert_array_equal(row, EXPECTED[name], err_msg=name)


ROUND_OFF = 1e-11
"""Of a hundred steps of some hundred roundings each, over motions of the order of one."""


def ended() -> np.ndarray:
    """Give where a chain is after a hundred steps."""
    simulation = CompiledSimulation([Lane(Chain.from_ratios(cells=20, friction_ratio=0.3), StillBase(), 1e-3)])
    start = State(*np.random.default_rng(0).normal(size=(2, 1, 40)))
    return simulation.advance(start, 0, 100).positions[0]


def ended_on(processor: str, features: str, folder: Path) -> np.ndarray:
    """Give the same as code for another processor has it."""
    other = {"NUMBA_CPU_NAME": processor, "NUMBA_CPU_FEATURES": features, "NUMBA_CACHE_DIR": str(folder / processor)}
    program = f"from {__name__} import ended; print(ended().tobytes().hex())"
    root = Path(__file__).parents[3]
    done = subprocess.run(
        [sys.executable, "-c", program], cwd=root, env=os.environ | other, capture_output=True, check=True
    )
    return np.frombuffer(bytes.fromhex(done.stdout.decode()))


@pytest.mark.slow
@pytest.mark.skipif(not get_host_cpu_features().get("fma"), reason="needs an x86-64 processor with AVX2 and FMA")
def test_registers_of_any_width_give_the_same_bits_with_fused_multiply_add_and_round_off_without(tmp_path) -> None:
    assert_array_equal(ended_on("haswell", "+avx,+avx2,+fma", tmp_path), ended())
    rounded_twice = ended_on("x86-64", "+sse2", tmp_path)
    assert not np.array_equal(rounded_twice, ended())
    np.testing.assert_allclose(rounded_twice, ended(), rtol=0, atol=ROUND_OFF)
