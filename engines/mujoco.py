"""MuJoCo: the chain as slide joints, with the dry friction of the joint between outer and inner mass."""

import contextlib
import importlib.util
from collections.abc import Iterator, Sequence
from importlib.metadata import version
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from engines.interface import (
    Capabilities,
    Engine,
    Formulation,
    FrictionLaw,
    Option,
    Preset,
    constant_normal_force,
)
from engines.units import Units
from reference_lcp.simulation import Lane, Simulation, common_cells
from reference_lcp.trajectory import State, Trajectory
from reference_lcp.validation import FloatArray, ParameterError, checked_count

JOINT_TUNED = Preset(
    "The dual solver without its softness: friction stops a contact at the end of the step, as equation (5) does.",
    {
        "units": Option("lane", "SI", "No number comes near MuJoCo's built-in smallest and largest ones."),
        "solver": Option("PGS", "Newton", "The friction forces are the unknowns, and each solves its own equation."),
        "iterations": Option(1, 100, "No contact touches another's joint, so that the first sweep is exact."),
        "noslip_iterations": Option(1, 0, "One sweep without the regularisation R; with it, stuck contacts creep."),
        "jacobian": Option("dense", "auto", "The matrices are small."),
        "integrator": Option("Euler", "Euler", "Velocities first, then positions, as equation (5)."),
        "disable": Option(
            ("eulerdamp", "warmstart", "island", "autoreset"),
            (),
            "Damping at the start of the step; no memory between runs; no search for islands; no silent reset.",
        ),
        "solref_friction": Option(
            (-1.0, -1.0), (0.02, 1.0), "Direct form, in units of d_width / dt: a stuck contact stops in one step."
        ),
    },
    shares_scheme=True,
    split_tolerance=1e-12,
)

LARGEST_COORDINATE = 1e10
"""MuJoCo's mjMAXVAL: beyond, it stops a simulation; in units of the lane."""


class MuJoCo(Engine):
    """MuJoCo, advanced by `mujoco.batch.Batch` on one thread."""

    name: ClassVar[str] = "mujoco"
    capabilities: ClassVar[Capabilities] = Capabilities(
        title="MuJoCo",
        package="mujoco",
        licence="Apache-2.0",
        friction_law=FrictionLaw.REGULARISED,
        presets={Formulation.JOINT: {"tuned": JOINT_TUNED}},
        notes=(
            "Friction is a convex regularisation of Coulomb's law: a stuck contact creeps unless the no-slip "
            "sweep removes the softness, as the tuned preset does; then it equals equation (5) to round-off."
        ),
    )

    def version(self) -> str:
        """Version of the package."""
        return version("mujoco")

    def why_not_installed(self) -> str | None:
        """Say why MuJoCo cannot be used here."""
        if importlib.util.find_spec("mujoco") is None:
            return "the package mujoco is not installed; pip install mujoco"
        if int(self.version().split(".")[0]) < 4:
            return f"mujoco {self.version()} has no batch of models; version 4.0 or newer is needed"
        return None

    def _build(self, lanes: tuple[Lane, ...], formulation: Formulation, preset: Preset) -> Simulation:
        return MuJoCoSimulation.build(lanes, preset)


class MuJoCoSimulation:
    """Lanes as the simulations of one batch, each with a model of its own.

    Parameters
    ----------
    lanes
        The lanes.
    units
        The units of each lane's model.
    models
        A compiled `mujoco.MjModel` a lane.
    """

    def __init__(self, lanes: Sequence[Lane], units: Sequence[Units], models: Sequence[Any]):
        """Make the batch, on the calling thread alone: the suite runs processes side by side."""
        from mujoco.batch import Batch

        self.lanes = tuple(lanes)
        self._models = tuple(models)
        self._units = tuple(units)
        self._shape = (len(self.lanes), 2 * common_cells(lanes))
        self._length = np.array([[unit.length] for unit in units])
        self._velocity = np.array([[unit.velocity] for unit in units])
        self._batch = Batch(self._models[0], nsim=len(self._models), nthread=1)
        self._batch.set_models(self._models)

    @classmethod
    def build(cls, lanes: Sequence[Lane], preset: Preset) -> "MuJoCoSimulation":
        """Compile a model a lane."""
        units = [Units.named(preset["units"], lane) for lane in lanes]
        models = [_joint_model(lane, unit, preset) for lane, unit in zip(lanes, units, strict=True)]
        return cls(lanes, units, models)

    def run(self, state: State, start: int, steps: int) -> list[Trajectory]:
        """Advance every lane; see `Simulation.run`.

        A lane that diverges stops about 1e10 displacement scales away, and its last row is repeated.
        """
        record = self._rollout(state, start, steps, ("qpos", "qvel", "qfrc_constraint"))
        return [
            Trajectory(
                lane.times(start, steps),
                _absolute(position) * units.length,
                _absolute(velocity) * units.velocity,
                friction[:, 1::2] * units.force,
                constant_normal_force(lane, steps),
            )
            for lane, units, position, velocity, friction in zip(
                self.lanes, self._units, record["qpos"], record["qvel"], record["qfrc_constraint"], strict=True
            )
        ]

    def advance(self, state: State, start: int, steps: int) -> State:
        """Advance every lane, keep the final state; see `Simulation.advance`."""
        self._rollout(state, start, steps, ())
        position = _absolute(self._batch.bind("qpos"))
        velocity = _absolute(self._batch.bind("qvel"))
        return State(position * self._length, velocity * self._velocity)

    def subset(self, lanes: Sequence[int] | NDArray[np.intp]) -> "MuJoCoSimulation":
        """Give the lanes of these indices; they share the models."""
        return MuJoCoSimulation(
            [self.lanes[lane] for lane in lanes],
            [self._units[lane] for lane in lanes],
            [self._models[lane] for lane in lanes],
        )

    def close(self) -> None:
        """Nothing to do: memory is all that MuJoCo holds, and it goes with the last reference."""
        return

    def _rollout(self, state: State, start: int, steps: int, record: Sequence[str]) -> dict[str, FloatArray]:
        """Set the state and take `steps` steps, with the load of each step as its control."""
        import mujoco

        checked_count("steps", steps)
        self._batch.bind("qpos")[:] = self._checked("positions", state.positions, self._length)
        self._batch.bind("qvel")[:] = self._checked("velocities", state.velocities, self._velocity)
        loads = [lane.loads(start, steps) / units.force for lane, units in zip(self.lanes, self._units, strict=True)]
        with _no_warning_file():
            rows: dict[str, FloatArray] = self._batch.rollout(
                steps,
                control=np.stack(loads)[:, :, None],
                control_spec=mujoco.mjtState.mjSTATE_CTRL,
                record=record,
            )
        return rows

    def _checked(self, name: str, values: FloatArray, units: FloatArray) -> FloatArray:
        """Give the joint coordinates of a state, or say that MuJoCo would stop there without a word."""
        if values.shape != self._shape:
            raise ParameterError(f"initial {name} have shape {values.shape}; allowed: {self._shape}")
        coordinates = _joint_coordinates(values / units)
        excess = np.abs(coordinates) / LARGEST_COORDINATE
        if np.any(excess > 1):
            largest = float(np.max(np.abs(values)))
            raise ParameterError(f"initial {name} reach {largest:g}; allowed by MuJoCo: {largest / excess.max():g}")
        return coordinates


@contextlib.contextmanager
def _no_warning_file() -> Iterator[None]:
    """Keep MuJoCo from writing to MUJOCO_LOG.TXT when a motion diverges; the rows show it."""
    import mujoco

    handler = mujoco.get_mju_user_warning()
    mujoco.set_mju_user_warning(lambda _: None)
    try:
        yield
    finally:
        mujoco.set_mju_user_warning(handler)


def _joint_coordinates(absolute: FloatArray) -> FloatArray:
    """Turn (u, v) into (u_1, v_1 - u_1, u_2, ...), the order of MuJoCo's joints; velocities likewise."""
    outer, inner = np.split(absolute, 2, axis=-1)
    return np.stack([outer, inner - outer], axis=-1).reshape(absolute.shape)


def _absolute(coordinates: FloatArray) -> FloatArray:
    """Turn (u_1, v_1 - u_1, u_2, ...) into (u, v); velocities likewise."""
    outer, relative = coordinates[..., 0::2], coordinates[..., 1::2]
    return np.concatenate([outer, outer + relative], axis=-1)


def _joint_model(lane: Lane, units: Units, preset: Preset) -> Any:
    """Compile a lane: an outer slide in the world, on each an inner slide, tendons between outer slides."""
    import mujoco

    chain = units.scaled(lane.chain)
    time_step = lane.time_step / units.time
    spec = mujoco.MjSpec()
    _set_options(spec.option, time_step, preset)
    for cell in range(chain.cells):
        outer = _add_slider(spec.worldbody, f"outer {cell}", chain.outer_mass[cell])
        inner = _add_slider(outer, f"inner {cell}", chain.inner_mass[cell])
        joint = inner.joints[0]
        joint.stiffness = [chain.inner_stiffness[cell], 0, 0]
        joint.damping = [chain.inner_damping[cell], 0, 0]
        joint.frictionloss = chain.friction_bound[cell]
        # A direct solref is divided by d_width: this makes the reference acceleration -ġ_T / dt.
        joint.solref_friction = np.array(preset["solref_friction"]) * joint.solimp_friction[1] / time_step
        _add_chain_spring(spec, cell, chain.chain_stiffness[cell], chain.chain_damping[cell])
    actuator = spec.add_actuator(target="outer 0", trntype=mujoco.mjtTrn.mjTRN_JOINT)
    actuator.set_to_motor()
    return spec.compile()


def _set_options(option: Any, time_step: float, preset: Preset) -> None:
    """Set what holds for the whole model."""
    import mujoco

    option.timestep = time_step
    option.gravity = [0, 0, 0]
    option.solver = getattr(mujoco.mjtSolver, f"mjSOL_{preset['solver'].upper()}")
    option.iterations = preset["iterations"]
    option.noslip_iterations = preset["noslip_iterations"]
    option.jacobian = getattr(mujoco.mjtJacobian, f"mjJAC_{preset['jacobian'].upper()}")
    option.integrator = getattr(mujoco.mjtIntegrator, f"mjINT_{preset['integrator'].upper()}")
    for flag in preset["disable"]:
        option.disableflags |= int(getattr(mujoco.mjtDisableBit, f"mjDSBL_{flag.upper()}"))


def _add_slider(parent: Any, name: str, mass: float) -> Any:
    """Add a body that slides along x, with a joint of the same name; its inertia never enters."""
    import mujoco

    body = parent.add_body(name=name, mass=mass, inertia=[mass] * 3, ipos=[0, 0, 0], explicitinertial=True)
    body.add_joint(name=name, type=mujoco.mjtJoint.mjJNT_SLIDE, axis=[1, 0, 0])
    return body


def _add_chain_spring(spec: Any, cell: int, stiffness: float, damping: float) -> None:
    """Add k_c and c_c at the left of a cell; the base's own motion is in the load on cell 1."""
    tendon = spec.add_tendon(stiffness=[stiffness, 0, 0], damping=[damping, 0, 0], springlength=[0, 0])
    if cell > 0:
        tendon.wrap_joint(f"outer {cell - 1}", -1)
    tendon.wrap_joint(f"outer {cell}", 1)
