"""A digest of the source files that compute an answer: what is corrected does not take old answers for its own."""

import hashlib
import re
import sys
from functools import cache
from pathlib import Path

import numba

from multibody_xval.engines.interface.engine import Engine
from multibody_xval.engines.interface.registry import engine, registered_names
from reference_lcp.process import ROOT

RUNS = tuple(
    ROOT / "multibody_xval" / "scenarios" / f"{name}.py"
    for name in ("runs/steady", "runs/transient", "runs/scene", "runs/failures", "compute/checked")
)
"""What asks an engine, and reads its motion."""

IMPORT = re.compile(rb"^\s*(?:from|import) ((?:multibody_xval\.engines|reference_lcp)[\w.]*)", re.MULTILINE)

LENGTH = 16
"""Digits of a digest: as many versions as anybody makes differ."""


def sources_of(adapter: Engine) -> str:
    """Give the digest of an engine's adapter with its models, and of every file of the suite that they import.

    Kernels that are not compiled round otherwise: their answers are others too.
    """
    base = adapter.name.partition("@")[0]
    modelled = [engine(base)] if base in registered_names() else []
    digest = _sources(frozenset(type(each).__module__ for each in (adapter, *modelled)))
    return f"{digest}, not compiled" if numba.config.DISABLE_JIT else digest


@cache
def _sources(modules: frozenset[str]) -> str:
    """Give the digest of the files of modules, and of all that they import."""
    waiting, found = {*RUNS, *(file for module in modules for file in _files(module))}, set[Path]()
    while waiting:
        file = waiting.pop()
        found.add(file)
        waiting |= _imported(file) - found
    return hashlib.sha256(b"".join(sorted(map(_digest, found)))).hexdigest()[:LENGTH]


@cache
def _digest(file: Path) -> bytes:
    return hashlib.sha256(file.read_bytes()).digest()


@cache
def _imported(file: Path) -> frozenset[Path]:
    """Give the files that one imports, of packages of engines with all that lie beside them."""
    names = IMPORT.findall(file.read_bytes())
    return frozenset(each for name in names for each in _files(name.decode()))


def _files(module: str) -> frozenset[Path]:
    """Give the source files of a module, and of the package of an adapter all; none of what has no source."""
    loaded = sys.modules.get(module)
    file = Path(getattr(loaded, "__file__", None) or ROOT.joinpath(*module.split(".")).with_suffix(".py"))
    if file.is_dir() or not file.is_file():
        file = ROOT.joinpath(*module.split("."), "__init__.py")
    adapter = file.parent.parent == ROOT / "multibody_xval" / "engines" or (
        file.name == "__init__.py" and ROOT not in file.parents
    )
    return frozenset(file.parent.glob("*.py") if adapter else [file]) if file.is_file() else frozenset()
