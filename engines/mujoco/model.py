"""Parts that MuJoCo's models of the chain share: options, sliding masses, chain springs."""

from typing import Any

import numpy as np

from engines.interface.presets import Option, Preset
from reference_lcp.chain.mass_in_mass import Chain

TUNED_OPTIONS = {
    "iterations": Option(1, 100, "Frictions do not touch each other's masses, so that the first sweep is exact."),
    "noslip_iterations": Option(1, 0, "One sweep without the regularisation R; with it, stuck contacts creep."),
    "jacobian": Option("dense", "auto", "The matrices are small."),
    "integrator": Option("Euler", "Euler", "Velocities first, then positions, as equation (5)."),
    "disable": Option(
        ("eulerdamp", "warmstart", "island", "autoreset"),
        (),
        "Damping at the start of the step; no warm start; no search for islands; no silent reset.",
    ),
}
"""Options of the whole model that the tuned presets of both formulations share."""

DEFAULT_OPTIONS = {
    "units": Option("SI", "SI", "The chain in SI units."),
    "solver": Option("Newton", "Newton", "MuJoCo's own."),
    "iterations": Option(100, 100, "MuJoCo's own."),
    "noslip_iterations": Option(0, 0, "MuJoCo's own: a stuck contact creeps."),
    "cone": Option("pyramidal", "pyramidal", "MuJoCo's own."),
    "jacobian": Option("auto", "auto", "MuJoCo's own."),
    "integrator": Option("Euler", "Euler", "MuJoCo's own."),
    "disable": Option((), (), "MuJoCo's own."),
}
"""Options of the whole model that MuJoCo itself chooses."""

DEPTH = 1.0
"""Depth of a sphere in its plate over the displacement scale."""

TOUCH = 2.0**-30
"""Depth of a sphere that may leave its plate, over the displacement scale: at none it would begin without contact."""

LEAST_COEFFICIENT = 1e-4
"""Smallest μ: MuJoCo cuts smaller ones off."""


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
    if "tolerance" in preset.options:
        option.tolerance = preset["tolerance"]
    option.cone = getattr(mujoco.mjtCone, f"mjCONE_{preset['cone'].upper()}")
    option.jacobian = getattr(mujoco.mjtJacobian, f"mjJAC_{preset['jacobian'].upper()}")
    option.integrator = getattr(mujoco.mjtIntegrator, f"mjINT_{preset['integrator'].upper()}")
    for flag in preset["disable"]:
        option.disableflags |= int(getattr(mujoco.mjtDisableBit, f"mjDSBL_{flag.upper()}"))
    return spec


ALONG_X = (1.0, 0.0)
"""Axis of a row that is not turned."""


def add_masses(
    spec: Any, chain: Chain, cell: int, across: float = 0.0, axis: tuple[float, float] = ALONG_X
) -> tuple[Any, Any]:
    """Add an outer mass that slides in the world, and on it an inner one with its spring and its dashpot."""
    outer = _add_slider(spec.worldbody, f"outer {cell}", chain.outer_mass[cell], axis, across)
    inner = _add_slider(outer, f"inner {cell}", chain.inner_mass[cell], axis)
    set_spring(inner.joints[0], chain.inner_stiffness[cell], chain.inner_damping[cell])
    return outer, inner


def _add_slider(parent: Any, name: str, mass: float, axis: tuple[float, float], across: float = 0.0) -> Any:
    """Add a body that slides along the row, with a joint of the same name; its inertia never enters."""
    import mujoco

    place = [0, across, 0]
    body = parent.add_body(name=name, mass=mass, inertia=[mass] * 3, ipos=[0, 0, 0], explicitinertial=True, pos=place)
    body.add_joint(name=name, type=mujoco.mjtJoint.mjJNT_SLIDE, axis=[*axis, 0])
    return body


def add_chain(spec: Any, chain: Chain) -> None:
    """Add k_c and c_c at the left of every cell, and the force on cell 1, in which is the motion of the base."""
    import mujoco

    for cell in range(chain.cells):
        _add_chain_spring(spec, cell, chain.chain_stiffness[cell], chain.chain_damping[cell])
    actuator = spec.add_actuator(target="outer 0", trntype=mujoco.mjtTrn.mjTRN_JOINT)
    actuator.set_to_motor()


def _add_chain_spring(spec: Any, cell: int, stiffness: float, damping: float) -> None:
    """Add a tendon between neighbouring outer masses, or from the world to the first."""
    tendon = spec.add_tendon(springlength=[0, 0])
    set_spring(tendon, stiffness, damping)
    if cell > 0:
        tendon.wrap_joint(f"outer {cell - 1}", -1)
    tendon.wrap_joint(f"outer {cell}", 1)


def set_spring(element: Any, stiffness: float, damping: float) -> None:
    """Set spring and dashpot of a joint or a tendon: numbers, or since 3.8 the coefficients of polynomials."""
    for name, value in (("stiffness", stiffness), ("damping", damping)):
        setattr(element, name, value if np.ndim(getattr(element, name)) == 0 else [value, 0, 0])
