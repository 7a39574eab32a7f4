"""An engine in an installable package of its own: found, listed and held to the contract, with nothing edited."""

import json
import subprocess
import sys
from pathlib import Path

import pytest

from multibody_xval.engines.contract import cases


def test_installed_engine_is_listed(install) -> None:
    rows = json.loads(install("plugin").run("-m", "multibody_xval", "engines", "--json"))
    assert {row["engine"]: (row["version"], row["missing"]) for row in rows}["tiny"] == ("1.2.3", None)


CONTRACT = "-m pytest -q -n 0 -p no:cacheprovider --pyargs multibody_xval.engines.contract --xval-engine"


@pytest.mark.slow
def test_installed_engine_is_held_to_the_contract(install) -> None:
    printed = install("plugin").run(*CONTRACT.split(), "tiny")
    assert int(printed.rsplit(" passed", 1)[0].split()[-1]) >= 20


def test_contract_refuses_an_engine_that_is_not_there(install) -> None:
    install("plugin").run(*CONTRACT.split(), "tinny", code=4)


def passes(folder: Path, *options: str) -> None:
    """Run the tests of a folder, with all plugins that are installed."""
    command = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", *options]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr


def test_a_project_with_an_option_of_the_same_kind_runs_beside_the_suite(tmp_path: Path) -> None:
    (tmp_path / "conftest.py").write_text(
        "def pytest_addoption(parser):\n"
        "    parser.addoption('--engine', default='diesel')\n"
        "    parser.addoption('--version-of-engine')\n"
    )
    (tmp_path / "test_engine.py").write_text(
        "def test_it(request):\n    assert request.config.option.engine == 'petrol'\n"
    )
    passes(tmp_path, "--engine", "petrol")


def test_a_session_that_does_not_use_the_option_imports_nothing_of_the_suite(tmp_path: Path) -> None:
    (tmp_path / "test_modules.py").write_text(
        "import sys\n\n\n"
        "def test_it():\n"
        "    suite = {'reference_lcp', 'multibody_xval'}\n"
        "    own = {name for name in sys.modules if name.split('.')[0] in suite}\n"
        "    plugins = ['multibody_xval.engines.contract.plugin', 'multibody_xval.scenarios.agreement.plugin']\n"
        "    assert own == {plugin.rsplit('.', up)[0] if up else plugin for plugin in plugins for up in range(4)}\n"
        "    assert not {'numpy', 'numba', 'rich', 'typer', 'pydantic'} & set(sys.modules)\n"
    )
    passes(tmp_path, "-p", "no:xdist")


def test_installed_engine_is_judged(install) -> None:
    said = install("plugin").run("-m", "multibody_xval", "run", "unit-cell", "--engine", "tiny")
    assert "tiny:joint:tuned agrees with what is expected" in said


@pytest.mark.parametrize(
    ("name", "tested"),
    [
        ("mujoco:joint:tuned", {("joint", "tuned")}),
        ("mujoco:joint", {("joint", "default"), ("joint", "recommended"), ("joint", "tuned")}),
    ],
)
def test_a_part_of_an_engine_is_held_to_the_contract(name: str, tested: set[tuple[str, str]]) -> None:
    own = cases.cases((name,))
    assert {(each.formulation, each.preset_name) for each in own["tested"]} == tested
    assert own["installed"] == ["mujoco"]
