"""A folder of this process in the temporary folder: crash logs, temporary stores, what engines leave there."""

import os
import re
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

NAME = re.compile(rf"{PREFIX}[0-9a-f]{{32}}")

MARKER = ".made-by-multibody-xval"
"""Empty file in each: without it, what has such a name is somebody's."""

LOCK = ".lock"
"""Ending of the file beside a folder that its process keeps locked; the system unlocks it when the process ends in
whatever way."""


class ScratchFolder(Closing):
    """A folder that is removed when it is closed, or by the next one if its process was killed."""

    def __init__(self) -> None:
        temporary = Path(tempfile.gettempdir())
        for file in temporary.glob(f"{PREFIX}*{LOCK}"):
            folder = file.with_suffix("")
            with suppress(OSError):  # locked by a living process, removed meanwhile, or another user's
                if _is_own(file) and _is_scratch(folder):
                    _remove(folder, _locked(folder))
        self.path = temporary / f"{PREFIX}{uuid.uuid4().hex}"
        # locked before it is made: a folder whose lock is free is nobody's any more
        self._remove = weakref.finalize(self, _remove, self.path, _locked(self.path))
        self.path.mkdir(mode=0o700)
        (self.path / MARKER).touch()

    def close(self) -> None:
        """Remove the folder."""
        self._remove()


def _is_scratch(folder: Path) -> bool:
    """Tell whether this class has made a folder, or would have: its process may be killed before it has marked it."""
    if NAME.fullmatch(folder.name) is None or folder.is_symlink():
        return False
    return (folder / MARKER).is_file() or not folder.exists() or not any(folder.iterdir())


def _is_own(file: Path) -> bool:
    """Tell whether a file is this user's; on Windows every user has a temporary folder of their own."""
    return not hasattr(os, "getuid") or file.lstat().st_uid == os.getuid()


def _locked(folder: Path) -> "BaseFileLock":
    """Lock a folder, or raise a `TimeoutError` at once where another process has done it."""
    from filelock import FileLock  # on first use: not every command needs a folder

    lock = FileLock(folder.with_name(folder.name + LOCK), timeout=0, thread_local=False)
    lock.acquire()
    return lock


def _remove(folder: Path, lock: "BaseFileLock") -> None:
    shutil.rmtree(folder, ignore_errors=True)
    with suppress(OSError):  # where a file that is open cannot be removed, the next process does it
        Path(lock.lock_file).unlink(missing_ok=True)
    lock.release()
