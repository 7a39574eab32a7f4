"""What is not used is not imported: help, the list of engines and a session of pytest load no heavy package."""

import json
import subprocess
import sys
from pathlib import Path

import pytest

from multibody_xval.reports.cli.run import STUDIES
from tests.installed import ENGINE_PACKAGES
from tests.test_help import COMMANDS

ROOT = Path(__file__).parents[1]

COMPUTING = ("numba", "scipy", "pandas", "xarray", "h5py", "matplotlib", "jinja2", "PIL", *ENGINE_PACKAGES)
"""Packages that compute, tabulate or draw; each takes a tenth of a second to a second to import."""

OF_CATALOGUE = {"numpy", "numba", "scipy", "pandas"}
"""What the catalogue of scenarios imports: together less than a second."""

HELP = """
import contextlib, io, json, sys
from multibody_xval.reports.cli.console_script import app
from multibody_xval.reports.cli.ending import run_command
commands, heavy = json.loads(sys.argv[1])
imported = {}
for command in commands:
    with contextlib.redirect_stdout(io.StringIO()) as printed:
        code = run_command(app, [*command.split(), "--help"])
    imported[command] = (code, "Usage" in printed.getvalue(), [name for name in heavy if name in sys.modules])
print(json.dumps(imported))
"""
"""Prints the help of commands, and says of each what is imported by then."""


def run_python(*arguments: str) -> str:
    """Run Python in a process of its own, and give what it prints."""
    return subprocess.run(
        [sys.executable, *arguments], cwd=ROOT, capture_output=True, text=True, encoding="utf-8", check=True
    ).stdout


def of_scenario(path: str) -> bool:
    """Tell the command of a scenario, `run NAME`, from all others."""
    run, name = path.split()[-2:] if " " in path else ("", "")
    return run == "run" and name not in STUDIES


@pytest.fixture(scope="module")
def imported_by_help() -> dict[str, tuple[int, bool, list[str]]]:
    """By command: its exit code, whether help was printed, and the heavy packages that are imported by then."""
    prefix = "multibody-xval "
    commands = sorted((path.removeprefix(prefix) for path in COMMANDS), key=of_scenario)
    told = json.loads(run_python("-c", HELP, json.dumps([commands, ["numpy", *COMPUTING]])))
    return {f"{prefix}{command}": tuple(told[command]) for command in commands}


@pytest.mark.parametrize("path", COMMANDS)
def test_help_imports_nothing_that_computes(path, imported_by_help) -> None:
    """The commands of scenarios are the catalogue's, whose cases are numbers: they know what arrays are."""
    code, printed, heavy = imported_by_help[path]
    assert (code, printed) == (0, True)
    assert set(heavy) <= (OF_CATALOGUE if of_scenario(path) else set())


@pytest.mark.parametrize("arguments", [[], ["--json"]])
def test_engines_are_listed_without_anything_that_computes(arguments) -> None:
    script = (
        "import json, sys\n"
        "from multibody_xval.reports.cli.engines import app\n"
        "from multibody_xval.reports.cli.ending import run_command\n"
        "code = run_command(app, json.loads(sys.argv[1]))\n"
        "print()\n"
        "print(json.dumps([code, [name for name in json.loads(sys.argv[2]) if name in sys.modules]]))"
    )
    *listed, last = run_python("-c", script, json.dumps(arguments), json.dumps(COMPUTING)).splitlines()
    assert json.loads(last) == [0, []]
    assert any("reference" in line for line in listed)


@pytest.mark.parametrize(
    "module",
    [
        "reference_lcp",
        "multibody_xval",
        "multibody_xval.engines",
        "multibody_xval.scenarios",
        "multibody_xval.reports",
        "multibody_xval.engines.contract.plugin",
        "multibody_xval.scenarios.agreement.plugin",
    ],
)
def test_package_is_imported_without_anything_that_computes(module) -> None:
    script = f"import json, sys, {module}; print(json.dumps([name for name in {COMPUTING!r} if name in sys.modules]))"
    assert json.loads(run_python("-c", script)) == []


def test_pytest_of_others_imports_no_engine_where_the_suite_is_installed(tmp_path) -> None:
    (tmp_path / "test_own.py").write_text(
        "import sys\n\n"
        "def test_own():\n"
        "    assert 'multibody_xval.engines.contract.plugin' in sys.modules\n"
        f"    assert [name for name in {('numpy', *COMPUTING)!r} if name in sys.modules] == []\n"
        "    assert 'multibody_xval.engines.interface' not in sys.modules\n"
    )
    done = subprocess.run(
        [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", "-p", "no:xdist", "-p", "no:hypothesispytest",
         str(tmp_path)],
        cwd=tmp_path, capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stdout
