"""A corrected adapter does not take the answers that it gave before for its own."""

import json
import os
import shutil
import sqlite3
import subprocess
import sys
from contextlib import closing
from types import ModuleType

import numba
import pytest

from multibody_xval.engines.interface import registry
from multibody_xval.engines.interface.registry import engine
from multibody_xval.scenarios.runs import sources, task
from multibody_xval.scenarios.runs.store import ResultStore, key_of
from reference_lcp.process import ROOT
from tests.scenarios.runs.builders import certified, steady

OLD, NEW = certified(transmittance_db=1.0), certified(transmittance_db=2.0)


@pytest.fixture
def corrected(monkeypatch):
    """Gives what changes the sources of every engine."""

    def correct(digest: str) -> None:
        monkeypatch.setattr(task, "sources_of", lambda _adapter: digest)
        task._identity.cache_clear()

    yield correct
    monkeypatch.undo()
    task._identity.cache_clear()


def test_a_corrected_adapter_computes_anew_and_keeps_what_it_said_before(tmp_path, corrected, capsys) -> None:
    file = tmp_path / "results.sqlite"
    corrected("one")
    with ResultStore(file) as store:
        store.keep([(steady(), OLD)])
        assert store.find(steady()) == OLD
    corrected("another")
    with ResultStore(file) as store:
        assert store.find(steady()) is None
    assert capsys.readouterr().err == ""
    with ResultStore(file, keep_old=True) as store:
        assert list(store.results([steady(0.5), steady()])) == [None, OLD]
    assert "1 results are of another version of the suite" in capsys.readouterr().err
    with ResultStore(file, keep_old=True) as store:
        store.keep([(steady(), NEW)])
        assert store.find(steady()) == NEW
    assert capsys.readouterr().err == ""
    corrected("one")
    with ResultStore(file) as store:
        assert store.find(steady()) == OLD


def test_a_store_of_before_there_were_digests_is_read_where_it_is_to_be(tmp_path) -> None:
    file = tmp_path / "results.sqlite"
    content = {name: value for name, value in steady().content().items() if name != "sources"}
    text = json.dumps(content, separators=(",", ":"))
    with ResultStore(file) as store, closing(sqlite3.connect(file)) as connection, connection:
        assert store.find(steady()) is None
        connection.execute("INSERT INTO answers VALUES (?, ?, ?)", (key_of(text), text, OLD.to_json()))
    with ResultStore(file) as store, ResultStore(file, keep_old=True) as keeping:
        assert store.find(steady()) is None
        assert keeping.find(steady()) == OLD


@pytest.mark.parametrize(
    ("file", "of_mujoco", "of_drake"),
    [
        ("engines/mujoco/step_model.py", True, False),
        ("engines/drake/contact.py", False, True),
        ("reference_lcp/schemes/euler_kernel.py", True, True),
        ("scenarios/runs/steady.py", True, True),
        ("reports/page/render.py", False, False),
    ],
)
def test_digest_is_of_what_computes_an_answer(monkeypatch, file, of_mujoco, of_drake) -> None:
    def digests() -> list[str]:
        sources._sources.cache_clear()
        return [sources.sources_of(engine(name)) for name in ("mujoco", "mujoco@law", "drake")]

    before, known = digests(), sources._digest
    monkeypatch.setattr(sources, "_digest", lambda own: b"changed" if own.resolve() == ROOT / file else known(own))
    assert [one != two for one, two in zip(before, digests(), strict=True)] == [of_mujoco, of_mujoco, of_drake]
    sources._sources.cache_clear()


def test_kernels_that_are_not_compiled_have_other_sources(monkeypatch) -> None:
    compiled = sources.sources_of(engine("reference"))
    monkeypatch.setattr(numba.config, "DISABLE_JIT", 1)
    assert sources.sources_of(engine("reference")) == f"{compiled}, not compiled"


def test_no_other_engine_is_asked_for_what_computes_an_answer(monkeypatch) -> None:
    """Each that runs in a Python of its own would start it, in every worker."""
    adapters = [engine(name) for name in ("reference", "mujoco", "mujoco@law")]
    asked, known = [], registry.broken_reason
    monkeypatch.setattr(registry, "broken_reason", lambda name: asked.append(name) or known(name))
    for adapter in adapters:
        sources.sources_of(adapter)
    assert asked == ["reference", "mujoco", "mujoco"]


ROOMS = ("reference_lcp", "engines", "scenarios", "multibody_xval")


@pytest.mark.slow
def test_digest_is_the_same_wherever_the_suite_lies(tmp_path) -> None:
    """A store goes on in another checkout, or in an environment that is made anew."""
    command = (
        "from multibody_xval.scenarios.runs.sources import sources_of as of; "
        "from multibody_xval.engines.interface.registry import engine;"
    )
    digests = set()
    for folder in (tmp_path / "a", tmp_path / "z"):
        for room in ROOMS:
            shutil.copytree(ROOT / room, folder / room, symlinks=True, ignore=shutil.ignore_patterns("__pycache__"))
        code = f"{command} print(*(of(engine(name)) for name in ('reference', 'mujoco')))"
        printed = subprocess.run(
            [sys.executable, "-c", code], env=os.environ | {"PYTHONPATH": str(folder)}, cwd=folder,
            capture_output=True, text=True, check=True,
        )  # fmt: skip
        digests.add(printed.stdout)
    assert len(digests) == 1
    assert len(set(digests.pop().split())) == 2


@pytest.mark.parametrize(("asked", "files"), [("outer", {"__init__.py", "joint.py"}), ("outer.joint", {"joint.py"})])
def test_digest_of_an_engine_from_elsewhere_is_of_its_whole_package(tmp_path, monkeypatch, asked, files) -> None:
    package = tmp_path / "outer"
    package.mkdir()
    for name in ("__init__.py", "joint.py"):
        (package / name).write_text(f"# {name}\n")
    for name, file in (("outer", "__init__.py"), ("outer.joint", "joint.py")):
        module = ModuleType(name)
        module.__file__ = str(package / file)
        monkeypatch.setitem(sys.modules, name, module)
    assert {file.name for file in sources._files(asked)} == files
