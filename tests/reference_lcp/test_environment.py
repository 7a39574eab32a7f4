"""Compiled kernels are kept where numba can write, and else in a folder of the process."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from reference_lcp import environment


@pytest.fixture
def no_place(tmp_path, monkeypatch):
    """No folder of the suite can be written, and no variable names one."""
    (tmp_path / "file").write_text("")
    monkeypatch.setattr(environment, "ROOT", tmp_path / "file")
    monkeypatch.setattr(environment.tempfile, "tempdir", str(tmp_path))
    monkeypatch.setenv(environment.CACHE_VARIABLE, "")
    monkeypatch.delenv(environment.CACHE_VARIABLE)
    return tmp_path


@pytest.mark.parametrize(("cache", "kept"), [("{}/cache", True), ("{}/file", False), ("cache", False)])
def test_kernels_are_kept_in_a_private_folder_where_no_absolute_place_can_be_written(
    cache, kept, no_place, monkeypatch, capsys
) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", cache.format(no_place))
    environment.ensure_kernel_cache()
    assert (environment.CACHE_VARIABLE in os.environ) is not kept
    assert capsys.readouterr().err.count("compiled solvers are kept until the end only") == (not kept)
    if not kept:
        folder = Path(os.environ[environment.CACHE_VARIABLE])
        assert (folder.parent, folder.stat().st_mode & 0o777) == (no_place, 0o700)


def test_numba_keeps_kernels_in_that_folder(no_place, monkeypatch) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(no_place / "file"))
    environment.ensure_kernel_cache()
    code = "import numba\n\n@numba.njit(cache=True)\ndef f(x):\n    return x + 1\n\nprint(f(1))\n"
    (no_place / "own.py").write_text(code)
    subprocess.run([sys.executable, str(no_place / "own.py")], check=True)
    assert list(Path(os.environ[environment.CACHE_VARIABLE]).rglob("*.nbi"))
