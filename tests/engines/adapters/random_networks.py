"""Random networks of sliding masses, coupled by tendons with dry friction, in MuJoCo: sparse algebra beside dense.

It needs NumPy and MuJoCo alone, of whatever version, and prints what it finds: ``python random_networks.py``.
"""

import json

import mujoco
import numpy as np

MASSES = (2, 5, 10, 20, 40, 80)
TENDONS_PER_MASS = (0.5, 1.0, 1.5, 2.0)
SEEDS = range(12)


def network(masses: int, tendons: int, seed: int, jacobian: str) -> "mujoco.MjModel":
    """Give masses in the world, and tendons between pairs of them that random numbers choose."""
    rng = np.random.default_rng(seed)
    bodies = "".join(
        f'<body><joint name="x{k}" type="slide" axis="1 0 0" stiffness="{rng.uniform(100, 1000):.17g}"/>'
        f'<inertial pos="0 0 0" mass="{rng.uniform(0.5, 2):.17g}" diaginertia="1 1 1"/></body>'
        for k in range(masses)
    )
    pairs = [rng.choice(masses, 2, replace=False) for _ in range(tendons)]
    fixed = "".join(
        f'<fixed frictionloss="{rng.uniform(0.1, 1):.17g}"><joint joint="x{first}" coef="1"/>'
        f'<joint joint="x{second}" coef="-1"/></fixed>'
        for first, second in pairs
    )
    return mujoco.MjModel.from_xml_string(
        f'<mujoco><option timestep="0.001" gravity="0 0 0" jacobian="{jacobian}"/>'
        f"<worldbody>{bodies}</worldbody><tendon>{fixed}</tendon></mujoco>"
    )


def accelerations(masses: int, tendons: int, seed: int, jacobian: str) -> "np.ndarray":
    """Give what one step makes of random velocities."""
    model = network(masses, tendons, seed, jacobian)
    data = mujoco.MjData(model)
    data.qvel[:] = np.random.default_rng(seed + 1000).normal(0, 0.1, masses)
    mujoco.mj_step(model, data)
    return data.qacc.copy()


def differences() -> "dict[str, float]":
    """Give the largest difference of an acceleration, over the largest acceleration, by network."""
    found = {}
    for masses in MASSES:
        for tendons in sorted({max(1, round(each * masses)) for each in TENDONS_PER_MASS}):
            for seed in SEEDS:
                dense, sparse = (accelerations(masses, tendons, seed, kind) for kind in ("dense", "sparse"))
                name = f"{masses} masses, {tendons} tendons, seed {seed}"
                found[name] = float(np.abs(sparse - dense).max() / np.abs(dense).max())
    return found


if __name__ == "__main__":
    print(json.dumps({"version": mujoco.__version__, "differences": differences()}))
