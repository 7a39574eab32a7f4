"""What ``python -m reports reproduce`` does."""

from pathlib import Path

from engines.interface.selection import check_installed
from reports.reproducers.script import checked, script
from scenarios.cli.evaluation import evaluator_of_run
from scenarios.execution.workers.dask_cluster import executor_for


def print_script(variant: str, scenario: str, case: str | None, store: Path | None, time_limit: float) -> None:
    """Print the script of a number; what the store lacks for its header is computed."""
    shown = checked(variant, scenario, case)
    check_installed(shown.variant.engine, shown.variant.unavailable_reason)
    with evaluator_of_run(store, executor_for(1, time_limit, None), [shown.variant]) as evaluator:
        text = script(shown, evaluator)
    print(text, end="")
