"""Lanes of MuJoCo, whatever their formulation, as the simulations of one batch."""

import contextlib
import importlib.util
from collections.abc import Iterator, Sequence
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from multibody_xval.engines.mujoco.joint import CompiledLane
from multibody_xval.engines.shared.coordinates import JointCoordinates
from multibody_xval.engines.shared.worlds_simulation import LanesOfJoints
from reference_lcp.chain.simulation import common_cells
from reference_lcp.chain.trajectory import State, Trajectory
from reference_lcp.errors import ParameterError
from reference_lcp.validation import FloatArray, checked_count

LARGEST_NUMBER = 1e10
"""MuJoCo's mjMAXVAL, in units of the lane: beyond, coordinates stop a simulation, and forces count as zero."""


class MuJoCoSimulation(LanesOfJoints):
    """Lanes as the simulations of one batch, each with a model of its own."""

    def __init__(self, compiled: Sequence[CompiledLane]):
        super().__init__([each.lane for each in compiled], [each.units for each in compiled])
        self._compiled, self._models = tuple(compiled), [each.model for each in compiled]
        self._joints = self._models[0].nq // common_cells(self.lanes)
        self._opens = self._models[0].nu > 1
        self._recorded = ("qpos", "qvel", "qfrc_constraint") + ("sensordata",) * (self._models[0].nsensor > 0)
        batch = _Batch if importlib.util.find_spec("mujoco.batch") else SteppedModels
        self._batch = batch(self._models)

    def run(self, state: State, start: int, steps: int) -> list[Trajectory]:
        """Advance every lane; see `Simulation.run`.

        A lane that diverges stops about 1e10 displacement scales away, and its last row is repeated.
        """
        record = self._rollout(state, start, steps, self._recorded)

        def forces(index: int) -> tuple[FloatArray, FloatArray]:
            given, force = self.lanes[index].preloads(start, steps), self._units[index].force
            if "sensordata" in record:
                given = self._compiled[index].measured(record["sensordata"][index], given)
            return record["qfrc_constraint"][index][:, 1 :: self._joints] * force, given

        return self._trajectories(start, record["qpos"], record["qvel"], forces)

    def advance(self, state: State, start: int, steps: int) -> State:
        """Advance every lane, keep the final state; see `Simulation.advance`."""
        self._rollout(state, start, steps, ())
        return self._state_at(*self._batch.motion())

    def subset(self, lanes: Sequence[int] | NDArray[np.intp]) -> Self:
        """Give the lanes of these indices; they share the models."""
        return type(self)([self._compiled[lane] for lane in lanes])

    def _rollout(self, state: State, start: int, steps: int, record: Sequence[str]) -> dict[str, FloatArray]:
        """Set the state and take `steps` steps, with the load of each step as its control."""
        checked_count("steps", steps)
        state.check_fits(len(self.lanes), self.lanes[0].chain.freedoms)
        self._check("positions", state.positions, self._length)
        self._check("velocities", state.velocities, self._velocity)
        self._batch.set_motion(*self._coordinates(state))
        with no_warning_file():
            return self._rolled(self._controls(start, steps), start, record)

    def _rolled(self, controls: FloatArray, start: int, record: Sequence[str]) -> dict[str, FloatArray]:
        """Take a step for each control, shape (lanes, steps, nu)."""
        return self._batch.rollout(controls, record)

    def _controls(self, start: int, steps: int) -> FloatArray:
        """Give the force on cell 1 in every step, and the normal loads where masses can leave their plates."""
        controls = []
        for lane, units in zip(self.lanes, self._units, strict=True):
            normal = [-lane.preloads(start, steps)] if self._opens else []
            forces = np.hstack([lane.loads(start, steps)[:, None], *normal])
            largest, allowed = float(np.max(np.abs(forces), initial=0.0)), LARGEST_NUMBER * units.force
            if largest > allowed:  # MuJoCo would take zero without a message
                raise ParameterError(f"forces reach {largest:g} N; allowed by MuJoCo: {allowed:g} N")
            controls.append(forces / units.force)
        return np.stack(controls)

    def _check(self, name: str, values: FloatArray, units: FloatArray) -> None:
        """Refuse a state at which MuJoCo would stop without a message."""
        excess = np.abs(JointCoordinates(self._joints).of(values / units)) / LARGEST_NUMBER
        if np.any(excess > 1):
            largest = float(np.max(np.abs(values)))
            raise ParameterError(f"initial {name} reach {largest:g}; allowed by MuJoCo: {largest / excess.max():g}")


class ModulatedJointSimulation(MuJoCoSimulation):
    """Lanes whose joints rub harder and softer: a bound is a part of the model, and set before every step."""

    def _rolled(self, controls: FloatArray, start: int, record: Sequence[str]) -> dict[str, FloatArray]:
        rows = []
        for step, bounds in enumerate(self._bounds(start, controls.shape[1])):
            for model, bound in zip(self._models, bounds, strict=True):
                model.dof_frictionloss[1::2] = bound
            rows.append(super()._rolled(controls[:, step : step + 1], start + step, record))
        return {name: np.concatenate([row[name] for row in rows], axis=1) for name in record}


class _Batch:
    """Simulations of a batch of MuJoCo, on the calling thread alone: the suite runs processes side by side."""

    def __init__(self, models: Sequence[Any]):
        from mujoco.batch import Batch

        self._batch = Batch(models[0], nsim=len(models), nthread=1)
        self._batch.set_models(models)

    def set_motion(self, positions: FloatArray, velocities: FloatArray) -> None:
        """Set where steps begin, shape (simulations, size) each, and forget the last solution."""
        bind = self._batch.bind
        bind("qpos")[:], bind("qvel")[:], bind("qacc_warmstart")[:] = positions, velocities, 0

    def motion(self) -> tuple[FloatArray, FloatArray]:
        """Give positions and velocities after the last step."""
        return self._batch.bind("qpos"), self._batch.bind("qvel")

    def rollout(self, control: FloatArray, record: Sequence[str]) -> dict[str, FloatArray]:
        """Take a step for each control, shape (lanes, steps, controls); gives records, shape (lanes, steps, size)."""
        import mujoco

        kind = mujoco.mjtState.mjSTATE_CTRL
        rows: dict[str, FloatArray] = self._batch.rollout(
            control.shape[1], control=control, control_spec=kind, record=record
        )
        return rows


@contextlib.contextmanager
def no_warning_file() -> Iterator[None]:
    """Keep MuJoCo from writing to MUJOCO_LOG.TXT when a motion diverges; the rows show it."""
    import mujoco

    handler = mujoco.get_mju_user_warning()
    mujoco.set_mju_user_warning(lambda _: None)
    try:
        yield
    finally:
        mujoco.set_mju_user_warning(handler)


class SteppedModels:
    """What a batch does of which the suite makes use, for versions before 3.17, which have none: step after step."""

    def __init__(self, models: Sequence[Any]):
        import mujoco

        self._models, self._data = models, [mujoco.MjData(model) for model in models]

    def set_motion(self, positions: FloatArray, velocities: FloatArray) -> None:
        """Set where steps begin; see `_Batch.set_motion`."""
        for data, position, velocity in zip(self._data, positions, velocities, strict=True):
            data.qpos[:], data.qvel[:], data.qacc_warmstart[:] = position, velocity, 0

    def motion(self) -> tuple[FloatArray, FloatArray]:
        """Give positions and velocities after the last step."""
        return np.stack([data.qpos for data in self._data]), np.stack([data.qvel for data in self._data])

    def rollout(self, control: FloatArray, record: Sequence[str]) -> dict[str, FloatArray]:
        """Take a step for each control; see `_Batch.rollout`.

        A simulation that diverges stops, and its last row is repeated.
        """
        steps = control.shape[1]
        rows = {name: np.stack([np.tile(getattr(data, name), (steps, 1)) for data in self._data]) for name in record}
        for index, forces in enumerate(control):
            self._step(index, forces, {name: row[index] for name, row in rows.items()})
        return rows

    def _step(self, index: int, control: FloatArray, rows: dict[str, FloatArray]) -> None:
        """Take the steps of one simulation; a warning, such as of a coordinate that is too large, is its end."""
        import mujoco

        model, data = self._models[index], self._data[index]
        before = data.warning.number.tobytes()
        for step, force in enumerate(control):
            if data.warning.number.tobytes() != before:
                for row in rows.values():
                    row[step:] = row[step - 1]
                return
            data.ctrl[:] = force
            mujoco.mj_step(model, data)
            for name, row in rows.items():
                row[step] = getattr(data, name)
