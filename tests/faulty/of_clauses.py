"""Faults that one clause of the contract finds, or a check of single numbers: of what other commands do not ask for."""

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from multibody_xval.engines import Option
from reference_lcp import HarmonicBase, State, StillBase
from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.trajectory import Trajectory
from reference_lcp.validation import FloatArray
from tests.faulty.faults import clipped, numbers, recorded
from tests.faulty.scheme import PRESETS, Batch, Fault, Rows, coulomb

ALL = {name: PRESETS[name] for name in ("tuned", "default")}
UNSAID = {"tuned": replace(PRESETS["tuned"], options={"gain": Option(1, 0, "")})}
LOOSE = {"tuned": replace(PRESETS["tuned"], split_tolerance=1e-12)}
OTHER_PART = {**ALL, "default": replace(PRESETS["default"], options={"part": Option(0.26, 1.0, "it hides that")})}
NO_PART = {**ALL, "default": PRESETS["other"]}


def drive_the_fast(batch: Batch, bound: FloatArray, stop: FloatArray, *asked: FloatArray) -> FloatArray:
    fast = np.abs(stop) > 0.02 * batch.reduced
    return np.where(fast, -1.0, 1.0) * coulomb(batch, bound, stop, *asked)


def skip_the_first(batch: Batch, *asked: FloatArray) -> FloatArray:
    return (0.0 if batch.memory.pop("first", False) else 1.0) * coulomb(batch, *asked)


def round_positions(_batch: Batch, x: FloatArray, _v: FloatArray, _step: int) -> None:
    x[:] = 1e-17 * np.rint(x / 1e-17)


def gain_energy(_batch: Batch, _x: FloatArray, v: FloatArray, _step: int) -> None:
    v *= 1.005


def cut_off(batch: Batch, _x: FloatArray, v: FloatArray, _step: int) -> None:
    frequency = np.array([[lane.chain.resonator_frequency] for lane in batch.lanes])
    v[:] = clipped(v, 50 * batch.scale * frequency)


def with_coefficients(change: Callable[[FloatArray], FloatArray]) -> Callable[[Batch], None]:
    """Change coefficients of friction."""
    return numbers(bound=lambda batch: np.array([change(lane.chain.friction_coefficient) * lane.chain.normal_force
                                                 for lane in batch.lanes]))  # fmt: skip


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


OF_CLAUSES: Mapping[str, Fault] = {
    "a+b": Fault("nothing, with a name that a regular expression reads otherwise", presets=PRESETS),
    "drives": Fault("friction that drives a fast slip", friction=drive_the_fast),
    "sine": Fault("every drive is a sine", batch=numbers(driven=lambda of: tuple(map(sine, of.lanes)))),
    "rubs": Fault(
        "some friction in cells without",
        batch=numbers(bound=lambda of: np.maximum(of.bound, 1e-3 * np.max(of.bound, axis=1, keepdims=True))),
    ),
    "floor": Fault(
        "friction bounds of at least 0.1 N",
        batch=numbers(bound=lambda of: np.where(of.bound > 0, np.maximum(of.bound, 0.1), 0.0)),
    ),
    "slippery": Fault(
        "friction coefficients of at least 0.05", batch=with_coefficients(lambda mu: np.maximum(mu, 0.05))
    ),
    "rubber": Fault("friction coefficients of at most 0.9", batch=with_coefficients(lambda mu: np.minimum(mu, 0.9))),
    "energy": Fault("velocities × 1.005 in every step", state=gain_energy),
    "quantum": Fault("positions in multiples of 1e-17 m", state=round_positions),
    "cuts": Fault("no velocity above fifty times that of the drive", state=cut_off),
    "kilogram-force": Fault(
        "springs of the default preset in kgf/mm", batch=numbers(forces=in_kilogram_force), presets=ALL
    ),
    "late-bound": Fault(
        "friction that follows the normal force a step late",
        pressing=lambda parts: np.concatenate([parts[:1], parts[:-1]]),
    ),
    "rigid": Fault("friction bounds that do not follow the normal force", pressing=np.ones_like),
    "grounded": Fault("contacts that never fly", record=grounded),
    "lands": Fault(
        "every run begins with closed contacts",
        around=with_state(lambda _batch, state: replace(state, internal_state=None)),
    ),
    "holds-no-more": Fault(
        "static friction as kinetic friction", batch=numbers(static_ratio=lambda of: np.ones_like(of.step))
    ),
    "never-lets-go": Fault(
        "kinetic friction as static friction",
        batch=numbers(bound=lambda of: of.static_ratio * of.bound, static_ratio=lambda of: np.ones_like(of.step)),
    ),
    "forgets": Fault("no friction in the first step of a run", around=forget, friction=skip_the_first),
    "remembers": Fault("hidden state: 1e-12 of the last run's velocity", around=remember),
    "wears": Fault("friction bounds × 0.99 after 200 runs", around=wear_out),
    "counts": Fault(
        "steps that are counted in sixteen bits",
        around=lambda batch, state, start, *asked: batch.advanced(state, start % 2**15, *asked),
    ),
    "crosstalk": Fault(
        "chains of a batch that feel each other by 1e-9",
        around=shifted(lambda _batch, state: 1e-9 * (np.mean(state.positions, axis=0) - state.positions)),
    ),
    "rounds": Fault(
        "5e-13 U0 more in every run", around=shifted(lambda batch, _state: 5e-13 * batch.scale), presets=LOOSE
    ),
    "short": Fault("no last step in runs without a record", around=stop_short),
    "by-chance": Fault("NaN in one of a hundred runs", around=fail_by_chance),
    "raises": Fault("an error in every run", around=fail),
    "shapes": Fault(
        "states of any shape are taken",
        around=with_state(lambda batch, _state: State.at_rest(len(batch.lanes), batch.bound.shape[1])),
    ),
    "unsaid": Fault("an option without a reason", presets=UNSAID),
    "lawless": Fault(
        "another step than its law says", batch=numbers(stopping=lambda of: of.stopping / 1.04), presets=OTHER_PART
    ),
    "no-law": Fault("a law that cannot be made", presets=NO_PART),
    "sign": Fault("recorded friction of the wrong sign", record=recorded(friction=lambda run: -run.friction)),
    "presses": Fault(
        "recorded normal forces that grow with the slip",
        record=recorded(normal_force=lambda run: run.normal_force * (1 + np.abs(run.relative_velocity))),
    ),
    **{
        name: Fault(f"one number of {what.replace('_', ' ')} is {value:g}", record=one_number(what, value))
        for name, what, value in (
            ("normal", "normal_force", np.nan),
            ("friction", "friction", np.nan),
            ("position", "positions", np.inf),
            ("velocity", "velocities", np.nan),
            ("gap", "normal_gap", np.nan),
            ("internal", "internal_state", np.nan),
            ("time", "time", 7.0),
            ("timeless", "time", np.nan),
        )
    },
}
"""Engines that break a clause of the contract, or that a check of single numbers finds."""
