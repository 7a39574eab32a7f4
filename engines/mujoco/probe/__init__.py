"""What creeps in a user's own model: as it is, and with the options of the presets ``recommended``.

Every contact pair and every joint with friction is watched that friction should hold by Coulomb's law.
"""

import math
import time as clock
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from multibody_xval.engines.interface.presets import Preset
from multibody_xval.engines.mujoco.probe import friction, stops
from multibody_xval.engines.mujoco.probe.friction import RESTING, Motion, NotJudged
from multibody_xval.engines.mujoco.probe.lines import (
    ALL,
    AS_IT_IS,
    WITH_SWEEPS,
    recipe_lines,
    with_options,
    with_sweeps,
)
from multibody_xval.engines.mujoco.probe.load import Loaded, loaded
from multibody_xval.engines.mujoco.probe.start import Start, started
from multibody_xval.engines.mujoco.probe.stops import Stop
from multibody_xval.engines.mujoco.simulation import no_warning_file
from reference_lcp.errors import ParameterError, shown
from reference_lcp.validation import checked_count, checked_scalar

BLOCKS, BLOCK_TIME = 8, 0.01
"""How often the cost of a step is taken, in turns, and for how long each time [s]; the least counts."""

WATCHED = 1000
"""Steps of a run that are looked at, at most: looking takes longer than the step of a small model."""

GOLDEN = (math.sqrt(5) - 1) / 2
"""Where in a stretch of steps the one is that is looked at moves by this part: no drive's period agrees with it."""


@dataclass(frozen=True)
class Creep:
    """What friction should hold: a pair of geoms, a joint or a tendon."""

    name: str
    unit: str
    load: float
    """Largest part of the bound, in the first line in which it is loaded and held."""
    creep: Mapping[str, float]
    """By line; infinite where it slides, NaN where it lost touch, or the model exploded."""
    law: Mapping[str, float]
    """What the law of a joint's friction predicts, by line; none of contacts and of what the law does not have."""


@dataclass(frozen=True)
class Probe:
    """What was measured in a model."""

    costs: Mapping[str, float]
    """Cost of a step, by line, over that of the model as it is; NaN where it exploded."""
    held: tuple[Creep, ...]
    not_loaded: tuple[str, ...]
    """Names of what has friction that nothing loads."""
    stops: tuple[Stop, ...]
    unfinished: Mapping[str, int]
    """Steps in which the solver stopped at its limit, by line, of those in which it was looked at."""
    watched: int
    """Number of these steps."""
    notes: tuple[str, ...]
    """What is to be known beside the numbers, a sentence each."""


@dataclass
class _Run:
    """A model that was watched."""

    data: Any
    motions: dict[str, Motion] = field(default_factory=dict)
    stopped: dict[int, float] = field(default_factory=dict)
    """Time by degree of freedom [s]."""
    unfinished: int = 0
    exploded: float = math.nan
    """When [s]."""


def probe(
    path: Path,
    presets: Sequence[Preset],
    time: float,
    settling: float,
    *,
    keyframe: str | None = None,
    ctrl: Path | None = None,
    floor: bool = False,
    free: bool = False,
) -> Probe:
    """Measure creep and cost of a model, as it is and with the options that `presets` change.

    Parameters
    ----------
    path
        MJCF, or URDF as MuJoCo reads it.
    time, settling
        How long the model is watched, and left alone before [s].
    keyframe
        Name or number of where it starts; its first one by default, ``none`` for the model's own pose.
    ctrl
        CSV file: time since the start [s] and all controls; each row holds until the next one.
    floor, free
        Put a plane below the model; give the base of a URDF a free joint.

    Raises
    ------
    ParameterError
        If the model does not load, has no friction, explodes, or nothing in it rests; or `ctrl` does not fit.
    """
    from rich.console import Console
    from rich.progress import Progress

    checked_scalar("time", time, "> 0")
    checked_scalar("settling", settling, ">= 0")
    console = Console(stderr=True)
    with no_warning_file():
        own = loaded(path, floor, free)
        step = own.model.opt.timestep
        before, steps = round(settling / step), checked_count("steps", round(time / step))
        start = started(own, keyframe, ctrl, (before + steps - 1.5) * step)
        models = {line: with_options(own.model, each) for line, each in recipe_lines(presets, own.model).items()}
        state = start.data(own.model)
        skipped = friction.not_judged(own.model, state, own.own_base)
        tenth = max(round(0.1 / step), 1)
        with Progress(console=console, transient=True, disable=not console.is_terminal) as progress:
            tenths = len(models) * ((before + steps) // tenth)
            advance = partial(progress.advance, progress.add_task("tenths of a simulated second", total=tenths))
            runs = {
                line: _run(model, start, skipped, (before, steps, tenth), advance) for line, model in models.items()
            }
        if WITH_SWEEPS in runs and _sweeps_help(runs[WITH_SWEEPS], runs[ALL]):
            models, runs = with_sweeps(models), with_sweeps(runs)
        result = _result(models, runs, min(steps, WATCHED), (own, start, state, skipped))
        _check(path, runs[AS_IT_IS], result, (skipped, settling, own.notes))
        return result


def _run(
    model: Any, start: Start, skipped: NotJudged, steps: tuple[int, int, int], advance: Callable[[], None]
) -> _Run:
    """Let a model settle and watch it; `steps` are those before, those watched, and those that `advance` counts."""
    import mujoco

    run = _Run(start.data(model))
    data, moving, (settling, watched, counted_steps) = run.data, stops.thrown(model, run.data), steps
    bad = [int(getattr(mujoco.mjtWarning, f"mjWARN_{name}")) for name in ("BADQPOS", "BADQVEL", "BADQACC")]
    looked = _looked_at(watched)
    for step in range(-settling, watched):
        start.drive(model, data)
        mujoco.mj_step(model, data)
        if data.warning.number[bad].any():
            return _Run(data, exploded=(settling + step) * model.opt.timestep)
        for dof in [dof for dof in moving if abs(data.qvel[dof]) < stops.STOPPED]:
            moving.remove(dof)
            run.stopped[dof] = data.time
        if step == 0 and moving:  # what friction has not stopped yet holds nothing
            skipped = replace(skipped, dofs=skipped.dofs | set(moving))
        if step in looked:
            _look(model, run, skipped)
        if (settling + step + 1) % counted_steps == 0:
            advance()
    return run


def _sweeps_help(kept: _Run, off: _Run) -> bool:
    """Tell whether a model with sweeps without softness creeps less than one without, and stops no joint later."""
    late = any(time > off.stopped.get(dof, math.inf) for dof, time in kept.stopped.items())
    return not late and kept.stopped.keys() >= off.stopped.keys() and _largest(kept) < _largest(off)


def _largest(run: _Run) -> float:
    """Give the largest creep of what is loaded and held; infinite where nothing is, as in a model that explodes."""
    held = (motion.creep for motion in run.motions.values() if motion.loaded and motion.held)
    return max(held, default=math.inf)


def _looked_at(steps: int) -> set[int]:
    """Give all steps, or `WATCHED` of them: one in each stretch, of as many as there are, never at one phase."""
    if steps <= WATCHED:
        return set(range(steps))
    length = steps / WATCHED
    return {int((number + number * GOLDEN % 1) * length) for number in range(WATCHED)}


def _look(model: Any, run: _Run, skipped: NotJudged) -> None:
    """Take a step into the means."""
    data = run.data
    run.unfinished += _stopped_at_limit(model, data)
    for act in (*friction.contacts(model, data, skipped), *friction.joints(model, data, skipped)):
        run.motions.setdefault(act.name, Motion(act.unit, act.row)).add(act)


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


def _result(
    models: Mapping[str, Any], runs: Mapping[str, _Run], watched: int, begin: tuple[Loaded, Start, Any, NotJudged]
) -> Probe:
    """Put together what was measured."""
    own, start, state, skipped = begin
    whole = {
        line: {name: motion for name, motion in run.motions.items() if motion.steps == watched}
        for line, run in runs.items()
    }
    names = dict.fromkeys(name for motions in whole.values() for name in motions)
    idle = [name for name in names if not any(own[name].loaded for own in whole.values() if name in own)]
    return Probe(
        _costs(models, runs),
        tuple(_held(models, whole, [name for name in names if name not in idle])),
        tuple(idle),
        tuple(_stops(own.model, state, runs)),
        {line: run.unfinished for line, run in runs.items() if math.isnan(run.exploded)},
        watched,
        (*own.notes, *start.notes, *_overlaps(own.model, skipped), *stops.warnings(own.model)),
    )


def _overlaps(model: Any, skipped: NotJudged) -> Iterator[str]:
    """Say which bodies overlap most at the start."""
    if skipped.overlaps:
        pair = max(skipped.overlaps, key=lambda each: skipped.overlaps[each])
        names = " / ".join(friction.element_name(model, "geom", geom) for geom in sorted(pair))
        more = f" and {len(skipped.overlaps) - 1} more" if len(skipped.overlaps) > 1 else ""
        yield f"Bodies overlap by {1e3 * skipped.overlaps[pair]:.3g} mm at the start: {names}{more}."
        yield "They are not judged, nor are the joints between them."


def _stops(model: Any, state: Any, runs: Mapping[str, _Run]) -> Iterator[Stop]:
    """Give when joints stopped that moved at the start."""
    for dof in stops.thrown(model, state):
        times = {
            line: run.stopped.get(dof, math.inf) if math.isnan(run.exploded) else math.nan for line, run in runs.items()
        }
        yield Stop(friction.friction_name(model, "dof", dof)[0], stops.exact_time(model, state, dof), times)


def _held(
    models: Mapping[str, Any], whole: Mapping[str, Mapping[str, Motion]], names: Sequence[str]
) -> Iterator[Creep]:
    """Give what is held in a line or more, with its creep in all."""
    for name in names:
        own = {line: motions[name] for line, motions in whole.items() if name in motions}
        held = sorted((motion for motion in own.values() if motion.held), key=lambda motion: not motion.loaded)
        first = next(iter(held), None)
        if first is not None:
            laws = {line: friction.law(models[line], motion) for line, motion in own.items()}
            creep = {line: _creep(own.get(line)) for line in whole}
            known = {line: value for line, value in laws.items() if value is not None}
            yield Creep(name, first.unit, first.load, creep, known)


def _creep(motion: Motion | None) -> float:
    return math.nan if motion is None else motion.creep if motion.creep < RESTING else math.inf


def _check(path: Path, installed: _Run, found: Probe, begin: tuple[NotJudged, float, Sequence[str]]) -> None:
    """Refuse a model in which there is nothing to measure."""
    skipped, settling, notes = begin
    problem = None
    if not math.isnan(installed.exploded):
        problem = f"explodes after {installed.exploded:.3g} s; allowed: one that MuJoCo simulates as it is"
    elif not (installed.motions or found.stops or skipped.overlaps):
        problem = "has no friction that acts: no joint has a frictionloss, and nothing touches; allowed: one that rubs"
    elif not (found.held or found.not_loaded or found.stops or skipped.overlaps):
        problem = f"does not rest after {settling:g} s: all that rubs slides; allowed: a longer --settling, or another"
    if problem is not None:
        raise ParameterError(" ".join([f"MODEL = {shown(path.name)} {problem}", *(f"({note})" for note in notes)]))


def _costs(models: Mapping[str, Any], runs: Mapping[str, _Run]) -> dict[str, float]:
    """Time steps of all lines in turns."""
    import mujoco

    least, count = dict.fromkeys(models, math.inf), 1
    for _ in range(BLOCKS):
        for line, model in models.items():
            if math.isnan(runs[line].exploded):
                begin = clock.perf_counter()
                mujoco.mj_step(model, runs[line].data, count)
                least[line] = min(least[line], (clock.perf_counter() - begin) / count)
        count = max(count, math.ceil(BLOCK_TIME / least[AS_IT_IS]))
    return {line: own / least[AS_IT_IS] if math.isfinite(own) else math.nan for line, own in least.items()}
