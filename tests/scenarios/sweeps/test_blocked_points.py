"""Blocked points are kept with their reason; files hold the statuses that are printed."""

import csv
import re
from collections import Counter
from pathlib import Path

import pytest
import xarray as xr

from multibody_xval.scenarios.sweeps.dataset import STATUSES

SWEEP = """
engines = ["reference:joint", "faulty-crash:joint:tuned", "faulty-killed:joint:tuned", "faulty-sound:joint:tuned"]
[grid]
friction_ratio = [0.3]
frequency_ratio = [0.4, 0.5, 0.9]
[chain]
cells = 2
"""
"""Of two engines, the process ends at the second point: by a crash, or killed as if from outside."""

SEGMENTATION_FAULT, KILLED = "the worker process crashed: Segmentation fault", "the worker process was killed"


def printed_counts(text: str) -> Counter[tuple[str, str]]:
    """Points by variant and status, as the table of a sweep says."""
    counts: Counter[tuple[str, str]] = Counter()
    for line in text.splitlines():
        cells = re.split(r"\s{2,}", line.strip())
        if re.fullmatch(r"[a-z:-]+", cells[0]) and len(cells) == 6 and cells[1].isdigit():
            counts.update({(cells[0], str(status)): int(n) for status, n in zip(STATUSES, cells[1:5], strict=False)})
    return +counts


@pytest.fixture
def sweep(install, tmp_path: Path):
    """Run the sweep into CSV and NetCDF; gives what is printed, and the statuses in both files."""
    (tmp_path / "sweep.toml").write_text(SWEEP)
    site = install("mutations")
    command = ["-m", "multibody_xval", "sweep", str(tmp_path / "sweep.toml"), "--store", str(tmp_path / "sweep.sqlite")]

    def run(*options: str) -> tuple[str, Counter[tuple[str, str]], Counter[tuple[str, str]]]:
        out = tmp_path / "sweep.nc", tmp_path / "sweep.csv"
        printed = site.run(*command, "--out", str(out[0]), "--workers", "1", *options)
        site.run(*command, "--out", str(out[1]), "--no-run")
        rows = list(csv.DictReader(out[1].read_text().splitlines()))
        assert {row["reason"].split(",")[0] for row in rows if row["status"] == "blocked"} == {
            SEGMENTATION_FAULT, KILLED,
        }  # fmt: skip
        with xr.open_dataset(out[0], engine="h5netcdf") as data:
            numbers = data.status.to_dataframe().reset_index()
        netcdf = Counter((row.variant, str(STATUSES[row.status])) for row in numbers.itertuples())
        return printed, Counter((row["variant"], row["status"]) for row in rows), netcdf

    return run


@pytest.mark.slow
def test_statuses_in_files_are_those_printed_and_blocked_points_are_recalled(sweep) -> None:
    expected = Counter({
        ("reference:joint:converged", "converged"): 3, ("reference", "converged"): 3, ("faulty-sound", "converged"): 3,
        ("faulty-crash", "converged"): 2, ("faulty-crash", "blocked"): 1,
        ("faulty-killed", "converged"): 2, ("faulty-killed", "blocked"): 1,
    })  # fmt: skip
    for options in [], ["--retry-blocked"]:
        printed, table, netcdf = sweep(*options)
        assert printed_counts(printed) == table == netcdf == expected
        assert f"faulty-crash: 1 point: {SEGMENTATION_FAULT}" in printed
        assert f"faulty-killed: 1 point: {KILLED}" in printed


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "reason"), [("raises", "RuntimeError: no solution"), ("nan", "the engine's position")]
)
def test_an_engine_that_always_fails_fails_the_run_and_is_named_in_the_last_lines(install, name, reason) -> None:
    command = ["-m", "multibody_xval", "run", "unit-cell", "--workers", "1", "--engine", f"faulty-{name}"]
    *_, named, _, failing = install("mutations").run(*command, code=1).splitlines()
    assert named.startswith(f"unit-cell: faulty-{name} fails at 9 numbers of friction 0.6, η_r 0.9: {reason}")
    assert failing.startswith(f"unit-cell: faulty-{name}: 36 of 36 numbers")
