"""Compiled kernels are kept where numba can write, and else in a folder of the process."""

import os
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
