"""The faults of motions and records, by name: each is the only thing that is wrong with its engine."""

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.trajectory import Trajectory
from reference_lcp.validation import FloatArray
from tests.faulty.scheme import Batch, Fault, Friction

ONE_CELL = 4
"""The cell that is wrong where one alone is; of shorter chains the last one."""

NOISE_BITS = 2.0**38
"""What is left of a position over U0 below its 38th bit is as good as random, and the same in every run."""


def one_cell(batch: Batch) -> int:
    """Give its place in arrays of a cell each."""
    return min(ONE_CELL, batch.bound.shape[1]) - 1


def rubs(friction: Callable[..., FloatArray]) -> Friction:
    """Let friction be a function of the bound, of what would stop the contacts, and of the friction before."""
    return lambda _batch, bound, stop, _slip, before: friction(bound, stop, before)


def clipped(stop: FloatArray, bound: FloatArray) -> FloatArray:
    """Stop the slip, within the bound."""
    return np.clip(stop, -bound, bound)


def noise(batch: Batch, x: FloatArray, _v: FloatArray, _step: int) -> None:
    fine = x / batch.scale * NOISE_BITS
    x += 1e-4 * batch.scale * (2 * (fine - np.floor(fine)) - 1)


def drift(batch: Batch, x: FloatArray, _v: FloatArray, _step: int) -> None:
    x += 1e-6 * batch.scale


def not_a_number(batch: Batch, x: FloatArray, _v: FloatArray, step: int) -> None:
    if step % 20 == 19:
        x[:, one_cell(batch)] = np.nan


def single(_batch: Batch, x: FloatArray, v: FloatArray, _step: int) -> None:
    x[:], v[:] = x.astype(np.float32), v.astype(np.float32)


def in_one_cell(name: str, factor: float) -> Callable[[Batch], None]:
    """Scale the numbers of a batch in one cell."""

    def spoil(batch: Batch) -> None:
        getattr(batch, name)[:, one_cell(batch)] *= factor

    return spoil


def numbers(**changes: Callable[[Batch], Any]) -> Callable[[Batch], None]:
    """Replace numbers of a batch."""

    def spoil(batch: Batch) -> None:
        for name, change in changes.items():
            setattr(batch, name, change(batch))

    return spoil


def pushed(batch: Batch) -> FloatArray:
    cell, push = one_cell(batch), np.zeros_like(batch.mass)
    push[:, cell] = 0.05 * batch.bound[:, cell]
    return push


def recorded(**changes: Callable[[Trajectory], FloatArray]) -> Callable[[Lane, Trajectory], Trajectory]:
    """Record other arrays than those of the motion."""
    return lambda _lane, run: replace(run, **{name: change(run) for name, change in changes.items()})


MOTIONS: Mapping[str, Fault] = {
    "sound": Fault("nothing"),
    "inner-mass": Fault("inner masses × 1.01", chain={"inner_mass": 1.01}),
    "outer-mass": Fault("outer masses × 1.01", chain={"outer_mass": 1.01}),
    "one-mass": Fault("outer mass of cell 4 × 1.01", batch=in_one_cell("mass", 1.01)),
    "inner-spring": Fault("inner springs × 1.01", chain={"inner_stiffness": 1.01}),
    "chain-spring": Fault("chain springs × 1.01", chain={"chain_stiffness": 1.01}),
    "damper": Fault("chain dashpots × 1.1", chain={"chain_damping": 1.1}),
    "bound": Fault("friction bounds × 1.01", chain={"friction_coefficient": 1.01}),
    "one-bound": Fault("no friction in cell 4", batch=in_one_cell("bound", 0.0)),
    "free": Fault("no friction", batch=numbers(bound=lambda of: 0 * of.bound)),
    "stuck": Fault("friction without a bound", friction=rubs(lambda _bound, stop, _before: stop)),
    "one-sided": Fault(
        "friction bounds × 1.01 in one direction",
        friction=rubs(lambda bound, stop, _before: np.clip(stop, -bound, 1.01 * bound)),
    ),
    "kinetic": Fault(
        "friction × 0.99 in motion",
        friction=rubs(lambda bound, stop, _: np.where(np.abs(stop) <= bound, stop, 0.99 * clipped(stop, bound))),
    ),
    "smooth": Fault(
        "friction that only tends to its bound",
        friction=rubs(lambda bound, stop, _: bound * np.tanh(stop / np.maximum(bound, 1e-300))),
    ),
    "viscous": Fault(
        "friction that grows with the slip velocity",
        friction=rubs(lambda bound, stop, _before: clipped(stop, bound) + 1e-3 * stop),
    ),
    "creep": Fault(
        "contacts that keep 1 % of what would stop them",
        friction=rubs(lambda bound, stop, _before: clipped(0.99 * stop, bound)),
    ),
    "slips": Fault(
        "contacts that keep 99.8 % of what would stop them",
        friction=rubs(lambda bound, stop, _before: clipped(0.002 * stop, bound)),
    ),
    "lag": Fault(
        "a tenth of the friction is a step late",
        friction=rubs(lambda bound, stop, before: 0.9 * clipped(stop, bound) + 0.1 * before),
        remembers=True,
    ),
    "explicit": Fault("positions by velocities before the step", old_velocity=1.0),
    "long-step": Fault("time steps × 1.01", batch=numbers(step=lambda of: 1.01 * of.step)),
    "late": Fault("a drive that is a step late", batch=numbers(delay=lambda of: of.step)),
    "push": Fault("a constant force of a twentieth of the bound in cell 4", batch=numbers(push=pushed)),
    "other-lane": Fault(
        "friction bounds of the chain before in the batch",
        batch=numbers(bound=lambda of: np.roll(of.bound, 1, axis=0)),
    ),
    "alike": Fault(
        "friction bounds of all cells as in cell 1",
        batch=numbers(bound=lambda of: np.repeat(of.bound[:, :1], of.bound.shape[1], axis=1)),
    ),
    "reversed": Fault(
        "friction bounds of cells in reverse order", batch=numbers(bound=lambda of: of.bound[:, ::-1].copy())
    ),
    "noise": Fault("noise of 1e-4 U0 on positions", state=noise),
    "drift": Fault("positions that drift by 1e-6 U0 per step", state=drift),
    "single": Fault("single precision that is called double", state=single),
    "nan": Fault("NaN in cell 4 in every 20th step", state=not_a_number),
}
"""Engines that move otherwise: every command finds them."""

RECORDS: Mapping[str, Fault] = {
    "shape": Fault("positions without a mass", record=recorded(positions=lambda run: run.positions[:, :-1])),
    "complex": Fault("complex velocities", record=recorded(velocities=lambda run: run.velocities + 0j)),
    "whole": Fault("friction in whole newtons", record=recorded(friction=lambda run: run.friction.astype(np.int64))),
    "clock": Fault("times of the steps before", record=recorded(time=lambda run: run.time - run.time[0])),
    "recorded": Fault("recorded positions × 1.01", record=recorded(positions=lambda run: 1.01 * run.positions)),
    "half": Fault("recorded friction halved", record=recorded(friction=lambda run: 0.5 * run.friction)),
}
"""Engines that move as they should, and record something else: every command finds them."""

SEEN: Mapping[str, Fault] = {**MOTIONS, **RECORDS}
