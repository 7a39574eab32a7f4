"""One chain as a system of Exudyn, whose solver takes all steps of a run by itself."""

import contextlib
import io
import sys
from abc import abstractmethod
from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from multibody_xval.engines.interface.presets import Preset
from multibody_xval.engines.shared.units import Units
from reference_lcp.chain.drives import HarmonicBase, HarmonicForce
from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.trajectory import State, Trajectory
from reference_lcp.schemes.sequential import LaneModel
from reference_lcp.validation import FloatArray


class ExudynLane(LaneModel):
    """One chain as a system of Exudyn, in the units of its lane; a formulation adds what rubs."""

    _force_variable = "Force"
    """What sensors record of a connector."""

    def __init__(self, lane: Lane, preset: Preset):
        self.lane = lane
        self._preset = preset
        # With dt as unit of time the solver adds up binary fractions: its times are exact, however late.
        self._units = Units.in_steps(preset["units"], lane)
        self._time_step = lane.time_step / self._units.time
        self._chain = self._units.scaled(lane.chain)
        self._substeps = preset["substeps"]
        self._rubbing = np.flatnonzero(self._chain.friction_bound > 0)
        self._harmonic = harmonic_amplitudes(lane)
        self._loads: list[float] = []
        self._first_load = 0
        self._exudyn = exudyn = import_exudyn()
        with silent(exudyn):
            self._container = exudyn.SystemContainer()
            self._system = self._container.AddSystem()
            self._assemble()
        self._settings = self._solver_settings()

    def run(self, state: State, start: int, steps: int) -> Trajectory:
        """Advance from `state`; sensors record the ends of the steps."""
        self._set_friction_state(state, start)
        self._solve(state.positions[0] / self._units.length, state.velocities[0] / self._units.velocity, start, steps)
        positions, velocities = (
            self._along(np.concatenate([self._recorded(sensor, steps) for sensor in sensors], axis=1))
            for sensors in self._motion_sensors
        )
        friction, normal_force = self._recorded_forces(steps)
        return Trajectory(
            self.lane.times(start, steps),
            positions * self._units.length,
            velocities * self._units.velocity,
            friction,
            normal_force,
            self._friction_state(),
        )

    def close(self) -> None:
        """Empty the system; Python frees the rest with the last reference."""
        self._container.Reset()

    @abstractmethod
    def _assemble(self) -> None:
        """Add masses, springs and dashpots, what rubs, the load and the sensors."""

    def _along(self, coordinates: FloatArray) -> FloatArray:
        """Pick the displacements of outer, then inner masses from Exudyn's coordinates; velocities likewise."""
        return coordinates

    def _coordinates(self, along: FloatArray) -> FloatArray:
        """Give all of Exudyn's coordinates for displacements; velocities likewise."""
        return along

    def _recorded_forces(self, steps: int) -> tuple[FloatArray, FloatArray]:
        """Friction and normal force of every contact [N]."""
        friction = np.zeros((steps, self._chain.cells))
        for cell, sensor in zip(self._rubbing, self._force_sensors, strict=True):
            # The connector's force resists its elongation: it is -λ_T on the inner mass.
            friction[:, cell] = -self._recorded(sensor, steps)[:, 0]
        return friction * self._units.force, self.lane.preloads(0, steps)

    def _set_friction_state(self, state: State, start: int) -> None:
        """Set the internal state of the friction law, if it has one."""
        return

    def _friction_state(self) -> FloatArray | None:
        """Give the internal state of the friction law at the end of a run."""
        return None

    def _solve(self, position: FloatArray, velocity: FloatArray, start: int, steps: int) -> None:
        """Run the solver, a new one each time: none of its data outlive a run."""
        data, initial = self._system.systemData, self._exudyn.ConfigurationType.Initial
        data.SetODE2Coordinates(self._coordinates(position), initial)
        data.SetODE2Coordinates_t(self._coordinates(velocity), initial)
        if self._harmonic is None:
            self._tabulate_load(start, steps)
        integration = self._settings.timeIntegration
        integration.startTime = start * self._time_step
        integration.endTime = (start + steps) * self._time_step
        integration.numberOfSteps = steps * self._substeps
        solver = self._exudyn.MainSolverImplicitSecondOrder()
        with silent(self._exudyn):
            succeeded = solver.SolveSystem(self._system, self._settings)
        if not succeeded:
            raise RuntimeError(f"exudyn stopped at {solver.it.currentTime * self._units.time:g} s: no convergence")

    def _recorded(self, sensor: Any, steps: int) -> FloatArray:
        """Rows of a sensor at the ends of the steps, without its column of time and its initial row."""
        rows: FloatArray = self._system.GetSensorStoredData(sensor)[1:, 1:]
        if rows.shape[0] != steps:
            raise RuntimeError(f"exudyn recorded {rows.shape[0]} rows in {steps} steps")
        return rows

    def _add_load(self, marker: Any) -> None:
        """Load the outer mass of cell 1: harmonic drives by a compiled expression, others from a table."""
        from exudyn import advancedUtilities, itemInterface

        load = self._system.AddLoad(itemInterface.LoadCoordinate(markerNumber=marker, load=0.0))
        if self._harmonic is None:
            function = self._tabulated_load
        else:
            sine, cosine = (float(amplitude / self._units.force) for amplitude in self._harmonic[:2])
            omega = self._harmonic[2] * self._units.time
            symbolic = self._exudyn.symbolic

            def expression(mbs: Any, t: Any, load: Any) -> Any:  # noqa: ARG001 - names that Exudyn looks for
                return sine * symbolic.sin(omega * t) + cosine * symbolic.cos(omega * t)

            function = advancedUtilities.CreateSymbolicUserFunction(self._system, expression, "loadUserFunction", load)
        self._load_function = function  # Exudyn does not keep it alive
        self._system.SetLoadParameter(load, "loadUserFunction", function)

    def _tabulate_load(self, start: int, steps: int) -> None:
        """Compute a drive that is not harmonic at the ends of all substeps of a run, at once."""
        substeps = start * self._substeps + np.arange(steps * self._substeps + 1, dtype=np.float64)
        loads = self.lane.drive.load(self.lane.chain, substeps * (self.lane.time_step / self._substeps))
        self._loads, self._first_load = (loads / self._units.force).tolist(), start * self._substeps

    def _tabulated_load(self, _system: Any, time: float, _load: float) -> float:
        """Load at a time; between substeps, where the solver halves one, along a straight line."""
        place = time / self._time_step * self._substeps - self._first_load
        before = min(max(int(place), 0), len(self._loads) - 2)
        part = place - before
        return (1 - part) * self._loads[before] + part * self._loads[before + 1]

    def _add_sensors(self, nodes: Sequence[Any], connectors: Sequence[Any]) -> None:
        """Record the coordinates of all nodes and the force of each connector."""
        from exudyn import itemInterface

        kinds = self._exudyn.OutputVariableType
        self._motion_sensors = [
            [self._add_sensor(itemInterface.SensorNode(nodeNumber=node, outputVariableType=kind)) for node in nodes]
            for kind in (kinds.Coordinates, kinds.Coordinates_t)
        ]
        force = getattr(kinds, self._force_variable)
        self._force_sensors = [
            self._add_sensor(itemInterface.SensorObject(objectNumber=connector, outputVariableType=force))
            for connector in connectors
        ]

    def _add_sensor(self, sensor: Any) -> Any:
        """Add a sensor that records in memory only."""
        sensor.storeInternal, sensor.writeToFile = True, False
        return self._system.AddSensor(sensor)

    def _solver_settings(self) -> Any:
        """Settings of the implicit solver, without any output to files or console."""
        settings = self._exudyn.SimulationSettings()
        settings.solution.file.write = False
        # A little less than a step, for times in seconds add up with round-off.
        settings.solution.sensors.writePeriod = self._time_step * (1 - 1e-9)
        preset, integration = self._preset, settings.timeIntegration
        integration.verboseMode = 0
        integration.minimumStepSize = preset["smallest_step"] * self._time_step
        integration.generalizedAlpha.useNewmark = preset["solver"] == "Newmark"
        integration.newton.relativeTolerance = preset["relative_tolerance"]
        integration.newton.absoluteTolerance = preset["absolute_tolerance"]
        return settings


def harmonic_amplitudes(lane: Lane) -> tuple[float, float, float] | None:
    """Sine and cosine amplitude [N] and ω [rad/s] of the force on cell 1, ``None`` for other drives."""
    drive: Any = lane.drive
    if type(drive) is HarmonicForce:
        return drive.amplitude, 0.0, drive.angular_frequency
    if type(drive) is HarmonicBase:
        spring = float(lane.chain.chain_stiffness[0]) * drive.amplitude
        dashpot = float(lane.chain.chain_damping[0]) * drive.amplitude * drive.angular_frequency
        return spring, dashpot, drive.angular_frequency
    return None


def import_exudyn() -> Any:
    """Import Exudyn without its greeting."""
    if "exudyn" not in sys.modules:
        # The build without range checks, a quarter faster: the only switch that other programs do not inherit.
        sys.exudynFast = True  # type: ignore[attr-defined]
    with contextlib.redirect_stdout(io.StringIO()):
        import exudyn
        import exudyn.advancedUtilities
        import exudyn.itemInterface
    return exudyn


@contextlib.contextmanager
def silent(exudyn: Any) -> Iterator[None]:
    """Keep Exudyn from printing; failures are raised, with their reason."""
    printed = exudyn.config.printToConsole
    exudyn.config.printToConsole = False
    try:
        yield
    finally:
        exudyn.config.printToConsole = printed
