"""Exudyn's joint formulation: a connector with dry friction between outer and inner mass, by two laws."""

import contextlib
import io
import sys
from collections.abc import Iterator, Sequence
from functools import cached_property
from typing import Any

import numpy as np

from multibody_xval.engines.exudyn.step_model import (
    bristle_numbers,
    bristles_at,
    harmonic_amplitudes,
    reduced_mass,
    zone_widths,
)
from multibody_xval.engines.interface.presets import Preset
from multibody_xval.engines.shared.units import Units
from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.trajectory import State, Trajectory
from reference_lcp.schemes.sequential import LaneModel
from reference_lcp.validation import FloatArray, checked_count

STATIC_DECAY = 1e-3
"""Velocity of a slip at which what static friction is above kinetic friction has decayed to 1/e of it [m/s]: Exudyn's
own `exponentialDecayStatic`."""

STATIC_DECAY_PER_KICK = 0.04
"""The same of tuned bristles, over μ_k λ_N h / m_red: it is passed in a substep, and vanishes with the step."""


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
        with imported(preset["module"]) as exudyn:
            self._exudyn = exudyn
            self._container = exudyn.SystemContainer()
            self._system = self._container.AddSystem()
            self._assemble()
        self._settings = self._solver_settings()
        self._loads: list[float] = []
        self._first_load = 0

    def run(self, state: State, start: int, steps: int) -> Trajectory:
        """Advance from `state`; sensors record the ends of the steps."""
        self._start(state, start, steps, record=True)
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

    def advance(self, state: State, start: int, steps: int) -> State:
        """Advance as `run` does and give the end only; without sensors it needs less time."""
        self._start(state, start, steps, record=False)
        data, current = self._system.systemData, self._exudyn.ConfigurationType.Current
        position = self._along(np.array(data.GetODE2Coordinates(current)))
        velocity = self._along(np.array(data.GetODE2Coordinates_t(current)))
        return self._units.state(position[None], velocity[None], self._friction_state())

    def close(self) -> None:
        """Empty the system; Python frees the rest with the last reference."""
        self._container.Reset()

    def _connector(self, cell: int) -> dict[str, Any]:
        """Parameters of the friction connector of one cell, in the units of the lane."""
        raise NotImplementedError

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

    def _start(self, state: State, start: int, steps: int, *, record: bool) -> None:
        checked_count("steps", steps)
        self._set_friction_state(state, start)
        position, velocity = state.positions[0] / self._units.length, state.velocities[0] / self._units.velocity
        self._solve(position, velocity, start, steps, record=record)

    def _solve(self, position: FloatArray, velocity: FloatArray, start: int, steps: int, *, record: bool) -> None:
        """Run the solver, a new one each time: none of its data outlive a run."""
        data, initial = self._system.systemData, self._exudyn.ConfigurationType.Initial
        data.SetODE2Coordinates(self._coordinates(position), initial)
        data.SetODE2Coordinates_t(self._coordinates(velocity), initial)
        self._tabulate_load(start, steps)
        integration = self._settings.timeIntegration
        integration.startTime = start * self._time_step
        integration.endTime = (start + steps) * self._time_step
        integration.numberOfSteps = steps * self._substeps
        self._settings.solution.sensors.active = record
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

    def _assemble(self) -> None:
        """Add masses, springs and dashpots as matrices, the friction connectors, the load and the sensors."""
        from exudyn import itemInterface

        system, cells = self._system, self._chain.cells
        still = [0.0] * (2 * cells)
        node = system.AddNode(
            itemInterface.NodeGenericODE2(
                numberOfODE2Coordinates=2 * cells,
                referenceCoordinates=still,
                initialCoordinates=still,
                initialCoordinates_t=still,
            )
        )
        system.AddObject(
            itemInterface.ObjectGenericODE2(
                nodeNumbers=[node],
                massMatrix=self._chain.mass_matrix,
                stiffnessMatrix=self._chain.stiffness_matrix,
                dampingMatrix=self._chain.damping_matrix,
            )
        )
        markers = [
            system.AddMarker(itemInterface.MarkerNodeCoordinate(nodeNumber=node, coordinate=i))
            for i in range(2 * cells)
        ]
        connectors = [
            system.AddObject(
                itemInterface.ObjectConnectorCoordinateSpringDamperExt(
                    markerNumbers=[markers[cell], markers[cells + cell]], **self._connector(cell)
                )
            )
            for cell in self._rubbing.tolist()
        ]
        self._add_load(markers[0])
        self._add_sensors([node], connectors)
        system.Assemble()

    def _add_load(self, marker: Any) -> None:
        """Load the outer mass of cell 1: harmonic drives by a compiled expression, others from a table."""
        from exudyn import advancedUtilities, itemInterface

        load = self._system.AddLoad(itemInterface.LoadCoordinate(markerNumber=marker, load=0.0))
        harmonic = harmonic_amplitudes(self.lane)
        if harmonic is None:
            function = self._tabulated_load
        else:
            sine, cosine = (float(amplitude / self._units.force) for amplitude in harmonic[:2])
            omega = harmonic[2] * self._units.time
            symbolic = self._exudyn.symbolic

            def expression(mbs: Any, t: Any, load: Any) -> Any:  # noqa: ARG001 - names that Exudyn looks for
                return sine * symbolic.sin(omega * t) + cosine * symbolic.cos(omega * t)

            function = advancedUtilities.CreateSymbolicUserFunction(self._system, expression, "loadUserFunction", load)
        self._load_function = function  # Exudyn does not keep it alive
        self._system.SetLoadParameter(load, "loadUserFunction", function)

    def _tabulate_load(self, start: int, steps: int) -> None:
        """Compute a drive that is not harmonic at the ends of all substeps of a run, at once."""
        if harmonic_amplitudes(self.lane) is not None:
            return
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
        """Record the coordinates of all nodes and the force of each connector, in memory only."""
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


class JointLane(ExudynLane):
    """Connectors whose friction at rest may be larger than in motion."""

    def _friction(self, cell: int, decay: float) -> dict[str, Any]:
        """Give kinetic friction, what static friction is above it, and the slip velocity at which it decays."""
        bound = float(self._chain.friction_bound[cell])
        return {
            "dynamicFrictionForce": bound,
            "staticFrictionOffsetForce": (self.lane.static_ratio - 1) * bound,
            "exponentialDecayStatic": decay,
        }


class RegularisedLane(JointLane):
    """Friction -F ġ_T / v_reg within |ġ_T| < v_reg, -F sign ġ_T beyond; static friction decays in as wide a zone."""

    def _connector(self, cell: int) -> dict[str, Any]:
        zone = float(zone_widths(self.lane, self._preset)[cell]) / self._units.velocity
        return {**self._friction(cell, zone), "frictionProportionalZone": zone}


class BristleLane(JointLane):
    """Friction of a bristle, whose internal state is whether it slips and where its foot is.

    In a state it is, in SI units, for each contact the slip force [N] with the sign of the
    slip, 0 in stick; then for each contact the deflection of the bristle [m]. Deflections, unlike
    the positions of the feet, stay valid when a solver of periodic orbits moves all masses.
    """

    @cached_property
    def _bristles(self) -> tuple[FloatArray, FloatArray]:
        return bristles(self.lane, self._preset, self._units)

    def _connector(self, cell: int) -> dict[str, Any]:
        from exudyn import itemInterface

        node = self._system.AddNode(
            itemInterface.NodeGenericData(initialCoordinates=[0.0] * 3, numberOfDataCoordinates=3)
        )
        stiffness, damping = self._bristles
        return {
            "nodeNumber": node,
            **self._friction(cell, self._static_decay(cell)),
            "stickingStiffness": float(stiffness[cell]),
            "stickingDamping": float(damping[cell]),
        }

    def _static_decay(self, cell: int) -> float:
        """Velocity at which static friction decays, in the units of the lane: the default, or a part of a kick."""
        if "stickingStiffness" in self._preset.options:
            return STATIC_DECAY / self._units.velocity
        kick = self._chain.friction_bound[cell] / reduced_mass(self._chain)[cell] * self._time_step / self._substeps
        return STATIC_DECAY_PER_KICK * float(kick)

    def _solver_settings(self) -> Any:
        settings = super()._solver_settings()
        # With none, Exudyn reports success and leaves the chain where it is.
        iterations = checked_count("discontinuous_iterations", self._preset["discontinuous_iterations"])
        settings.timeIntegration.discontinuous.maxIterations = iterations
        return settings

    def _set_friction_state(self, state: State, start: int) -> None:
        units, (stiffness, damping) = self._units, self._bristles
        load = float(self.lane.loads(start, 1)[0])
        si = stiffness * units.force / units.length, damping * units.force / units.velocity
        slip, deflection = bristles_at(state, self.lane, load, *si)
        outer, inner = np.split(state.positions[0], 2)
        foot = (inner - outer - deflection) / units.length
        data = np.stack([slip / units.force, foot, np.zeros_like(slip)], axis=1)[self._rubbing]
        self._system.systemData.SetDataCoordinates(data.ravel(), self._exudyn.ConfigurationType.Initial)

    def _friction_state(self) -> FloatArray:
        current = self._exudyn.ConfigurationType.Current
        data = np.array(self._system.systemData.GetDataCoordinates(current)).reshape(-1, 3)
        outer, inner = np.split(np.array(self._system.systemData.GetODE2Coordinates(current)), 2)
        slip, deflection = np.zeros((2, self._chain.cells))
        slip[self._rubbing] = data[:, 0]
        deflection[self._rubbing] = (inner - outer)[self._rubbing] - data[:, 1]
        return np.concatenate([slip * self._units.force, deflection * self._units.length])


def bristles(lane: Lane, preset: Preset, units: Units) -> tuple[FloatArray, FloatArray]:
    """Give stiffness k_s of each bristle and the dashpot beside it, shape (n,) each, in `units`."""
    if "stickingStiffness" in preset.options:
        stiffness = preset["stickingStiffness"] / (units.force / units.length)
        damping = preset["stickingDamping"] / (units.force / units.velocity)
        return np.full(lane.chain.cells, stiffness), np.full(lane.chain.cells, damping)
    time_step, numbers = lane.time_step / units.time, (preset["bristle_phase"], preset["bristle_damping"])
    return bristle_numbers(units.scaled(lane.chain), time_step, preset["substeps"], *numbers)


@contextlib.contextmanager
def imported(module: str) -> Iterator[Any]:
    """Import Exudyn without its greeting, and keep its console silent while a system is built."""
    if "exudyn" not in sys.modules:
        # The only switch for the fast build that is read at import and not inherited by other programs.
        sys.exudynFast = module == "fast"  # type: ignore[attr-defined]
    with contextlib.redirect_stdout(io.StringIO()):
        import exudyn
        import exudyn.advancedUtilities
        import exudyn.itemInterface
    with silent(exudyn):
        yield exudyn


@contextlib.contextmanager
def silent(exudyn: Any) -> Iterator[None]:
    """Keep Exudyn from printing; failures are raised, with their reason."""
    printed = exudyn.config.printToConsole
    exudyn.config.printToConsole = False
    try:
        yield
    finally:
        exudyn.config.printToConsole = printed
