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


def test_help_names_every_command_and_imports_none(tmp_path: Path) -> None:
    code = (
        "import sys; sys.argv = ['multibody-xval', '--help']\n"
        "from multibody_xval.reports.cli.entry_point import main\n"
        "try: main()\n"
        "finally: print(sorted(name for name in sys.modules if name.startswith('multibody_xval.reports.cli.')))"
    )
    found = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False, cwd=tmp_path)
    assert found.returncode == 0, found.stderr
    assert all(f" {name} " in found.stdout for name in COMMANDS)
    assert found.stdout.splitlines()[-1] == str(
        [f"multibody_xval.reports.cli.{name}" for name in ("console_script", "ending", "entry_point")]
    )


def test_the_program_alone_shows_its_help(capsys: pytest.CaptureFixture[str]) -> None:
    assert run_command(app, []) == 0
    shown = capsys.readouterr()
    assert "Usage: multibody-xval" in shown.out
    assert not shown.err


def test_files_of_the_working_folder_do_not_shadow_the_packages(tmp_path: Path) -> None:
    for name in ("multibody_xval", "reference_lcp"):
        (tmp_path / f"{name}.py").write_text("raise SystemExit('the file of the working folder')\n")
    script = Path(sys.executable).with_name("multibody-xval")
    found = subprocess.run([script, "engines"], capture_output=True, text=True, check=False, cwd=tmp_path)
    assert found.returncode == 0, found.stderr
    assert "reference" in found.stdout
    shadowed = subprocess.run(
        [sys.executable, "-m", "multibody_xval", "engines"], capture_output=True, text=True, check=False, cwd=tmp_path
    )
    assert "the file of the working folder" in shadowed.stderr, "without the shadow the test says nothing"


@pytest.mark.parametrize(
    ("words", "expected"),
    [
        ("re", ["reference", "report", "reproduce", "recipe"]),
        ("run unit", ["unit-cell"]),
        ("run unit-cell --engine exudyn", ["exudyn-bristle", "exudyn-regularised"]),
        (
            "report --engine mujoco:contact:",
            [f"mujoco:contact:{preset}" for preset in ("tuned", "newton", "recommended", "default")],
        ),
        ("recipe pyb", ["pybullet"]),
    ],
)
def test_a_shell_completes_commands_scenarios_and_engines(words: str, expected: list[str]) -> None:
    variables = {
        "_MULTIBODY_XVAL_COMPLETE": "complete_bash",
        "COMP_WORDS": f"multibody-xval {words}",
        "COMP_CWORD": str(len(words.split())),
    }
    script = Path(sys.executable).with_name("multibody-xval")
    done = subprocess.run([script], capture_output=True, text=True, check=False, env={**os.environ, **variables})
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout.split() == expected


def test_the_script_of_completions_is_shown_and_is_no_fault(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("typer.completion._get_shell_name", lambda: "bash")  # whatever has started the tests
    with pytest.raises(SystemExit) as end:
        run_command(app, ["--show-completion"])
    shown = capsys.readouterr()
    assert (end.value.code, shown.err) == (0, "")
    assert "_MULTIBODY_XVAL_COMPLETE" in shown.out


def test_version_is_that_of_the_distribution(capsys: pytest.CaptureFixture[str]) -> None:
    assert run_command(app, ["--version"]) == 0
    assert capsys.readouterr().out == f"multibody-xval {metadata.version('multibody-xval')}\n"
