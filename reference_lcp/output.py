"""Files that are complete or as they were: written beside, then renamed."""

import os
import uuid
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from reference_lcp.refusal import RunError


@contextmanager
def replacing(file: Path) -> Iterator[Path]:
    """Give a path to write to, with the ending of `file`; what is written there takes its place at the end.

    Raises
    ------
    RunError
        If it cannot be written, on a full disk for instance; `file` is as it was then.
    """
    target = file.resolve()
    part = target.with_name(f".{uuid.uuid4().hex}.part{target.suffix}")
    try:
        yield part
        with part.open("r+b") as written:  # Windows writes out what is open for writing only
            os.fsync(written.fileno())
        part.replace(target)
    except OSError as problem:
        raise RunError(f"{file} cannot be written: {problem.strerror or problem}; it is as it was") from None
    finally:
        part.unlink(missing_ok=True)


def write_whole(file: Path, content: str | bytes) -> None:
    """Write bytes, or a text as UTF-8; see `replacing`."""
    with replacing(file) as part:
        part.write_bytes(content.encode() if isinstance(content, str) else content)
