"""A folder of this process in the temporary folder: crash logs, temporary stores, what engines leave there."""

import os
import shutil
import tempfile
import uuid
import weakref
from abc import ABC, abstractmethod
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Self

if TYPE_CHECKING:
    from filelock import BaseFileLock


class Closing(ABC):
    """A context that ends with `close`."""

    @abstractmethod
    def close(self) -> None:
        """Free what is held."""

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()


PREFIX = "multibody-xval-"
"""How the names of such folders begin."""

LOCK = ".lock"
"""Ending of the file beside a folder that its process keeps locked; the system unlocks it when the process ends in
whatever way."""


class ScratchFolder(Closing):
    """A folder that is removed when it is closed, or by the next one if its process was killed."""

    def __init__(self) -> None:
        remove_abandoned()
        self.path = Path(tempfile.gettempdir()) / f"{PREFIX}{uuid.uuid4().hex}"
        # locked before it is made: a folder whose lock is free is nobody's any more
        lock = _lock_of(self.path)
        lock.acquire()
        self._remove = weakref.finalize(self, _remove, self.path, lock)
        self.path.mkdir(mode=0o700)

    def close(self) -> None:
        """Remove the folder."""
        self._remove()


def remove_abandoned() -> None:
    """Remove the folders of processes that have ended without it; those of living ones and of other users stay."""
    for file in Path(tempfile.gettempdir()).glob(f"{PREFIX}*{LOCK}"):
        folder = file.with_suffix("")
        with suppress(OSError):  # locked, removed meanwhile, or another user's
            # on Windows every user has a temporary folder of their own
            if not (hasattr(os, "getuid") and file.lstat().st_uid != os.getuid()) and not folder.is_symlink():
                lock = _lock_of(folder)
                lock.acquire()
                _remove(folder, lock)


def _lock_of(folder: Path) -> "BaseFileLock":
    """Give the lock of a folder; taking it is a `TimeoutError` at once where another process has it."""
    from filelock import FileLock  # on first use: not every command needs a folder

    return FileLock(folder.with_name(folder.name + LOCK), timeout=0, thread_local=False)


def _remove(folder: Path, lock: "BaseFileLock") -> None:
    shutil.rmtree(folder, ignore_errors=True)
    with suppress(OSError):  # where a file that is open cannot be removed, the next process does it
        Path(lock.lock_file).unlink(missing_ok=True)
    lock.release()
