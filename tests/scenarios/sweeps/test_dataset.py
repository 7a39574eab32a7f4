"""A sweep as labelled arrays with units, and back as the table that it was; what no sweep has written is refused."""

import json

import pandas as pd
import pytest
import xarray as xr

from multibody_xval.scenarios.compute.batch import run_batch
from multibody_xval.scenarios.model import failed
from multibody_xval.scenarios.result_tables import now, points
from multibody_xval.scenarios.ruler.judge import judged
from multibody_xval.scenarios.sweeps.dataset import by_tolerance, dataset, judged_table, sweep_in
from multibody_xval.scenarios.sweeps.file import sweep_of
from reference_lcp.errors import ParameterError

SWEEP = sweep_of({
    "engines": ["reference"], "grid": {"friction_ratio": [0.3, 0.1], "frequency_ratio": [0.7, 1.1], "cells": [1, 2]},
})  # fmt: skip


@pytest.fixture(scope="module")
def table() -> pd.DataFrame:
    return judged(points(now({run: run_batch([run])[0] for run in SWEEP.runs()})))


@pytest.fixture(scope="module")
def data(table: pd.DataFrame) -> xr.Dataset:
    return dataset(SWEEP, table)


def test_axes_are_in_the_order_of_the_sweep_and_everything_has_a_unit(data: xr.Dataset) -> None:
    sizes = {"configuration": 1, "friction_ratio": 2, "frequency_ratio": 2, "cells": 2, "cell": 2}
    assert dict(data.sizes) == sizes
    assert data.friction_ratio.values.tolist() == [0.3, 0.1]
    assert data.transmittance_db.attrs["units"] == "dB"
    for name in ("friction_ratio", "frequency_ratio", "cells", "error_db", "exact_deg", "seconds", "stuck_fraction"):
        assert "units" in data[name].attrs, name
    assert data.friction_ratio.attrs["long_name"].startswith("friction bound")
    assert sweep_in(data) == SWEEP


def test_the_judged_points_come_back(table: pd.DataFrame, data: xr.Dataset) -> None:
    again = judged_table(data)
    order = ["friction_ratio", "frequency_ratio", "cells"]
    expected = SWEEP.own_points(table)
    names = ["case", "curve", "steps", "ratio", "exact", "status", "verdict", "stuck", "error_percent", "config",
             "version", "judged", "shares_scheme", "mass_ratio"]  # fmt: skip
    one, other = (own.sort_values(order).reset_index(drop=True)[names] for own in (again, expected))
    pd.testing.assert_frame_equal(one, other, check_dtype=False)


def test_where_contacts_open_nothing_is_judged_in_a_dataset_either() -> None:
    grid = {"friction_ratio": [0.3], "frequency_ratio": [0.9], "modulation": [0.5, 1.5]}
    sweep = sweep_of({"engines": ["pybullet:contact"], "grid": grid, "chain": {"cells": 1}})
    again = judged_table(dataset(sweep, judged(points(now({run: failed("crashed") for run in sweep.runs()})))))
    assert dict(zip(again.modulation, again.judged, strict=True)) == {0.5: True, 1.5: False}
    assert dict(zip(again.modulation, again.shares_scheme, strict=True)) == {0.5: True, 1.5: False}


def test_where_a_sweep_has_no_point_it_is_missing_and_a_tolerance_decides_instead_of_the_ruler(table) -> None:
    part = dataset(SWEEP, table[table.friction_ratio == 0.1])
    assert set(part.status.sel(friction_ratio=0.3).values.ravel()) == {"missing"}
    assert set(part.status.sel(friction_ratio=0.1).values.ravel()) == {"periodic"}
    assert len(judged_table(part)) == 4
    assert judged_table(dataset(SWEEP, table[:0])).empty
    assert set(by_tolerance(table, 1e-9).verdict) == {"deviates"}
    assert set(by_tolerance(table, 10.0).verdict) == {"agrees"}


def with_attribute(value: object) -> object:
    return lambda data: data.assign_attrs(sweep=value)


FOREIGN = json.dumps({"engines": ["nope"], "grid": {"friction_ratio": [0.1], "frequency_ratio": [0.1]}})

SPOILT = {
    "the data have no attribute 'sweep'": lambda data: data.drop_attrs(),
    "attribute 'sweep' of the data: .*; allowed": with_attribute("[" * 5000),
    "attribute 'sweep' of the data: engine = 'nope' is unknown": with_attribute(FOREIGN),
    "the data are not as a sweep gives them: .*exact_real.*; allowed: what multibody_xval.sweep gives": lambda data: (
        data.drop_vars("exact_real")
    ),
    "not as a sweep gives them: Unable to parse string": lambda data: data.assign(transmittance_db=data.status),
    "friction_ratio = -0.3": lambda data: data.assign_coords(friction_ratio=[-0.3, 0.1]),
    "engine = 'mujocko' is unknown": lambda data: data.assign_coords(configuration=["mujocko"]),
    "data is a DataFrame; allowed: the dataset of a sweep": lambda _: pd.DataFrame(),
}


@pytest.mark.parametrize("message", SPOILT)
def test_what_no_sweep_has_written_is_refused(data: xr.Dataset, message: str) -> None:
    assert len(judged_table(data)) == 8
    with pytest.raises(ParameterError, match=message):
        judged_table(SPOILT[message](data))
