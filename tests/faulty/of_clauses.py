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
from tests.faulty.faults import clipped, records, remembering
from tests.faulty.scheme import PRESETS, Batch, Fault, Rows

TUNED, OTHER = PRESETS["tuned"], PRESETS["other"]


def round_positions(_batch: Batch, x: FloatArray, _v: FloatArray, _step: int) -> None:
    x[:] = 1e-17 * np.rint(x / 1e-17)


def gain_energy(_batch: Batch, _x: FloatArray, v: FloatArray, _step: int) -> None:
    v *= 1.005


def cut_off(batch: Batch, _x: FloatArray, v: FloatArray, _step: int) -> None:
    frequency = np.array([[lane.chain.resonator_frequency] for lane in batch.lanes])
    v[:] = clipped(v, 50 * batch.scale * frequency)


def with_coefficients(what: str, change: Callable[[FloatArray], FloatArray]) -> Fault:
    """Change coefficients of friction."""
    return Fault(what, numbers={"bound": lambda of: np.array([
        change(own.chain.friction_coefficient) * own.chain.normal_force for own in of.lanes
    ])})  # fmt: skip


def sine(lane: Lane) -> Lane:
    """Take whatever moves the base for a sine at the resonator's frequency."""
    if isinstance(lane.drive, HarmonicBase | StillBase):
        return lane
    scale = lane.drive.displacement_scale(lane.chain)
    return replace(lane, drive=HarmonicBase(scale, lane.chain.resonator_frequency))


def begins(what: str, **changes: Callable[[Batch, State], Any]) -> Fault:
    """Begin from another state than that which is given."""
    return Fault(what, around=lambda batch, state, *asked: batch.advanced(
        replace(state, **{name: change(batch, state) for name, change in changes.items()}), *asked
    ))  # fmt: skip


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


def one_is_not_a_number(run: Trajectory) -> FloatArray:
    wrong = run.velocities.copy()
    wrong[run.steps // 2, 1] = np.nan
    return wrong


def grounded(lane: Lane, run: Trajectory) -> Trajectory:
    pressing = lane.preloads(round(run.time[0] / lane.time_step) - 1, run.steps)
    return replace(run, normal_force=np.maximum(pressing, 0.0))


OF_CLAUSES: Mapping[str, Fault] = {
    # of presets
    "a+b": Fault("nothing, with a name that a regular expression reads otherwise", presets=PRESETS, radian=1.0),
    "milliradian": Fault("scenes in milliradians", presets=PRESETS, radian=1000.0),
    "unsaid": Fault(
        "an option without a reason", presets={"tuned": replace(TUNED, options={"gain": Option(1, 0, "")})}
    ),
    "lawless": Fault("another step than its law says", numbers={"stopping": lambda _: 0.24}, presets=PRESETS),
    "no-law": Fault("a law that cannot be made", presets={"tuned": TUNED, "default": OTHER}),
    # of the chain and its drive
    "kilogram-force": Fault(
        "springs in kgf/mm", numbers={"forces": lambda of: 1000 / 9.81 * of.forces}, presets=PRESETS
    ),
    "sine": Fault("every drive is a sine", numbers={"driven": lambda of: tuple(map(sine, of.lanes))}),
    "slippery": with_coefficients("friction coefficients of at least 0.05", lambda mu: np.maximum(mu, 0.05)),
    "rubber": with_coefficients("friction coefficients of at most 0.9", lambda mu: np.minimum(mu, 0.9)),
    # of the step
    "energy": Fault("velocities × 1.005 in every step", state=gain_energy),
    "quantum": Fault("positions in multiples of 1e-17 m", state=round_positions),
    "cuts": Fault("no velocity above fifty times that of the drive", state=cut_off),
    "late-bound": Fault("friction by the normal force before", pressing=lambda parts: np.roll(parts, 1, axis=0)),
    "rigid": Fault("friction bounds that do not follow the normal force", pressing=np.ones_like),
    "holds-no-more": Fault(
        "static friction as kinetic friction", numbers={"static_ratio": lambda of: np.ones_like(of.step)}
    ),
    "never-lets-go": Fault(
        "kinetic friction as static friction",
        numbers={"bound": lambda of: of.static_ratio * of.bound, "static_ratio": lambda of: np.ones_like(of.step)},
    ),
    # of how runs follow each other
    "remembers": Fault("hidden state: 1e-12 of the last run's velocity", around=remembering(1e-12)),
    "wears": Fault("friction bounds × 0.99 after 200 runs", around=wear_out),
    "rounds": begins("5e-13 U0 more in every run", positions=lambda of, state: state.positions + 5e-13 * of.scale),
    "crosstalk": begins(
        "chains that feel each other", positions=lambda _, q: q.positions + 1e-9 * np.mean(q.positions, axis=0)
    ),
    "lands": begins("every run begins with closed contacts", internal_state=lambda *_: None),
    "counts": Fault("steps counted in 15 bits", around=lambda of, q, k, *more: of.advanced(q, k % 2**15, *more)),
    "short": Fault("no last step in runs without a record", around=stop_short),
    "by-chance": Fault("NaN in one of a hundred runs", around=fail_by_chance),
    "shapes": Fault(
        "any state is taken", around=lambda of, _, *more: of.advanced(State.at_rest(*of.bound.shape), *more)
    ),
    # of what is recorded
    "sign": records("recorded friction of the wrong sign", "friction", lambda run: -run.friction),
    "presses": records(
        "pressed by slip", "normal_force", lambda run: run.normal_force * (1 + np.abs(run.relative_velocity))
    ),
    "grounded": Fault("contacts that never fly", record=grounded),
    "velocity": records("one velocity is not a number", "velocities", one_is_not_a_number),
}
"""Engines that break a clause of the contract, or that a check of single numbers finds."""
