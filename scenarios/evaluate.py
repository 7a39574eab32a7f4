"""The results of planned runs: from a store, and of what it lacks from worker processes."""

import os
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import pandas as pd

from multibody_xval.scenarios.judge import judged
from multibody_xval.scenarios.model import Run
from multibody_xval.scenarios.pool import SECONDS_A_RUN, dask, local, run_missing
from multibody_xval.scenarios.progress import shown
from multibody_xval.scenarios.result_tables import now, points
from multibody_xval.scenarios.store import opened
from reference_lcp.errors import ParameterError
from reference_lcp.validation import LONGEST_TIME_LIMIT, MOST_WORKERS, checked_count, checked_scalar


@dataclass(frozen=True, kw_only=True)
class Means:
    """What computes, and where results are kept.

    Raises
    ------
    ParameterError
        If a number is outside its range, or both workers and a scheduler are given.
    """

    store: Path | None = None
    """File of results; without it, none is kept."""
    workers: int | None = None
    """Processes of this machine; one a processor without it."""
    scheduler: str | None = None
    """Address of a dask scheduler, whose workers compute instead."""
    seconds_a_run: float = SECONDS_A_RUN
    """Time limit of a run [s]."""
    retry_failed: bool = False
    """Run again what an engine failed at before."""

    def __post_init__(self) -> None:
        checked_scalar("time_limit", self.seconds_a_run, "> 0", LONGEST_TIME_LIMIT)
        if self.workers is not None:
            checked_count("workers", self.workers, 1, MOST_WORKERS)
            if self.scheduler is not None:
                raise ParameterError(f"workers = {self.workers} with a scheduler; allowed: one of the two")


def judged_points(runs: Sequence[Run], means: Means, what: str) -> pd.DataFrame:
    """Give the judged points of runs; those that are known are not run again.

    Raises
    ------
    ParameterError
        If the store is no store, or there is no scheduler.
    RunError
        If the store cannot be written; what is stored stays.
    """
    opened_pool = local(means.workers or os.cpu_count() or 1) if means.scheduler is None else dask(means.scheduler)
    with opened(means.store) as store, shown(what, len(runs)) as ended, opened_pool as pool:
        found = run_missing(
            runs, store, pool, ended, seconds_a_run=means.seconds_a_run, retry_failed=means.retry_failed
        )
    return judged(points(now(found)))
