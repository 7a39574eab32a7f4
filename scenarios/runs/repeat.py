"""Tasks that repeat one motion in several ways, and say by how much it then differs."""

import io
import pickle
import subprocess
import sys
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Annotated

import numpy as np

from engines.interface.scene import ContactScene
from reference_lcp.chain.drives import HarmonicBase
from reference_lcp.chain.mass_in_mass import Chain
from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.trajectory import State
from reference_lcp.defaults import BASE_AMPLITUDE, MINIMUM_STEPS_PER_PERIOD
from reference_lcp.validation import FloatArray
from scenarios.runs.failures import results_together
from scenarios.runs.parameters import left_out
from scenarios.runs.result import Result, ResultStatus
from scenarios.runs.scene import SceneTask, built, in_world
from scenarios.runs.task import Task

BATCH = 64
"""Motions that are run beside each other."""

FRICTIONS = np.linspace(1.0, 0.1, BATCH)
"""Their friction, over that of the first: each moves in its own way."""

CHAIN_STEPS = MINIMUM_STEPS_PER_PERIOD // 2
"""Steps of a chain from rest, in which contacts slip and stick."""

TURNS = 10
"""Parts in which worlds are stepped, one world after the other."""

AGAIN, PROCESS, TOGETHER, REVERSED = "again", "another process", f"batch of {BATCH}", "another order"
"""Ways to repeat a motion: in the same process, in one of its own, beside others, and beside them in another order."""


@dataclass(frozen=True, kw_only=True)
class RepeatTask(Task):
    """A motion that is repeated: of the canonical chain from rest, or of a box that is launched."""

    motion: Annotated[SceneTask | None, left_out(None)] = None

    @property
    def series(self) -> Mapping[str, int]:
        """Ways in which it is repeated, a number each."""
        return dict.fromkeys((AGAIN, PROCESS, TOGETHER, REVERSED), 1)

    def unsupported_reason(self) -> str | None:
        """Give the reason why the variant has no such scene."""
        return None if self.motion is None else self.motion.unsupported_reason()

    def rows(self, beside: Sequence[int]) -> FloatArray:
        """Run motions of these numbers at once, and give that of number 0: rows of positions, over their scale."""
        return _chains(self, beside) if self.motion is None else _boxes(self.motion, beside)


def _chains(task: Task, beside: Sequence[int]) -> FloatArray:
    lanes = []
    for number in beside:
        chain = Chain.from_ratios(friction_ratio=0.3 * FRICTIONS[number])
        lanes.append(Lane.periodic(chain, HarmonicBase.from_ratio(chain, 0.6), MINIMUM_STEPS_PER_PERIOD))
    simulation = task.variant.build(lanes)
    try:
        runs = simulation.run(State.at_rest(len(lanes), lanes[0].chain.cells), 0, CHAIN_STEPS)
    finally:
        simulation.close()
    return runs[beside.index(0)].positions / BASE_AMPLITUDE


def _boxes(task: SceneTask, beside: Sequence[int]) -> FloatArray:
    """Step worlds in turn; those beside the first have less friction."""
    scene = task.scene
    assert isinstance(scene, ContactScene), "a box slides"
    boxes = [replace(scene, friction=scene.friction * FRICTIONS[number]) for number in beside]
    worlds = [built(replace(task, scene=box)) for box in boxes]
    try:
        for world in worlds:
            world.launch(in_world(scene, task.launch), task.spin)
        turns = [[world.run(task.steps // TURNS) for world in worlds] for _ in range(TURNS)]
    finally:
        for world in worlds:
            world.close()
    rows = np.concatenate([turn[beside.index(0)] for turn in turns])
    return rows[:, :3] / scene.boxes[0].side


def run_repeats(tasks: Sequence[RepeatTask]) -> list[Result]:
    """Repeat motions, one task after the other."""
    return results_together(tasks, lambda task: task, lambda alike: [_repeated(task) for task in alike])


def _repeated(task: RepeatTask) -> Result:
    """Give, by way, the largest difference from the first motion, over the displacement scale or the box's side."""
    begin, everyone = time.perf_counter(), list(range(BATCH))
    first = task.rows([0])
    ways: dict[str, Callable[[], FloatArray]] = {
        AGAIN: lambda: task.rows([0]),
        PROCESS: lambda: _elsewhere(task),
        TOGETHER: lambda: task.rows(everyone),
        REVERSED: lambda: task.rows(everyone[::-1]),
    }
    return Result(
        status=ResultStatus.FINISHED,
        series={way: (float(np.max(np.abs(motion() - first))),) for way, motion in ways.items()},
        seconds=time.perf_counter() - begin,
    )


def _elsewhere(task: RepeatTask) -> FloatArray:
    """Run the motion alone in a process of its own, which imports what this one does."""
    script = f"import sys; sys.path[:] = {sys.path!r}; from scenarios.runs.repeat import answer; answer()"
    command = [sys.executable, "-c", script]
    answered = subprocess.run(command, input=pickle.dumps(task), stdout=subprocess.PIPE, check=True).stdout
    rows: FloatArray = np.load(io.BytesIO(answered), allow_pickle=False)
    return rows


def answer() -> None:
    """Read a task from standard input, and write its rows to standard output, which engines may not write to."""
    with open(1, "wb", closefd=False) as output, io.BytesIO() as rows:
        sys.stdout = sys.stderr
        np.save(rows, pickle.load(sys.stdin.buffer).rows([0]))
        output.write(rows.getvalue())
