"""Folders in the temporary folder: those of killed processes are collected at the next start, of living ones stay."""

import subprocess
import sys
import tempfile
from pathlib import Path

import pytest

from scenarios.runs.scratch import ScratchFolder

OWNER = """
import time
from scenarios.runs.scratch import ScratchFolder
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


def test_nothing_is_left_when_it_is_closed(temporary) -> None:
    with ScratchFolder() as folder:
        (folder.path / "file").touch()
    assert not list(temporary.iterdir())
