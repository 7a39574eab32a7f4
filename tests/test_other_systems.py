"""Without what only POSIX or Linux has, modules are imported, and what can run does; the rest says why it cannot.

The system is another one in a process of its own: modules are gone, and `sys.platform` says so.
"""

import os
import subprocess
import sys
from pathlib import Path

import pandas as pd
import pytest

pytestmark = pytest.mark.slow

ROOT = Path(__file__).parents[1]

GONE = {"win32": ("fcntl", "resource", "pwd", "grp", "termios", "syslog"), "darwin": ()}
"""Modules of the standard library that the systems do not have."""

FUNCTIONS = {
    "win32": ("fork", "killpg", "setsid", "getuid", "waitid", "pidfd_open", "sched_getaffinity"),
    "darwin": ("pidfd_open", "sched_getaffinity"),
}
"""Functions of `os` that they do not have."""

AS_IF = """
import os, sys
# Libraries that have chosen their files for this system when they were installed are imported as they are.
import matplotlib.pyplot, numba, numpy, pandas, scipy.optimize, h5netcdf, xarray, typer, rich.console, filelock
import dask.array, multiprocessing.connection, subprocess, tempfile, uuid, platformdirs, exudyn, mujoco
for module in {gone}:
    sys.modules[module] = None
for function in {functions}:
    if hasattr(os, function):
        delattr(os, function)
sys.platform = {system!r}
sys.argv = ["multibody-xval", *sys.argv[1:]]
from multibody_xval.reports.cli.entry_point import main
main()
"""


def elsewhere(system: str, folder: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    """Run a command as if on another system."""
    code = AS_IF.format(gone=GONE[system], functions=FUNCTIONS[system], system=system)
    done = subprocess.run(
        [sys.executable, "-c", code, *arguments],
        cwd=folder, env={**os.environ, "PYTHONPATH": str(ROOT)}, capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    return done


@pytest.mark.parametrize("system", GONE)
def test_one_chain_is_simulated_and_a_sweep_runs_in_the_process_of_the_command_and_says_so(system, tmp_path) -> None:
    done = elsewhere(system, tmp_path, "reference", "--friction-ratio", "0.3", "--frequency-ratio", "0.9")
    assert "-9.56" in done.stdout
    listed = elsewhere(system, tmp_path, "engines").stdout
    assert "reference" in listed
    assert ("siconos: another Python needs a POSIX system, and this is win32" in listed) == (system == "win32")
    assert "halted" not in listed
    (tmp_path / "sweep.toml").write_text(
        'engines = ["reference:joint", "mujoco:joint"]\n[grid]\nfriction_ratio = [0.3]\nfrequency_ratio = [0.9]\n'
    )
    done = elsewhere(system, tmp_path, "sweep", "sweep.toml", "--out", "sweep.csv")
    assert f"worker processes need Linux, and this is {system}; engines run in the process" in done.stderr
    table = pd.read_csv(tmp_path / "sweep.csv")
    assert list(table.status) == 2 * ["periodic"]
    assert list(table.verdict) == 2 * ["agrees"]
    assert not list(tmp_path.glob("*.lock"))
