"""The results of planned runs: from a store, and of what it lacks from worker processes."""

import os
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import pandas as pd

from multibody_xval.scenarios.compute import SECONDS_A_RUN
from multibody_xval.scenarios.model import Result, Run
from multibody_xval.scenarios.result_tables import now, points
from multibody_xval.scenarios.running.dask_pool import dask
from multibody_xval.scenarios.running.pool import run_missing
from multibody_xval.scenarios.running.processes import local, without_processes
from multibody_xval.scenarios.running.progress import shown
from multibody_xval.scenarios.store import Stored, existing_store, identity, opened
from reference_lcp.errors import ParameterError
from reference_lcp.validation import LONGEST_TIME_LIMIT, checked_count, checked_scalar

Propose = Callable[[pd.DataFrame], list[Run]]
"""Gives the runs that a table of points still needs; none where it is whole."""


MOST_WORKERS = 1024
"""Most worker processes on a machine; more processors than that are in no machine so far."""


@dataclass(frozen=True, kw_only=True)
class Means:
    """What computes, and where results are kept.

    Raises
    ------
    ParameterError
        If a number is outside its range, both workers and a scheduler are given, or this system
        runs no worker processes.
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
            if self.workers > 1 and (reason := without_processes()) is not None:
                raise ParameterError(f"workers = {self.workers}; allowed here: 1, since {reason}")


def computed(
    runs: Sequence[Run],
    means: Means,
    what: str = "operating points",
    then: Sequence[tuple[str, Propose]] = (),
    known: Mapping[Run, Result] | None = None,
) -> list[Stored]:
    """Give the results of runs, in their order, and of those that they lead to; what is known is not run again.

    Parameters
    ----------
    runs
        What is known before anything is run.
    means
        What computes, and where results are kept.
    what
        What the runs are, for the line of progress.
    then
        What follows, each with its name: asked again with the points so far until it proposes nothing.
    known
        Results that neither are run nor kept.

    Raises
    ------
    ParameterError
        If the store is no store, or there is no scheduler.
    RunError
        If the store cannot be written; what is stored stays.
    """
    opened_pool = local(means.workers or os.cpu_count() or 1) if means.scheduler is None else dask(means.scheduler)
    with opened_pool as pool, opened(means.store) as store, shown([what, *(name for name, _ in then)]) as steps:

        def run(new: Sequence[Run]) -> None:
            given = {run: known[run] for run in new if run in known} if known else {}
            rest = [run for run in new if run not in given]
            results = given | run_missing(
                rest, store, pool, steps.ended, known=lambda own: steps.more(len(rest) - len(own)),
                seconds_a_run=means.seconds_a_run, retry_failed=means.retry_failed,
            )  # fmt: skip
            found.update((own, results[own]) for own in new)

        found: dict[Run, Result] = {}
        steps.begin()
        run(runs)
        for _, propose in then:
            steps.begin()
            table = points(now(found))
            while new := [own for own in propose(table) if own not in found]:
                run(new)
                table = pd.concat([table, points(now({own: found[own] for own in new}))], ignore_index=True)
        return now(found)


def stored_results(*stores: Path) -> list[Stored]:
    """Give all that stores hold, whatever engines and versions; of what several hold, the last is given.

    Raises
    ------
    ParameterError
        If a file is missing, or is no store.
    """
    found: dict[tuple[Run, str], Stored] = {}
    for path in stores:
        with opened(existing_store(path)) as store:
            found |= {(row.run, row.version): row for row in store.rows()}
    return list(found.values())


def newest(stored: Iterable[Stored]) -> dict[Run, Stored]:
    """Give one result a run: of the installed version of its engine, or else the last."""
    kept: dict[Run, Stored] = {}
    for row in stored:
        if row.run not in kept or kept[row.run].version != identity(row.run.config)[0]:
            kept[row.run] = row
    return kept
