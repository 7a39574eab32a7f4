"""How a motion is computed: advance the chain in the engine, stretch by stretch, and record what its case names."""

from collections.abc import Sequence

import numpy as np

from multibody_xval.engines.interface.presets import Formulation, NormalForce
from multibody_xval.scenarios.cases.motions import BlockMotion, Motion
from multibody_xval.scenarios.compute.checked import CheckedSimulation
from multibody_xval.scenarios.compute.groups import by_groups
from multibody_xval.scenarios.model import Result, Run, Status
from reference_lcp.chain.mass_in_mass import mechanical_energy
from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.trajectory import State, Trajectory
from reference_lcp.validation import FloatArray

AT_REST = 0.01
"""A contact has come to rest when the two masses stay this near to where they end, over F / k_i.

The creep of a stuck contact, and slip too small to matter, are below.
"""

Series = dict[str, tuple[float, ...]]


def motions(runs: Sequence[Run]) -> list[Result]:
    """Follow motions that share configuration, steps and number of cells; those with equal rows together."""
    return by_groups(runs, lambda run: (run.of(Motion).rows, run.of(Motion).stretch), _together)


def is_pressed(run: Run) -> bool:
    """Whether a block is pressed on its carrier by a force: where contacts are free across the row."""
    contact = run.config.formulation == Formulation.CONTACT
    return isinstance(run.case, BlockMotion) and contact and run.config.preset.represents(NormalForce.LIFTING)


def _together(runs: Sequence[Run]) -> list[Result]:
    config, steps, first = runs[0].config, runs[0].steps, runs[0].of(Motion)
    lanes = [run.of(Motion).lane(steps, pressed=is_pressed(run)) for run in runs]
    records = [_Record(lane, run.of(Motion), steps) for lane, run in zip(lanes, runs, strict=True)]
    stretch = first.every(steps) * max(1, first.stretch // first.every(steps))
    simulation = CheckedSimulation(config.build(lanes))
    try:
        state = State.stack([run.of(Motion).initial_state() for run in runs])
        for start in range(0, steps, stretch):
            trajectories = simulation.run(state, start, min(stretch, steps - start))
            for record, trajectory in zip(records, trajectories, strict=True):
                record.append(trajectory)
            state = State.stack([trajectory.end for trajectory in trajectories])
    finally:
        simulation.close()
    return [Result(status=Status.FINISHED, series=record.series()) for record in records]


class _Record:
    """Recorded rows of one motion, and what is added up over all of its steps."""

    def __init__(self, lane: Lane, case: Motion, steps: int):
        self._lane, self._case, self._every, self._scale = lane, case, case.every(steps), case.scale
        initial = case.initial_state()
        self._last_positions, self._last_velocities = initial.positions, initial.velocities
        self._rows: list[FloatArray] = []
        self._slip_velocities: list[FloatArray] = []
        self._slid: list[FloatArray] = []
        self._heat = np.zeros(2)  # what dashpots and contacts have turned into heat so far [J]
        self._initial_energy = float(mechanical_energy(lane.chain, initial.positions, initial.velocities)[0])
        self._least_energy, self._growth = self._initial_energy, 0.0

    def append(self, run: Trajectory) -> None:
        """Add the next stretch."""
        every = self._every
        self._rows.append(run.positions[every - 1 :: every].copy())
        if self._case.recorded == "decay":
            self._add_energies(run)
        if self._case.recorded == "slip":
            self._slip_velocities.append(run.relative_velocity[every - 1 :: every, 0].copy())
            self._add_sliding_distance(run)
        self._last_positions, self._last_velocities = run.positions[-1:].copy(), run.velocities[-1:].copy()

    def series(self) -> Series:
        """Give what the case names, displacements over the displacement scale and energies over the initial one.

        ``response``: the last outer mass at each row. ``slip``: v − u of cell 1 there, and
        ``slip_velocity`` [m/s]; ``slid``, the way ∫ |v̇ − u̇| dt until there [m]. ``decay``: see `_decay`.
        """
        rows, cells = np.concatenate(self._rows) / self._scale, self._lane.chain.cells
        if self._case.recorded == "decay":
            return self._decay(rows)
        if self._case.recorded == "slip":
            return {
                "slip": tuple((rows[:, cells] - rows[:, 0]).tolist()),
                "slip_velocity": tuple(np.concatenate(self._slip_velocities).tolist()),
                "slid": tuple(np.concatenate(self._slid).tolist()),
            }
        return {"response": tuple(rows[:, cells - 1].tolist())}

    def _decay(self, rows: FloatArray) -> Series:
        """``rest`` [s]: when the last contact came to rest. ``offsets``: v − u of each cell at the end.

        ``swing``: v − u of cell 1 at each row. ``energy``: left in the chain, taken by dashpots, taken by contacts, and
        the largest growth of the chain's energy over the least so far.
        """
        chain, n = self._lane.chain, self._lane.chain.cells
        slip = rows[:, n:] - rows[:, :n]
        near = AT_REST * chain.friction_bound / chain.inner_stiffness / self._scale
        away = np.any(np.abs(slip - slip[-1]) > near, axis=1)
        last = int(np.flatnonzero(away)[-1]) + 1 if np.any(away) else 0
        left = float(mechanical_energy(chain, self._last_positions, self._last_velocities)[0])
        energies = np.array([left, *self._heat, self._growth]) / self._initial_energy
        return {
            "rest": (float(self._case.row_times[min(last, slip.shape[0] - 1)]),),
            "offsets": tuple(slip[-1].tolist()),
            "swing": tuple(slip[:, 0].tolist()),
            "energy": tuple(energies.tolist()),
        }

    def _add_sliding_distance(self, run: Trajectory) -> None:
        """Add up the way that cell 1 slides, by the trapezoidal rule over all steps, also those that are not kept."""
        cells, every = self._lane.chain.cells, self._every
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
