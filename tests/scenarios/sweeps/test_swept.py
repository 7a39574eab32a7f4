"""Sweeps against closed forms: points are steady states at their places, more of them where a curve bends; edges."""

import json
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import xarray as xr
from scipy.interpolate import PchipInterpolator
from scipy.optimize import brentq

from multibody_xval import band_edges
from multibody_xval.scenarios.model import REFERENCE, Case, Run, linear_limits
from multibody_xval.scenarios.running import pool
from multibody_xval.scenarios.running.evaluate import Means
from multibody_xval.scenarios.store import opened
from multibody_xval.scenarios.sweeps import swept as module
from multibody_xval.scenarios.sweeps.file import sweep_of
from multibody_xval.scenarios.sweeps.frequency_grid import AdaptiveGrid, level, missing, resonances
from multibody_xval.scenarios.sweeps.swept import stored_sweep, swept
from reference_lcp import Chain, HarmonicBase, ParameterError, steady_state
from tests.scenarios.in_this_process import result_of

pytestmark = pytest.mark.usefixtures("here")

FREQUENCIES = [0.5, 0.6, 0.7, 0.8, 0.85, 0.9, 1.0, 1.2, 1.4, 1.45, 1.5]
SOFT = "mujoco:joint:default"
SWEEP = sweep_of({
    "engines": ["reference", "mujoco", SOFT], "grid": {"friction_ratio": [0.0, 0.3], "frequency_ratio": FREQUENCIES},
    "chain": {"cells": 2, "mass_ratio": 0.9},
})  # fmt: skip


def free_db(eta: float, **chain: float | str) -> float:
    """Level of a chain without friction, in closed form."""
    return 20 * math.log10(abs(linear_limits(Case(friction_ratio=0.0, frequency_ratio=eta, **chain))[0]))


@pytest.fixture(scope="module")
def store(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("swept") / "own.sqlite"


@pytest.fixture(scope="module")
def data(here, store: Path) -> xr.Dataset:
    return swept(SWEEP, Means(store=store))


@pytest.fixture(scope="module")
def found(data: xr.Dataset) -> pd.DataFrame:
    return band_edges(data)


def test_every_point_is_the_steady_state_at_its_place(data: xr.Dataset) -> None:
    chain = Chain.from_ratios(cells=2, mass_ratio=0.9, friction_ratio=0.3)
    expected = steady_state(chain, HarmonicBase.from_ratio(chain, 0.9), with_error_bar=False).transmittance_db
    levels = data.transmittance_db.sel(friction_ratio=0.3, frequency_ratio=0.9)
    assert float(levels.sel(configuration="reference")) == pytest.approx(expected, abs=1e-9)
    assert float(levels.sel(configuration="mujoco")) == pytest.approx(expected, abs=1e-4)
    exact = [free_db(eta, cells=2, mass_ratio=0.9) for eta in FREQUENCIES]
    assert data.exact_db.sel(friction_ratio=0.0, configuration="mujoco").values == pytest.approx(exact, abs=1e-9)


def test_a_store_alone_and_a_second_sweep_give_the_same_and_run_nothing(data, store: Path, monkeypatch) -> None:
    monkeypatch.setattr(pool, "run_batch", lambda _: pytest.fail("a known run is run"))
    xr.testing.assert_identical(swept(SWEEP, Means(store=store)), data)
    monkeypatch.setattr(module, "computed", lambda *_, **__: pytest.fail("something is run"))
    xr.testing.assert_identical(stored_sweep(SWEEP, store), data)


def at(found: pd.DataFrame, friction: float, edge: str) -> pd.DataFrame:
    rows = found[(found.friction_ratio == friction) & (found.edge == edge)].set_index("configuration")
    return rows.loc[["reference", "mujoco", SOFT]]


@pytest.mark.parametrize(("edge", "ends"), [("lower", (0.8, 0.9)), ("upper", (1.2, 1.5))])
def test_edges_without_friction_are_those_of_the_linear_chain(found: pd.DataFrame, edge: str, ends) -> None:
    exact = brentq(lambda eta: free_db(eta, cells=2, mass_ratio=0.9), *ends, xtol=1e-12)
    rows = at(found, 0.0, edge)
    assert set(rows.verdict) == {"agrees"}
    assert ((rows.exact - exact).abs() <= rows.exact_bar).all()
    assert (rows.exact_bar < 1e-6).all()
    assert rows.error.to_numpy() == pytest.approx((rows.frequency_ratio - exact).to_numpy(), abs=1e-6)
    assert (rows.error.abs() < 1e-4).all()
    assert set(rows.note) == {""}


def test_an_edge_that_friction_moves_deviates_with_soft_friction_and_one_that_is_absent_says_why(found) -> None:
    assert at(found, 0.3, "lower").verdict.tolist() == ["agrees", "agrees", "deviates"]
    absent = at(found, 0.3, "upper")
    assert absent.frequency_ratio.isna().all()
    assert (set(absent.note), set(absent.verdict)) == ({"below 0 dB up to 1.5"}, {"agrees"})


def test_the_exact_edge_is_given_with_the_reference_alone_and_a_small_peak_that_decides_it_is_said(here) -> None:
    """The last peak of two damped cells rises by half a decibel over the threshold."""
    chain, peak = {"cells": 2, "damping_ratio": 0.1}, 0.801
    frequencies = [0.5, 0.7, peak, 0.85, 0.9, 0.95, 1.0]
    grid = {"friction_ratio": [0.0], "frequency_ratio": frequencies}
    data = swept(sweep_of({"engines": ["reference"], "grid": grid, "chain": chain}), Means())
    lower = band_edges(data).iloc[0]
    exact = brentq(lambda eta: free_db(eta, **chain), peak, 0.9, xtol=1e-12)
    assert abs(lower.exact - exact) <= lower.exact_bar < 1e-6
    assert lower.note.startswith("last peak only ")
    assert lower.note.endswith(" dB above 0 dB")
    assert float(lower.note.split()[3]) == pytest.approx(free_db(peak, **chain), abs=0.02)
    assert 0 < free_db(peak, **chain) < 1
    with pytest.raises(ParameterError, match="the data have 0 points; allowed: at least one"):
        band_edges(data.sel(frequency_ratio=slice(2.0, 3.0)))


def test_points_of_the_data_are_not_run_again_but_those_of_another_version(data: xr.Dataset, monkeypatch) -> None:
    runs, batch = [], pool.run_batch
    monkeypatch.setattr(pool, "run_batch", lambda own: runs.extend(own) or batch(own))
    own, other = data.sel(configuration="mujoco"), json.dumps({"mujoco": {"sources": "another"}})
    asked = []
    for each in (own, own.assign_attrs(configurations=other)):
        runs.clear()
        band_edges(each)
        asked.append({run.case.frequency_ratio for run in runs if str(run.config) == "mujoco"})
    assert asked[0]
    assert not asked[0] & {*FREQUENCIES}
    assert {*FREQUENCIES} <= asked[1]
    old = data.assign(version=data.version.where(data.configuration != "mujoco", "1.0"))
    message = r"the data are of mujoco 1\.0, and .* is installed; allowed: the same version, or data\.sel\(\.\.\.\)"
    with pytest.raises(ParameterError, match=message):
        band_edges(old)
    assert len(band_edges(old.sel(configuration="reference"))) == 4


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


ADAPTIVE = sweep_of({
    "engines": ["reference", "mujoco"],
    "grid": {
        "friction_ratio": [0.0, 0.3],
        "frequency_ratio": {"first": 0.5, "last": 1.5, "accuracy_db": 2.0, "least_spacing": 0.005},
    },
    "chain": {"cells": 1},
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
    exact = [level(free_db(own, cells=1, drive="force")) for own in eta.tolist()]
    assert np.abs(interpolated(eta) - exact).max() < 3.0
    assert float(adaptive.error_db.sel(friction_ratio=0.0).max()) < 0.5
    xr.testing.assert_identical(stored_sweep(ADAPTIVE, store), adaptive)
    run = Run(REFERENCE, replace(ADAPTIVE.places[0].case, frequency_ratio=0.777), 400)
    with opened(store) as kept:
        kept.add({run: result_of(run)})
    assert 0.777 not in stored_sweep(ADAPTIVE, store).frequency_ratio.values
