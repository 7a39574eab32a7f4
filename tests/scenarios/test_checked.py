"""One wrong number in what an engine reports fails its run, with the array, the time and the cell."""

import dataclasses
import re
from operator import itemgetter, methodcaller

import numpy as np
import pytest

from multibody_xval.scenarios.cases.motions import ChainMotion
from multibody_xval.scenarios.compute.batch import run_batch
from multibody_xval.scenarios.compute.checked import TIME_MARGIN, TrajectoryFault, check_trajectory
from multibody_xval.scenarios.model import Case, Config, Result, Run
from reference_lcp import Chain, HarmonicBase, Lane, RickerPulse, StillBase
from reference_lcp.chain.trajectory import State
from reference_lcp.schemes.euler import CompiledSimulation

LIFTING = ("faulty-gap", "faulty-internal")
"""Engines whose fault is in what contacts have that open."""


def runs_of(name: str) -> list[Run]:
    """Give a run of every kind of case that an engine can represent."""
    config, lifts = Config(name), name in LIFTING
    steady = Case(friction_ratio=0.3, frequency_ratio=0.9, cells=2, modulation=1.5 if lifts else 0.0)
    usual = {"cells": 2, "friction_ratio": 0.1, "time": 0.4, "rows": 100}
    pulse = ChainMotion(drive=RickerPulse(0.01, 31.6, 0.35), **usual)
    decay = ChainMotion(drive=StillBase(0.01), shape="stretched", recorded="decay", **usual)
    return [Run(config, case, 400) for case in (steady, *([] if lifts else [pulse, decay]))]


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


@pytest.fixture(scope="module")
def rows(install) -> dict[str, list[Result]]:
    """Results of every kind of case, by engine."""
    with install("faulty").visible():
        return {name: [run_batch([run])[0] for run in runs_of(name)] for name in ("faulty-sound", *FAULTS)}


@pytest.mark.parametrize("name", FAULTS)
def test_a_wrong_number_fails_every_kind_of_case_and_is_named(rows, name) -> None:
    assert [result.status for result in rows["faulty-sound"]] == ["periodic", "finished", "finished"]
    for result in rows[name]:
        assert result.status == "failed"
        assert re.fullmatch(f"the engine's {FAULTS[name]}", result.reason), result.reason


@pytest.fixture
def lane() -> Lane:
    """Two cells, one of them without friction."""
    chain = Chain.from_ratios(cells=2, friction_ratio=[0.3, 0.0])
    return Lane.periodic(chain, HarmonicBase.from_ratio(chain, 0.9), 400)


@pytest.mark.parametrize("start", [0, 10**6])
def test_times_may_be_rounded(lane, start) -> None:
    """Those of a million steps that were added up one by one are still the lane's."""
    run = CompiledSimulation([lane]).run(State.at_rest(1, 2), start, 100)[0]
    check_trajectory(run, lane, start, 100)
    every = np.add.accumulate(np.full(start + 100, lane.time_step))
    check_trajectory(dataclasses.replace(run, time=every[start:]), lane, start, 100)
    late = dataclasses.replace(run, time=run.time + 2 * TIME_MARGIN * lane.time_step)
    with pytest.raises(TrajectoryFault, match="the engine's time of row 0 is"):
        check_trajectory(late, lane, start, 100)


OTHERWISE = {
    r"the shape \(99,.*; allowed: \(100,": itemgetter(slice(-1)),
    **{
        f"^the engine's .* is of type {kind}; allowed: float64 or float32$": methodcaller("astype", kind)
        for kind in ("float16", "complex128", "int64", "object")
    },
}
"""Of half precision three digits are left, and half of a complex number."""


@pytest.mark.parametrize("name", ["positions", "velocities", "friction", "normal_force", "time"])
@pytest.mark.parametrize("message", OTHERWISE)
def test_array_of_another_shape_or_type_is_refused_and_one_in_single_precision_passes(lane, name, message) -> None:
    run = CompiledSimulation([lane]).run(State.at_rest(1, 2), 0, 100)[0]
    if name != "time":
        check_trajectory(dataclasses.replace(run, **{name: getattr(run, name).astype(np.float32)}), lane, 0, 100)
    with pytest.raises(TrajectoryFault, match=message):
        check_trajectory(dataclasses.replace(run, **{name: OTHERWISE[message](getattr(run, name))}), lane, 0, 100)
