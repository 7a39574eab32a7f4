"""The faults of motions and records, by name: each is the only thing that is wrong with its engine."""

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from multibody_xval.engines import Option
from reference_lcp import HarmonicBase, State, StillBase
from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.trajectory import Trajectory
from reference_lcp.validation import FloatArray
from tests.faulty.scheme import PRESETS, Batch, Fault, Friction, Rows, coulomb

ONE_CELL = 4
"""The cell that is wrong where one alone is; of shorter chains the last one."""

NOISE_BITS = 2.0**38
"""What is left of a position over U0 below its 38th bit is as good as random, and the same in every run."""

ALL = {name: PRESETS[name] for name in ("tuned", "default")}
UNSAID = {"tuned": replace(PRESETS["tuned"], options={"gain": Option(1, 0, "")})}
LOOSE = {"tuned": replace(PRESETS["tuned"], split_tolerance=1e-12)}
OTHER_PART = {**ALL, "default": replace(PRESETS["default"], options={"part": Option(0.26, 1.0, "it hides that")})}
NO_PART = {**ALL, "default": PRESETS["other"]}


def one_cell(batch: Batch) -> int:
    """Give its place in arrays of a cell each."""
    return min(ONE_CELL, batch.bound.shape[1]) - 1


def rubs(friction: Callable[..., FloatArray]) -> Friction:
    """Let friction be a function of the bound, of what would stop the contacts, and of the friction before."""
    return lambda _batch, bound, stop, _slip, before: friction(bound, stop, before)


def clipped(stop: FloatArray, bound: FloatArray) -> FloatArray:
    """Stop the slip, within the bound."""
    return np.clip(stop, -bound, bound)


def drive_the_fast(batch: Batch, bound: FloatArray, stop: FloatArray, *asked: FloatArray) -> FloatArray:
    fast = np.abs(stop) > 0.02 * batch.reduced
    return np.where(fast, -1.0, 1.0) * coulomb(batch, bound, stop, *asked)


def skip_the_first(batch: Batch, *asked: FloatArray) -> FloatArray:
    return (0.0 if batch.memory.pop("first", False) else 1.0) * coulomb(batch, *asked)


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


def round_positions(_batch: Batch, x: FloatArray, _v: FloatArray, _step: int) -> None:
    x[:] = 1e-17 * np.rint(x / 1e-17)


def gain_energy(_batch: Batch, _x: FloatArray, v: FloatArray, _step: int) -> None:
    v *= 1.005


def cut_off(batch: Batch, _x: FloatArray, v: FloatArray, _step: int) -> None:
    frequency = np.array([[lane.chain.resonator_frequency] for lane in batch.lanes])
    v[:] = clipped(v, 50 * batch.scale * frequency)


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


def with_coefficients(change: Callable[[FloatArray], FloatArray]) -> Callable[[Batch], None]:
    """Change coefficients of friction."""
    return numbers(bound=lambda batch: np.array([change(lane.chain.friction_coefficient) * lane.chain.normal_force
                                                 for lane in batch.lanes]))  # fmt: skip


def pushed(batch: Batch) -> FloatArray:
    cell, push = one_cell(batch), np.zeros_like(batch.mass)
    push[:, cell] = 0.05 * batch.bound[:, cell]
    return push


def sine(lane: Lane) -> Lane:
    """Take whatever moves the base for a sine at the resonator's frequency."""
    if isinstance(lane.drive, HarmonicBase | StillBase):
        return lane
    scale = lane.drive.displacement_scale(lane.chain)
    return replace(lane, drive=HarmonicBase(scale, lane.chain.resonator_frequency))


def in_kilogram_force(batch: Batch) -> FloatArray:
    """Take springs of the default preset for kilogram-force a millimetre."""
    springs = batch.mass.shape[1]
    factor = np.where(np.arange(2 * springs) < springs, 1000 / 9.81, 1.0)
    return batch.forces * factor if "part" in batch.preset.options else batch.forces


def with_state(change: Callable[[Batch, State], State]) -> Callable[..., State]:
    """Begin from another state than that which is given."""
    return lambda batch, state, *asked: batch.advanced(change(batch, state), *asked)


def shifted(by: Callable[[Batch, State], FloatArray]) -> Callable[..., State]:
    """Begin from other positions."""
    return with_state(lambda batch, state: replace(state, positions=state.positions + by(batch, state)))


def forget(batch: Batch, *asked: Any) -> State:
    batch.memory["first"] = True
    return batch.advanced(*asked)


def remember(batch: Batch, state: State, *asked: Any) -> State:
    velocities = state.velocities + batch.memory.get("left", 0.0)
    end = batch.advanced(replace(state, velocities=velocities), *asked)
    batch.memory["left"] = 1e-12 * end.velocities[:, :1]
    return end


def fail_by_chance(batch: Batch, *asked: Any) -> State:
    chance = batch.memory.setdefault("chance", np.random.default_rng(7))
    end = batch.advanced(*asked)
    if chance.random() < 0.01:
        end.velocities[-1] = np.nan
    return end


def wear_out(batch: Batch, *asked: Any) -> State:
    batch.memory["runs"] = batch.memory.get("runs", 0) + 1
    if batch.memory["runs"] == 200:
        batch.bound = 0.99 * batch.bound
    return batch.advanced(*asked)


def stop_short(batch: Batch, state: State, start: int, steps: int, rows: Rows) -> State:
    return batch.advanced(state, start, max(steps - 1, 1) if rows is None else steps, rows)


def fail(*_asked: Any) -> State:
    raise RuntimeError("no solution")


def recorded(**changes: Callable[[Trajectory], FloatArray]) -> Callable[[Lane, Trajectory], Trajectory]:
    """Record other arrays than those of the motion."""
    return lambda _lane, run: replace(run, **{name: change(run) for name, change in changes.items()})


def one_number(name: str, value: float) -> Callable[[Lane, Trajectory], Trajectory]:
    """Record one number in the middle of a run, or at its end, that is another."""

    def record(_lane: Lane, run: Trajectory) -> Trajectory:
        array = getattr(run, name)
        if array is None:
            return run
        wrong, row = np.array(array, dtype=float), run.steps // 2
        wrong[row if name == "time" else 1 if name == "internal_state" else (row, 1)] = value
        return replace(run, **{name: wrong})

    return record


def grounded(lane: Lane, run: Trajectory) -> Trajectory:
    pressing = lane.preloads(round(run.time[0] / lane.time_step) - 1, run.steps)
    return replace(run, normal_force=np.maximum(pressing, 0.0))


MOTIONS: Mapping[str, Fault] = {
    "sound": Fault(what="nothing", presets=PRESETS),
    "a+b": Fault(what="nothing, with a name that a regular expression reads otherwise", presets=PRESETS),
    "inner-mass": Fault(what="inner masses × 1.01", chain={"inner_mass": 1.01}),
    "outer-mass": Fault(what="outer masses × 1.01", chain={"outer_mass": 1.01}),
    "one-mass": Fault(what="outer mass of cell 4 × 1.01", batch=in_one_cell("mass", 1.01)),
    "inner-spring": Fault(what="inner springs × 1.01", chain={"inner_stiffness": 1.01}),
    "chain-spring": Fault(what="chain springs × 1.01", chain={"chain_stiffness": 1.01}),
    "damper": Fault(what="chain dashpots × 1.1", chain={"chain_damping": 1.1}),
    "bound": Fault(what="friction bounds × 1.01", chain={"friction_coefficient": 1.01}),
    "one-bound": Fault(what="no friction in cell 4", batch=in_one_cell("bound", 0.0)),
    "free": Fault(what="no friction", batch=numbers(bound=lambda of: 0 * of.bound)),
    "stuck": Fault(what="friction without a bound", friction=rubs(lambda _bound, stop, _before: stop)),
    "one-sided": Fault(
        what="friction bounds × 1.01 in one direction",
        friction=rubs(lambda bound, stop, _before: np.clip(stop, -bound, 1.01 * bound)),
    ),
    "kinetic": Fault(
        what="friction × 0.99 in motion",
        friction=rubs(lambda bound, stop, _: np.where(np.abs(stop) <= bound, stop, 0.99 * clipped(stop, bound))),
    ),
    "smooth": Fault(
        what="friction that only tends to its bound",
        friction=rubs(lambda bound, stop, _: bound * np.tanh(stop / np.maximum(bound, 1e-300))),
    ),
    "viscous": Fault(
        what="friction that grows with the slip velocity",
        friction=rubs(lambda bound, stop, _before: clipped(stop, bound) + 1e-3 * stop),
    ),
    "creep": Fault(
        what="contacts that keep 1 % of what would stop them",
        friction=rubs(lambda bound, stop, _before: clipped(0.99 * stop, bound)),
    ),
    "slips": Fault(
        what="contacts that keep 99.8 % of what would stop them",
        friction=rubs(lambda bound, stop, _before: clipped(0.002 * stop, bound)),
    ),
    "drives": Fault(what="friction that drives a fast slip", friction=drive_the_fast),
    "lag": Fault(
        what="a tenth of the friction is a step late",
        friction=rubs(lambda bound, stop, before: 0.9 * clipped(stop, bound) + 0.1 * before),
        remembers=True,
    ),
    "explicit": Fault(what="positions by velocities before the step", old_velocity=1.0),
    "long-step": Fault(what="time steps × 1.01", batch=numbers(step=lambda of: 1.01 * of.step)),
    "late": Fault(what="a drive that is a step late", batch=numbers(delay=lambda of: of.step)),
    "sine": Fault(what="every drive is a sine", batch=numbers(driven=lambda of: tuple(map(sine, of.lanes)))),
    "push": Fault(what="a constant force of a twentieth of the bound in cell 4", batch=numbers(push=pushed)),
    "other-lane": Fault(
        what="friction bounds of the chain before in the batch",
        batch=numbers(bound=lambda of: np.roll(of.bound, 1, axis=0)),
    ),
    "alike": Fault(
        what="friction bounds of all cells as in cell 1",
        batch=numbers(bound=lambda of: np.repeat(of.bound[:, :1], of.bound.shape[1], axis=1)),
    ),
    "reversed": Fault(
        what="friction bounds of cells in reverse order", batch=numbers(bound=lambda of: of.bound[:, ::-1].copy())
    ),
    "rubs": Fault(
        what="some friction in cells without",
        batch=numbers(bound=lambda of: np.maximum(of.bound, 1e-3 * np.max(of.bound, axis=1, keepdims=True))),
    ),
    "floor": Fault(
        what="friction bounds of at least 0.1 N",
        batch=numbers(bound=lambda of: np.where(of.bound > 0, np.maximum(of.bound, 0.1), 0.0)),
    ),
    "slippery": Fault(
        what="friction coefficients of at least 0.05", batch=with_coefficients(lambda mu: np.maximum(mu, 0.05))
    ),
    "rubber": Fault(
        what="friction coefficients of at most 0.9", batch=with_coefficients(lambda mu: np.minimum(mu, 0.9))
    ),
    "noise": Fault(what="noise of 1e-4 U0 on positions", state=noise),
    "drift": Fault(what="positions that drift by 1e-6 U0 per step", state=drift),
    "single": Fault(what="single precision that is called double", state=single),
    "nan": Fault(what="NaN in cell 4 in every 20th step", state=not_a_number),
    "energy": Fault(what="velocities × 1.005 in every step", state=gain_energy),
    "quantum": Fault(what="positions in multiples of 1e-17 m", state=round_positions),
    "cuts": Fault(what="no velocity above fifty times that of the drive", state=cut_off),
    "kilogram-force": Fault(
        what="springs of the default preset in kgf/mm", batch=numbers(forces=in_kilogram_force), presets=ALL
    ),
    "late-bound": Fault(
        what="friction that follows the normal force a step late",
        pressing=lambda parts: np.concatenate([parts[:1], parts[:-1]]),
    ),
    "rigid": Fault(what="friction bounds that do not follow the normal force", pressing=np.ones_like),
    "grounded": Fault(what="contacts that never fly", record=grounded),
    "lands": Fault(
        what="every run begins with closed contacts",
        around=with_state(lambda _batch, state: replace(state, internal_state=None)),
    ),
    "turned": Fault(
        what="more friction in a row that is turned",
        batch=numbers(bound=lambda of: np.array([[1 + np.sin(own.direction) / 10] for own in of.lanes]) * of.bound),
    ),
    "aside": Fault(
        what="friction recorded along another tangent",
        record=lambda lane, run: replace(run, friction=np.cos(lane.direction) * run.friction),
    ),
    "holds-no-more": Fault(
        what="static friction as kinetic friction", batch=numbers(static_ratio=lambda of: np.ones_like(of.step))
    ),
    "never-lets-go": Fault(
        what="kinetic friction as static friction",
        batch=numbers(bound=lambda of: of.static_ratio * of.bound, static_ratio=lambda of: np.ones_like(of.step)),
    ),
    "forgets": Fault(what="no friction in the first step of a run", around=forget, friction=skip_the_first),
    "remembers": Fault(what="hidden state: 1e-12 of the last run's velocity", around=remember),
    "wears": Fault(what="friction bounds × 0.99 after 200 runs", around=wear_out),
    "counts": Fault(
        what="steps that are counted in sixteen bits",
        around=lambda batch, state, start, *asked: batch.advanced(state, start % 2**15, *asked),
    ),
    "crosstalk": Fault(
        what="chains of a batch that feel each other by 1e-9",
        around=shifted(lambda _batch, state: 1e-9 * (np.mean(state.positions, axis=0) - state.positions)),
    ),
    "rounds": Fault(
        what="5e-13 U0 more in every run", around=shifted(lambda batch, _state: 5e-13 * batch.scale), presets=LOOSE
    ),
    "short": Fault(what="no last step in runs without a record", around=stop_short),
    "by-chance": Fault(what="NaN in one of a hundred runs", around=fail_by_chance),
    "raises": Fault(what="an error in every run", around=fail),
    "shapes": Fault(
        what="states of any shape are taken",
        around=with_state(lambda batch, _state: State.at_rest(len(batch.lanes), batch.bound.shape[1])),
    ),
    "unsaid": Fault(what="an option without a reason", presets=UNSAID),
    "lawless": Fault(
        what="another step than its law says", batch=numbers(stopping=lambda of: of.stopping / 1.04), presets=OTHER_PART
    ),
    "no-law": Fault(what="a law that cannot be made", presets=NO_PART),
}
"""Engines whose motion is wrong, or what they say of themselves."""

RECORDS: Mapping[str, Fault] = {
    "shape": Fault(what="positions without a mass", record=recorded(positions=lambda run: run.positions[:, :-1])),
    "complex": Fault(what="complex velocities", record=recorded(velocities=lambda run: run.velocities + 0j)),
    "whole": Fault(
        what="friction in whole newtons", record=recorded(friction=lambda run: run.friction.astype(np.int64))
    ),
    "clock": Fault(what="times of the steps before", record=recorded(time=lambda run: run.time - run.time[0])),
    "recorded": Fault(what="recorded positions × 1.01", record=recorded(positions=lambda run: 1.01 * run.positions)),
    "half": Fault(what="recorded friction halved", record=recorded(friction=lambda run: 0.5 * run.friction)),
    "sign": Fault(what="recorded friction of the wrong sign", record=recorded(friction=lambda run: -run.friction)),
    "presses": Fault(
        what="recorded normal forces that grow with the slip",
        record=recorded(normal_force=lambda run: run.normal_force * (1 + np.abs(run.relative_velocity))),
    ),
    **{
        name: Fault(what=f"one number of {what.replace('_', ' ')} is {value:g}", record=one_number(what, value))
        for name, what, value in (
            ("normal", "normal_force", np.nan), ("friction", "friction", np.nan), ("position", "positions", np.inf),
            ("velocity", "velocities", np.nan), ("gap", "normal_gap", np.nan), ("internal", "internal_state", np.nan),
            ("time", "time", 7.0), ("timeless", "time", np.nan),
        )
    },
}  # fmt: skip
"""Engines that move as they should, and record something else."""

FAULTS: Mapping[str, Fault] = {**MOTIONS, **RECORDS}
