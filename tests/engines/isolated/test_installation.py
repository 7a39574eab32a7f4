"""Environments are whole or not there, and whatever goes wrong is one line and exit code 2."""

import fcntl
import io
import os
import re
import shutil
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

import pytest

from engines.interface.variant import Variant
from engines.isolated import installation
from engines.isolated.environment import RECORD, Environment, edited_fault, environments, unavailable_reason
from engines.isolated.installation import Plan, install
from engines.isolated.versioned_engine import Requirement, engine_of_its_own_environment
from engines.mujoco import MuJoCo
from reference_lcp.errors import ParameterError
from reference_lcp.process import run_command
from reports.cli.engines import app

NAME = "mujoco@3.98.0"


NOBODY = 65534
"""Number of the user who owns nothing."""


class Space(NamedTuple):
    free: int


def plan(version: str = "3.98.0") -> Plan:
    return Plan.of(Requirement.of(MuJoCo(), version))


def left_in(folder: Path) -> list[str]:
    return [path.name for path in folder.iterdir() if not path.name.startswith(".")] if folder.is_dir() else []


def test_an_environment_is_announced_made_listed_checked_and_removed(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run_command(app, ["install", NAME]) == 0
    announced, *_, last = capsys.readouterr().out.splitlines()
    assert announced.startswith(f"{NAME}: mujoco 3.98.0, numpy 9.0, packaging 9.0; into {folder / NAME}; about ")
    assert last.startswith(f"{NAME} is installed: Python 3.")
    assert run_command(app, ["install", NAME]) == 0
    assert capsys.readouterr().out.splitlines() == [last]
    assert run_command(app, ["environments"]) == 0
    assert NAME in capsys.readouterr().out
    assert run_command(app, ["environments", "check"]) == 0
    assert capsys.readouterr().out == f"{NAME} is whole\n"
    assert run_command(app, ["environments", "remove", NAME]) == 0
    assert left_in(folder) == []


TERMS = "https://example.org/terms"


@pytest.fixture(name="unfree")
def engine_that_is_not_free_software(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(MuJoCo, "capabilities", replace(MuJoCo.capabilities, licence="LicenseRef-X", terms=TERMS))


@pytest.mark.usefixtures("unfree")
def test_terms_of_an_engine_are_said_before_anything_is_downloaded_and_nobody_agrees_by_saying_nothing(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run_command(app, ["install", NAME]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith(f"error: {NAME} is not free software (LicenseRef-X); who downloads it agrees to {TERMS}; ")
    assert line.endswith("allowed: with --yes, which agrees to that")
    assert left_in(folder) == []
    assert run_command(app, ["install", NAME, "--yes"]) == 0
    assert run_command(app, ["install", NAME]) == 0, "what is installed is not asked about again"


@pytest.mark.usefixtures("unfree")
@pytest.mark.parametrize(("reply", "code"), [("n", 2), ("", 2), ("y", 0)])
def test_terms_of_an_engine_are_asked_about_in_a_terminal(
    reply: str, code: int, folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    terminal = io.StringIO(f"{reply}\n")
    terminal.isatty = lambda: True  # type: ignore[method-assign]
    monkeypatch.setattr(sys, "stdin", terminal)
    assert run_command(app, ["install", NAME]) == code
    printed = capsys.readouterr()
    assert f"(LicenseRef-X); who downloads it agrees to {TERMS}" in printed.out
    assert ("its terms were not agreed to" in printed.err) == (code == 2)
    assert left_in(folder) == ([] if code else [NAME])


def test_an_engine_of_free_software_asks_nothing(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run_command(app, ["install", NAME]) == 0
    assert "agree" not in capsys.readouterr().out


def test_a_version_is_the_newest_one_that_begins_so(folder: Path) -> None:
    assert plan("3").packages["mujoco"] == "3.99.0"
    assert plan("3.98").packages["mujoco"] == "3.98.0"
    assert Plan.of(Requirement.of(MuJoCo())).packages["mujoco"] == "4.99.0"


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("mujoco@", "has no version after the @"),
        ("mujoco@new", "has no version after the @"),
        ("mujoco@3@4", "has no version after the @"),
        (f"mujoco@{'9' * 5000}", "has no version after the @"),
        ("mujoco@v3.98.0", "is not how that version is written; allowed: mujoco@3.98.0"),
        ("mujoco@03.98.0", "is not how that version is written; allowed: mujoco@3.98.0"),
        ("mujoco@ 3.98.0", "is not how that version is written; allowed: mujoco@3.98.0"),
        ("mujoco@3.98.0-1", "is not how that version is written; allowed: mujoco@3.98.0.post1"),
        ("mujoco@3.98.0.post1", "there is no such version for this Python and this machine"),
        ("mujoco@3.3.6", "its adapter does not take that; allowed: mujoco >=3.3.7,<5"),
        ("mujoco@3.94.0", "there is no such version for this Python and this machine"),
        ("mujoco@3.95.0", "was installed and cannot be used: .*libmissing.so: no such file"),
        ("nothing@1", "engine = 'nothing' is unknown; allowed: reference, "),
        ("siconos@4.5", "it comes with the system"),
        ("reference@1", "it comes with the suite"),
    ],
)
def test_what_cannot_be_installed_is_one_line_and_leaves_nothing(
    name: str, message: str, folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run_command(app, ["install", name]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith("error: ")
    assert re.search(message, line), line
    assert left_in(folder) == []


def test_a_package_index_that_cannot_be_reached_is_named(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("UV_CONFIG_FILE")
    monkeypatch.setenv("UV_DEFAULT_INDEX", "http://127.0.0.1:9/simple")
    monkeypatch.setenv("UV_HTTP_RETRIES", "0")
    with pytest.raises(ParameterError, match="the package index cannot be reached"):
        plan()
    assert left_in(folder) == []


@pytest.mark.parametrize("python", [sys.executable, os.path.realpath(sys.executable)])
def test_a_python_can_be_named(python: str, folder: Path) -> None:
    assert Plan.of(Requirement.of(MuJoCo(), "3.98.0"), python).interpreter == python


def test_a_python_that_there_is_not_is_named(folder: Path) -> None:
    with pytest.raises(ParameterError, match="there is no such Python on this machine"):
        Plan.of(Requirement.of(MuJoCo(), "3.98.0"), "3.99")


def test_a_machine_without_uv_is_told_how_to_get_it(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "uv", None)
    monkeypatch.setattr(shutil, "which", lambda _name: None)
    with pytest.raises(ParameterError, match="uv, which is not installed; pip install uv"):
        plan()


def test_a_disk_without_room_is_found_out_before(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    known = plan()
    monkeypatch.setattr(Plan, "size", 5e9)
    monkeypatch.setattr(shutil, "disk_usage", lambda _folder: Space(1_000_000))
    with pytest.raises(ParameterError, match=r"needs about 5000 MB, and .* has 1 MB left"):
        install(known)
    assert left_in(folder) == []


def test_a_disk_with_just_enough_room_is_taken(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    known = plan()
    monkeypatch.setattr(shutil, "disk_usage", lambda _folder: Space(known.size))
    install(known)
    assert left_in(folder) == [NAME]


def test_a_disk_that_is_full_meanwhile_leaves_nothing(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    real, known = installation.run_uv, plan()

    def full(*arguments: str) -> str:
        if "sync" in arguments:
            raise ParameterError(
                installation._explained("error: failed to copy\n  cause: No space left on device (os error 28)")
            )
        return real(*arguments)

    monkeypatch.setattr(installation, "run_uv", full)
    with pytest.raises(ParameterError, match="the disk is full"):
        install(known)
    assert left_in(folder) == []


def test_an_interrupted_installation_leaves_nothing(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    real, known = installation.run_uv, plan()

    def interrupted(*arguments: str) -> str:
        if "sync" in arguments:
            raise KeyboardInterrupt
        return real(*arguments)

    monkeypatch.setattr(installation, "run_uv", interrupted)
    with pytest.raises(KeyboardInterrupt):
        install(known)
    assert left_in(folder) == []


KILLED = """
import os, signal, sys
from engines.isolated import installation
real = installation.run_uv
def killed(*arguments, **options):
    if "sync" in arguments:
        real(*arguments, **options)
        os.kill(os.getpid(), signal.SIGKILL)
    return real(*arguments, **options)
installation.run_uv = killed
from reports.cli.engines import install_engine
install_engine(sys.argv[1], None)
"""


@pytest.mark.slow
def test_an_installation_that_was_killed_is_no_environment_and_is_made_anew(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    root = str(Path(__file__).parents[3])
    killed = subprocess.run([sys.executable, "-c", KILLED, NAME], cwd=root, capture_output=True, check=False)
    assert killed.returncode == -9
    assert left_in(folder) == [NAME]
    with pytest.raises(ParameterError, match=rf"was not installed to the end; multibody-xval engines install {NAME}"):
        Variant.parse(NAME)
    assert run_command(app, ["environments"]) == 0
    assert f"{NAME} was not installed to the end" in capsys.readouterr().out
    assert run_command(app, ["install", NAME]) == 0
    assert Environment(NAME).fault() is None


@pytest.mark.slow
def test_an_environment_that_somebody_changed_is_refused_until_it_is_made_anew(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    install(plan())
    (packages,) = (folder / NAME).glob("lib/python*/site-packages")
    (packages / "packaging-9.0.dist-info").rename(packages / "packaging-8.0.dist-info")
    details = packages / "packaging-8.0.dist-info" / "METADATA"
    details.write_text(details.read_text().replace("9.0", "8.0"))
    added = packages / "added-1.dist-info"
    added.mkdir()
    (added / "METADATA").write_text("Metadata-Version: 2.1\nName: added\nVersion: 1\n")
    changes = "added 1, installed: none, packaging 8.0, installed: 9.0"
    with pytest.raises(ParameterError, match=f"changed since it was installed: {changes}; multibody-xval engines"):
        Variant.parse(NAME)
    assert run_command(app, ["environments", "check"]) == 1
    assert changes in capsys.readouterr().out
    assert run_command(app, ["install", NAME]) == 0
    assert Variant.parse(NAME).title == "MuJoCo 3.98.0"


@pytest.mark.parametrize("edit", ["mujoco/__init__.py", "mujoco-3.97.0.dist-info/WHEEL"])
def test_a_file_that_somebody_edited_or_removed_is_found_by_a_check(folder: Path, edit: str, capsys) -> None:
    install(Plan.of(Requirement.of(MuJoCo(), "3.97.0")))
    environment = Environment("mujoco@3.97.0")
    assert edited_fault(environment) is None
    (site,) = environment.folder.glob("lib/python*/site-packages")
    (site / edit).unlink()
    if edit.endswith(".py"):
        (site / edit).write_text("import time\n")
    assert environment.fault() is None
    assert run_command(app, ["environments", "check", environment.name]) == 1
    cleaned = f"uv cache clean mujoco; {environment.remedy}"
    assert capsys.readouterr().out == f"{environment.name} has files that were edited: {edit}; {cleaned}\n"


@pytest.mark.slow
def test_a_file_that_no_package_lists_is_named_and_not_run(
    folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """What Python would run at its start keeps the environment from being used at all."""
    install(plan())
    environment = Environment(NAME)
    assert run_command(app, ["environments", "check"]) == 0
    (site,) = environment.folder.glob("lib/python*/site-packages")
    starting = ("evil.pth", "sitecustomize.py", "usercustomize/__init__.py")
    for added in (*starting, "mujoco/evil.py", "evil.py"):
        (site / added).parent.mkdir(exist_ok=True)
        (site / added).write_text(f"import pathlib; pathlib.Path({str(tmp_path / 'run')!r}).touch()\n")
        capsys.readouterr()
        assert run_command(app, ["environments", "check"]) == 1
        fault = f"has files that no package lists: {(site / added).relative_to(environment.folder)}"
        assert capsys.readouterr().out == f"{NAME} {fault}; {environment.remedy}\n"
        assert environment.fault() == (fault if added in starting else None)
        (site / added).unlink()
    assert not (tmp_path / "run").exists()


def test_two_processes_do_not_make_the_same_environment(folder: Path) -> None:
    known = plan()
    folder.mkdir()
    lock = os.open(folder / f".{NAME}.lock", os.O_CREAT | os.O_RDWR)
    fcntl.flock(lock, fcntl.LOCK_EX)
    with pytest.raises(ParameterError, match="is being installed or removed by another process"):
        install(known)
    os.close(lock)
    install(known)
    assert Environment(NAME).fault() is None


@pytest.mark.parametrize("arguments", [["remove", "mujoco@1"], ["check", "mujoco@1"], ["remove"]])
def test_an_environment_that_there_is_not_is_refused(
    arguments: list[str], folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run_command(app, ["environments", *arguments]) == 2
    assert capsys.readouterr().err.count("\n") == 1


@pytest.mark.parametrize(
    "record",
    [
        "[]",
        "{}",
        "[" * 100_000,
        '{"python": 3, "packages": [], "seconds": "s", "megabytes": 1}',
        '{"python": "3", "packages": {"mujoco": 3}, "seconds": 1, "megabytes": 1}',
        '{"python": "3", "packages": {"mujoco": "3\\udc80"}, "seconds": 1, "megabytes": 1}',
        '{"python": "3", "packages": {}, "seconds": 1e999, "megabytes": true}',
        '{"python": "3", "packages": {}, "seconds": ' + "9" * 400 + ', "megabytes": 1}',
    ],
)
def test_a_record_of_wrong_types_is_that_of_no_environment(folder: Path, record: str) -> None:
    environment = Environment(NAME)
    environment.folder.mkdir(parents=True)
    (environment.folder / RECORD).write_text(record)
    assert environment.fault() == "was not installed to the end"


def test_an_environment_that_lost_its_python_is_refused(folder: Path) -> None:
    install(plan())
    Environment(NAME).interpreter.unlink()
    assert str(Environment(NAME).fault()).startswith("has lost its Python 3.")


@pytest.mark.parametrize(
    ("problem", "reason"),
    [
        (OSError(28, "No space left on device"), "No space left on device"),
        (OSError("the pipe is gone"), "the pipe is gone"),
    ],
)
def test_a_folder_that_cannot_be_written_is_one_line_with_the_reason(
    problem: OSError, reason: str, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    chosen = plan()

    def fail(*_: object) -> None:
        raise problem

    monkeypatch.setattr(installation, "run_uv", fail)
    with pytest.raises(ParameterError, match=f"{NAME} cannot be written: {reason}$"):
        install(chosen)
    assert left_in(folder) == []


@pytest.fixture
def closed(folder: Path) -> Iterator[None]:
    """A folder of environments into which this user may not look."""
    (folder / NAME).mkdir(parents=True)
    folder.chmod(0)
    user = os.getuid()
    if user == 0:  # who may look everywhere
        os.setresuid(NOBODY, NOBODY, user)
    yield
    if user == 0:
        os.setresuid(user, user, user)
    folder.chmod(0o700)


@pytest.mark.usefixtures("closed")
def test_environments_that_only_another_user_may_read_are_not_there() -> None:
    """The home of a user may be that of another, as with ``su`` and without a home of one's own."""
    assert environments() == []
    assert str(unavailable_reason(Environment(NAME))).startswith("its environment is not installed; ")
    assert engine_of_its_own_environment(MuJoCo()) is None


def test_folder_of_environments_is_in_the_cache_of_the_user(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.delenv("MULTIBODY_XVAL_ENVIRONMENTS", raising=False)
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    assert Environment(NAME).folder == tmp_path / "multibody-xval" / "environments" / NAME
