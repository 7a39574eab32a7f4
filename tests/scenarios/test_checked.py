"""One wrong number in what an engine reports fails its run, with the array, the time and the cell."""

import re
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from multibody_xval.scenarios.cases.motions import ChainMotion
from multibody_xval.scenarios.compute.batch import run_batch
from multibody_xval.scenarios.compute.checked import TrajectoryFault, check_trajectory
from multibody_xval.scenarios.model import Case, Config, Run
from reference_lcp import Chain, HarmonicBase, Lane, RickerPulse, StillBase
from reference_lcp.chain.trajectory import State, Trajectory
from reference_lcp.schemes.euler import CompiledSimulation
from reference_lcp.validation import FloatArray

USUAL = {"cells": 2, "friction_ratio": 0.1, "time": 0.4, "rows": 100}
CASES = [
    Case(friction_ratio=0.3, frequency_ratio=0.9, cells=2),
    ChainMotion(drive=RickerPulse(0.01, 31.6, 0.35), **USUAL),
    ChainMotion(drive=StillBase(0.01), shape="stretched", recorded="decay", **USUAL),
]


def test_a_wrong_number_fails_every_kind_of_case_and_is_named(install) -> None:
    with install("faulty").visible():
        sound = [run_batch([Run(Config("faulty-sound"), case, 400)])[0] for case in CASES]
        wrong = [run_batch([Run(Config("faulty-velocity"), case, 400)])[0] for case in CASES]
    assert [own.status for own in sound] == ["periodic", "finished", "finished"]
    for result in wrong:
        assert result.status == "failed"
        assert re.fullmatch(r"the engine's velocity is not finite at \d\S* s in cell 2: nan", result.reason)


CHAIN = Chain.from_ratios(cells=2, friction_ratio=[0.3, 0.0])
LANE = Lane.periodic(CHAIN, HarmonicBase.from_ratio(CHAIN, 0.9), 400)


def ran(start: int = 0) -> Trajectory:
    """Run the reference; with gaps and a state of contacts, as engines have them whose contacts open."""
    run = CompiledSimulation([LANE]).run(State.at_rest(1, 2), start, 100)[0]
    return replace(run, normal_gap=np.zeros((100, 2)), internal_state=np.zeros(4))


def with_last(number: float) -> Callable[[FloatArray], FloatArray]:
    """Put a number into the last place of an array."""
    return lambda values: np.append(values.ravel()[:-1], number).reshape(values.shape)


LAST = r"at \d\S* s in cell 2"
WRONG = {
    "position": ("positions", with_last(np.inf), f"not finite {LAST}: inf"),
    **{name.replace("_", " "): (name, with_last(np.nan), f"not finite {LAST}: nan")
       for name in ("friction", "normal_force", "normal_gap", "internal_state")},
    "time of row 99": ("time", with_last(7.0), r"7 s; allowed: \d\S* s"),
    "time of row 0": ("time", lambda time: time + 0.01 * LANE.time_step, r"\d\S* s; allowed: \d\S* s"),
}  # fmt: skip


@pytest.mark.parametrize("name", WRONG)
def test_array_time_and_cell_of_a_wrong_number_are_named(name: str) -> None:
    array, spoil, problem = WRONG[name]
    check_trajectory(ran(), LANE, 0, 100)
    with pytest.raises(TrajectoryFault, match=f"^the engine's {name} is {problem}$"):
        check_trajectory(replace(ran(), **{array: spoil(getattr(ran(), array))}), LANE, 0, 100)


@pytest.mark.parametrize("name", ["positions", "velocities", "friction", "normal_force", "time"])
def test_array_of_another_shape_or_type_is_refused_and_one_in_single_precision_passes(name: str) -> None:
    """Of half precision three digits are left, and half of a complex number."""
    run, own = ran(), getattr(ran(), name)
    if name != "time":
        check_trajectory(replace(run, **{name: own.astype(np.float32)}), LANE, 0, 100)
    with pytest.raises(TrajectoryFault, match=r"the shape \(99,.*; allowed: \(100,"):
        check_trajectory(replace(run, **{name: own[:-1]}), LANE, 0, 100)
    for kind in ("float16", "complex128", "int64", "object"):
        with pytest.raises(TrajectoryFault, match=f" is of type {kind}; allowed: float64 or float32$"):
            check_trajectory(replace(run, **{name: own.astype(kind)}), LANE, 0, 100)


def test_times_of_a_million_steps_may_be_added_up_one_by_one() -> None:
    """They are still the lane's, rounded."""
    every = np.add.accumulate(np.full(10**6 + 100, LANE.time_step))
    check_trajectory(replace(ran(10**6), time=every[10**6 :]), LANE, 10**6, 100)
