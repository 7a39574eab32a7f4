"""One digest of the files that compute a result: what is corrected does not take old results for its own."""

import hashlib
from functools import cache
from importlib import import_module
from pathlib import Path

import reference_lcp
from multibody_xval import engines
from multibody_xval.engines.interface.registry import engine


@cache
def digest(name: str) -> str:
    """Give the digest of code and data of an engine, of what engines share, of the reference and of this folder."""
    adapter = Path(import_module(type(engine(name)).__module__).__file__ or "").resolve()
    own = sorted(adapter.parent.rglob("*.*")) if adapter.name == "__init__.py" else [adapter]
    return _digest(*(file for file in own if file.suffix in (".py", ".toml"))) + _of_the_suite()


@cache
def _of_the_suite() -> str:
    """Give the digest of what every result depends on: what computes, and what builds chains, blocks and scenes."""
    adapters, here = Path(engines.__path__[0]), Path(__file__).parent
    folders = [adapters / "shared", Path(reference_lcp.__path__[0]), here, here.parent / "cases"]
    every = [file for folder in folders for file in sorted(folder.rglob("*.py"))]
    return _digest(*every, adapters / "interface" / "scene.py")


def _digest(*files: Path) -> str:
    return hashlib.sha256(b"".join(hashlib.sha256(file.read_bytes()).digest() for file in files)).hexdigest()[:16]
