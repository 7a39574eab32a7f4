"""How a motion is computed: advance the chain in the engine, stretch by stretch, and record what the task names."""

import time
from collections.abc import Sequence

import numpy as np

from multibody_xval.scenarios.compute.checked import CheckedSimulation
from multibody_xval.scenarios.runs.failures import results_together
from multibody_xval.scenarios.runs.result import NamedNumbers, Result, ResultStatus
from multibody_xval.scenarios.runs.transient_task import TransientTask
from reference_lcp.chain.mass_in_mass import mechanical_energy
from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.trajectory import State, Trajectory
from reference_lcp.validation import FloatArray

AT_REST = 0.01
"""A contact has come to rest when the two masses stay this near to where they end, over F / k_i.

The creep of a stuck contact, and slip too small to matter, are below.
"""


def run_transients(tasks: Sequence[TransientTask]) -> list[Result]:
    """Simulate motions of one variant and of chains of one length, in order; those with as many steps together."""
    return results_together(tasks, lambda task: (task.steps, task.every, task.stretch), _results)


def _results(tasks: Sequence[TransientTask]) -> list[Result]:
    begin = time.perf_counter()
    lanes = [task.lane() for task in tasks]
    records = [_Record(lane, task) for lane, task in zip(lanes, tasks, strict=True)]
    steps, every = tasks[0].steps, tasks[0].every
    stretch = every * max(1, tasks[0].stretch // every)
    simulation = CheckedSimulation(tasks[0].variant.build(lanes))
    try:
        state = State.stack([task.initial_state() for task in tasks])
        for start in range(0, steps, stretch):
            runs = simulation.run(state, start, min(stretch, steps - start))
            for record, run in zip(records, runs, strict=True):
                record.append(run)
            state = State.stack([run.end for run in runs])
    finally:
        simulation.close()
    seconds = (time.perf_counter() - begin) / len(tasks)
    return [Result(status=ResultStatus.FINISHED, series=record.series(), seconds=seconds) for record in records]


class _Record:
    """Recorded rows of one motion, and what is added up over all of its steps."""

    def __init__(self, lane: Lane, task: TransientTask):
        self._lane, self._task, self._scale = lane, task, lane.drive.displacement_scale(lane.chain)
        initial = task.initial_state()
        self._last_positions, self._last_velocities = initial.positions, initial.velocities
        self._rows: list[FloatArray] = []
        self._slip_velocities: list[FloatArray] = []
        self._slid: list[FloatArray] = []
        self._heat = np.zeros(2)  # what dashpots and contacts have turned into heat so far [J]
        self._initial_energy = float(mechanical_energy(lane.chain, initial.positions, initial.velocities)[0])
        self._least_energy, self._growth = self._initial_energy, 0.0

    def append(self, run: Trajectory) -> None:
        """Add the next stretch."""
        every = self._task.every
        self._rows.append(run.positions[every - 1 :: every].copy())
        if self._task.recorded == "decay":
            self._add_energies(run)
        if self._task.recorded == "slip":
            self._slip_velocities.append(run.relative_velocity[every - 1 :: every, 0].copy())
            self._add_sliding_distance(run)
        self._last_positions, self._last_velocities = run.positions[-1:].copy(), run.velocities[-1:].copy()

    def series(self) -> NamedNumbers:
        """Give what the task names, displacements over the displacement scale and energies over the initial one.

        ``response``: the last outer mass at each kept row. ``slip``: v − u of cell 1 there, and
        ``slip_velocity`` [m/s]; ``slid``, the way ∫ |v̇ − u̇| dt until there [m]. ``decay``: see `_decay`.
        """
        rows, chain = np.concatenate(self._rows) / self._scale, self._lane.chain
        if self._task.recorded == "decay":
            return self._decay(rows)
        if self._task.recorded == "slip":
            return {
                "slip": tuple((rows[:, chain.cells] - rows[:, 0]).tolist()),
                "slip_velocity": tuple(np.concatenate(self._slip_velocities).tolist()),
                "slid": tuple(np.concatenate(self._slid).tolist()),
            }
        return {"response": tuple(rows[:, chain.cells - 1].tolist())}

    def _decay(self, rows: FloatArray) -> NamedNumbers:
        """``rest`` [s]: when the last contact came to rest. ``offsets``: v − u of each cell at the end.

        ``swing``: v − u of cell 1 at each kept row. ``energy``: left in the chain, taken by dashpots, taken by
        contacts, and the largest growth of the chain's energy over the least so far.
        """
        chain, n = self._lane.chain, self._lane.chain.cells
        slip = rows[:, n:] - rows[:, :n]
        near = AT_REST * chain.friction_bound / chain.inner_stiffness / self._scale
        away = np.any(np.abs(slip - slip[-1]) > near, axis=1)
        last = int(np.flatnonzero(away)[-1]) + 1 if np.any(away) else 0
        left = float(mechanical_energy(chain, self._last_positions, self._last_velocities)[0])
        energies = np.array([left, *self._heat, self._growth]) / self._initial_energy
        return {
            "rest": (float(self._task.row_times()[min(last, slip.shape[0] - 1)]),),
            "offsets": tuple(slip[-1].tolist()),
            "swing": tuple(slip[:, 0].tolist()),
            "energy": tuple(energies.tolist()),
        }

    def _add_sliding_distance(self, run: Trajectory) -> None:
        """Add up the way that cell 1 slides, by the trapezoidal rule over all steps, also those that are not kept."""
        cells, every = self._lane.chain.cells, self._task.every
        before = self._last_velocities[:1, cells] - self._last_velocities[:1, 0]
        speed = np.abs(np.concatenate([before, run.relative_velocity[:, 0]]))
        way = self._lane.time_step * np.cumsum((speed[1:] + speed[:-1]) / 2)
        begun = self._slid[-1][-1] if self._slid else 0.0
        self._slid.append(begun + way[every - 1 :: every])

    def _add_energies(self, run: Trajectory) -> None:
        """Add up heat, velocities taken as the mean of both ends of a step, and find energy that grows."""
        chain, dt = self._lane.chain, self._lane.time_step
        positions = np.vstack([self._last_positions, run.positions])
        velocities = np.vstack([self._last_velocities, run.velocities])
        mean = (velocities[1:] + velocities[:-1]) / 2
        dashpots = dt * float(np.einsum("ti,ij,tj->", mean, chain.damping_matrix, mean))
        contacts = -dt * float(np.sum(run.friction * (mean @ chain.contact_directions)))
        self._heat += dashpots, contacts
        rows = mechanical_energy(chain, positions[1:], velocities[1:])
        least = np.minimum.accumulate(np.concatenate([[self._least_energy], rows]))
        self._growth = max(self._growth, float(np.max(rows - least[:-1])))
        self._least_energy = float(least[-1])
