"""A batch of runs in this process: failures of an engine are results, each of its own run."""

import time
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import replace

from multibody_xval.engines.interface.engine import EngineNotInstalled
from multibody_xval.engines.interface.texts import shortened, text_of
from multibody_xval.scenarios.cases.motions import BlockMotion, ChainMotion
from multibody_xval.scenarios.cases.scene_motion import SceneMotion
from multibody_xval.scenarios.compute.checked import TrajectoryFault
from multibody_xval.scenarios.compute.motions import motions
from multibody_xval.scenarios.compute.scenes import prepare_scenes, scenes
from multibody_xval.scenarios.compute.steady import steady_states
from multibody_xval.scenarios.model import Case, Config, Result, Run, failed, unsupported
from reference_lcp.chain.trajectory import State
from reference_lcp.errors import ParameterError

KINDS = {
    Case.kind: steady_states,
    ChainMotion.kind: motions,
    BlockMotion.kind: motions,
    SceneMotion.kind: scenes,
}
"""What computes a batch, by its kind of case."""

CIRCUMSTANCES = (MemoryError, OSError)
"""Errors that say more of the machine than of the engine: too little memory, too many open files, a full disk."""

LONGEST_REASON = 500
"""Characters of a reason: an engine may put a whole state into the text of an error."""


def run_batch(runs: Sequence[Run]) -> list[Result]:
    """Run what shares configuration, steps, cells and kind of case; what fails together is run one by one."""
    begin = time.process_time()
    try:
        results = KINDS[runs[0].case.kind](runs)
    except (Exception, SystemExit) as problem:  # whatever an engine raises
        if len(runs) > 1:
            return [run_batch([run])[0] for run in runs]
        results = [result_of(problem)]
    seconds = (time.process_time() - begin) / len(runs)
    return [replace(result, seconds=seconds) for result in results]


def result_of(problem: BaseException) -> Result:
    """Give the result that an error is."""
    text = shortened(" ".join(text_of(problem).split()), LONGEST_REASON)
    if isinstance(problem, EngineNotInstalled):
        return unsupported(f"not installed: {text}")
    if isinstance(problem, ParameterError):
        return unsupported(text)
    if isinstance(problem, TrajectoryFault):
        return failed(text)
    return failed(f"{type(problem).__name__}: {text}", circumstance=isinstance(problem, CIRCUMSTANCES))


def prepare(config: Config) -> None:
    """Import an engine and let it compile, by a step of the paper's chain, or of a scene where it runs nothing else.

    What it raises is the runs' to report.
    """
    with suppress(Exception):
        if config.preset.scenes_only:
            prepare_scenes(config)
            return
        case = Case(friction_ratio=0.3, frequency_ratio=0.9)
        steps = case.steps()
        simulation = config.build([case.lane(steps)])
        try:
            simulation.run(State.at_rest(1, case.cells), 0, 1)
        finally:
            simulation.close()
