"""One chain in an engine that runs in another Python."""

import weakref
from collections.abc import Callable
from typing import Any

import numpy as np

from engines.interface.presets import Preset
from engines.out_of_process.process import EngineProcess, EngineProcessError
from engines.out_of_process.worker import Message
from engines.shared.units import Units
from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.trajectory import State, Trajectory
from reference_lcp.stepping.sequential import LaneModel
from reference_lcp.validation import FloatArray, checked_array, checked_count

REQUEST_LIMIT = 60.0
"""Seconds that any request may take, on a machine that is busy."""

STEP_LIMIT = 0.02
"""Seconds that a step may take beside; a hundred times what one of the slowest engine here does."""


class OutOfProcessLane(LaneModel):
    """One chain; the worker builds it on first use, and a fresh worker builds it again.

    Parameters
    ----------
    process
        The worker process of its engine.
    lane
        The lane.
    preset
        Its options; ``units`` is among them. The server gets the others by name.
    formulation
        By its name in the server.
    """

    def __init__(self, process: EngineProcess, lane: Lane, preset: Preset, formulation: str):
        preset = preset if lane.preload is None else preset.modulated()
        self.lane = lane
        self._process = process
        self._preset = preset
        self._units = Units.named(preset["units"], lane)
        self._parameters = self._chain_parameters() | {
            **{name: option.value for name, option in preset.options.items()},
            "formulation": formulation,
        }
        self._generation = 0
        self._number = -1
        self._release: Callable[[], object] = int

    def run(self, state: State, start: int, steps: int) -> Trajectory:
        """Advance from `state`, in one request; see `LaneModel.run`."""
        units, rows = self._units, self._rows(state, start, steps, record=True)
        given = self.lane.preloads(start, steps)
        return Trajectory(
            self.lane.times(start, steps),
            rows["position"] * units.length,
            rows["velocity"] * units.velocity,
            # Of a motor that may do nothing in a step an engine may report what it did in an earlier one.
            np.where(given == 0, 0.0, rows["friction"] * units.force),
            rows["normal"] * units.force if "normal" in rows else given,
            self._internal_state(rows),
            rows["gap"] * units.length if self.lane.opens else None,
        )

    def advance(self, state: State, start: int, steps: int) -> State:
        """Advance as `run` does; only the end is sent back."""
        rows = self._rows(state, start, steps, record=False)
        return self._units.state(rows["position"], rows["velocity"], self._internal_state(rows))

    def native_steps(self, steps: int) -> None:
        """Take steps of the engine alone, in one request; see `engines.interface.engine.NativeStepping`."""
        self._request("native_steps", checked_count("steps", steps), steps=steps)

    def close(self) -> None:
        """Let the worker drop the chain; another use builds it again."""
        self._release()
        self._generation = 0

    def _loads(self, start: int, steps: int) -> FloatArray:
        """Force on cell 1 in each step [N], shape (steps,): the one at its start, as equation (5) takes it."""
        return self.lane.loads(start, steps)

    def _chain_parameters(self) -> dict[str, Any]:
        """Give a server's parameters of the chain, in the units of the lane."""
        chain = self._units.scaled(self.lane.chain)
        scale = self.lane.drive.displacement_scale(self.lane.chain) / self._units.length
        return {
            "mass": np.diag(chain.mass_matrix),
            "stiffness": chain.stiffness_matrix,
            "damping": chain.damping_matrix,
            "chain_stiffness": chain.chain_stiffness,
            "chain_damping": chain.chain_damping,
            "inner_stiffness": chain.inner_stiffness,
            "inner_damping": chain.inner_damping,
            "normal": chain.normal_force,
            "coefficient": chain.friction_coefficient,
            "time_step": self.lane.time_step / self._units.time,
            "length": scale,
        }

    def _rows(self, state: State, start: int, steps: int, record: bool) -> Message:
        checked_count("steps", steps)
        # An engine that meets numbers which are not finite may loop for ever.
        return self._request(
            "run",
            steps,
            position=checked_array("initial positions", state.positions[0]) / self._units.length,
            velocity=checked_array("initial velocities", state.velocities[0]) / self._units.velocity,
            loads=self._loads(start, steps) / self._units.force,
            record=record,
            **self._normal_load(state, start, steps),
        )

    def _normal_load(self, state: State, start: int, steps: int) -> Message:
        """Give the normal loads if they change in time, and the gaps and their rates where contacts open."""
        if self.lane.preload is None:
            return {}
        normal_load = {"normal_load": self.lane.preloads(start, steps) / self._units.force}
        return normal_load | ({"across": self._units.gaps(self.lane, state)} if self.lane.opens else {})

    def _internal_state(self, rows: Message) -> FloatArray | None:
        """Give gaps and their rates, the internal state of a lane; ``None`` where none opens."""
        return self._units.normal_state(rows["gap"][-1], rows["gap_rate"][-1]) if self.lane.opens else None

    def _request(self, request: str, steps: int, /, **values: Any) -> Message:
        self._ensure_built()
        try:
            return self._process.request(request, REQUEST_LIMIT + STEP_LIMIT * steps, number=self._number, **values)
        except EngineProcessError as problem:
            problem.add_note(f"lane: {self.lane.chain.cells} cells, time step {self.lane.time_step:g} s")
            raise

    def _ensure_built(self) -> None:
        """Build the chain unless the worker that runs has it."""
        if self._generation == self._process.generation and self._process.alive():
            return
        self._release()
        self._number = self._process.new_number()
        self._process.request("build", REQUEST_LIMIT, number=self._number, **self._parameters)
        self._generation = self._process.generation
        self._release = weakref.finalize(self, self._process.release, self._number)
