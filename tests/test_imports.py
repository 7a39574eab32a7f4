"""Every command explains itself; help, the list of engines and a session of pytest import nothing heavy."""

import json
import subprocess
import sys
from pathlib import Path

import pytest

from multibody_xval.reports.cli import console_script
from multibody_xval.reports.cli.run import STUDIES
from tests.installed import ENGINE_PACKAGES


def commands():
    """Every command of the suite, with its path as it is typed."""
    for name in console_script.COMMANDS:
        yield from below(f"multibody-xval {name}", console_script.loaded(name))


def below(path, command):
    yield path, command
    if hasattr(command, "list_commands"):
        for name in command.list_commands(None):
            yield from below(f"{path} {name}", command.get_command(None, name))


COMMANDS = dict(commands())


@pytest.mark.parametrize("path", COMMANDS)
def test_help_says_what_the_command_does_with_an_example(path) -> None:
    command = COMMANDS[path]
    assert command.help
    if not hasattr(command, "commands") or command.invoke_without_command:
        assert f"Example: {path}" in " ".join(command.help.split())


ROOT = Path(__file__).parents[1]

COMPUTING = ("numba", "scipy", "pandas", "xarray", "h5py", "matplotlib", "jinja2", "PIL", *ENGINE_PACKAGES)
"""Packages that compute, tabulate or draw; each takes a tenth of a second to a second to import."""

OF_CATALOGUE = {"numpy", "numba", "scipy", "pandas"}
"""What the catalogue of scenarios imports: together less than a second."""

LOOK = """
import contextlib, importlib, io, json, sys
modules, commands, heavy = json.loads(sys.argv[1])
imported = {}
for module in modules:
    importlib.import_module(module)
    imported[module] = (0, True, [name for name in heavy if name in sys.modules])
from multibody_xval.reports.cli.ending import run_command
from multibody_xval.reports.cli.console_script import app
for command in commands:
    with contextlib.redirect_stdout(io.StringIO()) as printed:
        code = run_command(app, command.split())
    imported[command] = (code, bool(printed.getvalue()), [name for name in heavy if name in sys.modules])
print(json.dumps(imported))
"""
"""Imports modules and runs commands, and says of each what is imported by then."""


def run_python(*arguments: str) -> str:
    """Run Python in a process of its own, and give what it prints."""
    return subprocess.run(
        [sys.executable, *arguments], cwd=ROOT, capture_output=True, text=True, encoding="utf-8", check=True
    ).stdout


MODULES = [
    "multibody_xval.engines.contract.plugin", "reference_lcp", "multibody_xval", "multibody_xval.engines",
    "multibody_xval.scenarios", "multibody_xval.reports",
]  # fmt: skip


def of_scenario(command: str) -> bool:
    """Tell the command of a scenario, `run NAME`, from all others."""
    run, name, *_ = [*command.split(), ""]
    return run == "run" and name not in (*STUDIES, "--help")


def test_help_packages_and_the_list_of_engines_import_nothing_that_computes() -> None:
    """The commands of scenarios are the catalogue's, whose cases are numbers: they know what arrays are."""
    paths = [f"{path.removeprefix('multibody-xval ')} --help" for path in COMMANDS]
    commands = sorted([*paths, "engines", "engines --json"], key=of_scenario)
    told = json.loads(run_python("-c", LOOK, json.dumps([MODULES, commands, COMPUTING])))
    assert list(told) == [*MODULES, *commands]
    for name, (code, printed, heavy) in told.items():
        assert (name, code, printed) == (name, 0, True)
        assert set(heavy) <= (OF_CATALOGUE if of_scenario(name) else set()), name


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
