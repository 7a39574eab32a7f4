"""How steady states are computed: build the chains, find their periodic orbits, read them."""

import math
import time
from collections import defaultdict
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import lru_cache, partial
from typing import Any

import numpy as np

from multibody_xval.engines.interface.engine import Engine, SteadyStateSolver
from multibody_xval.engines.interface.law import ROUND_OFF_PERIOD, Law, NotModelled
from multibody_xval.engines.interface.presets import FrictionLaw
from multibody_xval.engines.interface.registry import LAW_SUFFIX, law_of
from multibody_xval.engines.interface.variant import Variant
from multibody_xval.engines.shared.law_distance import distance_from_law, gain, stepped_by, unclaimed_reason
from multibody_xval.scenarios.compute.checked import NOT_FINITE, CheckedSimulation, check_trajectory
from multibody_xval.scenarios.runs.failures import results_together
from multibody_xval.scenarios.runs.recorded import RecordedPeriod
from multibody_xval.scenarios.runs.result import RESOLVED_DB, Result, ResultStatus
from multibody_xval.scenarios.runs.task import Recorded, Start, SteadyStateTask
from reference_lcp.chain.simulation import Lane, OrbitStatus, PeriodicOrbit
from reference_lcp.chain.trajectory import State
from reference_lcp.defaults import DEFAULT_PERIODS
from reference_lcp.observables.stick_slip import creep_velocity, largest_gap, open_fraction
from reference_lcp.observables.transmittance import decibel, transmittance
from reference_lcp.one_call import SteadyState
from reference_lcp.steady.neighbours import orbits_from_balance, orbits_from_euler, residual_amplification
from reference_lcp.steady.orbits import LONGEST_MULTIPLE, part_of, periodic_orbits, repetitions, search_repetitions
from reference_lcp.steady.richardson import amplitude_in_db

LAW_RESIDUAL = 0.1
"""Residual of the law's orbit over the one that certifies the engine's: what is left of it is the engine's own."""

ENGINE_PERIODS = 100
"""Periods of a search from harmonic balance of an engine that no law describes: all steady states of the default report
take fewer, and what never settles takes up to three times as many until all hope is gone."""

UNCHANGED_ORBITS = 64
"""Orbits of laws that are kept for variants that change an option of the same preset."""


def is_warm_started(variant: Variant) -> bool:
    """Whether searches of a variant begin at steady states of models, or beside: not those of models themselves."""
    return variant.engine != "reference" and not variant.engine.endswith(LAW_SUFFIX)


def law_orbits(variant: Variant, lanes: Sequence[Lane], steps: int) -> list[PeriodicOrbit | None]:
    """Search the steady state of each lane's law; ``None`` where no law says.

    Those are variants of the reference and of laws themselves, presets whose steps are not modelled, and lanes that a
    law does not claim.
    """
    law = _supposed_law(variant)
    if law is not None and stepped_by(variant) is None and _nearly(variant) is None:
        return [_unchanged_orbit(variant.unchanged, lane, steps) for lane in lanes]
    found: list[PeriodicOrbit | None] = [None] * len(lanes)
    claimed = [number for number, lane in enumerate(lanes) if law is not None and unclaimed_reason(law, lane) is None]
    if law is None or not claimed:
        return found
    model, tolerance = law.build([lanes[number] for number in claimed]), LAW_RESIDUAL * variant.capabilities.residual
    search = orbits_from_euler if isinstance(law, Law) else periodic_orbits
    orbits = search(model, steps, tolerance=tolerance, longest_multiple=1)
    for number, orbit in zip(claimed, orbits, strict=True):
        found[number] = orbit
    return found


@lru_cache(maxsize=UNCHANGED_ORBITS)
def _unchanged_orbit(unchanged: Variant, lane: Lane, steps: int) -> PeriodicOrbit | None:
    """Search the steady state of a law once for all variants that change an option of its preset."""
    return law_orbits(unchanged, [lane], steps)[0]


def _supposed_law(variant: Variant) -> Engine | Law | None:
    """Give what a variant steps by, or nearly, or what it would step by if its changed options did not matter.

    The others say of a motion that it does not settle, see `_unsettled`, which asks them of no bristle.
    """
    if not is_warm_started(variant):
        return None
    own, unchanged = stepped_by(variant), variant.preset.unchanged
    if own is not None or variant.capabilities.friction_law is FrictionLaw.BRISTLE:
        return own
    return _nearly(variant) or (None if unchanged is None else law_of(unchanged))


def _nearly(variant: Variant) -> Law | None:
    stated = variant.preset.stated_law()
    return stated.nearly if isinstance(stated, NotModelled) else None


EULER = Variant("reference")
"""Whose steady states tell by how much a residual is amplified; engines at the same point have nearly the same."""


def run_steady_states(tasks: Sequence[SteadyStateTask]) -> list[Result]:
    """Find the steady states of tasks for one variant, on chains of one length, in order."""
    return results_together(tasks, lambda task: (task.lane()[1], task.start, task.recorded), _results)


def _results(tasks: Sequence[SteadyStateTask]) -> list[Result]:
    """Find the steady states of tasks that share their number of steps a period, at once."""
    variant, recorded = tasks[0].variant, tasks[0].recorded
    if recorded is Recorded.LAW:
        return [_law_period(task) for task in tasks]
    begin, steps = time.perf_counter(), tasks[0].lane()[1]
    states = _steady_states(variant, [task.lane()[0] for task in tasks], steps, tasks[0].start)
    seconds = (time.perf_counter() - begin) / len(tasks)
    return [_result(variant, state, seconds, recorded) for state in states]


def _law_period(task: SteadyStateTask) -> Result:
    """Compare a period with the law's, also where the law does not claim to hold: it may, and the reason is noted."""
    begin = time.perf_counter()
    law = stepped_by(task.variant)
    if law is None:
        return Result.blocked(f"{task.variant} has no law that is a model")
    lane, steps = task.lane()
    distance = distance_from_law(CheckedSimulation(task.variant.build([lane])), law, lane, steps)
    series = {"distance": (distance.law,), "reference": (distance.reference,)}
    if ROUND_OFF_PERIOD < distance.law < math.inf:
        series["gain"] = (gain(law, lane, steps, distance.law),)
    return Result(
        status=ResultStatus.FINISHED,
        series=series,
        reason=unclaimed_reason(law, lane) or "",
        steps_per_period=steps,
        seconds=time.perf_counter() - begin,
    )


def _steady_states(variant: Variant, lanes: Sequence[Lane], steps: int, start: Start) -> list[SteadyState]:
    """Find the steady states of lanes, by the simulation itself where it can."""
    simulation = variant.build(lanes)
    try:
        if isinstance(simulation, SteadyStateSolver):
            states = simulation.steady_states(steps)
            for lane, state in zip(lanes, states, strict=True):
                check_trajectory(state.orbit.trajectory, lane, 0, steps)
            return states
        orbits = _orbits(CheckedSimulation(simulation), variant, lanes, steps, start)
    finally:
        simulation.close()
    return [SteadyState.of(orbit, variant.preset.stick_margin) for orbit in orbits]


def _orbits(
    simulation: CheckedSimulation, variant: Variant, lanes: Sequence[Lane], steps: int, start: Start
) -> list[PeriodicOrbit]:
    """Search every lane: from its law's steady state where there is one, and beside the reference's otherwise.

    What does not settle by its law, or by that of the unchanged preset, is not searched from harmonic balance anew;
    what nearly is its law has the last word only where the engine's next period is the model's. Bristles that find no
    steady state are led by their law, which is theirs to round-off, to where they may repeat after several periods.
    """
    tolerance = variant.capabilities.residual
    if variant.engine == EULER.engine:
        return periodic_orbits(simulation, steps, tolerance=tolerance)
    if start is Start.HARMONIC_BALANCE:
        return orbits_from_balance(simulation, steps, tolerance=tolerance)
    laws = law_orbits(variant, lanes, steps)
    orbits = _unsettled(simulation, variant, laws, steps)
    most = ENGINE_PERIODS if is_warm_started(variant) else DEFAULT_PERIODS
    groups, own, nearly = defaultdict(list), stepped_by(variant), _nearly(variant) is not None
    leads = variant.capabilities.friction_law is FrictionLaw.BRISTLE
    for lane, law in enumerate(laws):
        if lane not in orbits:
            groups[own is not None and law is not None, nearly or law is None or law.converged].append(lane)
    for (from_law, settles), group in groups.items():
        ends = [law.trajectory.end for lane in group if (law := laws[lane]) is not None]
        part, begin = part_of(simulation, group), State.stack(ends) if from_law else None
        search: Callable[..., list[PeriodicOrbit]] = periodic_orbits
        if not (from_law and settles):
            search = partial(orbits_from_euler, max_periods=most, anew=settles)
        leading = own if from_law and leads else None
        longest = LONGEST_MULTIPLE if leading is None else 1
        found = search(part, steps, tolerance=tolerance, start=begin, longest_multiple=longest)
        if leading is not None:
            reached = State.stack([orbit.trajectory.end for orbit in found])
            search_repetitions(found, part, reached, steps, tolerance, leading=leading.build)
        orbits |= dict(zip(group, found, strict=True))
    return [orbits[lane] for lane in range(len(lanes))]


def _unsettled(
    simulation: CheckedSimulation, variant: Variant, laws: Sequence[PeriodicOrbit | None], steps: int
) -> dict[int, PeriodicOrbit]:
    """Give a period of the lanes that neither settle nor repeat by their law, where it is the law's to its bound.

    Left to the engine are lanes whose transmittance the law's best period resolves, since its own may be better, and
    bristles: where they rest, an engine may repeat that differs from its law by round-off.
    """
    law, tolerance = _supposed_law(variant), variant.capabilities.residual
    orbits: dict[int, PeriodicOrbit] = {}
    if not isinstance(law, Law) or variant.capabilities.friction_law is FrictionLaw.BRISTLE:
        return orbits
    for lane, known in enumerate(laws):
        if known is None or known.converged or _is_resolved(known):
            continue
        model, end = law.build([known.lane]), known.trajectory.end
        (own,) = periodic_orbits(part_of(simulation, [lane]), steps, start=end, tolerance=tolerance, max_periods=1)
        (predicted,) = model.run(end, 0, steps)
        distance = np.max(np.abs(own.trajectory.positions - predicted.positions))
        if distance <= law.bound_at(steps) * known.lane.drive.displacement_scale(known.lane.chain):
            multiples, _, _ = repetitions(model, end, steps, tolerance)
            if multiples == [0]:
                orbits[lane] = replace(own, multiple=0)
    return orbits


def _is_resolved(orbit: PeriodicOrbit) -> bool:
    return amplitude_in_db(orbit.residual, decibel(transmittance(orbit))) <= RESOLVED_DB


def _result(variant: Variant, state: SteadyState, seconds: float, recorded: Recorded) -> Result:
    """Give the numbers of a steady state; one whose search has diverged has none."""
    orbit, stick_margin = state.orbit, variant.preset.stick_margin
    if not math.isfinite(orbit.residual):
        reason = f"the engine's numbers are {NOT_FINITE}, in period {orbit.periods} of the search"
        return Result.blocked(reason, by_engine=True)
    if orbit.status is OrbitStatus.DIVERGED:
        return Result(status=ResultStatus(orbit.status), periods=orbit.periods, seconds=seconds)
    drive: Any = orbit.lane.drive
    length = drive.displacement_scale(orbit.lane.chain)
    speed = drive.angular_frequency * length
    modulated = orbit.lane.preload is not None
    series = {} if state.travels is None else {"travels": tuple((state.travels / length).tolist())}
    if recorded is Recorded.PERIOD:
        series |= RecordedPeriod.of(orbit, stick_margin).to_series()
    return Result(
        status=ResultStatus(orbit.status),
        reason=orbit.reason,
        transmittance_db=state.transmittance_db,
        phase=state.phase,
        residual=orbit.residual,
        amplification=residual_amplification(orbit) if variant == EULER else math.nan,
        periods=orbit.periods,
        multiple=orbit.multiple,
        steps_per_period=orbit.trajectory.steps,
        period=orbit.lane.time_step * orbit.trajectory.steps,
        stuck_fraction=tuple(state.stuck_fraction.tolist()),
        transitions=tuple((change.cell, change.time, str(change.kind)) for change in state.transitions),
        creep=tuple((creep_velocity(orbit, stick_margin) / speed).tolist()),
        open_fraction=tuple(open_fraction(orbit).tolist()) if modulated else (),
        largest_gap=tuple((largest_gap(orbit) / length).tolist()) if modulated else (),
        seconds=seconds,
        series=series,
    )
