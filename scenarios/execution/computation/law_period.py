"""How a period of an engine beside its law's is computed."""

import time
from collections.abc import Sequence

from engines.shared.law_distance import distance_from_law, stepped_by, unclaimed_reason
from scenarios.execution.computation.checked_simulation import CheckedSimulation
from scenarios.execution.computation.failures import results_together
from scenarios.tasks.law_period import LawPeriodTask
from scenarios.tasks.result import Result, ResultStatus


def run_law_periods(tasks: Sequence[LawPeriodTask]) -> list[Result]:
    """Compare a period of one variant with its law's, in order; tasks without a law are blocked.

    The period is compared where the law does not claim to hold too, and the reason is noted: it may hold there.
    """
    return results_together(tasks, lambda some: [_result(task) for task in some])  # their steps may differ


def _result(task: LawPeriodTask) -> Result:
    begin = time.perf_counter()
    law = stepped_by(task.variant)
    if law is None:
        return Result.blocked(f"{task.variant} has no law that is a model")
    lane, steps = task.lane()
    distance = distance_from_law(CheckedSimulation(task.variant.build([lane])), law, lane, steps)
    return Result(
        status=ResultStatus.FINISHED,
        series={"distance": (distance.law,), "reference": (distance.reference,)},
        reason=unclaimed_reason(law, lane) or "",
        steps_per_period=steps,
        seconds=time.perf_counter() - begin,
    )
