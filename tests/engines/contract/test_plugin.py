"""An engine in an installable package of its own: found, listed and held to the contract, with nothing edited."""

import json
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace

import pytest
from xdist.remote import Producer

from multibody_xval.engines.contract import cases, plugin


def test_installed_engine_is_listed(install) -> None:
    rows = {
        row["engine"]: row for row in json.loads(install("plugin").run("-m", "multibody_xval", "engines", "--json"))
    }
    assert rows["tiny"]["version"] == "1.2.3"
    assert rows["tiny"]["missing"] is None


@pytest.mark.slow
def test_installed_engine_is_held_to_the_contract(install) -> None:
    command = "-m pytest -q -n 0 -p no:cacheprovider --pyargs multibody_xval.engines.contract --xval-engine tiny"
    printed = install("plugin").run(*command.split())
    assert int(printed.rsplit(" passed", 1)[0].split()[-1]) >= 20


def test_contract_refuses_an_engine_that_is_not_there(install) -> None:
    command = "-m pytest -q -n 0 -p no:cacheprovider --pyargs multibody_xval.engines.contract --xval-engine tinny"
    install("plugin").run(*command.split(), code=4)


def test_a_project_with_an_option_of_the_same_kind_runs_beside_the_suite(tmp_path: Path) -> None:
    (tmp_path / "conftest.py").write_text(
        "def pytest_addoption(parser):\n"
        "    parser.addoption('--engine', default='diesel')\n"
        "    parser.addoption('--version-of-engine')\n"
    )
    (tmp_path / "test_engine.py").write_text(
        "def test_it(request):\n    assert request.config.option.engine == 'petrol'\n"
    )
    command = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", "--engine", "petrol"]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr


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
    command = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", "-p", "no:xdist"]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr


@pytest.mark.slow
def test_installed_engine_is_compared_in_the_report(install, tmp_path: Path) -> None:
    script = (
        "from multibody_xval.engines.interface.variant import Variant\n"
        "from multibody_xval.scenarios.running.evaluate import Means, computed\n"
        "from multibody_xval.scenarios.ruler.judge import judged\n"
        "from multibody_xval.scenarios.model import Case\n"
        "from multibody_xval.scenarios.plan import runs_at\n"
        "from multibody_xval.scenarios.result_tables import points\n"
        "if __name__ == '__main__':\n"
        "    cases = [Case(friction_ratio=0.3, frequency_ratio=eta) for eta in (0.9, 1.3)]\n"
        "    rows = judged(points(computed(runs_at([Variant('tiny')], cases), Means(workers=1))))\n"
        "    print(rows[rows.engine == 'tiny'].verdict.tolist())\n"
    )
    file = tmp_path / "compare.py"
    file.write_text(script)
    assert install("plugin").run(str(file)).strip() == "['agrees', 'agrees']"


@pytest.mark.parametrize(
    ("name", "together"),
    [
        ("engines/contract/test_invariance.py::test_units[mujoco-warp-contact-default-micrometres]", "mujoco-warp"),
        ("agreement::test_agrees[mujoco-warp-contact-tuned-friction 0.3, frequency 0.9]", "mujoco-warp"),
        ("tests/engines/test_folders.py::test_imports[mujoco-joint]", "tests/engines/test_folders.py"),
    ],
)
def test_one_worker_runs_all_clauses_for_an_engine(name: str, together: str) -> None:
    """Its package is imported once."""
    settings = {"dist": "loadscope", "tx": ["2*popen"]}
    config = SimpleNamespace(getoption=settings.get, getvalue=settings.get)
    assert plugin.pytest_xdist_make_scheduler(config, Producer("test"))._split_scope(name) == together


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
