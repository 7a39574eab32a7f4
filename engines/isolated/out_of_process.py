"""Engines of a distribution, in its own Python: where that is, one chain there, and the engine."""

import functools
import os
import shutil
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, ClassVar

import numpy as np

from multibody_xval.engines.interface.engine import Engine
from multibody_xval.engines.interface.presets import Formulation, Preset
from multibody_xval.engines.interface.scene import Vector, not_pushed
from multibody_xval.engines.interface.texts import visible
from multibody_xval.engines.isolated.process import REQUEST_LIMIT, STEP_LIMIT, Built, EngineProcess, EngineProcessError
from multibody_xval.engines.isolated.worker import Message
from multibody_xval.engines.shared.units import Units
from reference_lcp.chain.simulation import Lane, Simulation
from reference_lcp.chain.trajectory import State, Trajectory
from reference_lcp.schemes.sequential import LaneModel, SequentialSimulation
from reference_lcp.validation import FloatArray, checked_array, checked_count

START_LIMIT = 60.0
"""Seconds that a worker may take to start and to import its engine, on a machine that is busy."""


def system_python() -> str:
    """Give the Python that the packages of a distribution are for; a virtual environment's own comes first in PATH."""
    search = os.pathsep.join([os.defpath, os.environ.get("PATH", "")])
    return shutil.which("python3", path=search) or "python3"


def interpreter_variable(engine: str) -> str:
    """Give the environment variable that names an engine's Python; the system's is taken without it."""
    return f"MULTIBODY_XVAL_{engine.upper()}_PYTHON"


def interpreter_of(engine: str) -> str:
    """Give an engine's Python, as a path or as a command."""
    return os.environ.get(interpreter_variable(engine)) or system_python()


def process_of(engine: str, server: Path) -> EngineProcess:
    """Give the worker process that runs a server in an engine's Python, which all that it builds share."""
    return _process(engine, interpreter_of(engine), server)


_process = functools.cache(EngineProcess)


@functools.cache
def _versions_or_reason(process: EngineProcess) -> dict[str, str] | str:
    """Give the versions that the server states, or why it cannot be used there: each Python is tried once."""
    try:
        stated = process.request("versions", START_LIMIT)
    except EngineProcessError as problem:
        return str(problem)
    return {name: visible(str(value)) for name, value in stated.items()}


class OutOfProcessLane(LaneModel):
    """One chain; the worker builds it on first use, and a fresh worker builds it again."""

    sizes: ClassVar[Mapping[str, float]] = {}
    """What its server needs of sizes over the displacement scale, by name."""

    def __init__(self, process: EngineProcess, lane: Lane, preset: Preset, formulation: str):
        preset = preset if lane.preload is None else preset.modulated()
        self.lane = lane
        self._preset = preset
        self._units = Units.named(preset["units"], lane)
        options = {name: option.value for name, option in preset.options.items()}
        given = self._chain_parameters() | options | {"formulation": formulation, **self.sizes}
        self._built = Built(process, given)

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

    def close(self) -> None:
        """Let the worker drop the chain; another use builds it again."""
        self._built.close()

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
        try:
            return self._built.request(request, REQUEST_LIMIT + STEP_LIMIT * steps, **values)
        except EngineProcessError as problem:
            problem.add_note(f"lane: {self.lane.chain.cells} cells, time step {self.lane.time_step:g} s")
            raise


class ServedScene:
    """A scene in another Python: a `SceneWorld`, which the worker builds on first use."""

    def __init__(self, name: str, server: Path, parameters: Message):
        """Take the engine, its server and what that builds the scene from; a box is pushed along ``forward``."""
        self.server, self.given = server, parameters
        self._built = Built(process_of(name, server), parameters)
        self._launch: Sequence[float] = ()
        self._push: Sequence[float] = ()
        self.close = self._built.close

    def run(self, steps: int) -> FloatArray:
        """Take steps in one request; see `SceneWorld.run`."""
        limit, known = REQUEST_LIMIT + STEP_LIMIT * steps, self._built.number
        reply = self._built.request("follow", limit, steps=steps, launch=self._launch, push=self._push)
        if known not in {-1, self._built.number}:
            raise EngineProcessError("a scene was lost with its worker, and with it how far it had come")
        self._launch = ()
        rows: FloatArray = reply["rows"]
        return rows

    def launch(self, velocity: Vector, spin: float) -> None:
        """Give the followed box a velocity [m/s] and a spin [rad/s], with the next request."""
        self._launch = *velocity, spin

    def push(self, force: float) -> None:
        """Push the followed box with the next request; see `SceneWorld.push`."""
        if "forward" not in self.given:
            not_pushed(force)
        self._push = [force]


class OutOfProcessEngine(Engine):
    """An engine whose lanes live in a worker process; an adapter adds name, capabilities and server."""

    server: ClassVar[Path]
    """File that serves it in another Python; see `multibody_xval.engines.isolated.worker`."""
    lane_model: ClassVar[type[OutOfProcessLane]] = OutOfProcessLane

    @property
    def interpreter(self) -> str:
        """The Python that is chosen, as a path or as a command."""
        return interpreter_of(self.name)

    def process(self) -> EngineProcess:
        """Give the worker process that all lanes of this engine share."""
        return process_of(self.name, self.server)

    def version(self) -> str:
        """Version of the engine, as its server states it."""
        return self._stated("engine")

    def python(self) -> str:
        """Version of the Python that it runs in."""
        return self._stated("python")

    def unavailable_reason(self) -> str | None:
        """Reason why the engine cannot be used, and what to do; ``None`` if it can."""
        versions, variable = _versions_or_reason(self.process()), interpreter_variable(self.name)
        remedy = f"apt install {self.capabilities.package}, or let {variable} name a Python that has it"
        return f"{remedy} ({versions})" if isinstance(versions, str) else None

    def _stated(self, name: str) -> str:
        versions = _versions_or_reason(self.process())
        if isinstance(versions, str):
            raise EngineProcessError(versions)
        return versions[name]

    def _build(self, lanes: tuple[Lane, ...], formulation: Formulation, preset: Preset) -> Simulation:
        process = self.process()
        return SequentialSimulation([self.lane_model(process, lane, preset, str(formulation)) for lane in lanes])
