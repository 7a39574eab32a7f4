"""Band edges of a dataset as a table: exact where there is a closed form, and a reason where a curve has none."""

import json

import numpy as np
import pandas as pd
import pytest
import xarray as xr
from scipy.optimize import brentq

from multibody_xval import ParameterError, band_edges, sweep
from multibody_xval.scenarios.model import Case, linear_limits

pytestmark = pytest.mark.usefixtures("here")

FREQUENCIES = [0.5, 0.6, 0.7, 0.8, 0.85, 0.9, 1.0, 1.2, 1.4, 1.45, 1.5]
CHAIN = {"cells": 2}


@pytest.fixture(scope="module")
def data(here) -> xr.Dataset:
    return sweep(["reference", "mujoco", "mujoco:joint:default"], [0.0, 0.3], FREQUENCIES, chain=CHAIN)


@pytest.fixture(scope="module")
def found(data: xr.Dataset) -> pd.DataFrame:
    return band_edges(data)


def free(eta: float) -> float:
    """Level of the frictionless chain in closed form: its logarithm is 0 at an edge."""
    return float(np.log(abs(linear_limits(Case(friction_ratio=0.0, frequency_ratio=eta, cells=2))[0])))


@pytest.mark.parametrize(("edge", "ends"), [("lower", (0.8, 0.9)), ("upper", (1.2, 1.5))])
def test_edges_without_friction_are_those_of_the_linear_chain(found: pd.DataFrame, edge: str, ends) -> None:
    exact = brentq(free, *ends, xtol=1e-12)
    rows = found[(found.friction_ratio == 0.0) & (found.edge == edge)]
    assert len(rows) == 3
    assert rows.exact.to_numpy() == pytest.approx(exact, abs=1e-6)
    assert (np.abs(rows.frequency_ratio - exact) <= rows.error_bar + 1e-6).all()
    assert (rows.error_bar < 1e-4).all()
    assert rows.error.to_numpy() == pytest.approx((rows.frequency_ratio - exact).to_numpy(), abs=1e-6)
    assert set(rows.verdict) == {"agrees"}


def test_columns_begin_with_the_case_and_its_edge(found: pd.DataFrame, data: xr.Dataset) -> None:
    first = ["friction_ratio", "edge", "frequency_ratio", "error_bar"]
    assert list(found) == [*first, "configuration", "exact", "error", "expected", "allowed", "verdict", "reason"]
    assert set(found.configuration) == set(data.configuration.values.tolist())
    alone = band_edges(data.sel(configuration="reference"))
    assert list(alone) == [*first, "reason"]
    own = found[found.configuration == "reference"]
    np.testing.assert_array_equal(alone.frequency_ratio, own.frequency_ratio)


def test_transmittance_at_an_edge_is_that_of_the_base(found: pd.DataFrame) -> None:
    edge = found[(found.friction_ratio == 0.3) & (found.configuration == "mujoco") & (found.edge == "lower")]
    there = sweep("mujoco", 0.3, edge.frequency_ratio.tolist(), chain=CHAIN)
    assert abs(there.transmittance_db.item()) < 1e-3


def test_an_edge_that_friction_moves_deviates_with_soft_friction(found: pd.DataFrame) -> None:
    rows = found[(found.friction_ratio == 0.3) & (found.edge == "lower")].set_index("configuration")
    assert rows.verdict.to_dict() == {"reference": "agrees", "mujoco": "agrees", "mujoco:joint:default": "deviates"}
    assert abs(rows.error["mujoco:joint:default"]) > 10 * rows.allowed["mujoco:joint:default"]
    own = rows.loc["mujoco"]  # shares the scheme: beside the reference, not the exact motion
    assert own.expected == rows.frequency_ratio["reference"]
    assert abs(own.frequency_ratio - own.expected) <= own.allowed < abs(own.error)


def test_a_curve_without_an_edge_has_a_row_that_says_why(found: pd.DataFrame) -> None:
    rows = found[(found.friction_ratio == 0.3) & (found.edge == "upper")]
    assert len(rows) == 3
    assert rows.frequency_ratio.isna().all()
    assert set(rows.reason) == {"below 0 dB up to 1.5"}
    assert set(rows.verdict) == {"agrees"}
    assert (found.reason[found.frequency_ratio.notna()] == "").all()


GRIDS = {
    "below 0 dB from 0.7 on": ([0.7, 0.9, 1.2, 1.3], "lower"),
    "no attenuation below -10 dB up to 0.56": ([0.5, 0.52, 0.54, 0.56], "lower"),
    "fewer than 4 points: too few to say": ([0.5, 0.55], "lower"),
}


@pytest.mark.parametrize("reason", GRIDS)
def test_where_no_curve_has_an_edge_the_table_has_all_rows(data: xr.Dataset, reason: str) -> None:
    etas, edge = GRIDS[reason]
    rows = band_edges(sweep(["mujoco", "mujoco:contact"], 0.3, etas, chain=CHAIN))
    assert len(rows) == 4
    assert set(rows.reason[rows.edge == edge]) == {reason}
    assert rows.frequency_ratio.dtype == float


def test_a_curve_that_is_never_periodic_says_so(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("multibody_xval.scenarios.compute.steady.MOST_PERIODS", 1)
    rows = band_edges(sweep("mujoco:joint:default", 0.3, [0.6, 0.8, 0.9, 1.1], chain=CHAIN))
    assert set(rows.reason) == {"not periodic at 4 points"}


def test_edges_of_a_part_are_those_of_the_whole(found: pd.DataFrame, data: xr.Dataset) -> None:
    part = band_edges(data.sel(friction_ratio=0.3, configuration=["reference", "mujoco"]))
    whole = found[(found.friction_ratio == 0.3) & found.configuration.isin(["reference", "mujoco"])]
    np.testing.assert_allclose(part.frequency_ratio, whole.frequency_ratio, rtol=0, atol=1e-9)


def test_points_of_the_data_are_not_run_again(data: xr.Dataset, monkeypatch: pytest.MonkeyPatch) -> None:
    from multibody_xval.scenarios.running import pool

    runs, batch = [], pool.run_batch
    monkeypatch.setattr(pool, "run_batch", lambda own: runs.extend(own) or batch(own))
    band_edges(data.sel(configuration="mujoco"))
    again = [run for run in runs if str(run.config) == "mujoco" and run.case.frequency_ratio in FREQUENCIES]
    assert again == []
    assert any(str(run.config) == "mujoco" for run in runs)
    of_other_code = json.dumps({"mujoco": {"sources": "another"}})
    band_edges(data.sel(configuration="mujoco").assign_attrs(configurations=of_other_code))
    again = [run for run in runs if str(run.config) == "mujoco" and run.case.frequency_ratio in FREQUENCIES]
    assert len(again) == 2 * len(FREQUENCIES)


def test_each_number_of_steps_has_edges_of_its_own() -> None:
    """Euler's error of an edge falls with the step: at half the step it is half as large at most."""
    data = sweep("reference", 0.0, FREQUENCIES, vary={"steps_per_period": [400, 800]}, chain=CHAIN)
    rows = band_edges(data).query("edge == 'lower'")
    assert rows.steps_per_period.tolist() == [400, 800]
    exact = brentq(free, 0.8, 0.9, xtol=1e-12)
    coarse, fine = (rows.frequency_ratio - exact).tolist()
    assert 0 < fine < 0.5 * coarse
    assert (np.abs(rows.frequency_ratio - exact) <= rows.error_bar + 1e-6).all()


def test_another_version_of_an_engine_refines_no_edge(data: xr.Dataset) -> None:
    other = data.assign(version=data.version.where(data.configuration != "mujoco", "1.0"))
    message = r"the data are of mujoco 1\.0, and .* is installed; allowed: the same version, or data\.sel\(\.\.\.\)"
    with pytest.raises(ParameterError, match=message):
        band_edges(other)
    assert len(band_edges(other.sel(configuration="reference"))) == 4


def test_an_adaptive_sweep_has_edges_too() -> None:
    grid = {"first": 0.5, "last": 1.5, "accuracy_db": 3.0, "least_spacing": 0.01}
    rows = band_edges(sweep(["reference", "mujoco"], 0.0, grid, chain=CHAIN))
    exact = brentq(free, 0.8, 0.9, xtol=1e-12)
    lower = rows[rows.edge == "lower"]
    assert lower.exact.to_numpy() == pytest.approx(exact, abs=1e-6)
    assert set(lower.verdict) == {"agrees"}
