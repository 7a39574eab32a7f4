"""The faults of motions and records, by name: each is the only thing that is wrong with its engine."""

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from reference_lcp.chain.trajectory import State, Trajectory
from reference_lcp.validation import FloatArray
from tests.faulty.scheme import Batch, Fault

ONE_CELL = 4
"""The cell that is wrong where one alone is; of shorter chains the last one."""


def one_cell(batch: Batch) -> int:
    """Give its place in arrays of a cell each."""
    return min(ONE_CELL, batch.bound.shape[1]) - 1


def in_one_cell(name: str, factor: float) -> Callable[[Batch], FloatArray]:
    """Scale the numbers of a batch in one cell."""

    def scaled(batch: Batch) -> FloatArray:
        values = getattr(batch, name).copy()
        values[:, one_cell(batch)] *= factor
        return values

    return scaled


def clipped(stop: FloatArray, bound: FloatArray) -> FloatArray:
    """Stop the slip, within the bound."""
    return np.clip(stop, -bound, bound)


def noise(batch: Batch, x: FloatArray, _v: FloatArray, _step: int) -> None:
    x += 1e-4 * batch.scale * np.sin(1e11 * x / batch.scale)  # as good as random, and the same in every run


def drift(batch: Batch, x: FloatArray, _v: FloatArray, _step: int) -> None:
    x += 1e-6 * batch.scale


def not_a_number(batch: Batch, x: FloatArray, _v: FloatArray, step: int) -> None:
    if step % 20 == 19:
        x[:, one_cell(batch)] = np.nan


def single(_batch: Batch, x: FloatArray, v: FloatArray, _step: int) -> None:
    x[:], v[:] = x.astype(np.float32), v.astype(np.float32)


def pushed(batch: Batch) -> FloatArray:
    push = np.zeros_like(batch.mass)
    push[:, one_cell(batch)] = 0.05 * batch.bound[:, one_cell(batch)]
    return push


def rubs(what: str, law: Callable[[FloatArray, FloatArray, FloatArray], FloatArray]) -> Fault:
    """Give friction by the bound, by what would stop the contacts, and by the friction before."""
    return Fault(what, friction=lambda _batch, bound, stop, _slip, before: law(bound, stop, before))


def remembering(part: float) -> Callable[..., State]:
    """Begin with a part of the last run's velocity beside that which is given."""

    def around(batch: Batch, state: State, *asked: Any) -> State:
        velocities = state.velocities + batch.memory.get("left", 0.0)
        end = batch.advanced(replace(state, velocities=velocities), *asked)
        batch.memory["left"] = part * end.velocities[:, :1]
        return end

    return around


def records(what: str, name: str, change: Callable[[Trajectory], FloatArray]) -> Fault:
    """Record another array than that of the motion."""
    return Fault(what, record=lambda _lane, run: replace(run, **{name: change(run)}))


SEEN: Mapping[str, Fault] = {
    "sound": Fault("nothing"),
    "inner-mass": Fault("inner masses × 1.01", chain={"inner_mass": 1.01}),
    "outer-mass": Fault("outer masses × 1.01", chain={"outer_mass": 1.01}),
    "one-mass": Fault("outer mass of cell 4 × 1.01", numbers={"mass": in_one_cell("mass", 1.01)}),
    "inner-spring": Fault("inner springs × 1.01", chain={"inner_stiffness": 1.01}),
    "chain-spring": Fault("chain springs × 1.01", chain={"chain_stiffness": 1.01}),
    "damper": Fault("chain dashpots × 1.1", chain={"chain_damping": 1.1}),
    "bound": Fault("friction bounds × 1.01", chain={"friction_coefficient": 1.01}),
    "one-bound": Fault("no friction in cell 4", numbers={"bound": in_one_cell("bound", 0.0)}),
    "free": Fault("no friction", numbers={"bound": lambda of: 0 * of.bound}),
    "other-lane": Fault("bounds of another chain", numbers={"bound": lambda of: np.roll(of.bound, 1, axis=0)}),
    "alike": Fault("bounds of all cells as in cell 1", numbers={"bound": lambda of: 0 * of.bound + of.bound[:, :1]}),
    "reversed": Fault("bounds of cells in reverse order", numbers={"bound": lambda of: of.bound[:, ::-1].copy()}),
    "stuck": rubs("friction without a bound", lambda _bound, stop, _before: stop),
    "one-sided": rubs("bounds × 1.01 in one direction", lambda bound, stop, _: np.clip(stop, -bound, 1.01 * bound)),
    "smooth": rubs("friction that tends to its bound", lambda bound, stop, _: bound * np.tanh(stop / (bound + 1e-300))),
    "viscous": rubs("friction that grows with the slip", lambda bound, stop, _: clipped(stop, bound) + 1e-3 * stop),
    "creep": rubs("contacts that keep 1 % of their slip", lambda bound, stop, _: clipped(0.99 * stop, bound)),
    "slips": rubs("contacts that keep 99.8 % of their slip", lambda bound, stop, _: clipped(0.002 * stop, bound)),
    "lag": rubs("a tenth of the friction is late", lambda bound, stop, old: 0.9 * clipped(stop, bound) + 0.1 * old),
    "explicit": Fault("positions by velocities before the step", old_velocity=1.0),
    "long-step": Fault("time steps × 1.01", numbers={"step": lambda of: 1.01 * of.step}),
    "late": Fault("a drive that is a step late", numbers={"delay": lambda of: of.step}),
    "push": Fault("a constant force of a twentieth of the bound in cell 4", numbers={"push": pushed}),
    "memory": Fault("hidden state: a thousandth of the last run's velocity", around=remembering(1e-3)),
    "noise": Fault("noise of 1e-4 U0 on positions", state=noise),
    "drift": Fault("positions that drift by 1e-6 U0 per step", state=drift),
    "single": Fault("single precision that is called double", state=single),
    "nan": Fault("NaN in cell 4 in every 20th step", state=not_a_number),
    "shape": records("positions without a mass", "positions", lambda run: run.positions[:, :-1]),
    "complex": records("complex velocities", "velocities", lambda run: run.velocities + 0j),
    "whole": records("friction in whole newtons", "friction", lambda run: run.friction.astype(np.int64)),
    "clock": records("times of the steps before", "time", lambda run: run.time - run.time[0]),
    "recorded": records("recorded positions × 1.01", "positions", lambda run: 1.01 * run.positions),
    "half": records("recorded friction halved", "friction", lambda run: 0.5 * run.friction),
}
"""Engines that every command has to find, and a sound one."""
