"""Cost of engines side by side: a step, a steady state, and what a second worker process gives."""

import math
import time
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from engines.interface.variant import Variant
from engines.shared.step_cost import StepCost, step_cost
from reference_lcp.defaults import MINIMUM_STEPS_PER_PERIOD
from scenarios.runs.dask_cluster import executor_for
from scenarios.runs.executor import Batch
from scenarios.runs.parameters import ChainRatios
from scenarios.runs.result import Result
from scenarios.runs.task import SteadyStateTask
from scenarios.studies import COST_SECONDS
from scenarios.tables import Column

TYPICAL_PERIODS = 35
"""Periods of a steady state from which the number of points is estimated: the mean over figure 3."""

LEAST_BATCHES, MOST_BATCHES = 4, 64
"""Batches of a measurement: even for two workers, and enough that the last one alone weighs little."""


@dataclass(frozen=True)
class Cost:
    """What one variant costs, on this machine and in this run."""

    step: StepCost
    points: int
    certified: int
    """Steady states that were searched for, and found."""
    periods: float
    """Median number of periods of the certified ones; NaN without any."""
    seconds: dict[int, float]
    """Wall-clock time of all points, by number of workers; the workers had been started and had imported the engine."""

    @property
    def cell_step(self) -> float:
        """Seconds a cell and step of the adapter."""
        return self.step.advance / ChainRatios().cells

    @property
    def point(self) -> float:
        """Seconds a point with one worker."""
        return self.seconds[1] / self.points

    @property
    def speed_up(self) -> float:
        """How many times faster two workers are than one."""
        return self.seconds[1] / self.seconds[2]


def cost(variant: Variant, seconds: float = COST_SECONDS) -> Cost:
    """Measure one variant that is installed.

    Steady states are those of the canonical chain, spread over friction ratios 0.1…1 and frequency ratios
    0.3…1.6, as many as fill about `seconds`, in the batches that the engine takes at best.
    """
    step = step_cost(variant)
    batches = _batches(variant, step.advance * MINIMUM_STEPS_PER_PERIOD * TYPICAL_PERIODS, seconds)
    taken: dict[int, float] = {}
    for workers in (1, 2):
        taken[workers], results = _timed(batches, workers)
    certified = [result for result in results if result.converged]
    periods = float(np.median([result.periods for result in certified])) if certified else math.nan
    return Cost(step, len(results), len(certified), periods, taken)


def _batches(variant: Variant, point: float, seconds: float) -> list[Batch]:
    """Choose the points: batches smaller than the engine's best where a point alone takes long."""
    lanes = min(variant.batch_lanes, max(1, int(seconds / LEAST_BATCHES / point)))
    count = 2 * round(seconds / point / lanes / 2)
    count = min(max(count, LEAST_BATCHES), MOST_BATCHES)
    # a golden-section sequence spreads any number of points evenly, and hard ones over the batches
    numbers = np.arange(lanes * count)
    friction, eta = 0.1 + 0.9 * (numbers + 0.5) / numbers.size, 0.3 + 1.3 * (numbers * (np.sqrt(5) - 1) / 2 % 1)
    order = numbers.reshape(lanes, count).T
    return [
        [
            SteadyStateTask(variant=variant, friction_ratio=float(friction[k]), frequency_ratio=float(eta[k]))
            for k in row
        ]
        for row in order
    ]


def _timed(batches: Sequence[Batch], workers: int) -> tuple[float, list[Result]]:
    """Run batches in so many workers; gives the seconds, and the results."""
    with executor_for(workers) as executor:
        for _ in executor.run([batches[0][:1]] * workers):  # starts the processes, and imports the engine in each
            pass
        begin = time.perf_counter()
        every = [result for _, results in executor.run(batches) for result in results]
        return time.perf_counter() - begin, every


CostRow = tuple[Cost, Cost]
"""A cost, and that of the reference."""

STEP_COLUMNS: tuple[Column[StepCost], ...] = (
    Column("variant", lambda row: str(row.variant), "engine:formulation:preset"),
    Column("device", lambda row: row.device),
    Column("lanes", lambda row: row.lanes),
    Column("advance [µs]", lambda row: 1e6 * row.advance, pattern="{:.3g}"),
    Column("run [µs]", lambda row: 1e6 * row.run, pattern="{:.3g}"),
    Column("bare [µs]", lambda row: 1e6 * row.bare, pattern="{:.3g}"),
)
"""Of a step of one chain of seven, in batches of several sizes."""

COST_COLUMNS: tuple[Column[CostRow], ...] = (
    Column("variant", lambda row: str(row[0].step.variant), "engine:formulation:preset"),
    Column("advance [µs]", lambda row: 1e6 * row[0].step.advance, pattern="{:.2f}"),
    Column("run [µs]", lambda row: 1e6 * row[0].step.run, pattern="{:.2f}"),
    Column("bare [µs]", lambda row: 1e6 * row[0].step.bare, pattern="{:.2f}"),
    Column("advance / bare", lambda row: row[0].step.ratio, pattern="{:.2f}"),
    Column("run / bare", lambda row: row[0].step.run / row[0].step.bare, pattern="{:.2f}"),
    Column("cell-step [ns]", lambda row: 1e9 * row[0].cell_step, pattern="{:.2f}"),
    Column("step / reference", lambda row: row[0].step.advance / row[1].step.advance, pattern="{:.1f}"),
    Column("points", lambda row: row[0].points),
    Column("certified", lambda row: row[0].certified),
    Column("periods", lambda row: row[0].periods, pattern="{:.0f}"),
    Column("point [ms]", lambda row: 1e3 * row[0].point, pattern="{:.2f}"),
    Column("point / reference", lambda row: row[0].point / row[1].point, pattern="{:.1f}"),
    Column("two workers [ms]", lambda row: 1e3 * row[0].seconds[2] / row[0].points, pattern="{:.2f}"),
    Column("speed-up", lambda row: row[0].speed_up, pattern="{:.2f}"),
)
"""What is printed; times of steps are of one lane of seven cells, times of points those of the whole batch shared."""
