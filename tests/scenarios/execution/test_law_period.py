"""A period of an engine beside its law's, also where the law does not claim to hold."""

import pytest

from engines.exudyn import ExudynRegularised
from engines.interface.law_engine import law_of
from engines.interface.variant import Variant
from scenarios.execution.computation.law_period import run_law_periods
from scenarios.tasks.law_period import LawPeriodTask
from scenarios.tasks.result import ResultStatus

pytestmark = pytest.mark.skipif(ExudynRegularised().unavailable_reason() is not None, reason="exudyn is not installed")

DEFAULT = Variant("exudyn-regularised", "joint", "default")


def test_law_is_compared_where_it_does_not_claim_to_hold_and_the_reason_is_noted() -> None:
    """Newton's iteration may fail where friction kicks beyond two zones; where it does not, the law holds."""
    tasks = [
        LawPeriodTask(variant=DEFAULT, friction_ratio=friction_ratio, frequency_ratio=eta)
        for friction_ratio, eta in ((0.1, 0.9), (0.3, 0.9), (0.6, 0.9))
    ]
    within, holds, fails = run_law_periods(tasks)
    law = law_of(DEFAULT.preset)
    assert law is not None
    assert all(result.status is ResultStatus.FINISHED for result in (within, holds, fails))
    assert within.series["distance"][0] <= law.period_bound < within.series["reference"][0]
    assert not within.reason
    assert holds.series["distance"][0] <= law.period_bound < fails.series["distance"][0]
    for result in (holds, fails):
        assert "Newton's iteration" in result.reason
