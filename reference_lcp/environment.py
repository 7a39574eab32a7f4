"""What compiled code and linear algebra find in the environment of a process; imports the standard library only."""

import os
import sys
import tempfile
from pathlib import Path

CACHE_VARIABLE = "NUMBA_CACHE_DIR"
"""Variable of the environment that names where numba keeps compiled kernels."""

ROOT = Path(__file__).resolve().parents[1]

ONE_THREAD = dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1")
"""Environment of commands, which time one core, and of worker processes. The suite runs these side by side, one a
processor, where threads of linear algebra slow each other down; and a process that workers are forked from must have no
other thread."""

_FOLDERS: list[tempfile.TemporaryDirectory[str]] = []
"""Removed when the process ends."""


def ensure_kernel_cache() -> None:
    """Let kernels be kept in a private folder while this process lives, where numba has no place for them."""
    cache = Path(os.environ.get("XDG_CACHE_HOME") or os.path.expanduser("~/.cache"), "numba")  # noqa: PTH111 - "~" stays
    own = ROOT / "reference_lcp" / "chain" / "__pycache__"
    if CACHE_VARIABLE in os.environ or _writable(own) or (cache.is_absolute() and _writable(cache)):
        return
    _FOLDERS.append(tempfile.TemporaryDirectory(prefix="mbxv-kernels-", ignore_cleanup_errors=True))
    os.environ[CACHE_VARIABLE] = _FOLDERS[-1].name
    where = f"neither {ROOT} nor {cache} can be written"
    print(f"{where}: compiled solvers are kept until the end only; {CACHE_VARIABLE} names a folder", file=sys.stderr)


def _writable(folder: Path) -> bool:
    """Tell whether files can be made in a folder, as numba does; `os.access` says yes where a sandbox forbids it."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
        tempfile.TemporaryFile(dir=folder).close()
    except OSError:
        return False
    return True
