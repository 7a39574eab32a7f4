"""Folders in the temporary folder: those of killed processes are collected at the next start, of living ones stay."""

import subprocess
import sys
import tempfile
from pathlib import Path

import pytest

from multibody_xval.scenarios.runs.scratch import LOCK, MARKER, PREFIX, ScratchFolder

OWNER = """
import time
from multibody_xval.scenarios.runs.scratch import ScratchFolder
folder = ScratchFolder()
print(folder.path, flush=True)
time.sleep(1000)
"""


@pytest.fixture(autouse=True)
def temporary(tmp_path, monkeypatch) -> Path:
    monkeypatch.setenv("TMPDIR", str(tmp_path))
    monkeypatch.setattr(tempfile, "tempdir", None)
    return tmp_path


def test_folder_of_a_killed_process_is_collected_and_that_of_a_living_one_stays(temporary) -> None:
    owners = [subprocess.Popen([sys.executable, "-c", OWNER], stdout=subprocess.PIPE, text=True) for _ in range(2)]
    try:
        killed, living = (Path(owner.stdout.readline().strip()) for owner in owners)
        (killed / "crash log").touch()
        foreign = temporary / "multibody-xval-of-another-program"
        foreign.mkdir()
        owners[0].kill()
        owners[0].wait()
        assert killed.is_dir()
        with ScratchFolder() as folder:
            assert folder.path.is_dir()
            assert not killed.exists()
            assert living.is_dir()
            assert foreign.is_dir()
    finally:
        for owner in owners:
            owner.kill()
            owner.communicate()


@pytest.mark.parametrize(
    ("name", "held", "stays"),
    [
        ("results", ["data"], True),
        ("results", [MARKER, "data"], True),
        (f"{'0' * 31}g", [MARKER], True),
        ("0" * 33, [], True),
        ("0" * 32, ["data"], True),
        ("0" * 32, [MARKER, "data"], False),
        ("0" * 32, [], False),
        ("0" * 32, None, False),
    ],
)
def test_what_the_suite_has_not_made_stays_whatever_its_name_is(temporary, name, held, stays) -> None:
    """With a lock beside it that is free, and that is not emptied either."""
    folder, lock = temporary / f"{PREFIX}{name}", temporary / f"{PREFIX}{name}{LOCK}"
    lock.write_text("12")
    if held is not None:
        folder.mkdir()
        for file in held:
            (folder / file).write_text("1")
    ScratchFolder().close()
    assert sorted(temporary.iterdir()) == ([folder, lock] if stays else [])
    if stays:
        assert lock.read_text() == "12"
        assert sorted(file.name for file in folder.iterdir()) == sorted(held)


def test_nothing_is_left_when_it_is_closed(temporary) -> None:
    with ScratchFolder() as folder:
        (folder.path / "file").touch()
    assert not list(temporary.iterdir())
