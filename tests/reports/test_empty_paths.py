"""An empty path, as of a variable that is not set, is refused by its name: it would mean the folder one is in."""

from pathlib import Path

import pytest
import xarray as xr

from multibody_xval import ParameterError, check, compare, plot, report, sweep

CALLS = {
    "folder": lambda: report("sweep.nc", ""),
    "file": lambda: plot(xr.Dataset(), ""),
    "data": lambda: report("", "out"),
    "store": lambda: sweep("reference", 0.3, 0.9, store=""),
    "store ": lambda: check("unit-cell", store=" "),
    "store  ": lambda: compare("", "other.sqlite"),
}


@pytest.mark.parametrize("name", CALLS)
def test_an_empty_path_is_refused_before_anything_is_written(name: str, tmp_path: Path, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    with pytest.raises(ParameterError, match=rf"^{name.strip()} = ' ?' is empty; allowed: a path$"):
        CALLS[name]()
    assert not list(tmp_path.iterdir())
