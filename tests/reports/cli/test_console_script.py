"""The console script: one name for the commands of the four packages."""

import os
import subprocess
import sys
from importlib import metadata
from pathlib import Path

import pytest

from multibody_xval.reports.cli.console_script import COMMANDS, app, loaded
from multibody_xval.reports.cli.ending import run_command


@pytest.mark.parametrize("name", COMMANDS)
def test_every_command_is_the_one_of_its_name(name: str) -> None:
    assert loaded(name).name in {name, f"multibody-xval {name}"}


def test_files_of_the_working_folder_do_not_shadow_the_packages(tmp_path: Path) -> None:
    for name in ("multibody_xval", "reference_lcp"):
        (tmp_path / f"{name}.py").write_text("raise SystemExit('the file of the working folder')\n")
    script = Path(sys.executable).with_name("multibody-xval")
    found = subprocess.run([script, "engines"], capture_output=True, text=True, check=False, cwd=tmp_path)
    assert found.returncode == 0, found.stderr
    assert "reference" in found.stdout


def test_a_shell_completes_scenarios_and_engines() -> None:
    words = "run unit-cell --engine exudyn"
    variables = {
        "_MULTIBODY_XVAL_COMPLETE": "complete_bash",
        "COMP_WORDS": f"multibody-xval {words}",
        "COMP_CWORD": "4",
    }
    script = Path(sys.executable).with_name("multibody-xval")
    done = subprocess.run([script], capture_output=True, text=True, check=False, env={**os.environ, **variables})
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout.split() == ["exudyn-bristle", "exudyn-regularised"]


def test_version_is_that_of_the_distribution(capsys: pytest.CaptureFixture[str]) -> None:
    assert run_command(app, ["--version"]) == 0
    assert capsys.readouterr().out == f"multibody-xval {metadata.version('multibody-xval')}\n"
