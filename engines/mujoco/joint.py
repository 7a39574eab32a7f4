"""MuJoCo's models of the chain: its masses, springs and options, and the dry friction of slide joints."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from multibody_xval.engines.interface.presets import Preset
from multibody_xval.engines.shared.units import Units
from reference_lcp.chain.mass_in_mass import Chain
from reference_lcp.chain.simulation import Lane
from reference_lcp.validation import FloatArray


@dataclass(frozen=True)
class CompiledLane:
    """A lane, and its compiled `mujoco.MjModel` in units of its own.

    In each cell, the joints of the outer mass and of the inner one relative to it come first, and that across the plate
    last where a mass can leave it; then an actuator a cell pushes it on its plate. Where contacts have sensors, these
    give the contact force, its normal part first.
    """

    lane: Lane
    units: Units
    model: Any
    normal_share: FloatArray | float = 1.0
    """λ_N of each cell over that with which its contact is pressed, shape (n,)."""

    def measured(self, sensors: FloatArray, given: FloatArray) -> FloatArray:
        """Give λ_N [N] of rows of the sensors; cells without friction have no contact."""
        measured = sensors[:, ::3] * self.units.force * self.normal_share
        return np.where(self.lane.chain.friction_bound > 0, measured, given)


def new_spec(time_step: float, preset: Preset) -> Any:
    """Begin a model, with what holds for the whole of it."""
    import mujoco

    spec = mujoco.MjSpec()
    option = spec.option
    option.timestep = time_step
    option.gravity = [0, 0, 0]
    option.solver = getattr(mujoco.mjtSolver, f"mjSOL_{preset['solver'].upper()}")
    option.iterations = preset["iterations"]
    option.noslip_iterations = preset["noslip_iterations"]
    for name in ("tolerance", "impratio"):
        if name in preset.options:
            setattr(option, name, preset[name])
    option.cone = getattr(mujoco.mjtCone, f"mjCONE_{preset['cone'].upper()}")
    option.jacobian = getattr(mujoco.mjtJacobian, f"mjJAC_{preset['jacobian'].upper()}")
    option.integrator = getattr(mujoco.mjtIntegrator, f"mjINT_{preset['integrator'].upper()}")
    for flag in preset["disable"]:
        option.disableflags |= int(getattr(mujoco.mjtDisableBit, f"mjDSBL_{flag.upper()}"))
    return spec


def add_masses(spec: Any, chain: Chain, cell: int, across: float = 0.0) -> tuple[Any, Any]:
    """Add an outer mass that slides in the world, and on it an inner one with its spring and its dashpot."""
    outer = _add_slider(spec.worldbody, f"outer {cell}", chain.outer_mass[cell], across)
    inner = _add_slider(outer, f"inner {cell}", chain.inner_mass[cell])
    set_spring(inner.joints[0], chain.inner_stiffness[cell], chain.inner_damping[cell])
    return outer, inner


def _add_slider(parent: Any, name: str, mass: float, across: float = 0.0) -> Any:
    """Add a body that slides along the row, with a joint of the same name; its inertia never enters."""
    import mujoco

    place = [0, across, 0]
    body = parent.add_body(name=name, mass=mass, inertia=[mass] * 3, ipos=[0, 0, 0], explicitinertial=True, pos=place)
    body.add_joint(name=name, type=mujoco.mjtJoint.mjJNT_SLIDE, axis=[1, 0, 0])
    return body


def add_chain(spec: Any, chain: Chain) -> None:
    """Add k_c and c_c at the left of every cell, and the force on cell 1, in which is the motion of the base."""
    import mujoco

    for cell in range(chain.cells):
        tendon = spec.add_tendon(springlength=[0, 0])
        set_spring(tendon, chain.chain_stiffness[cell], chain.chain_damping[cell])
        if cell > 0:
            tendon.wrap_joint(f"outer {cell - 1}", -1)
        tendon.wrap_joint(f"outer {cell}", 1)
    spec.add_actuator(target="outer 0", trntype=mujoco.mjtTrn.mjTRN_JOINT).set_to_motor()


def set_spring(element: Any, stiffness: float, damping: float) -> None:
    """Set spring and dashpot of a joint or a tendon: numbers, or since 3.8 the coefficients of polynomials."""
    for name, value in (("stiffness", stiffness), ("damping", damping)):
        setattr(element, name, value if np.ndim(getattr(element, name)) == 0 else [value, 0, 0])


def solref_of(preset: Preset, name: str, time_step: float, units: Units) -> tuple[float, float]:
    """Give a solref at a time step [s] in these units: time constant and ratio or, negative, stiffness and damping."""
    first, second = preset.value(name, time_step)
    if first > 0:
        return first / units.time, second
    return first * units.time**2, second * units.time


def compiled_joints(lane: Lane, preset: Preset) -> CompiledLane:
    """Compile a lane: an outer slide in the world, on each an inner slide, tendons between outer slides."""
    units = Units.named(preset["units"], lane)
    chain, time_step = units.scaled(lane.chain), lane.time_step / units.time
    spec = new_spec(time_step, preset)
    for cell in range(chain.cells):
        joint = add_masses(spec, chain, cell)[1].joints[0]
        joint.frictionloss = chain.friction_bound[cell]
        if "solimp_friction" in preset.options:
            joint.solimp_friction[:2] = preset["solimp_friction"]
        joint.solref_friction = solref_of(preset, "solref_friction", lane.time_step, units)
    add_chain(spec, chain)
    return CompiledLane(lane, units, spec.compile())
