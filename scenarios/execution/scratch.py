"""A folder of this process in the temporary folder: crash logs, temporary stores, what engines leave there."""

import fcntl
import os
import shutil
import tempfile
from contextlib import suppress
from pathlib import Path

from scenarios.execution.closing import Closing

PREFIX = "multibody-xval-"
"""How the names of such folders begin."""

LOCK = "lock"
"""File of such a folder that its process keeps locked; the system unlocks it when the process ends, however it does."""


class ScratchFolder(Closing):
    """A folder that is removed when it is closed, or by the next one if its process was killed."""

    def __init__(self) -> None:
        remove_abandoned()
        self._folder = tempfile.TemporaryDirectory(prefix=PREFIX, ignore_cleanup_errors=True)
        self.path = Path(self._folder.name)
        # locked before it has its name: what has no lock is being made
        new = self.path / "new"
        self._lock = os.open(new, os.O_CREAT | os.O_RDWR)
        fcntl.flock(self._lock, fcntl.LOCK_EX)
        new.rename(self.path / LOCK)

    def close(self) -> None:
        """Remove the folder."""
        self._folder.cleanup()
        os.close(self._lock)


def remove_abandoned() -> None:
    """Remove the folders of processes that have ended without it; those of living ones and of other users stay."""
    for folder in Path(tempfile.gettempdir()).glob(f"{PREFIX}*"):
        with suppress(OSError):  # removed meanwhile, or another user's
            if not folder.is_symlink() and folder.stat().st_uid == os.getuid() and _is_abandoned(folder):
                shutil.rmtree(folder, ignore_errors=True)


def _is_abandoned(folder: Path) -> bool:
    """Tell whether nobody holds the lock of a folder."""
    lock = os.open(folder / LOCK, os.O_RDWR)
    try:
        fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    finally:
        os.close(lock)
    return True
