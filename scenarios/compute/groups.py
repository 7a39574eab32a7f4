"""Runs of a batch that have to be computed apart."""

from collections import defaultdict
from collections.abc import Callable, Hashable, Sequence

from multibody_xval.scenarios.model import Result, Run


def by_groups(
    runs: Sequence[Run], key: Callable[[Run], Hashable], compute: Callable[[Sequence[Run]], list[Result]]
) -> list[Result]:
    """Compute runs with equal keys together; gives the results of all in the order of the runs."""
    groups: dict[Hashable, list[Run]] = defaultdict(list)
    for run in runs:
        groups[key(run)].append(run)
    found = {run: result for group in groups.values() for run, result in zip(group, compute(group), strict=True)}
    return [found[run] for run in runs]
