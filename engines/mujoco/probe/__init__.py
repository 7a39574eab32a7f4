"""What drifts in a user's own model: as it is, and with the options of the presets ``recommended``.

Every contact pair and every joint with friction is watched that friction should hold by Coulomb's law.
"""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

from multibody_xval.engines.interface.presets import Preset
from multibody_xval.engines.mujoco.probe import friction, lines, stops
from multibody_xval.engines.mujoco.probe.friction import RESTING, Motion, NotJudged
from multibody_xval.engines.mujoco.probe.lines import (
    AS_IT_IS,
    RECIPE,
    WITH_SWEEPS,
    Recipe,
    acts,
    recipe_lines,
    with_options,
)
from multibody_xval.engines.mujoco.probe.load import Loaded, loaded
from multibody_xval.engines.mujoco.probe.slides import Slide, overloaded
from multibody_xval.engines.mujoco.probe.start import Start, started, ways_to_load
from multibody_xval.engines.mujoco.probe.stops import Stop
from multibody_xval.engines.mujoco.probe.watch import WATCHED, Run, costs, run_watched
from multibody_xval.engines.mujoco.simulation import no_warning_file
from reference_lcp.errors import ParameterError, shown
from reference_lcp.validation import checked_count, checked_scalar


@dataclass(frozen=True)
class Held:
    """What friction should hold: a pair of geoms, a joint or a tendon."""

    name: str
    unit: str
    load: float
    """Largest part of the bound, in the first line in which it is loaded and held."""
    loaded: Mapping[str, bool]
    """By line: whether friction has something to hold."""
    drift: Mapping[str, float]
    """By line; infinite where it slides or lost contact, NaN where it touches at times, or the model exploded."""
    predicted: Mapping[str, float]
    """Drift of a joint by the formula of MuJoCo's friction, by line; none of contacts and of joints without one."""
    settled: Mapping[str, float]
    """How far a joint moved before it was watched, by line [m] or [rad]; none of contacts."""


@dataclass(frozen=True)
class Probe:
    """What was measured in a model."""

    costs: Mapping[str, float]
    """Cost of a step, by line, over that of the model as it is; NaN where it exploded.

    As it is alone where there is nothing to hold or to stop; the recipe is last where there is.
    """
    held: tuple[Held, ...]
    not_loaded: tuple[str, ...]
    """Names of what has friction that nothing loads."""
    slides: Mapping[str, Mapping[str, Slide]]
    """What is not judged since its load is above the limit, by name, as it is and with the recipe."""
    ways_to_load: tuple[str, ...]
    """How a user may load the friction of this model, half a sentence each."""
    stops: tuple[Stop, ...]
    unfinished: Mapping[str, int]
    """Steps in which the solver stopped at its limit, by line, of those in which it was looked at."""
    watched: int
    """Number of these steps."""
    notes: tuple[str, ...]
    """What is to be known beside the numbers, a sentence each."""


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
    """Measure drift and cost of a model, as it is and with the options that `presets` change.

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
        If the model does not load, has no friction, explodes, or all in it touches at times only; or `ctrl` does not
        fit.
    """
    checked_scalar("time", time, "> 0")
    checked_scalar("settling", settling, ">= 0")
    with no_warning_file():
        own = loaded(path, floor, free)
        step = own.model.opt.timestep
        before, steps = round(settling / step), checked_count("steps", round(time / step))
        start = started(own, keyframe, ctrl, (before + steps - 1.5) * step)
        lines = recipe_lines(presets, own.model)
        models = {line: with_options(own.model, each) for line, each in lines.items()}
        state = start.data(own.model)
        skipped = friction.not_judged(own.model, state, own.own_base)
        runs = _watched(models, lines, (before, steps, max(round(0.1 / step), 1)), (start, skipped))
        ends = {line: runs[line] for line in (AS_IT_IS, RECIPE)}
        sliding = {line: overloaded(run.slides, run.motions, before * step) for line, run in ends.items()}
        order = _order(runs, [line for line in models if line in runs])
        models, runs = {line: models[line] for line in order}, {line: runs[line] for line in order}
        result = _result(models, runs, sliding, min(steps, WATCHED), (own, start, state, skipped))
        _check(path, runs[AS_IT_IS], result, (skipped, settling, own.notes))
        return result


def _watched(
    models: Mapping[str, Any], lines: Recipe, steps: tuple[int, int, int], begin: tuple[Start, NotJudged]
) -> dict[str, Run]:
    """Watch the model as it is, with the recipe, and with each line of it that may change what was found."""
    from rich.console import Console
    from rich.progress import Progress

    console, runs = Console(stderr=True), dict[str, Run]()
    with Progress(console=console, transient=True, disable=not console.is_terminal) as progress:
        tenths = len(models) * ((steps[0] + steps[1]) // steps[2])
        advance = partial(progress.advance, progress.add_task("tenths of a simulated second", total=tenths))
        for line in (AS_IT_IS, RECIPE, *models):
            if line not in runs and (len(runs) < 2 or (_has_work(runs) and _acts_on(lines[line], runs))):
                runs[line] = run_watched(models[line], *begin, steps, advance)
    return runs


def _has_work(runs: Mapping[str, Run]) -> bool:
    """Tell whether friction has something to hold or to stop, so that it is worthwhile to try each line."""
    whole = [motion for run in runs.values() for motion in run.whole().values()]
    return any(run.moving for run in runs.values()) or any(motion.loaded and motion.held for motion in whole)


def _acts_on(options: Sequence[tuple[str, Any]], runs: Mapping[str, Run]) -> bool:
    """Tell whether a line acts on a friction that the model has."""
    kinds = {motion.row[0] for run in runs.values() for motion in run.motions.values()}
    kinds |= {"dof" for run in runs.values() if run.moving}
    return any(not acts(name) or acts(name) & kinds for name, _ in options)


def _order(runs: Mapping[str, Run], lines: Sequence[str]) -> list[str]:
    """Give the lines that were run, the recipe last: with the model's own sweeps where these help."""
    if not _has_work(runs):
        return [AS_IT_IS]
    kept = [WITH_SWEEPS] if WITH_SWEEPS in runs else []
    best = [RECIPE, *kept] if kept and _sweeps_help(runs[WITH_SWEEPS], runs[RECIPE]) else [*kept, RECIPE]
    return [line for line in lines if line not in best] + best


def _sweeps_help(kept: Run, off: Run) -> bool:
    """Tell whether a model with sweeps without softness drifts less than one without, and stops no joint later."""
    late = any(time > off.stopped.get(dof, math.inf) for dof, time in kept.stopped.items())
    return not late and kept.stopped.keys() >= off.stopped.keys() and _largest(kept) < _largest(off)


def _largest(run: Run) -> float:
    """Give the largest drift of what is loaded and held; infinite where nothing is, as in a model that explodes."""
    held = (motion.drift for motion in run.whole().values() if motion.loaded and motion.held)
    return max(held, default=math.inf)


Whole = Mapping[str, Mapping[str, Motion]]
"""By line, what touched or was loaded in each step that was looked at."""


def _result(
    models: Mapping[str, Any],
    runs: Mapping[str, Run],
    sliding: Mapping[str, Mapping[str, Slide]],
    watched: int,
    begin: tuple[Loaded, Start, Any, NotJudged],
) -> Probe:
    """Put together what was measured."""
    own, start, state, skipped = begin
    whole = {line: run.whole() for line, run in runs.items()}
    names = dict.fromkeys(name for motions in whole.values() for name in motions)
    idle = [name for name in names if not any(own[name].loaded for own in whole.values() if name in own)]
    held = tuple(_held(models, runs, whole, [name for name in names if name not in idle]))
    judged = {*idle, *(each.name for each in held)}
    slides = dict.fromkeys(name for slides in sliding.values() for name in slides if name not in judged)
    return Probe(
        costs(models, runs),
        held,
        tuple(idle),
        {name: {line: own[name] for line, own in sliding.items() if name in own} for name in slides},
        tuple(ways_to_load(own.model)),
        tuple(_stops(own.model, state, runs)),
        {line: run.unfinished for line, run in runs.items() if math.isnan(run.exploded)},
        watched,
        (
            *own.notes,
            *start.notes,
            *_overlaps(own.model, skipped),
            *lines.warnings(own.model),
            *stops.warnings(own.model),
        ),
    )


def _overlaps(model: Any, skipped: NotJudged) -> Iterator[str]:
    """Say which bodies overlap most at the start."""
    if skipped.overlaps:
        pair = max(skipped.overlaps, key=lambda each: skipped.overlaps[each])
        names = " / ".join(friction.element_name(model, "geom", geom) for geom in sorted(pair))
        more = f" and {len(skipped.overlaps) - 1} more" if len(skipped.overlaps) > 1 else ""
        yield f"Bodies overlap by {1e3 * skipped.overlaps[pair]:.3g} mm at the start: {names}{more}."
        yield "They are not judged, nor are the joints between them."


def _stops(model: Any, state: Any, runs: Mapping[str, Run]) -> Iterator[Stop]:
    """Give when joints stopped that moved at the start."""
    for dof in stops.thrown(model, state):
        times = {
            line: run.stopped.get(dof, math.inf) if math.isnan(run.exploded) else math.nan for line, run in runs.items()
        }
        yield Stop(friction.friction_name(model, "dof", dof)[0], stops.exact_time(model, state, dof), times)


def _held(models: Mapping[str, Any], runs: Mapping[str, Run], whole: Whole, names: Sequence[str]) -> Iterator[Held]:
    """Give what is held in a line or more, with its drift in all."""
    for name in names:
        own = {line: motions[name] for line, motions in whole.items() if name in motions}
        held = sorted((motion for motion in own.values() if motion.held), key=lambda motion: not motion.loaded)
        first = next(iter(held), None)
        if first is not None:
            predicted = {line: friction.predicted_drift(models[line], motion) for line, motion in own.items()}
            kind, number = first.row
            yield Held(
                name,
                first.unit,
                first.load,
                {line: motion.loaded for line, motion in own.items()},
                {line: _drift(name, run) for line, run in runs.items()},
                {line: value for line, value in predicted.items() if value is not None},
                {line: float(runs[line].settled[number]) for line in own} if kind == "dof" else {},
            )


def _drift(name: str, run: Run) -> float:
    """Give the drift of a pair, joint or tendon in a run; see `Held.drift`."""
    motion = run.motions.get(name)
    if not math.isnan(run.exploded):
        return math.nan
    if motion is None or motion.drift >= RESTING:
        return math.inf
    return motion.drift if motion.steps == run.looked else math.nan


def _check(path: Path, installed: Run, found: Probe, begin: tuple[NotJudged, float, Sequence[str]]) -> None:
    """Refuse a model in which there is nothing to measure."""
    skipped, settling, notes = begin
    problem = None
    if not math.isnan(installed.exploded):
        problem = f"explodes after {installed.exploded:.3g} s; allowed: one that MuJoCo simulates as it is"
    elif not (installed.motions or found.stops or skipped.overlaps):
        problem = "has no friction to test: no joint has a frictionloss, and nothing that has friction touches; "
        problem += "allowed: a model in which something touches, or a joint has a frictionloss"
    elif not (found.held or found.not_loaded or found.slides or found.stops or skipped.overlaps):
        problem = f"does not rest after {settling:g} s: what has friction touches at times only; allowed: a longer "
        problem += "--settling, or a model that comes to rest"
    if problem is not None:
        raise ParameterError(" ".join([f"MODEL = {shown(path.name)} {problem}", *(f"({note})" for note in notes)]))
