"""A sweep as labelled arrays, in a file, and back as the table that it was."""

from pathlib import Path

import pandas as pd
import xarray as xr

from multibody_xval.scenarios.compute.batch import run_batch
from multibody_xval.scenarios.dataset import by_tolerance, dataset, judged_table, sweep_in, write
from multibody_xval.scenarios.judge import judged
from multibody_xval.scenarios.result_tables import now, points
from multibody_xval.scenarios.sweep_file import sweep_of


def test_a_file_gives_back_the_judged_points(tmp_path: Path) -> None:
    grid = {"friction_ratio": [0.1, 0.3], "frequency_ratio": [0.7, 1.1]}
    sweep = sweep_of({"engines": ["reference"], "grid": grid, "chain": {"cells": 1}})
    table = judged(points(now({run: run_batch([run])[0] for run in sweep.runs()})))
    data = dataset(sweep, table)
    assert dict(data.sizes) == {"configuration": 1, "friction_ratio": 2, "frequency_ratio": 2}
    assert data.transmittance_db.attrs["units"] == "dB"
    assert sweep_in(data) == sweep
    for name in ("own.nc", "own.csv"):
        write(data, tmp_path / name)
    assert len(pd.read_csv(tmp_path / "own.csv")) == 4
    with xr.open_dataset(tmp_path / "own.nc", engine="h5netcdf") as read:
        again = judged_table(read.load())
    order = ["friction_ratio", "frequency_ratio"]
    expected = sweep.own_points(table).sort_values(order).reset_index(drop=True)
    names = ["case", "steps", "ratio", "exact", "status", "verdict", "stuck", "error_percent", "config", "version"]
    pd.testing.assert_frame_equal(again.sort_values(order)[names], expected[names], check_dtype=False)
    assert set(by_tolerance(again, 1e-9).verdict) == {"deviates"}
