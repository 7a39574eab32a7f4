"""A report from a store of 20,000 points: built in seconds, and small enough to be sent."""

import math
import resource
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

import pytest

from multibody_xval.engines.interface.registry import engine, engine_names
from multibody_xval.engines.interface.variant import Variant, variants_of
from multibody_xval.reports.page.render import LARGEST_PAGE
from multibody_xval.reports.plan import sweep_of
from multibody_xval.scenarios.runs.evaluator import StoredResults
from multibody_xval.scenarios.runs.result import Result
from multibody_xval.scenarios.runs.store import ResultStore
from multibody_xval.scenarios.runs.task import SteadyStateTask
from multibody_xval.scenarios.sweeps.compared import compare_sweep
from multibody_xval.scenarios.sweeps.spec_file import read_sweep

POINTS = 20_000
SECONDS = 120.0
"""Processor time that the report may take: 39 s were measured on two busy cores, and three times as many leave room for
a slower machine. A step that takes a millisecond more a point, or looks through all points for each, takes longer."""

FRICTION_RATIOS = (0.0, 0.1, 0.3, 0.6, 1.0, 5.0)


class Inventor(StoredResults):
    """Makes answers up, and keeps them: curves that fall through the band, with an error of each variant's own."""

    def evaluate(self, tasks: Sequence[SteadyStateTask]) -> list[Result]:
        new = {task: invented(task) for task in self.new_tasks(tasks)}
        self._store.keep(new.items())
        self._results |= new
        return [self._results[task] for task in tasks]


def invented(task: SteadyStateTask) -> Result:
    edge = 0.6 + abs(task.friction_ratio - 0.3) / 4
    error = 1e-3 * (sum(map(ord, str(task.variant))) % 700)
    changes = [
        (cell, (0.07 * cell + 0.25 * k + error / 100) % 1.0, ("stick", "forward slip", "stick", "backward slip")[k])
        for cell in range(1, 6)
        for k in range(4)
    ]
    return Result(
        status="converged",
        transmittance_db=6 * (1 - (task.frequency_ratio / edge) ** 4) + error * math.sin(9 * task.frequency_ratio),
        residual=3e-9,
        periods=33,
        steps_per_period=task.steps_per_period,
        period=1.0,
        stuck_fraction=(0.5,) * 5 + (1.0, 1.0),
        creep=(0.0,) * 7,
        transitions=tuple(changes),
        seconds=0.01,
    )


def sweep_text(variants: Sequence[Variant]) -> str:
    count = math.ceil(POINTS / len(variants) / len(FRICTION_RATIOS))
    etas = sorted({0.6, 0.9, 1.3, *(round(0.3 + 1.7 * k / count, 4) for k in range(count))})
    names = [f"{v.engine}:{v.formulation}:{v.preset_name}" for v in variants]
    return f"engines = {names!r}\n[grid]\nfriction_ratio = {list(FRICTION_RATIOS)}\nfrequency_ratio = {etas}\n"


@pytest.mark.slow
def test_twenty_thousand_points_are_a_page_of_less_than_five_mebibytes(tmp_path: Path) -> None:
    installed = [name for name in engine_names() if engine(name).unavailable_reason() is None]
    variants = [variant for name in installed for variant in variants_of(name)]
    sweep, store = tmp_path / "sweep.toml", tmp_path / "results.sqlite"
    sweep.write_text(sweep_text(variants))
    asked = sweep_of(sweep)
    assert len(read_sweep(sweep).variants) == len(variants)
    with ResultStore(store) as kept:
        result = compare_sweep(asked, Inventor(kept))
    assert len(result.points) >= POINTS
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    files = ["--sweep", str(sweep), "--store", str(store), "--out", str(tmp_path / "out")]
    subprocess.run(
        [sys.executable, "-m", "multibody_xval", "report", "--no-run", *files],
        check=True,
        cwd=Path(__file__).parents[3],
    )
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    seconds = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    size = (tmp_path / "out" / "index.html").stat().st_size
    print(
        f"{len(result.points)} points, {len(variants)} variants: "
        f"{seconds:.1f} s of processor time, {size / 2**20:.2f} MiB"
    )
    assert size < LARGEST_PAGE
    assert seconds < SECONDS
