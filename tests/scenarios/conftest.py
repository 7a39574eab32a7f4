"""Asking scenarios in this process: no workers, no store, and an engine that is as wrong as a test wants it."""

import dataclasses
import itertools

import pytest

from multibody_xval.engines.interface.variant import Variant
from multibody_xval.scenarios.runs.executor import run_batch
from multibody_xval.scenarios.runs.result import Result
from multibody_xval.scenarios.runs.task import SteadyStateTask

ANSWERS: dict[SteadyStateTask, Result] = {}
"""What was really asked so far in this process: many tests ask the reference for the same."""

WRONG = Variant("mujoco")
"""Whose answers are falsified: any variant that shares the scheme, for the reference answers in its place."""


class InProcess:
    """Answers by the reference; questions to `WRONG` as `falsified` makes them."""

    def __init__(self, falsified):
        self.falsified = falsified

    def evaluate(self, tasks):
        asked = [self.really(task) for task in tasks]
        missing = [task for task in dict.fromkeys(asked) if task not in ANSWERS]
        for _, group in itertools.groupby(missing, key=lambda q: (q.variant, q.ratios.cells)):
            batch = list(group)
            ANSWERS.update(zip(batch, run_batch(batch), strict=True))
        return [ANSWERS[task] for task in asked]

    def really(self, task: SteadyStateTask) -> SteadyStateTask:
        if task.variant != WRONG:
            return task
        return dataclasses.replace(self.falsified(task), variant=Variant("reference"))


@pytest.fixture
def verdicts():
    """Run a scenario on an engine that is right but for what `falsified` makes of its questions."""

    def run(scenario, falsified=lambda task: task, variant=WRONG):
        return scenario.run([variant], InProcess(falsified))

    return run
