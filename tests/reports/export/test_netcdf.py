"""A NetCDF file says by itself what its numbers are, and a report of it has the numbers of the sweep."""

import json
import re
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from multibody_xval.reports import report
from multibody_xval.scenarios import sweep

STANDARD_ATTRIBUTES = {"Conventions", "title", "source", "comment"}
"""Of the whole file, by the CF conventions."""

NAME = re.compile(r"[A-Za-z][A-Za-z0-9_]*")
MEANING = re.compile(r"[A-Za-z0-9_.+@-]+")


pytestmark = pytest.mark.usefixtures("in_this_process")


@pytest.fixture(scope="module")
def data(tmp_path_factory: pytest.TempPathFactory) -> xr.Dataset:
    return sweep(
        ["reference", "exudyn-regularised", "mujoco:joint:default"],
        [0.1, 0.3],
        [0.6, 0.9],
        chain={"cells": 2, "damping_ratio": 0.02, "mass_ratio": [1.0, 1.5]},
        steps_per_period=500,
        store=tmp_path_factory.mktemp("store") / "results.sqlite",
    )


@pytest.fixture(scope="module")
def file(data: xr.Dataset, tmp_path_factory: pytest.TempPathFactory) -> Path:
    file = tmp_path_factory.mktemp("netcdf") / "sweep.nc"
    data.to_netcdf(file, engine="h5netcdf")
    return file


@pytest.fixture(scope="module")
def read(file: Path) -> xr.Dataset:
    with xr.open_dataset(file, engine="h5netcdf") as opened:
        return opened.load()


def test_file_keeps_the_rules_of_its_conventions(read) -> None:
    assert read.attrs.keys() >= STANDARD_ATTRIBUTES
    assert read.attrs["Conventions"] == "CF-1.11"
    assert read.attrs["title"]
    for name, variable in read.variables.items():
        assert NAME.fullmatch(str(name))
        assert variable.attrs["long_name"], name
        assert variable.dtype.kind in "OU" or "units" in variable.attrs or "flag_values" in variable.attrs, name
        beside = variable.attrs.get("ancillary_variables", "").split()
        assert set(beside) <= read.variables.keys()
        if "flag_values" in variable.attrs:
            check_flags(variable)


def check_flags(variable: xr.Variable) -> None:
    """As many meanings as values, of the variable's type, and no value without one."""
    values, meanings = variable.attrs["flag_values"], variable.attrs["flag_meanings"].split()
    assert len(values) == len(set(values)) == len(meanings)
    assert all(MEANING.fullmatch(meaning) for meaning in meanings)
    assert np.asarray(values).dtype == variable.dtype
    known = variable.values[~np.isnan(variable.values)]
    assert set(known.tolist()) <= set(np.asarray(values).tolist())


def test_file_has_what_is_not_varied(read) -> None:
    fixed = {name: np.asarray(read.attrs[name]).tolist() for name in ("cells", "damping_ratio", "mass_ratio")}
    assert fixed == {"cells": 2, "damping_ratio": 0.02, "mass_ratio": [1.0, 1.5]}
    assert read.attrs["friction_profile"] == read.attrs["outer_mass_ratio"] == 1.0
    assert read.attrs["steps_per_period"] == 500
    assert (read.attrs["drive_kind"], read.attrs["drive_amplitude_units"]) == ("base", "m")
    for name in (*fixed, "steps_per_period", "drive_amplitude"):
        assert f"{name}: " in read.attrs["comment"]


def test_file_has_engines_presets_versions_and_options(read) -> None:
    mujoco = read.sel(variant="mujoco:joint:default")
    assert [str(mujoco[name].item()) for name in ("engine", "formulation", "preset")] == ["mujoco", "joint", "default"]
    described = json.loads(read.attrs["variants"])["mujoco:joint:default"]
    assert str(mujoco.version.item()) == described["version"] != ""
    assert described["options"]


def test_file_has_error_bars_and_what_is_allowed(read) -> None:
    own = read.sel(variant="exudyn-regularised")
    assert bool(own.step_error_db.notnull().all())
    agrees = own.verdict == read.verdict.attrs["flag_meanings"].split().index("agree")
    within = abs(own.difference_db) <= own.allowed_db
    assert bool(within.where(agrees, other=True).all())


@pytest.mark.slow
def test_report_of_the_file_has_the_numbers_of_the_sweep(data, file, tmp_path) -> None:
    folders = [Path(report(source, tmp_path / name)).parent for source, name in ((data, "a"), (str(file), "b"))]
    for name in ("transmittance.csv", "band_edges.csv", "transitions.csv"):
        tables = [(folder / name).read_text() for folder in folders]
        assert tables[0] == tables[1]
    assert len((folders[0] / "transmittance.csv").read_text().splitlines()) == 1 + data.status.size
    pages = [numbers_of(folder / "index.html") for folder in folders]
    assert pages[0] == pages[1]


def numbers_of(page: Path) -> list[str]:
    """Cells of the tables of a page that have a number."""
    return [cell for cell in re.findall(r"<td[^>]*>([^<]+)</td>", page.read_text()) if re.search(r"\d", cell)]
