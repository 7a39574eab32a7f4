"""Band edges of a dataset as a table: exact where there is a closed form, and a reason where a curve has none."""

import json

import numpy as np
import pandas as pd
import pytest
import xarray as xr
from scipy.optimize import brentq

from multibody_xval import ParameterError, band_edges, sweep
from multibody_xval.scenarios.model import Case, linear_limits
from multibody_xval.scenarios.running import pool

pytestmark = pytest.mark.usefixtures("here")

FREQUENCIES = [0.5, 0.6, 0.7, 0.8, 0.85, 0.9, 1.0, 1.2, 1.4, 1.45, 1.5]
SOFT = "mujoco:joint:default"


@pytest.fixture(scope="module")
def data(here) -> xr.Dataset:
    return sweep(["reference", "mujoco", SOFT], [0.0, 0.3], FREQUENCIES, chain={"cells": 2})


@pytest.fixture(scope="module")
def found(data: xr.Dataset) -> pd.DataFrame:
    return band_edges(data)


def at(found: pd.DataFrame, friction: float, edge: str) -> pd.DataFrame:
    rows = found[(found.friction_ratio == friction) & (found.edge == edge)].set_index("configuration")
    assert rows.index.tolist() == ["reference", "mujoco", SOFT]
    return rows


def free(eta: float) -> float:
    """Level of the frictionless chain in closed form: its logarithm is 0 at an edge."""
    return float(np.log(abs(linear_limits(Case(friction_ratio=0.0, frequency_ratio=eta, cells=2))[0])))


@pytest.mark.parametrize(("edge", "ends"), [("lower", (0.8, 0.9)), ("upper", (1.2, 1.5))])
def test_edges_without_friction_are_those_of_the_linear_chain(found: pd.DataFrame, edge: str, ends) -> None:
    exact, rows = brentq(free, *ends, xtol=1e-12), at(found, 0.0, edge)
    assert set(rows.verdict) == {"agrees"}
    assert rows.exact.to_numpy() == pytest.approx(exact, abs=1e-6)
    assert (np.abs(rows.frequency_ratio - exact) <= rows.error_bar + 1e-6).all()
    assert (rows.error_bar < 1e-4).all()


def test_an_edge_that_friction_moves_deviates_with_soft_friction_and_one_that_is_absent_says_why(found) -> None:
    rows, absent = at(found, 0.3, "lower"), at(found, 0.3, "upper")
    assert rows.verdict.tolist() == ["agrees", "agrees", "deviates"]
    assert absent.frequency_ratio.isna().all()
    assert (set(absent.reason), set(absent.verdict)) == ({"below 0 dB up to 1.5"}, {"agrees"})


def test_points_of_the_data_are_not_run_again_but_those_of_another_version(data: xr.Dataset, monkeypatch) -> None:
    runs, batch = [], pool.run_batch
    monkeypatch.setattr(pool, "run_batch", lambda own: runs.extend(own) or batch(own))
    own = data.sel(configuration="mujoco")
    band_edges(own)
    asked = {run.case.frequency_ratio for run in runs if str(run.config) == "mujoco"}
    assert asked
    assert not asked & {*FREQUENCIES}
    runs.clear()
    band_edges(own.assign_attrs(configurations=json.dumps({"mujoco": {"sources": "another"}})))
    assert {*FREQUENCIES} <= {run.case.frequency_ratio for run in runs if str(run.config) == "mujoco"}
    other = data.assign(version=data.version.where(data.configuration != "mujoco", "1.0"))
    message = r"the data are of mujoco 1\.0, and .* is installed; allowed: the same version, or data\.sel\(\.\.\.\)"
    with pytest.raises(ParameterError, match=message):
        band_edges(other)
    assert len(band_edges(other.sel(configuration="reference"))) == 4
