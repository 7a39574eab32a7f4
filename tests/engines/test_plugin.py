"""An engine in an installable package of its own: found, listed and held to the contract, with nothing edited."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PLUGIN = ROOT / "tests" / "plugin"


@pytest.fixture(scope="module")
def environment(tmp_path_factory: pytest.TempPathFactory) -> dict[str, str]:
    """Variables of a process for which the plugin is installed."""
    target = tmp_path_factory.mktemp("site")
    install = ["-m", "pip", "install", "--quiet", "--no-deps", "--no-index", "--no-build-isolation"]
    subprocess.run(
        [sys.executable, *install, "--disable-pip-version-check", "--target", str(target), str(PLUGIN)], check=True
    )
    return {**os.environ, "PYTHONPATH": os.pathsep.join([str(target), str(ROOT)])}


def run(environment: dict[str, str], *arguments: str) -> str:
    done = subprocess.run(
        [sys.executable, "-m", *arguments], env=environment, cwd=ROOT, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def test_installed_engine_is_listed(environment: dict[str, str]) -> None:
    rows = {row["engine"]: row for row in json.loads(run(environment, "engines", "--json"))}
    assert rows["tiny"]["version"] == "1.2.3"
    assert rows["tiny"]["missing"] is None


def test_installed_engine_is_held_to_the_contract(environment: dict[str, str]) -> None:
    printed = run(
        environment,
        "pytest",
        "-q",
        "-n",
        "0",
        "-p",
        "no:cacheprovider",
        "--pyargs",
        "engines.contract",
        "--engine",
        "tiny",
    )
    assert "passed" in printed
    assert int(printed.rsplit(" passed", 1)[0].split()[-1]) >= 10


def test_installed_engine_is_compared_in_the_report(environment: dict[str, str], tmp_path: Path) -> None:
    script = (
        "from pathlib import Path\n"
        "from scenarios.evaluation import Evaluator\n"
        "from scenarios.figure3 import Figure3, run\n"
        "from engines.variant import Variant\n"
        "from scenarios.store import ResultStore\n"
        "if __name__ == '__main__':\n"
        "    asked = Figure3(variants=(Variant('tiny'),), friction_ratios=(0.3,), frequency_ratios=(0.9, 1.3))\n"
        f"    with ResultStore(Path({str(tmp_path / 'store.sqlite')!r})) as store, Evaluator(store, 1) as evaluator:\n"
        "        points = run(asked, evaluator).curve(Variant('tiny'), 0.3)\n"
        "    print([str(point.comparison.verdict) for point in points])\n"
    )
    file = tmp_path / "compare.py"
    file.write_text(script)
    done = subprocess.run(
        [sys.executable, str(file)], env=environment, cwd=ROOT, capture_output=True, text=True, check=False
    )
    assert done.stdout.strip() == "['agree', 'agree']", done.stderr
