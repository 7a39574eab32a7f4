"""Vectors of eight numbers in compiled code give the same bits on processors of any width."""

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from llvmlite.binding import get_host_cpu_features
from numpy.testing import assert_array_equal

from reference_lcp import Chain, CompiledSimulation, Lane, State, StillBase

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
