"""A whole motion of an engine beside that of its law, from the same state."""

import numpy as np

from engines.interface.law_engine import law_of
from engines.interface.tolerances import STEPS
from scenarios.execution.evaluator import Evaluator
from scenarios.tasks.result import ResultStatus
from scenarios.tasks.transient import TransientTask
from scenarios.verdicts.prediction import LawPeriod


def motion_distance(task: TransientTask, of_law: TransientTask, series: str, evaluator: Evaluator) -> LawPeriod:
    """Give the largest difference of a series in the whole motion, or the reason why there is none.

    What a law allows of a period adds up over the motion at most. Motions are compared where the law does not claim to
    hold, too, for it may hold there; but not if it models other contacts than those of the task.

    Parameters
    ----------
    task, of_law
        Of a variant that has a law, and of that.
    series
        Of lengths over the displacement scale.
    evaluator
        Runs both.
    """
    law = law_of(of_law.variant.preset)
    assert law is not None, "it is the model of a law"
    bound = law.period_bound * max(1.0, task.steps / STEPS)
    own, predicted = evaluator.evaluate([task, of_law])
    absent = (each.reason for each in (own, predicted) if each.status in (ResultStatus.BLOCKED, ResultStatus.MISSING))
    reason = law.other_contact_reason(task.lane()) or next(absent, None)
    if reason is not None:
        return LawPeriod(np.nan, bound, reason)
    motions = (np.array(result.series[series]) for result in (own, predicted))
    distance = float(np.max(np.abs(np.subtract(*motions))))
    return LawPeriod(distance, bound, law.unmodelled_reason(task.lane()) or "" if distance > bound else "")
