"""A plant of Drake with its load and its records, and the simulator that advances them in one call."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from reference_lcp.validation import FloatArray


@dataclass(frozen=True)
class Mechanism:
    """Masses, joints and contacts in a plant that is finalised, as a formulation builds them.

    Parameters
    ----------
    plant
        The `MultibodyPlant`.
    outer, inner
        Numbers of the joints among the coordinates, shape (n,): of every outer mass relative to the one
        before it, of every inner mass relative to its outer one.
    across
        Numbers of the coordinates across the motion, shape (k,).
    forces
        Output port that gives the forces in the contacts; ``None`` without contacts.
    constant_force
        Force on every coordinate that never changes, shape (coordinates,).
    """

    plant: Any
    outer: NDArray[np.intp]
    inner: NDArray[np.intp]
    across: NDArray[np.intp]
    forces: Any
    constant_force: FloatArray


def joint_numbers(plant: Any, names: list[str]) -> NDArray[np.intp]:
    """Give the numbers of joints of one coordinate among all coordinates."""
    return np.array([plant.GetJointByName(name).position_start() for name in names], dtype=np.intp)


class Diagram:
    """A mechanism, a table of loads, and logs: everything that happens in a step happens in Drake.

    Parameters
    ----------
    builder
        The `DiagramBuilder` that holds the mechanism.
    mechanism
        The mechanism.
    time_step
        dt in the units of the mechanism.
    record
        Whether the motion and the forces are logged.
    """

    def __init__(self, builder: Any, mechanism: Mechanism, time_step: float, *, record: bool):
        from pydrake.systems.analysis import Simulator

        self.mechanism = mechanism
        self._time_step = time_step
        self._source = _add_load(builder, mechanism)
        self._logs = _add_logs(builder, mechanism, time_step) if record else []
        self._diagram = builder.Build()
        self._simulator = Simulator(self._diagram)
        self._context = self._simulator.get_mutable_context()
        self._plant_context = mechanism.plant.GetMyMutableContextFromRoot(self._context)

    def advance(self, vector: FloatArray, loads: FloatArray) -> FloatArray:
        """Take a step under each load, from coordinates and their velocities; give those at the end.

        Raises
        ------
        RuntimeError
            If Drake finds no velocities for a step.
        """
        from pydrake.trajectories import PiecewisePolynomial

        steps = loads.shape[0]
        # A step reads its load at its start: there is one value from half a step before it to half a step after.
        breaks = self._time_step * (np.arange(steps + 1) - 0.5)
        table = np.append(loads, loads[-1])[None]
        self._source.UpdateTrajectory(PiecewisePolynomial.ZeroOrderHold(breaks, table))
        self._step(vector, steps)
        return np.array(self.mechanism.plant.GetPositionsAndVelocities(self._plant_context))

    def native_steps(self, steps: int) -> None:
        """Take steps from rest, under no load."""
        from pydrake.trajectories import PiecewisePolynomial

        self._source.UpdateTrajectory(PiecewisePolynomial(np.zeros((1, 1))))
        self._step(np.zeros(self.mechanism.plant.num_multibody_states()), steps)

    def recorded(self, *, sampled: bool) -> tuple[FloatArray, FloatArray]:
        """Give what the last run logged at the ends of its steps: coordinates with velocities, and forces.

        Parameters
        ----------
        sampled
            Forces are those that the plant kept from the step before; otherwise those of the step that begins.
        """
        rows = [log.FindLog(self._context).data().T for log in self._logs]
        motion: FloatArray = rows[0][1:]
        if len(rows) == 1:
            return motion, np.zeros((motion.shape[0], 0))
        return motion, rows[1][1:] if sampled else rows[1][:-1]

    def _step(self, vector: FloatArray, steps: int) -> None:
        """Start anew, with nothing left of earlier runs, and advance."""
        self._context.SetTime(0.0)
        self.mechanism.plant.SetPositionsAndVelocities(self._plant_context, vector)
        for log in self._logs:
            log.FindMutableLog(self._context).Clear()
        self._simulator.Initialize()
        try:
            self._simulator.AdvanceTo(steps * self._time_step)
        except RuntimeError as problem:
            step = round(self._context.get_time() / self._time_step)
            raise RuntimeError(f"drake stopped in step {step} of {steps}: {problem}") from problem


def _add_load(builder: Any, mechanism: Mechanism) -> Any:
    """Add a table in time, whose value acts on the first outer mass, beside the forces that never change."""
    from pydrake.systems.primitives import AffineSystem, TrajectorySource
    from pydrake.trajectories import PiecewisePolynomial

    coordinates = mechanism.constant_force.shape[0]
    on_first = np.zeros((coordinates, 1))
    on_first[mechanism.outer[0]] = 1
    source = builder.AddSystem(TrajectorySource(PiecewisePolynomial(np.zeros((1, 1)))))
    forces = builder.AddSystem(
        AffineSystem(
            A=np.zeros((0, 0)), B=np.zeros((0, 1)), f0=np.zeros(0),
            C=np.zeros((coordinates, 0)), D=on_first, y0=mechanism.constant_force,
        )
    )  # fmt: skip
    builder.Connect(source.get_output_port(), forces.get_input_port())
    builder.Connect(forces.get_output_port(), mechanism.plant.get_applied_generalized_force_input_port())
    return source


def _add_logs(builder: Any, mechanism: Mechanism, time_step: float) -> list[Any]:
    """Log the state, and the forces if there are any, at the start and after every step."""
    from pydrake.systems.primitives import VectorLogSink

    ports = [mechanism.plant.get_state_output_port()]
    if mechanism.forces is not None:
        ports.append(mechanism.forces)
    logs = [builder.AddSystem(VectorLogSink(port.size(), time_step)) for port in ports]
    for port, log in zip(ports, logs, strict=True):
        builder.Connect(port, log.get_input_port())
    return logs
