"""The faults, by name: each is the only thing that is wrong with its engine."""

from collections.abc import Callable, Mapping
from dataclasses import replace

import numpy as np

from reference_lcp.chain.trajectory import Trajectory
from reference_lcp.validation import FloatArray
from tests.faulty.scheme import Batch, Fault, coulomb

ONE_CELL = 4
"""The cell that is wrong where one alone is; of shorter chains the last one."""

NOISE_BITS = 2.0**38
"""What is left of a position over U0 below its 38th bit is as good as random, and the same in every run."""


def _one_cell(batch: Batch) -> int:
    """Give its place in arrays of a cell each."""
    return min(ONE_CELL, batch.bound.shape[1]) - 1


def _rub_harder_one_way(batch: Batch, stop: FloatArray, _before: FloatArray) -> FloatArray:
    return np.clip(stop, -batch.bound, 1.01 * batch.bound)


def _rub_less_in_motion(batch: Batch, stop: FloatArray, before: FloatArray) -> FloatArray:
    held = np.abs(stop) <= batch.bound
    return np.where(held, stop, 0.99 * coulomb(batch, stop, before))


def _give_way_smoothly(batch: Batch, stop: FloatArray, _before: FloatArray) -> FloatArray:
    return batch.bound * np.tanh(stop / batch.bound)


def _flow(batch: Batch, stop: FloatArray, before: FloatArray) -> FloatArray:
    return coulomb(batch, stop, before) + 1e-3 * stop


def _creep(batch: Batch, stop: FloatArray, before: FloatArray) -> FloatArray:
    return coulomb(batch, 0.99 * stop, before)


def _never_let_go(_batch: Batch, stop: FloatArray, _before: FloatArray) -> FloatArray:
    return stop


def _rub_a_step_late(batch: Batch, stop: FloatArray, before: FloatArray) -> FloatArray:
    return 0.9 * coulomb(batch, stop, before) + 0.1 * before


def _noise(batch: Batch, x: FloatArray, _v: FloatArray, _step: int) -> None:
    fine = x / batch.scale * NOISE_BITS
    x += 1e-4 * batch.scale * (2 * (fine - np.floor(fine)) - 1)


def _drift(batch: Batch, x: FloatArray, _v: FloatArray, _step: int) -> None:
    x += 1e-6 * batch.scale


def _not_a_number(batch: Batch, x: FloatArray, _v: FloatArray, step: int) -> None:
    if step == 300:
        x[:, _one_cell(batch)] = np.nan


def _single(_batch: Batch, x: FloatArray, v: FloatArray, _step: int) -> None:
    x[:], v[:] = x.astype(np.float32), v.astype(np.float32)


def _in_one_cell(name: str, factor: float) -> Callable[[Batch], None]:
    """Scale the numbers of a batch in one cell."""

    def spoil(batch: Batch) -> None:
        getattr(batch, name)[:, _one_cell(batch)] *= factor

    return spoil


def _of_the_lane_before(batch: Batch) -> None:
    batch.bound = np.roll(batch.bound, 1, axis=0)


def _all_cells_alike(batch: Batch) -> None:
    batch.bound[:] = batch.bound[:, :1]


def _reversed(batch: Batch) -> None:
    batch.bound = batch.bound[:, ::-1].copy()


def _pushed(batch: Batch) -> None:
    cell = _one_cell(batch)
    batch.push[:, cell] = 0.05 * batch.bound[:, cell]


def _long_step(batch: Batch) -> None:
    batch.step = 1.01 * batch.step


def _recorded(**changes: Callable[[Trajectory], FloatArray]) -> Callable[[Trajectory], Trajectory]:
    """Record other arrays than those of the motion."""
    return lambda run: replace(run, **{name: change(run) for name, change in changes.items()})


FAULTS: Mapping[str, Fault] = {
    "sound": Fault(what="nothing"),
    "inner-mass": Fault(what="inner masses × 1.01", chain={"inner_mass": 1.01}),
    "outer-mass": Fault(what="outer masses × 1.01", chain={"outer_mass": 1.01}),
    "one-mass": Fault(what="outer mass of cell 4 × 1.01", batch=_in_one_cell("mass", 1.01)),
    "inner-spring": Fault(what="inner springs × 1.01", chain={"inner_stiffness": 1.01}),
    "chain-spring": Fault(what="chain springs × 1.01", chain={"chain_stiffness": 1.01}),
    "damper": Fault(what="chain dashpots × 1.1", chain={"chain_damping": 1.1}),
    "bound": Fault(what="friction bounds × 1.01", chain={"friction_coefficient": 1.01}),
    "one-bound": Fault(what="no friction in cell 4", batch=_in_one_cell("bound", 0.0)),
    "free": Fault(what="no friction", batch=lambda batch: batch.bound.fill(0.0)),
    "stuck": Fault(what="friction without a bound", friction=_never_let_go),
    "one-sided": Fault(what="friction bounds × 1.01 in one direction", friction=_rub_harder_one_way),
    "kinetic": Fault(what="friction × 0.99 in motion", friction=_rub_less_in_motion),
    "smooth": Fault(what="friction that only tends to its bound", friction=_give_way_smoothly),
    "viscous": Fault(what="friction that grows with the slip velocity", friction=_flow),
    "creep": Fault(what="contacts that keep 1 % of what would stop them", friction=_creep),
    "lag": Fault(what="a tenth of the friction is a step late", friction=_rub_a_step_late, remembers=True),
    "explicit": Fault(what="positions by velocities before the step", old_velocity=1.0),
    "long-step": Fault(what="time steps × 1.01", batch=_long_step),
    "late": Fault(what="a drive that is a step late", late=1),
    "push": Fault(what="a constant force of a twentieth of the bound in cell 4", batch=_pushed),
    "other-lane": Fault(what="friction bounds of the chain before in the batch", batch=_of_the_lane_before),
    "alike": Fault(what="friction bounds of all cells as in cell 1", batch=_all_cells_alike),
    "reversed": Fault(what="friction bounds of cells in reverse order", batch=_reversed),
    "noise": Fault(what="noise of 1e-4 U0 on positions", state=_noise),
    "drift": Fault(what="positions that drift by 1e-6 U0 per step", state=_drift),
    "single": Fault(what="single precision that is called double", state=_single),
    "nan": Fault(what="NaN in cell 4 after 300 steps", state=_not_a_number),
    "shape": Fault(
        what="positions without the last cell", record=_recorded(positions=lambda run: run.positions[:, :-1])
    ),
    "complex": Fault(what="complex velocities", record=_recorded(velocities=lambda run: run.velocities + 0j)),
    "whole": Fault(
        what="friction in whole newtons", record=_recorded(friction=lambda run: run.friction.astype(np.int64))
    ),
    "clock": Fault(what="times of the steps before", record=_recorded(time=lambda run: run.time - run.time[0])),
    "recorded": Fault(what="recorded positions × 1.01", record=_recorded(positions=lambda run: 1.01 * run.positions)),
    "half": Fault(what="recorded friction halved", record=_recorded(friction=lambda run: 0.5 * run.friction)),
}
"""Every engine of the family by its name."""
