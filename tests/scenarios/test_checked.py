"""One wrong number in what an engine reports fails its run, with the array, the time and the cell."""

import re
from dataclasses import replace

import numpy as np
import pytest

from multibody_xval.scenarios.cases.motions import ChainMotion
from multibody_xval.scenarios.compute.batch import run_batch
from multibody_xval.scenarios.compute.checked import TIME_MARGIN, TrajectoryFault, check_trajectory
from multibody_xval.scenarios.model import Case, Config, Run
from reference_lcp import Chain, HarmonicBase, Lane, RickerPulse, StillBase
from reference_lcp.chain.trajectory import State, Trajectory
from reference_lcp.schemes.euler import CompiledSimulation

NUMBER = r" at \d\S* s in cell 2"
FAULTS = {
    "faulty-normal": f"normal force is not finite{NUMBER}: nan",
    "faulty-friction": f"friction is not finite{NUMBER}: nan",
    "faulty-position": f"position is not finite{NUMBER}: inf",
    "faulty-velocity": f"velocity is not finite{NUMBER}: nan",
    "faulty-gap": f"normal gap is not finite{NUMBER}: nan",
    "faulty-internal": f"internal state is not finite{NUMBER}: nan",
    "faulty-time": r"time of row \d+ is 7 s; allowed: \d\S* s",
    "faulty-timeless": r"time of row \d+ is nan s; allowed: \d\S* s",
}


def runs_of(name: str) -> list[Run]:
    """Give a run of every kind of case that an engine can represent: some faults are in contacts that open."""
    lifts = name in ("faulty-gap", "faulty-internal")
    steady = Case(friction_ratio=0.3, frequency_ratio=0.9, cells=2, modulation=1.5 if lifts else 0.0)
    usual = {"cells": 2, "friction_ratio": 0.1, "time": 0.4, "rows": 100}
    pulse = ChainMotion(drive=RickerPulse(0.01, 31.6, 0.35), **usual)
    decay = ChainMotion(drive=StillBase(0.01), shape="stretched", recorded="decay", **usual)
    return [Run(Config(name), case, 400) for case in (steady, *([] if lifts else [pulse, decay]))]


def test_a_wrong_number_fails_every_kind_of_case_and_is_named(install) -> None:
    with install("faulty").visible():
        sound = [run_batch([run])[0].status for run in runs_of("faulty-sound")]
        found = [(name, run_batch([run])[0]) for name in FAULTS for run in runs_of(name)]
    assert sound == ["periodic", "finished", "finished"]
    for name, result in found:
        assert result.status == "failed"
        assert re.fullmatch(f"the engine's {FAULTS[name]}", result.reason), result.reason


CHAIN = Chain.from_ratios(cells=2, friction_ratio=[0.3, 0.0])
LANE = Lane.periodic(CHAIN, HarmonicBase.from_ratio(CHAIN, 0.9), 400)


def ran(start: int = 0) -> Trajectory:
    return CompiledSimulation([LANE]).run(State.at_rest(1, 2), start, 100)[0]


@pytest.mark.parametrize("start", [0, 10**6])
def test_times_may_be_rounded(start: int) -> None:
    """Those of a million steps that were added up one by one are still the lane's."""
    run = ran(start)
    check_trajectory(run, LANE, start, 100)
    every = np.add.accumulate(np.full(start + 100, LANE.time_step))
    check_trajectory(replace(run, time=every[start:]), LANE, start, 100)
    late = replace(run, time=run.time + 2 * TIME_MARGIN * LANE.time_step)
    with pytest.raises(TrajectoryFault, match="the engine's time of row 0 is"):
        check_trajectory(late, LANE, start, 100)


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
