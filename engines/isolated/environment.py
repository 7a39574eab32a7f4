"""An environment on this machine: where it lies, what was installed into it, and whether it is still that."""

import base64
import csv
import hashlib
import json
import os
from collections.abc import Collection, Mapping, Sequence
from dataclasses import asdict, dataclass
from functools import lru_cache
from importlib import metadata
from importlib.metadata import Distribution
from math import isfinite
from pathlib import Path

from packaging.utils import canonicalize_name

from reference_lcp.errors import shortened
from reference_lcp.output import replacing

FOLDER_VARIABLE = "MULTIBODY_XVAL_ENVIRONMENTS"
"""Variable of the environment that names the folder of all environments; the user's cache without it."""

RECORD, LOCK = "environment.json", "pylock.toml"
"""Files of an environment: what was installed, written when all of it was; and what uv was to install, by hash."""

RUN_AT_START = ("*.pth", *(f"{name}{more}" for name in ("sitecustomize", "usercustomize") for more in ("*", "/**/*")))
"""Files that Python runs when it starts, whatever is to be run then."""

LONGEST_LIST = 120
"""Characters of the differences that a message names."""


@dataclass(frozen=True)
class Record:
    """What an environment holds."""

    python: str
    """Version of its Python."""
    packages: Mapping[str, str]
    """Versions of its packages, by name."""
    seconds: float
    """How long it took to make [s]."""
    megabytes: float
    """Size of its files [MB]."""

    def __post_init__(self) -> None:
        texts = [self.python, *self.packages, *self.packages.values()]
        plain = all(isinstance(text, str) and text.isprintable() for text in texts)
        if not (plain and isfinite(self.seconds + self.megabytes)):
            raise TypeError("an environment's record has texts and numbers")


@dataclass(frozen=True)
class Environment:
    """An environment, made or not."""

    name: str
    """Of the engine that runs in it, such as ``mujoco@3.3.7``."""

    @property
    def folder(self) -> Path:
        """Where it lies."""
        return environments_folder() / self.name

    @property
    def is_there(self) -> bool:
        """Whether it has a folder that this user may read: another's cache may be closed."""
        return os.access(self.folder, os.R_OK | os.X_OK)

    @property
    def interpreter(self) -> Path:
        """Its Python."""
        return self.folder / "bin" / "python"

    @property
    def remedy(self) -> str:
        """The command that makes it."""
        return f"multibody-xval engines install {self.name}"

    def record(self) -> Record | None:
        """Give what was installed; ``None`` where it is missing, or was not made to the end."""
        try:
            return Record(**json.loads((self.folder / RECORD).read_text()))
        except (OSError, ValueError, TypeError, AttributeError, ArithmeticError, RecursionError):
            return None

    def write_record(self, record: Record) -> None:
        """Say that it has been made to the end."""
        with replacing(self.folder / RECORD) as part:
            part.write_text(json.dumps(asdict(record), indent=2))

    def fault(self) -> str | None:
        """Give what is wrong with it, as the end of a sentence that begins with it; ``None`` if nothing is."""
        if not self.is_there:
            return "is not installed"
        record = self.record()
        if record is None:
            return "was not installed to the end"
        if not os.access(self.interpreter, os.X_OK):
            return f"has lost its Python {record.python}, which {self.interpreter} pointed to"
        changes = _differences(record.packages, self.packages())
        if changes:
            return f"has been changed since it was installed: {shortened(changes, LONGEST_LIST)}"
        return self.added_fault(RUN_AT_START)

    def added_fault(self, patterns: Sequence[str] = ("**/*",)) -> str | None:
        """Give what is wrong where files lie among its packages that none of them lists, but for compiled ones."""
        found = [file for folder in self._package_folders() for each in patterns for file in folder.glob(each)]
        listed = {_place(each, file) for each in self.distributions() for file, *_ in _hashed(each)} if found else set()
        added = [str(file.relative_to(self.folder)) for file in sorted(found) if _may_be_run(file, listed)]
        return f"has files that no package lists: {shortened(', '.join(added), LONGEST_LIST)}" if added else None

    def packages(self) -> dict[str, str]:
        """Give the versions of the packages that are there now, by name in lower case, with hyphens."""
        return {canonicalize_name(each.name): each.version for each in self.distributions()}

    def distributions(self) -> list[metadata.Distribution]:
        """Give the packages that are there now."""
        return list(metadata.distributions(path=[str(folder) for folder in self._package_folders()]))

    def _package_folders(self) -> list[Path]:
        return list(self.folder.glob("lib/python*/site-packages")) if self.is_there else []

    def changed(self) -> tuple[int, ...]:
        """Give when something was last installed or removed [ns]; until this changes `fault` does not."""
        files = [self.folder, self.folder / RECORD, self.interpreter, *self._package_folders()]
        return tuple(file.stat().st_mtime_ns if os.access(file, os.F_OK) else 0 for file in files)


@lru_cache
def _fault(environment: Environment, _folder: Path, _changed: tuple[int, ...]) -> str | None:
    """Give the fault of an environment as long as nothing changes: every batch of tasks needs to know."""
    return environment.fault()


def unavailable_reason(environment: Environment) -> str | None:
    """Give the reason why an environment cannot be used, and the command that makes it; ``None`` if it can."""
    fault = _fault(environment, environment.folder, environment.changed())
    return None if fault is None else f"its environment {fault}; {environment.remedy}"


def _differences(recorded: Mapping[str, str], present: Mapping[str, str]) -> str:
    """Name the packages whose versions are not those that were installed."""
    return ", ".join(
        f"{name} {present.get(name, 'is gone')}, installed: {recorded.get(name, 'none')}"
        for name in sorted({*recorded, *present})
        if recorded.get(name) != present.get(name)
    )


def environments_folder() -> Path:
    """Give the folder that holds all environments, whether or not it is there."""
    from platformdirs import user_cache_path

    named = os.environ.get(FOLDER_VARIABLE)
    return Path(named).absolute() if named else user_cache_path("multibody-xval") / "environments"


def environments() -> list[Environment]:
    """Give every environment that is there, whole or not, by name."""
    folder = environments_folder()
    names = sorted(entry.name for entry in folder.iterdir()) if os.access(folder, os.R_OK | os.X_OK) else []
    return [environment for name in names if (environment := Environment(name)).is_there]


def edited_fault(environment: Environment) -> str | None:
    """Give what is wrong with the files of an environment, as the end of a sentence; ``None`` if nothing is.

    Every file is read: some seconds a gigabyte. Environments share files with uv's cache, which an edit reaches too,
    so that the packages have to go from there before they are installed anew.
    """
    edited = {each.name: files for each in environment.distributions() if (files := _edited_files(each))}
    if not edited:
        return None
    named = shortened(", ".join(file for files in edited.values() for file in files), LONGEST_LIST)
    return f"has files that were edited: {named}; uv cache clean {' '.join(edited)}"


def _edited_files(distribution: Distribution) -> list[str]:
    """Name the files of a package that are gone, or do not have the hash that they were published with.

    They are read from its record: what lists them for programs may leave out those that are gone.
    """
    return [file for file, published in _hashed(distribution) if not _whole(distribution, file, published)]


def _hashed(distribution: Distribution) -> list[tuple[str, str]]:
    """Give the files that a package lists with the hash that they were published with, and that."""
    rows = csv.reader((distribution.read_text("RECORD") or "").splitlines())
    return [(file, published) for file, published, *_ in (row for row in rows if len(row) > 1) if published]


def _place(distribution: Distribution, file: str) -> Path:
    """Give where a file of a package lies: names may lead through the folder above."""
    return Path(os.path.normpath(str(distribution.locate_file(file))))


def _may_be_run(file: Path, listed: Collection[Path]) -> bool:
    """Tell whether Python may run a file that no package lists; what was compiled from one lies beside it."""
    if file in listed or (file.is_dir() and not file.is_symlink()):
        return False
    return file.parent.name != "__pycache__" and file.parent.suffix != ".dist-info"


def _whole(distribution: Distribution, file: str, published: str) -> bool:
    path, (mode, _, expected) = _place(distribution, file), published.partition("=")
    if not path.is_file():
        return False
    with path.open("rb") as opened:
        digest = hashlib.file_digest(opened, mode).digest()
    return base64.urlsafe_b64encode(digest).rstrip(b"=").decode() == expected
