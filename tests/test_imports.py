"""Every command explains itself; help, the list of engines and a session of pytest import nothing heavy."""

import json
import subprocess
import sys
from functools import cache
from pathlib import Path

from multibody_xval.engines.interface.registry import engine, engine_names
from multibody_xval.engines.shared.pip_engine import PipEngine
from multibody_xval.reports.cli import console_script
from multibody_xval.reports.cli.run import STUDIES


def below(path, command):
    """Every command of a command, with its path as it is typed."""
    yield path, command
    if hasattr(command, "list_commands"):
        for name in command.list_commands(None):
            yield from below(f"{path} {name}", command.get_command(None, name))


@cache
def commands():
    """Give every command by its path."""
    return dict(own for name in console_script.COMMANDS for own in below(name, console_script.loaded(name)))


def test_help_of_every_command_says_what_it_does_with_an_example() -> None:
    for path, command in commands().items():
        assert command.help, path
        if not hasattr(command, "commands") or command.invoke_without_command:
            assert f"Example: multibody-xval {path}" in " ".join(command.help.split())


@cache
def heavy() -> tuple[str, ...]:
    """Give packages that compute, tabulate or draw, each of which takes a tenth of a second or more to import."""
    every = [own for name in engine_names() if isinstance(own := engine(name), PipEngine)]
    of_engines = {"siconos", "ode", "warp", *(own.module.partition(".")[0] for own in every)}
    return ("numba", "scipy", "pandas", "xarray", "h5py", "matplotlib", "jinja2", "PIL", *sorted(of_engines))


OF_CATALOGUE = {"numpy", "numba", "scipy", "pandas"}
"""What the catalogue of scenarios imports: together less than a second."""

MODULES = [
    "multibody_xval.engines.contract.plugin", "reference_lcp", "multibody_xval", "multibody_xval.engines",
    "multibody_xval.scenarios", "multibody_xval.reports",
]  # fmt: skip

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


def of_scenario(command: str) -> bool:
    """Tell the command of a scenario, `run NAME`, from all others."""
    run, name, *_ = [*command.split(), ""]
    return run == "run" and name not in (*STUDIES, "--help")


def test_help_packages_and_the_list_of_engines_import_nothing_that_computes() -> None:
    """The commands of scenarios are the catalogue's, whose cases are numbers: they know what arrays are."""
    scenarios = [path for path in commands() if of_scenario(path)]
    paths = [path for path in commands() if path not in scenarios] + scenarios[:1]
    lines = sorted([*(f"{path} --help" for path in paths), "engines", "engines --json"], key=of_scenario)
    words = [sys.executable, "-c", LOOK, json.dumps([MODULES, lines, heavy()])]
    told = json.loads(subprocess.run(words, cwd=Path(__file__).parents[1], capture_output=True, check=True).stdout)
    assert list(told) == [*MODULES, *lines]
    for name, (code, printed, imported) in told.items():
        assert (name, code, printed) == (name, 0, True)
        assert set(imported) <= (OF_CATALOGUE if of_scenario(name) else set()), name


OWN_TEST = """
import sys, time

def test_own():
    plugins = "multibody_xval.engines.contract.plugin", "multibody_xval.scenarios.agreement.plugin"
    assert set(plugins) <= set(sys.modules)
    assert [name for name in {heavy!r} if name in sys.modules] == []
    assert "multibody_xval.engines.interface" not in sys.modules
    seconds = []
    for _ in range(3):
        for name in [name for name in sys.modules if name.startswith("multibody_xval")]:
            del sys.modules[name]
        begin = time.process_time()
        for plugin in plugins:
            __import__(plugin)
        seconds.append(time.process_time() - begin)
    assert min(seconds) < 0.02
"""


def test_pytest_of_others_imports_no_engine_where_the_suite_is_installed_and_loses_less_than_20_ms(tmp_path) -> None:
    """Of a processor, the least of three: other programs run beside it."""
    (tmp_path / "test_own.py").write_text(OWN_TEST.format(heavy=("numpy", *heavy())))
    words = ["-m", "pytest", "-q", "-p", "no:cacheprovider", "-p", "no:xdist", "-p", "no:hypothesispytest"]
    done = subprocess.run([sys.executable, *words], cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout
