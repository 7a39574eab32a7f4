"""MuJoCo's contact formulation: in every cell a sphere, the inner mass, that dips into a plate, the outer one.

The depth is fixed, and the stiffness of the contact chosen so that it presses with λ_N. Nothing moves across
the plate, and so the normal force stays what it is.

Where it changes in time the sphere is free across the plate, and an actuator pushes it on, or pulls it off.
"""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from multibody_xval.engines.interface.presets import Preset
from multibody_xval.engines.mujoco.joint import CompiledLane, add_chain, add_masses, new_spec, solref_of
from multibody_xval.engines.shared.units import Units, power_of_two
from reference_lcp.chain.mass_in_mass import Chain
from reference_lcp.chain.simulation import Lane
from reference_lcp.errors import ParameterError
from reference_lcp.validation import FloatArray

RADIUS = 4.0
"""Radius of a sphere, and half of a plate's width, over the displacement scale of the drive."""

PLATE = 2.0**20
"""Half of a plate's length over the displacement scale; beyond, spheres would fall off."""

FINENESS = 2.0**14
"""Displacement scale over the unit of length and the largest μ: makes forces of contacts some hundreds.

MuJoCo's sweep solves for a sliding contact to 1e-10 in the square of its force, whatever the force.
"""

DEPTH = 1.0
"""Depth of a sphere in its plate over the displacement scale."""

TOUCH = 2.0**-30
"""Depth of a sphere that may leave its plate, over the displacement scale: at none it would begin without contact."""

LEAST_COEFFICIENT = 1e-4
"""Smallest μ: MuJoCo cuts smaller ones off."""

LEAST_SHARE = 0.01
"""Smallest μ over the largest of a chain: below, MuJoCo takes a contact for singular."""


def contact_units(lane: Lane, preset: Preset) -> Units:
    """Choose units in which A μ² is near one, for A the inverse mass of a contact, and forces are some hundreds."""
    chain = lane.chain
    rubbing = chain.friction_coefficient[chain.friction_bound > 0]
    largest = float(np.max(rubbing, initial=0.0))
    least = max(LEAST_COEFFICIENT, LEAST_SHARE * largest)
    if np.any(rubbing < least):
        raise ParameterError(f"friction_coefficient = {rubbing.min():g}; allowed: at least {least:g} in MuJoCo")
    if preset["units"] != "contact" or rubbing.size == 0:
        return Units.named("SI" if preset["units"] == "SI" else "lane", lane)
    units = Units.of(lane)
    coefficient = power_of_two(largest)
    units = Units(units.length * coefficient / FINENESS, units.mass / coefficient**2, units.time)
    return replace(units, mass=units.mass / _lighter(units.scaled(chain)))


def _lighter(chain: Chain) -> float:
    """Give by how much lighter the unit of mass should be, where bounds are far below the forces of springs.

    The sweep leaves a force that is a part ε beyond its bound as it is where 2 ε N² or ε A μ² is below 1e-10, N the
    normal force and A the inverse mass. A lighter unit raises N and lowers A; the best one makes both limits equal.
    """
    rubs = chain.friction_bound > 0
    inverse_mass = 1 / chain.inner_mass + 1 / chain.outer_mass
    curvature = inverse_mass * chain.friction_coefficient**2
    force = float(np.min(chain.normal_force[rubs]))
    return max(1.0, power_of_two((float(np.min(curvature[rubs])) / (2 * force**2)) ** (1 / 3)))


def compiled_contacts(
    lane: Lane,
    preset: Preset,
    *,
    lifting: bool = False,
    units_of: Callable[[Lane, Preset], Units] = contact_units,
    touch: float = TOUCH,
) -> CompiledLane:
    """Compile a lane with spheres that are held in their plates or, if `lifting`, rest on them and may leave them."""
    pressed = pressed_harder(lane, preset)
    units = units_of(pressed, preset)
    model = _model(pressed, units, preset, lifting=lifting, depth=touch if lifting else DEPTH)
    rubs = lane.chain.friction_bound > 0
    share = np.divide(lane.chain.normal_force, pressed.chain.normal_force, where=rubs, out=np.ones(rubs.size))
    return CompiledLane(lane, units, model, share)


def _model(lane: Lane, units: Units, preset: Preset, *, lifting: bool, depth: float) -> Any:
    """Compile sliding plates in the world, on each a sphere, and tendons between the plates."""
    import mujoco

    chain, time_step = units.scaled(lane.chain), lane.time_step / units.time
    scale = power_of_two(lane.drive.displacement_scale(lane.chain)) / units.length
    spec = new_spec(time_step, preset)
    for cell in range(chain.cells):
        outer, inner = _add_masses(spec, chain, cell, scale)
        if lifting:
            inner.add_joint(name=f"above {cell}", type=mujoco.mjtJoint.mjJNT_SLIDE, axis=[0, 0, 1])
        _add_geometry(outer, inner, cell, scale, depth)
        pair = _add_contact(spec, chain, cell, preset)
        pair.solreffriction = solref_of(preset, "solreffriction", lane.time_step, units)
        if lifting:
            pair.condim = 3 if chain.friction_bound[cell] else 1  # MuJoCo's own for what does not rub
            pair.solref = solref_of(preset, "solref", lane.time_step, units)
        else:
            # In its direct form, negative, a solref holds stiffness and damping; this is that of a time constant.
            pair.solref = [-1.0, -2 * units.time / preset["normal time constant"]]
            if chain.friction_bound[cell] == 0:
                pair.margin = -2 * DEPTH * scale
    add_chain(spec, chain)
    if lifting:
        for cell in range(chain.cells):
            spec.add_actuator(target=f"above {cell}", trntype=mujoco.mjtTrn.mjTRN_JOINT).set_to_motor()
    model = spec.compile()
    if not lifting:
        _set_normal_load(model, chain)
    return model


def _add_masses(spec: Any, chain: Chain, cell: int, scale: float) -> tuple[Any, Any]:
    """Add the masses of a cell, side by side with the others; the inner one is free in the plane."""
    import mujoco

    outer, inner = add_masses(spec, chain, cell, 4 * RADIUS * scale * cell)
    # MuJoCo solves for friction in the plane: without inertia across it, the problem is singular.
    inner.add_joint(name=f"across {cell}", type=mujoco.mjtJoint.mjJNT_SLIDE, axis=[0, 1, 0])
    return outer, inner


def _add_geometry(outer: Any, inner: Any, cell: int, scale: float, depth: float) -> None:
    """Add a plate to the outer mass, and to the inner one a sphere that dips into it; others do not touch them."""
    import mujoco

    radius = RADIUS * scale
    height = 2 * radius - depth * scale
    for body, name, kind, size, place in (
        (outer, "plate", mujoco.mjtGeom.mjGEOM_BOX, [PLATE * scale, radius, radius], [0, 0, 0]),
        (inner, "sphere", mujoco.mjtGeom.mjGEOM_SPHERE, [radius, 0, 0], [0, 0, height]),
    ):
        body.add_geom(name=f"{name} {cell}", type=kind, size=size, pos=place, contype=0, conaffinity=0)


def _add_contact(spec: Any, chain: Chain, cell: int, preset: Preset) -> Any:
    """Pair plate and sphere, and measure the force between them; gives the pair."""
    import mujoco

    plate, sphere = f"plate {cell}", f"sphere {cell}"
    force = 1 << int(mujoco.mjtConDataField.mjCONDATA_FORCE)
    coefficient = max(float(chain.friction_coefficient[cell]), LEAST_COEFFICIENT)
    pair = spec.add_pair(name=f"contact {cell}", geomname1=plate, geomname2=sphere, condim=3)
    pair.friction = [coefficient, coefficient, 0, 0, 0]
    if "solimp" in preset.options:
        pair.solimp[:2] = preset["solimp"]
    spec.add_sensor(
        name=f"force {cell}", type=mujoco.mjtSensor.mjSENS_CONTACT, objtype=mujoco.mjtObj.mjOBJ_GEOM, objname=plate,
        reftype=mujoco.mjtObj.mjOBJ_GEOM, refname=sphere, intprm=[force, 0, 1],
    )  # fmt: skip
    return pair


def _set_normal_load(model: Any, chain: Chain) -> None:
    """Choose the stiffness of every contact, to which its force is proportional, so that the force is λ_N."""
    import mujoco

    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    force: FloatArray = data.sensordata[::3]
    rubbing = chain.friction_bound > 0
    model.pair_solref[rubbing, 0] *= chain.normal_force[rubbing] / force[rubbing]


def pressed_harder(lane: Lane, preset: Preset) -> Lane:
    """Give the lane with the preset's coefficient of friction and the same bounds, if the preset has one.

    What friction adds to the normal force goes with the square of the coefficient.
    """
    if "coefficient" not in preset.options:
        return lane
    chain, coefficient = lane.chain, preset["coefficient"]
    rubs = chain.friction_bound > 0
    return replace(
        lane,
        chain=replace(
            chain,
            friction_coefficient=np.where(rubs, coefficient, chain.friction_coefficient),
            normal_force=np.where(rubs, chain.friction_bound / coefficient, chain.normal_force),
        ),
    )
