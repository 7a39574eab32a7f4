"""What ``python -m reports card`` does."""

from pathlib import Path

from reports.cards.card import card, card_variants
from reports.cards.write import check_card_files, write_card
from scenarios.cli.evaluation import evaluator_of_run
from scenarios.execution.workers.dask_cluster import executor_for


def write_engine_card(name: str, out: Path, store: Path | None, workers: int | None, time_limit: float) -> None:
    """Collect the card of an engine, write it, and print its page."""
    variants = card_variants(name)
    check_card_files(name, out, store)
    with evaluator_of_run(store, executor_for(workers, time_limit, None), variants) as evaluator:
        shown = card(name, evaluator)
    print(write_card(shown, out)[0])
