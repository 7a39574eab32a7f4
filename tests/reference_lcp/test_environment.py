"""Compiled kernels are kept where numba can write, and else in a folder of the process."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from reference_lcp import environment


@pytest.mark.parametrize("kept", [True, False])
def test_kernels_are_kept_in_a_private_folder_where_there_is_no_other_place(
    kept, tmp_path, monkeypatch, capsys
) -> None:
    """Below a file no folder can be made, whoever asks for it."""
    (tmp_path / "file").write_text("")
    monkeypatch.setattr(environment, "ROOT", tmp_path / "file")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / ("cache" if kept else "file")))
    monkeypatch.setenv("NUMBA_CACHE_DIR", "")
    monkeypatch.delenv("NUMBA_CACHE_DIR")
    monkeypatch.setattr(environment.tempfile, "tempdir", str(tmp_path))
    environment.ensure_kernel_cache()
    line = capsys.readouterr().err
    assert ("NUMBA_CACHE_DIR" in os.environ) is not kept
    assert line.count("\n") == (not kept)
    if not kept:
        folder = Path(os.environ["NUMBA_CACHE_DIR"])
        assert folder.parent == tmp_path
        assert folder.stat().st_mode & 0o777 == 0o700
        code = "import numba\n\n@numba.njit(cache=True)\ndef f(x):\n    return x + 1\n\nprint(f(1))\n"
        (tmp_path / "own.py").write_text(code)
        done = subprocess.run([sys.executable, str(tmp_path / "own.py")], capture_output=True, text=True, check=True)
        assert done.stdout == "2\n"
        assert list(folder.rglob("*.nbi"))


@pytest.mark.parametrize(("home", "can"), [("/cache", False), ("/cache", True), ("cache", True)])
def test_kernels_are_kept_in_a_private_folder_where_no_absolute_place_can_be_written(
    home, can, monkeypatch, capsys
) -> None:
    kept = home.startswith("/") and can
    monkeypatch.delenv(environment.CACHE_VARIABLE, raising=False)
    monkeypatch.setenv("XDG_CACHE_HOME", home)
    monkeypatch.setattr(environment, "_writable", lambda folder: can and "__pycache__" not in str(folder))
    environment.ensure_kernel_cache()
    assert (environment.CACHE_VARIABLE not in os.environ) == kept
    assert ("compiled solvers are kept until the end only" in capsys.readouterr().err) != kept
    os.environ.pop(environment.CACHE_VARIABLE, None)
