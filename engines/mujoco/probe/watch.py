"""A model that is simulated and watched, and the cost of its step."""

import math
import time as clock
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from multibody_xval.engines.mujoco.probe import friction, stops
from multibody_xval.engines.mujoco.probe.friction import Act, Motion, NotJudged
from multibody_xval.engines.mujoco.probe.lines import AS_IT_IS
from multibody_xval.engines.mujoco.probe.slides import Slide, note_slides
from multibody_xval.engines.mujoco.probe.start import Start
from reference_lcp.validation import FloatArray

BLOCKS, BLOCK_TIME = 8, 0.01
"""How often the cost of a step is taken, in turns, and for how long each time [s]; the least counts."""

WATCHED = 1000
"""Steps of a run that are looked at, at most: looking takes longer than the step of a small model."""

GOLDEN = (math.sqrt(5) - 1) / 2
"""Where in a stretch of steps the one is that is looked at moves by this part: no drive's period agrees with it."""


@dataclass
class Run:
    """A model that was watched."""

    data: Any
    settled: FloatArray
    """How far each degree of freedom moved before it was watched [m] or [rad]; shape (nv,)."""
    motions: dict[str, Motion] = field(default_factory=dict)
    moving: frozenset[int] = frozenset()
    """Degrees of freedom with friction that move at the start."""
    stopped: dict[int, float] = field(default_factory=dict)
    """Time by degree of freedom [s]."""
    slides: dict[str, Slide] = field(default_factory=dict)
    """By name, while the model settles too."""
    unfinished: int = 0
    looked: int = 0
    """Steps in which it was looked at."""
    exploded: float = math.nan
    """When [s]."""

    def whole(self) -> dict[str, Motion]:
        """Give what touched or was loaded in each step that was looked at, by name."""
        return {name: motion for name, motion in self.motions.items() if motion.steps == self.looked}


def run_watched(
    model: Any, start: Start, skipped: NotJudged, steps: tuple[int, int, int], advance: Callable[[], None]
) -> Run:
    """Let a model settle and watch it; `steps` are those before, those watched, and those that `advance` counts."""
    import mujoco

    data, (settling, watched, counted_steps) = start.data(model), steps
    begin, moving = data.qpos.copy(), stops.thrown(model, data)
    run = Run(data, np.zeros(model.nv), moving=frozenset(moving))
    bad = [int(getattr(mujoco.mjtWarning, f"mjWARN_{name}")) for name in ("BADQPOS", "BADQVEL", "BADQACC")]
    looked, before = _looked_at(watched), _looked_at(settling)
    at_rest = replace(skipped, dofs=skipped.dofs | set(moving))
    for step in range(-settling, watched):
        start.drive(model, data)
        mujoco.mj_step(model, data)
        if data.warning.number[bad].any():
            return Run(data, run.settled, moving=run.moving, exploded=(settling + step) * model.opt.timestep)
        for dof in [dof for dof in moving if abs(data.qvel[dof]) < stops.STOPPED]:
            moving.remove(dof)
            run.stopped[dof] = data.time
        if step == -1:
            mujoco.mj_differentiatePos(model, run.settled, 1.0, begin, data.qpos)
        if step == 0 and moving:  # what friction has not stopped yet holds nothing
            skipped = replace(skipped, dofs=skipped.dofs | set(moving))
        if settling + step in before:
            note_slides(run.slides, _acts(model, run, at_rest), data.time, _stretch(model, settling))
        if step in looked:
            _look(model, run, skipped, _stretch(model, watched))
        if (settling + step + 1) % counted_steps == 0:
            advance()
    return run


def _looked_at(steps: int) -> set[int]:
    """Give all steps, or `WATCHED` of them: one in each stretch, of as many as there are, never at one phase."""
    if steps <= WATCHED:
        return set(range(steps))
    length = steps / WATCHED
    return {int((number + number * GOLDEN % 1) * length) for number in range(WATCHED)}


def _stretch(model: Any, steps: int) -> float:
    """Give the time for which each step stands that is looked at [s]."""
    return float(max(1.0, steps / WATCHED) * model.opt.timestep)


def _acts(model: Any, run: Run, skipped: NotJudged) -> list[Act]:
    """Give all friction of a step that is judged."""
    return [*friction.contacts(model, run.data, skipped), *friction.joints(model, run.data, skipped)]


def _look(model: Any, run: Run, skipped: NotJudged, stretch: float) -> None:
    """Take a step into the means."""
    run.looked += 1
    run.unfinished += _stopped_at_limit(model, run.data)
    acts = _acts(model, run, skipped)
    for act in acts:
        run.motions.setdefault(act.name, Motion(act.unit, act.row)).add(act)
    note_slides(run.slides, acts, run.data.time, stretch)


def _stopped_at_limit(model: Any, data: Any) -> bool:
    """Tell whether the solver had its last iteration and has not converged; sweeps of noslip count on after it."""
    import mujoco

    last, tolerance = model.opt.iterations - 1, model.opt.tolerance
    if last >= mujoco.mjNSOLVER:  # of which MuJoCo keeps nothing
        return bool((data.solver_niter >= model.opt.iterations).any())
    gradients = model.opt.solver != mujoco.mjtSolver.mjSOL_PGS
    for island in np.flatnonzero(data.solver_niter >= model.opt.iterations).tolist():
        end = data.solver[island * mujoco.mjNSOLVER + last]
        if end.improvement >= tolerance and (not gradients or end.gradient >= tolerance):
            return True
    return False


def costs(models: Mapping[str, Any], runs: Mapping[str, Run]) -> dict[str, float]:
    """Time steps of all lines in turns, without what other programs take of the processor."""
    import mujoco

    least, count = dict.fromkeys(models, math.inf), 1
    for _ in range(BLOCKS):
        for line, model in models.items():
            if math.isnan(runs[line].exploded):
                begin = clock.thread_time()
                mujoco.mj_step(model, runs[line].data, count)
                least[line] = min(least[line], (clock.thread_time() - begin) / count)
        count = max(count, math.ceil(BLOCK_TIME / least[AS_IT_IS]))
    return {line: own / least[AS_IT_IS] if math.isfinite(own) else math.nan for line, own in least.items()}
