"""Sweeps against closed forms: every point is the steady state at its place, and points go where a curve bends."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from scipy.interpolate import PchipInterpolator

from multibody_xval.scenarios.model import REFERENCE, Case, Run, linear_limits
from multibody_xval.scenarios.running.evaluate import Means
from multibody_xval.scenarios.store import opened
from multibody_xval.scenarios.sweeps import swept as module
from multibody_xval.scenarios.sweeps.file import sweep_of
from multibody_xval.scenarios.sweeps.frequency_grid import AdaptiveGrid, level, missing, resonances
from multibody_xval.scenarios.sweeps.swept import stored_sweep, swept
from reference_lcp import Chain, HarmonicBase, steady_state
from tests.scenarios.in_this_process import result_of

pytestmark = pytest.mark.usefixtures("here")


def free_db(eta: float, **chain: int | str) -> float:
    """Level of a chain without friction, in closed form."""
    return 20 * math.log10(abs(linear_limits(Case(friction_ratio=0.0, frequency_ratio=eta, **chain))[0]))


def test_interpolated_curve_is_as_accurate_as_asked() -> None:
    """That of the paper's chain without friction, which bends most."""
    grid, levels = AdaptiveGrid(first=0.3, last=1.6, accuracy_db=0.5), dict[float, float]()
    peaks = resonances(Case(friction_ratio=0.0, frequency_ratio=1.0))
    while new := missing(grid, peaks, levels):
        levels |= {eta: free_db(eta) for eta in new}
    eta = np.array(sorted(levels))
    between = np.concatenate([(3 * eta[1:] + eta[:-1]) / 4, (eta[1:] + 3 * eta[:-1]) / 4])
    curve = PchipInterpolator(eta, [level(levels[own]) for own in eta.tolist()])
    assert np.abs(curve(between) - [level(free_db(own)) for own in between.tolist()]).max() <= 0.75


GRID = {"friction_ratio": [0.0, 0.3], "frequency_ratio": [0.5, 0.9, 1.5], "mass_ratio": [0.5, 1.0]}
SWEEP = sweep_of({"engines": ["reference", "mujoco"], "grid": GRID, "chain": {"cells": 2}})


@pytest.fixture(scope="module")
def store(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("swept") / "own.sqlite"


@pytest.fixture(scope="module")
def data(here, store: Path) -> xr.Dataset:
    return swept(SWEEP, Means(store=store))


def test_every_point_is_the_steady_state_at_its_place(data: xr.Dataset) -> None:
    chain = Chain.from_ratios(cells=2, mass_ratio=0.5, friction_ratio=0.3)
    expected = steady_state(chain, HarmonicBase.from_ratio(chain, 0.9), with_error_bar=False).transmittance_db
    place = {"friction_ratio": 0.3, "frequency_ratio": 0.9, "mass_ratio": 0.5}
    levels = data.transmittance_db.sel(place)
    assert float(levels.sel(configuration="reference")) == pytest.approx(expected, abs=1e-9)
    assert float(levels.sel(configuration="mujoco")) == pytest.approx(expected, abs=1e-4)
    assert abs(float(data.transmittance_db.sel({**place, "mass_ratio": 1.0}, drop=True)[0]) - expected) > 0.1


def test_a_store_alone_and_a_second_sweep_give_the_same_and_run_nothing(data, store: Path, monkeypatch) -> None:
    monkeypatch.setattr("multibody_xval.scenarios.running.pool.run_batch", lambda _: pytest.fail("a known run is run"))
    xr.testing.assert_identical(swept(SWEEP, Means(store=store)), data)
    monkeypatch.setattr(module, "computed", lambda *_, **__: pytest.fail("something is run"))
    xr.testing.assert_identical(stored_sweep(SWEEP, store), data)


ADAPTIVE = sweep_of({
    "engines": ["reference", "mujoco"],
    "grid": {
        "friction_ratio": [0.0, 0.3],
        "frequency_ratio": {"first": 0.5, "last": 1.5, "accuracy_db": 1.0, "least_spacing": 0.005},
    },
    "chain": {"cells": 2},
    "drive": {"kind": "force", "amplitude": 5.0},
})  # fmt: skip


def test_adaptive_curves_are_right_between_their_points_and_come_back_out_of_the_store(here, store: Path) -> None:
    """The frictionless curve, driven by a force, against the closed form; Euler's own error is part of it.

    Points of other frequencies, such as those that band edges add, are not among them.
    """
    adaptive = swept(ADAPTIVE, Means(store=store))
    curve = adaptive.transmittance_db.sel(configuration="reference", friction_ratio=0.0).dropna("frequency_ratio")
    interpolated = PchipInterpolator(curve.frequency_ratio.values, [level(own) for own in curve.values])
    eta = np.linspace(0.52, 1.48, 24)
    exact = [level(free_db(own, cells=2, drive="force")) for own in eta.tolist()]
    assert np.abs(interpolated(eta) - exact).max() < 1.5
    assert float(adaptive.error_db.sel(friction_ratio=0.0).max()) < 0.5
    xr.testing.assert_identical(stored_sweep(ADAPTIVE, store), adaptive)
    run = Run(REFERENCE, replace(ADAPTIVE.places[0].case, frequency_ratio=0.777), 400)
    with opened(store) as kept:
        kept.add({run: result_of(run)})
    assert 0.777 not in stored_sweep(ADAPTIVE, store).frequency_ratio.values
