"""Exudyn: the chain as one generic second-order object, with a dry-friction connector in every cell.

The connector `CoordinateSpringDamperExt` knows two friction laws, and each is an engine of its own here:
a force proportional to velocity within a narrow zone, and a bristle that sticks until it breaks.
"""

import contextlib
import dataclasses
import importlib.util
import io
import sys
from collections.abc import Iterator, Sequence
from importlib.metadata import version
from typing import Any, ClassVar

import numpy as np

from engines.interface import (
    Capabilities,
    Engine,
    Formulation,
    FrictionLaw,
    LaneModel,
    LanewiseSimulation,
    Option,
    Preset,
    constant_normal_force,
)
from engines.units import Units
from reference_lcp.chain import Chain
from reference_lcp.drive import HarmonicBase, HarmonicForce
from reference_lcp.simulation import Lane, Simulation
from reference_lcp.trajectory import State, Trajectory
from reference_lcp.validation import FloatArray, checked_count

_SHARED_OPTIONS = {
    "module": Option("fast", "checked", "The build without range checks needs a quarter less time."),
    "solver": Option("Newmark", "generalised alpha", "Accelerations then follow from the state: restarts are exact."),
    "relative_tolerance": Option(1e-10, 1e-8, "Newton residual over the first; a period then repeats to 1e-8."),
    "absolute_tolerance": Option(1e-13, 1e-10, "Newton residual in the units of the lane, where forces are small."),
    "smallest_step": Option(1e-6, 1e-8, "Over dt, not in seconds: where adaptive steps give up."),
}

REGULARISED_TUNED = Preset(
    "Steps and proportional zone small enough that creep stays below what a transmittance shows.",
    {
        **_SHARED_OPTIONS,
        "substeps": Option(
            8, 1, "Steps inside each dt: the trapezoidal rule rings where F h / m_red is many zones wide."
        ),
        "zone": Option(5e-4, 0.0, "frictionProportionalZone over s ω_r, with s the displacement scale of the drive."),
        "zone_per_kick": Option(0.15, 0.0, "Smallest frictionProportionalZone over F h / m_red, for h the substep."),
    },
    split_tolerance=1e-9,
)

BRISTLE_TUNED = Preset(
    "Bristles as stiff as the step resolves, and one correction of the friction state a step.",
    {
        **_SHARED_OPTIONS,
        "substeps": Option(4, 1, "Steps inside each dt: reversals that graze are seen at the end of a step only."),
        "bristle_phase": Option(
            0.4, 0.0, "h √(k_s / m_red), and so stickingStiffness k_s; at 1.8 far cells err by 0.8 dB, at 0.6 by 0.5."
        ),
        "bristle_damping": Option(0.4, 0.0, "stickingDamping over 2 √(k_s m_red); more delays reversals, 0 rings."),
        "discontinuous_iterations": Option(
            1, 5, "Corrections of the friction state a step, whatever their error; 5 at coarse steps stall the orbit."
        ),
    },
    split_tolerance=1e-9,
)


class _Exudyn(Engine):
    """What both friction laws share."""

    def version(self) -> str:
        """Version of the package."""
        return version("exudyn")

    def why_not_installed(self) -> str | None:
        """Say why Exudyn cannot be used here."""
        if importlib.util.find_spec("exudyn") is None:
            return "the package exudyn is not installed; pip install exudyn"
        return None


class ExudynRegularised(_Exudyn):
    """Exudyn, friction proportional to the relative velocity within a narrow zone."""

    name: ClassVar[str] = "exudyn-regularised"
    capabilities: ClassVar[Capabilities] = Capabilities(
        title="Exudyn, regularised",
        package="exudyn",
        licence="BSD-3-Clause",
        friction_law=FrictionLaw.REGULARISED,
        presets={Formulation.JOINT: {"tuned": REGULARISED_TUNED}},
        notes=(
            "Friction is proportional to the relative velocity below the width of a zone, so that a stuck contact "
            "creeps; the transmittance errs in proportion to the width, most where cells hardly move."
        ),
    )

    def _build(self, lanes: tuple[Lane, ...], formulation: Formulation, preset: Preset) -> Simulation:
        return LanewiseSimulation.build(lanes, lambda lane: _RegularisedLane(lane, preset))


class ExudynBristle(_Exudyn):
    """Exudyn, friction as a bristle: a stiff spring and dashpot until the bound is reached."""

    name: ClassVar[str] = "exudyn-bristle"
    capabilities: ClassVar[Capabilities] = Capabilities(
        title="Exudyn, bristle",
        package="exudyn",
        licence="BSD-3-Clause",
        friction_law=FrictionLaw.BRISTLE,
        presets={Formulation.JOINT: {"tuned": BRISTLE_TUNED}},
        notes=(
            "A stuck contact is a stiff spring and dashpot and gives way by F / k_s; a slipping one sticks only from "
            "the end of a substep on, so that the period map jumps, and some orbits repeat to 1e-3 and not to 1e-8."
        ),
    )

    def _build(self, lanes: tuple[Lane, ...], formulation: Formulation, preset: Preset) -> Simulation:
        return LanewiseSimulation.build(lanes, lambda lane: _BristleLane(lane, preset))


class _ExudynLane(LaneModel):
    """One chain as a system of Exudyn, in the units of its lane.

    Parameters
    ----------
    lane
        The lane.
    preset
        Its options.
    """

    def __init__(self, lane: Lane, preset: Preset):
        self.lane = lane
        # With dt as unit of time the solver adds up binary fractions: its times are exact, however late.
        self._units = dataclasses.replace(Units.of(lane), time=lane.time_step)
        self._chain = self._units.scaled(lane.chain)
        self._substeps = preset["substeps"]
        self._reduced_mass = 1 / (1 / self._chain.outer_mass + 1 / self._chain.inner_mass)
        self._rubbing = np.flatnonzero(self._chain.friction_bound > 0)
        with _imported(preset["module"]) as exudyn:
            self._exudyn = exudyn
            self._container = exudyn.SystemContainer()
            self._system = self._container.AddSystem()
            self._assemble(preset)
        self._settings = self._solver_settings(preset)

    def run(self, state: State, start: int, steps: int) -> Trajectory:
        """Advance from `state`; sensors record the ends of the steps."""
        memory = self._solve(state, start, steps, record=True)
        friction = np.zeros((steps, self._chain.cells))
        for cell, sensor in zip(self._rubbing, self._force_sensors, strict=True):
            # The connector's force resists its elongation: it is -λ_T on the inner mass.
            friction[:, cell] = -self._recorded(sensor, steps)[:, 0]
        return Trajectory(
            self.lane.times(start, steps),
            self._recorded(self._motion_sensors[0], steps) * self._units.length,
            self._recorded(self._motion_sensors[1], steps) * self._units.velocity,
            friction * self._units.force,
            constant_normal_force(self.lane, steps),
            memory,
        )

    def advance(self, state: State, start: int, steps: int) -> State:
        """Advance as `run` does and give the end only; without sensors it needs less time."""
        memory = self._solve(state, start, steps, record=False)
        data, current = self._system.systemData, self._exudyn.ConfigurationType.Current
        return State(
            np.array(data.GetODE2Coordinates(current))[None] * self._units.length,
            np.array(data.GetODE2Coordinates_t(current))[None] * self._units.velocity,
            None if memory is None else memory[None],
        )

    def close(self) -> None:
        """Empty the system; Python frees the rest with the last reference."""
        self._container.Reset()

    def _connector(self, cell: int) -> dict[str, Any]:
        """Parameters of the friction connector of one cell, in the units of the lane."""
        raise NotImplementedError

    def _set_friction_state(self, state: State, start: int) -> None:
        """Set what the friction law remembers, if it does."""
        return

    def _friction_state(self) -> FloatArray | None:
        """Give what the friction law remembers at the end of a run."""
        return None

    def _solve(self, state: State, start: int, steps: int, record: bool) -> FloatArray | None:
        """Run the solver, a new one each time: none of its data outlive a run."""
        checked_count("steps", steps)
        data, initial = self._system.systemData, self._exudyn.ConfigurationType.Initial
        data.SetODE2Coordinates(state.positions[0] / self._units.length, initial)
        data.SetODE2Coordinates_t(state.velocities[0] / self._units.velocity, initial)
        self._set_friction_state(state, start)
        integration = self._settings.timeIntegration
        integration.startTime = start
        integration.endTime = start + steps
        integration.numberOfSteps = steps * self._substeps
        self._settings.solution.sensors.active = record
        solver = self._exudyn.MainSolverImplicitSecondOrder()
        with _silent(self._exudyn):
            succeeded = solver.SolveSystem(self._system, self._settings)
        if not succeeded:
            raise RuntimeError(f"exudyn stopped at {solver.it.currentTime * self._units.time:g} s: no convergence")
        return self._friction_state()

    def _recorded(self, sensor: Any, steps: int) -> FloatArray:
        """Rows of a sensor at the ends of the steps, without its column of time and its initial row."""
        rows: FloatArray = self._system.GetSensorStoredData(sensor)[1:, 1:]
        if rows.shape[0] != steps:
            raise RuntimeError(f"exudyn recorded {rows.shape[0]} rows in {steps} steps")
        return rows

    def _assemble(self, preset: Preset) -> None:
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
        self._add_sensors(node, connectors)
        system.Assemble()

    def _add_load(self, marker: Any) -> None:
        """Load the outer mass of cell 1: harmonic drives by a compiled expression, others through Python."""
        from exudyn import advancedUtilities, itemInterface

        load = self._system.AddLoad(itemInterface.LoadCoordinate(markerNumber=marker, load=0.0))
        harmonic = _harmonic_amplitudes(self.lane)
        if harmonic is None:
            drive, chain, units = self.lane.drive, self.lane.chain, self._units

            def function(_system: Any, time: float, _load: float) -> float:
                return float(drive.load(chain, np.asarray(time * units.time))) / units.force
        else:
            sine, cosine = (float(amplitude / self._units.force) for amplitude in harmonic[:2])
            omega = harmonic[2] * self._units.time
            symbolic = self._exudyn.symbolic

            def expression(mbs: Any, t: Any, load: Any) -> Any:  # noqa: ARG001 - names that Exudyn looks for
                return sine * symbolic.sin(omega * t) + cosine * symbolic.cos(omega * t)

            function = advancedUtilities.CreateSymbolicUserFunction(self._system, expression, "loadUserFunction", load)
        self._load_function = function  # Exudyn does not keep it alive
        self._system.SetLoadParameter(load, "loadUserFunction", function)

    def _add_sensors(self, node: Any, connectors: Sequence[Any]) -> None:
        """Record the motion of all masses and the force of each connector, in memory only."""
        from exudyn import itemInterface

        kinds = self._exudyn.OutputVariableType
        self._motion_sensors = [
            self._system.AddSensor(
                itemInterface.SensorNode(
                    nodeNumber=node, outputVariableType=kind, storeInternal=True, writeToFile=False
                )
            )
            for kind in (kinds.Coordinates, kinds.Coordinates_t)
        ]
        self._force_sensors = [
            self._system.AddSensor(
                itemInterface.SensorObject(
                    objectNumber=connector, outputVariableType=kinds.Force, storeInternal=True, writeToFile=False
                )
            )
            for connector in connectors
        ]

    def _solver_settings(self, preset: Preset) -> Any:
        """Settings of the implicit solver, without any output to files or console."""
        settings = self._exudyn.SimulationSettings()
        settings.solution.file.write = False
        settings.solution.sensors.writePeriod = 1
        integration = settings.timeIntegration
        integration.verboseMode = 0
        integration.minimumStepSize = preset["smallest_step"]
        integration.generalizedAlpha.useNewmark = preset["solver"] == "Newmark"
        integration.newton.relativeTolerance = preset["relative_tolerance"]
        integration.newton.absoluteTolerance = preset["absolute_tolerance"]
        return settings


class _RegularisedLane(_ExudynLane):
    """Friction -F ġ_T / v_reg within |ġ_T| < v_reg, -F sign ġ_T beyond."""

    def __init__(self, lane: Lane, preset: Preset):
        self._preset = preset
        super().__init__(lane, preset)

    def _connector(self, cell: int) -> dict[str, Any]:
        bound = float(self._chain.friction_bound[cell])
        kick = bound / self._substeps / self._reduced_mass[cell]
        speed = self.lane.drive.displacement_scale(self.lane.chain) * self.lane.chain.resonator_frequency
        zone = max(self._preset["zone"] * speed / self._units.velocity, self._preset["zone_per_kick"] * float(kick))
        return {"dynamicFrictionForce": bound, "frictionProportionalZone": zone}


class _BristleLane(_ExudynLane):
    """Friction of a bristle, which remembers whether it slips and where its foot is.

    The memory of a state is, in SI units, for each contact the slip force [N] with the sign of the
    slip, 0 in stick; then for each contact the deflection of the bristle [m]. Deflections, unlike
    the positions of the feet, stay valid when a solver of periodic orbits moves all masses.
    """

    def __init__(self, lane: Lane, preset: Preset):
        self._preset = preset
        super().__init__(lane, preset)

    def _connector(self, cell: int) -> dict[str, Any]:
        from exudyn import itemInterface

        node = self._system.AddNode(
            itemInterface.NodeGenericData(initialCoordinates=[0.0] * 3, numberOfDataCoordinates=3)
        )
        return {
            "nodeNumber": node,
            "dynamicFrictionForce": float(self._chain.friction_bound[cell]),
            "stickingStiffness": float(self._stiffness[cell]),
            "stickingDamping": float(self._damping[cell]),
        }

    @property
    def _stiffness(self) -> FloatArray:
        """Stiffness k_s of each bristle in the units of the lane."""
        stiffness: FloatArray = (self._preset["bristle_phase"] * self._substeps) ** 2 * self._reduced_mass
        return stiffness

    @property
    def _damping(self) -> FloatArray:
        """Dashpot beside each bristle in the units of the lane."""
        damping: FloatArray = self._preset["bristle_damping"] * 2 * np.sqrt(self._stiffness * self._reduced_mass)
        return damping

    def _solver_settings(self, preset: Preset) -> Any:
        settings = super()._solver_settings(preset)
        settings.timeIntegration.discontinuous.maxIterations = preset["discontinuous_iterations"]
        return settings

    def _set_friction_state(self, state: State, start: int) -> None:
        if state.memory is None:
            slip, deflection = self._fresh(state, start)
        else:
            slip, deflection = np.split(state.memory[0], 2)
            slip, deflection = slip / self._units.force, deflection / self._units.length
        outer, inner = np.split(state.positions[0] / self._units.length, 2)
        data = np.stack([slip, inner - outer - deflection, np.zeros_like(slip)], axis=1)[self._rubbing]
        self._system.systemData.SetDataCoordinates(data.ravel(), self._exudyn.ConfigurationType.Initial)

    def _friction_state(self) -> FloatArray:
        current = self._exudyn.ConfigurationType.Current
        data = np.array(self._system.systemData.GetDataCoordinates(current)).reshape(-1, 3)
        outer, inner = np.split(np.array(self._system.systemData.GetODE2Coordinates(current)), 2)
        slip, deflection = np.zeros((2, self._chain.cells))
        slip[self._rubbing] = data[:, 0]
        deflection[self._rubbing] = (inner - outer)[self._rubbing] - data[:, 1]
        return np.concatenate([slip * self._units.force, deflection * self._units.length])

    def _fresh(self, state: State, start: int) -> tuple[FloatArray, FloatArray]:
        """Slip forces and deflections without a history: each bristle holds the load that it meets.

        A bristle that started unloaded would let go of a stuck contact and ring.
        """
        chain = self._chain
        position, velocity = state.positions[0] / self._units.length, state.velocities[0] / self._units.velocity
        load = -chain.stiffness_matrix @ position - chain.damping_matrix @ velocity
        load[0] += self.lane.loads(start, 1)[0] / self._units.force
        outer, inner = np.split(load / np.diag(chain.mass_matrix), 2)
        holding = self._reduced_mass * (inner - outer)
        force = holding + self._damping * (chain.contact_directions.T @ velocity)
        slips = np.abs(force) >= chain.friction_bound
        slip = np.where(slips, np.copysign(chain.friction_bound, force), 0.0)
        return slip, np.where(slips, 0.0, holding / self._stiffness)


def _harmonic_amplitudes(lane: Lane) -> tuple[float, float, float] | None:
    """Sine and cosine amplitude [N] and ω [rad/s] of the force on cell 1, ``None`` for other drives."""
    drive: Any = lane.drive
    if type(drive) is HarmonicForce:
        return drive.amplitude, 0.0, drive.angular_frequency
    if type(drive) is HarmonicBase:
        chain: Chain = lane.chain
        spring = float(chain.chain_stiffness[0]) * drive.amplitude
        dashpot = float(chain.chain_damping[0]) * drive.amplitude * drive.angular_frequency
        return spring, dashpot, drive.angular_frequency
    return None


@contextlib.contextmanager
def _imported(module: str) -> Iterator[Any]:
    """Import Exudyn without its greeting, and keep its console silent while a system is built."""
    if "exudyn" not in sys.modules:
        # The only switch for the fast build that is read at import and not inherited by other programs.
        sys.exudynFast = module == "fast"  # type: ignore[attr-defined]
    with contextlib.redirect_stdout(io.StringIO()):
        import exudyn
        import exudyn.advancedUtilities
        import exudyn.itemInterface
    with _silent(exudyn):
        yield exudyn


@contextlib.contextmanager
def _silent(exudyn: Any) -> Iterator[None]:
    """Keep Exudyn from printing; failures are raised, with their reason."""
    printed = exudyn.config.printToConsole
    exudyn.config.printToConsole = False
    try:
        yield
    finally:
        exudyn.config.printToConsole = printed
