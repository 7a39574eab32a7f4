"""Whether the files of an environment still hold what their packages were published with."""

import base64
import csv
import hashlib
from importlib.metadata import Distribution
from pathlib import Path

from engines.environments.environment import LONGEST_LIST, Environment
from reference_lcp.refusal import shortened


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
    rows = csv.reader((distribution.read_text("RECORD") or "").splitlines())
    return [file for file, published, _ in rows if published and not _whole(distribution, file, published)]


def _whole(distribution: Distribution, file: str, published: str) -> bool:
    path, (mode, _, expected) = Path(str(distribution.locate_file(file))), published.partition("=")
    if not path.is_file():
        return False
    with path.open("rb") as opened:
        digest = hashlib.file_digest(opened, mode).digest()
    return base64.urlsafe_b64encode(digest).rstrip(b"=").decode() == expected
