"""What the suite says of a store that an earlier version of it wrote: every task that commands ask for, every file.

``python -m tests.golden.record STORE --out FOLDER`` writes the outputs of any store into a folder, so that two work
trees can be compared byte by byte. ``python -m tests.golden.record`` writes `EXPECTED` anew; that changes the contract.
"""

import contextlib
import functools
import hashlib
import json
import lzma
import sys
import tempfile
from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any
from unittest.mock import patch

import numpy as np
from reports.cards.card import card

from multibody_xval.engines.interface import registry
from multibody_xval.engines.interface.registry import engine, engine_names
from multibody_xval.engines.interface.variant import variants_named
from multibody_xval.reports.data.collect import Scope, collect
from multibody_xval.reports.export.files import report_dataset
from multibody_xval.reports.export.tables import table_files
from multibody_xval.reports.plan import planned_report
from multibody_xval.reports.reproducers.questions import QUESTIONS
from multibody_xval.reports.reproducers.script import checked, has_reproducer, script
from multibody_xval.scenarios.catalogue.base import run_with_predictions
from multibody_xval.scenarios.catalogue.registry import CATALOGUE
from multibody_xval.scenarios.catalogue.scenes.base import SceneScenario
from multibody_xval.scenarios.catalogue.verdict_table import finding_table
from multibody_xval.scenarios.runs import task
from multibody_xval.scenarios.runs.evaluator import StoredResults
from multibody_xval.scenarios.runs.executor import run_batch
from multibody_xval.scenarios.runs.result import Result
from multibody_xval.scenarios.runs.store import ResultStore
from multibody_xval.scenarios.runs.task import Task, unsourced_key
from multibody_xval.scenarios.studies.accuracy import accuracies
from multibody_xval.scenarios.sweeps.run import saved_sweeps
from reference_lcp.errors import ParameterError

FOLDER = Path(__file__).parent
STORE = FOLDER / "store.sqlite.xz"
EXPECTED = FOLDER / "expected.json.xz"

VERSIONS = {"reference": "0.1.0", "mujoco": "4.0.0", "pybullet": "3.2.7", "exudyn": "1.13.6"}
"""Of the engines whose results the store has; of others, an arbitrary one."""

OF_THIS_MACHINE = ("written", "date_created", "history", "python", "platform", "packages", "source")
"""Parts of files that say when and where they were written."""

STORED = ("unit-cell", "modulated-normal-force", "graded-chain", "inclined-chain", "static-above-kinetic")
STORED_VARIANTS = ("mujoco:joint:default", "exudyn-regularised:contact")
"""Scenarios and variants of which the store has results."""


@contextlib.contextmanager
def every_engine_installed() -> Iterator[None]:
    """Let every engine seem to be there, in the version that wrote the store: keys and scripts depend on both."""
    with contextlib.ExitStack() as patches:
        for name in engine_names():
            version = next((known for start, known in VERSIONS.items() if name.startswith(start)), "1.0.0")
            for method, value in (("version", version), ("unavailable_reason", None)):
                patches.enter_context(patch.object(type(engine(name)), method, lambda _self, value=value: value))
        patches.enter_context(patch.object(Task, "key", lambda own: unsourced_key(own.text())))
        _forget_versions()
        yield
        _forget_versions()


def _forget_versions() -> None:
    """Let the versions of engines, and of laws, be asked for again."""
    task._identity.cache_clear()
    registry._law_engine.cache_clear()


class Asked(StoredResults):
    """Gives what a store has, and notes the key of every task that it is asked for."""

    def __init__(self, store: ResultStore):
        super().__init__(store)
        self.keys: set[str] = set()

    def evaluate(self, tasks: Sequence[Task]) -> list[Result]:
        """Look tasks up."""
        self.keys.update(task.key() for task in tasks)
        return super().evaluate(tasks)


class WithReference(StoredResults):
    """Gives what a store has, and computes what the reference says."""

    def __init__(self, store: ResultStore):
        super().__init__(store)
        self._run_once = functools.cache(lambda task: run_batch([task])[0])

    def evaluate(self, tasks: Sequence[Task]) -> list[Result]:
        """Look tasks up, or run them."""
        stored = super().evaluate(tasks)
        own = [task.variant.engine == "reference" for task in tasks]
        return [self._run_once(task) if run else known for task, run, known in zip(tasks, own, stored, strict=True)]


def requested(store: ResultStore) -> dict[str, list[str]]:
    """Give the keys of the tasks that each command asks of a store first, sorted."""
    quick = planned_report((), None, quick=True, stored_in=None)
    every = variants_named(["all:all:all"])

    def run_quick(asked: Asked) -> None:
        collect(quick.sweep, store, asked, quick.command, scope=quick.scope)

    def run_all(asked: Asked) -> None:
        for scenario in CATALOGUE.values():
            if not isinstance(scenario, SceneScenario):  # which asks whatever engines have scenes
                run_with_predictions(scenario, every, asked)

    keys = {}
    for name, run in {
        "report --quick": run_quick,
        "run all": run_all,
        "run accuracy": lambda asked: accuracies(every, asked),
        "card mujoco": lambda asked: card("mujoco", asked),
    }.items():
        asked = Asked(store)
        run(asked)
        keys[name] = sorted(asked.keys)
    return keys


def digest(keys: Iterable[str]) -> str:
    """Give one digest of all keys."""
    return hashlib.sha256("\n".join(keys).encode()).hexdigest()


def outputs(store: ResultStore, file: Path) -> dict[str, str]:
    """Give every file of the report of a store but the page and its figures, and its tables of verdicts."""
    sweep = saved_sweeps(file).sweep.with_reference()
    report = collect(sweep, store, StoredResults(store), "report", scope=Scope())
    written = dict(table_files(report))
    written["report.json"] = _without(written["report.json"], OF_THIS_MACHINE)
    written["report.nc"] = json.dumps(_plain(report_dataset(report.result).to_dict()))
    variants = variants_named(STORED_VARIANTS)
    for name in STORED:
        findings = {CATALOGUE[name]: run_with_predictions(CATALOGUE[name], variants, StoredResults(store))}
        written[f"{name}.csv"] = finding_table(findings).to_csv(index=False)
    return written


def _plain(data: Mapping[str, Any]) -> Mapping[str, Any]:
    """Give a dataset as plain data, without what depends on this machine."""
    attributes = {name: value for name, value in data["attrs"].items() if name not in OF_THIS_MACHINE}
    return {**data, "attrs": {name: np.asarray(value).tolist() for name, value in attributes.items()}}


def _without(text: str, names: Iterable[str]) -> str:
    """Leave out parts of a JSON file."""
    content = json.loads(text)
    for name in names:
        content["provenance"].pop(name, None)
    return json.dumps(content)


def scripts(store: ResultStore) -> dict[str, str]:
    """Give the reproducer of every variant that has one, for every question; the reference's part is computed."""
    written, evaluator = {}, WithReference(store)
    for variant in filter(has_reproducer, variants_named(["all:all:all"])):
        for scenario in QUESTIONS:
            with contextlib.suppress(ParameterError):
                written[f"{variant} {scenario}.py"] = script(checked(str(variant), scenario), evaluator)
    return written


def everything(file: Path) -> dict[str, str]:
    """Give all outputs of a store and what commands ask of it."""
    with every_engine_installed(), ResultStore(file) as store:
        asked = {name: f"{len(keys)} tasks, {digest(keys)}" for name, keys in requested(store).items()}
        return {**asked, **outputs(store, file), **scripts(store)}


def golden() -> dict[str, str]:
    """Give all outputs of the stored results of `STORE`."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "store.sqlite"
        file.write_bytes(lzma.decompress(STORE.read_bytes()))
        return everything(file)


if __name__ == "__main__":
    if len(sys.argv) > 1:
        chosen, folder = Path(sys.argv[1]), Path(sys.argv[3])
        folder.mkdir(parents=True)
        for name, content in everything(chosen).items():
            (folder / name.replace("/", "_")).write_text(content)
    else:
        EXPECTED.write_bytes(lzma.compress(json.dumps(golden()).encode(), preset=9 | lzma.PRESET_EXTREME))
