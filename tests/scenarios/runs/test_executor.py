"""The order in which batches reach workers: nobody compiles what another worker is compiling."""

from collections.abc import Collection
from concurrent.futures import Future

import pytest

from multibody_xval.engines.interface.variant import Variant
from multibody_xval.scenarios.runs.executor import Batch, Run, WorkerExecutor
from multibody_xval.scenarios.runs.result import Result
from tests.scenarios.runs.builders import certified, steady

FIRST, SAME_ENGINE, SAME_PACKAGE, OTHER = (
    Variant.parse(name) for name in ("exudyn-bristle", "exudyn-bristle:joint:default", "exudyn-regularised", "pybullet")
)


class TwoWorkers(WorkerExecutor):
    """Two workers, of which the one that began first ends first; notes what they have at the same time."""

    def __init__(self) -> None:
        super().__init__(2, 1.0)
        self.together: list[tuple[Variant, ...]] = []

    def _start(self, batch: Batch) -> Run:
        return Future()

    def _wait(self, running: Collection[Run]) -> None:
        batches = list(running.values())
        self.together.append(tuple(batch[0].variant for batch in batches))
        oldest, results = next(iter(running)), [certified() for _ in batches[0]]
        oldest.set_result(results)

    def _abandon(self, running: Collection[Run]) -> None:
        assert not running


def ran(*variants: Variant) -> list[tuple[Variant, ...]]:
    """Give what two workers had at the same time; the older batch ends first, and every batch comes back."""
    executor, batches = TwoWorkers(), [[steady(0.5 + place / 10, own)] for place, own in enumerate(variants)]
    back: list[tuple[Batch, list[Result]]] = list(executor.run(batches))
    assert sorted(own[0].frequency_ratio for own, _ in back) == [own[0].frequency_ratio for own in batches]
    return executor.together


def test_a_second_worker_takes_another_engine_while_the_first_begins_with_one() -> None:
    assert ran(FIRST, FIRST, OTHER) == [(FIRST, OTHER), (OTHER, FIRST), (FIRST,)]


def test_what_was_put_off_comes_before_the_rest_once_its_engine_has_begun() -> None:
    assert ran(FIRST, FIRST, OTHER, OTHER) == [(FIRST, OTHER), (OTHER, FIRST), (FIRST, OTHER), (OTHER,)]


@pytest.mark.parametrize("alike", [SAME_ENGINE, SAME_PACKAGE])
def test_another_variant_of_a_package_waits_too_since_they_share_what_is_compiled(alike) -> None:
    assert ran(FIRST, alike, OTHER)[0] == (FIRST, OTHER)


def test_no_worker_is_idle_where_there_is_one_engine_alone() -> None:
    assert ran(FIRST, FIRST, FIRST)[0] == (FIRST, FIRST)
