"""Results of a small sweep, run once: two engines, one of them with default options too, and the ruler."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import pytest

from multibody_xval.engines.interface.registry import engine
from multibody_xval.reports.page.drift import drift_runs
from multibody_xval.scenarios import edges
from multibody_xval.scenarios.compute.batch import run_batch
from multibody_xval.scenarios.model import Config, Result, Run
from multibody_xval.scenarios.result_tables import now, points
from multibody_xval.scenarios.store import Store, Stored
from multibody_xval.scenarios.sweeps.file import sweep_of

ENGINES = ["reference", "mujoco", "mujoco:joint:default"]

SWEEP = {
    "engines": ENGINES,
    "grid": {"friction_ratio": [0.3], "frequency_ratio": [0.6, 0.7, 1.1]},
    "chain": {"cells": 3},
}  # fmt: skip


@pytest.fixture(scope="session")
def results() -> dict[Run, Result]:
    """Every run of the sweep and of its band edges."""
    engines = [*ENGINES, *["pybullet"] * (engine("pybullet").unavailable_reason() is None)]
    sweep = sweep_of({**SWEEP, "engines": engines})
    found: dict[Run, Result] = {}
    new: Sequence[Run] = sweep.runs()
    while new := [run for run in new if run not in found]:
        found |= {run: run_batch([run])[0] for run in new}
        new = edges.propose(points(now(found)))
    return found


@pytest.fixture(scope="session")
def stored(results: dict[Run, Result]) -> list[Stored]:
    return now(results)


@pytest.fixture(scope="session")
def stacks() -> list[Stored]:
    """Three boxes on a slope, with MuJoCo's default options and with the recipe."""
    configs = [Config("mujoco", "contact", name) for name in ("default", "recommended")]
    return now({run: run_batch([run])[0] for run in drift_runs([*configs, Config("mujoco")])})


def kept(results: dict[Run, Result], file: Path) -> Path:
    """Write a store."""
    store = Store(file)
    store.add(results)
    store.close()
    return file


def spoilt(results: dict[Run, Result], config: Config, factor: complex) -> dict[Run, Result]:
    """Give results in which one configuration is off by a factor."""
    return {
        run: replace(own, transmittance=own.transmittance * factor) if run.config == config else own
        for run, own in results.items()
    }
