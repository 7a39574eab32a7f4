"""MuJoCo's sparse algebra: one step of random networks of masses and frictional tendons equals that of its dense one.

Sparse and dense factorisations solve the same equations, so that nothing but round-off may part them. The chain couples
two masses at most, and shows no fault that depends on which masses are coupled; random networks do.
"""

import json
import subprocess
import sys
from pathlib import Path

import mujoco
import pytest

NETWORKS = Path(__file__).with_name("random_networks.py")

ROUND_OFF = 1e-12
"""Of accelerations, over the largest: a thousand times what versions without a fault leave, 1e-15."""


@pytest.mark.xfail(
    mujoco.__version__ == "4.0.0",
    reason="the sparse Cholesky factorisation of MuJoCo 4.0.0 merges columns that differ: google-deepmind/mujoco#3767",
    strict=True,
)
def test_sparse_and_dense_steps_of_random_networks_are_equal() -> None:
    done = subprocess.run([sys.executable, str(NETWORKS)], capture_output=True, text=True, check=True)
    differences: dict[str, float] = json.loads(done.stdout)["differences"]
    assert {name: size for name, size in differences.items() if size > ROUND_OFF} == {}
