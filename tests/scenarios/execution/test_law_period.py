"""A period of an engine beside its law's, and where the law claims nothing."""

import pytest

from engines.exudyn import ExudynRegularised
from engines.interface.law_engine import law_of
from engines.interface.variant import Variant
from scenarios.execution.law_period import run_law_periods
from scenarios.tasks.law_period import LawPeriodTask
from scenarios.tasks.result import ResultStatus

pytestmark = pytest.mark.skipif(ExudynRegularised().unavailable_reason() is not None, reason="exudyn is not installed")

DEFAULT = Variant("exudyn-regularised", "joint", "default")


def test_law_is_not_compared_where_it_says_that_it_does_not_hold() -> None:
    """Newton's iteration fails where a kick of friction is wider than two zones, and not where it is narrower."""
    tasks = [
        LawPeriodTask(variant=DEFAULT, friction_ratio=friction_ratio, frequency_ratio=0.9)
        for friction_ratio in (0.1, 0.3)
    ]
    within, beyond = run_law_periods(tasks)
    law = law_of(DEFAULT.preset)
    assert law is not None
    assert within.status is ResultStatus.FINISHED
    assert within.series["distance"][0] <= law.period_bound < within.series["reference"][0]
    assert beyond.status is ResultStatus.BLOCKED
    assert "Newton's iteration" in str(beyond.reason)
