"""What is set before a step of Newton and read after it, on its device.

A cell has `joints` coordinates: the place of the outer mass, that of the inner one in it, and in contacts last the
distance of the two across.
"""

import warp as wp

wp.set_module_options({"enable_backward": False})  # nothing is differentiated

LEAST = wp.constant(1e-30)
"""Of an effort limit: Newton takes one of zero for no limit."""


@wp.func
def tension(
    springs: wp.array3d[float],
    joints: int,
    positions: wp.array2d[float],
    velocities: wp.array2d[float],
    world: int,
    cell: int,
) -> float:
    """Give the force of spring and dashpot between an outer mass and its left neighbour, or the ground."""
    own, left = cell * joints, wp.max(cell - 1, 0) * joints
    neighbour = wp.where(cell > 0, 1.0, 0.0)
    stretch = positions[world, own] - neighbour * positions[world, left]
    rate = velocities[world, own] - neighbour * velocities[world, left]
    return springs[world, 0, cell] * stretch + springs[world, 1, cell] * rate


@wp.kernel
def set_forces(
    step: wp.array[int],
    loads: wp.array2d[float],
    springs: wp.array3d[float],
    joints: int,
    positions: wp.array2d[float],
    velocities: wp.array2d[float],
    forces: wp.array2d[float],
) -> None:
    """Set the forces of springs, dashpots and load on every cell; `springs` are k_c, c_c, k_i and c_i of each."""
    world, cell = wp.tid()
    outer, inner = cell * joints, cell * joints + 1
    force = -tension(springs, joints, positions, velocities, world, cell)
    if cell + 1 < springs.shape[2]:
        force = force + tension(springs, joints, positions, velocities, world, cell + 1)
    if cell == 0:
        force = force + loads[step[0], world]
    forces[world, outer] = force
    slip, rate = positions[world, inner], velocities[world, inner]
    forces[world, inner] = -(springs[world, 2, cell] * slip + springs[world, 3, cell] * rate)


@wp.kernel
def set_effort_limits(
    step: wp.array[int], bounds: wp.array3d[float], joints: int, effort_limit: wp.array2d[float]
) -> None:
    """Set the bound of the drive of every inner mass."""
    world, cell = wp.tid()
    effort_limit[world, cell * joints + 1] = wp.max(bounds[step[0], world, cell], LEAST)


@wp.kernel
def press(step: wp.array[int], normal_forces: wp.array3d[float], joints: int, forces: wp.array2d[float]) -> None:
    """Press every inner mass on its outer one, by the last coordinate of its cell."""
    world, cell = wp.tid()
    forces[world, cell * joints + joints - 1] = -normal_forces[step[0], world, cell]


@wp.kernel
def read_drives(
    rows: wp.array2d[int], impulses: wp.array2d[float], joints: int, rate: float, friction: wp.array2d[float]
) -> None:
    """Read the force of every drive from the impulse of its row."""
    world, cell = wp.tid()
    friction[world, cell] = impulses[world, rows[world, cell * joints + 1]] * rate


@wp.kernel
def read_contacts(
    count: wp.array[int],
    first_shape: wp.array[int],
    forces: wp.array[wp.spatial_vector],
    friction: wp.array2d[float],
    normal_force: wp.array2d[float],
) -> None:
    """Add the force of every contact on its inner mass; shapes are the plate and the sphere of a cell after another."""
    contact = wp.tid()
    if contact >= count[0]:
        return
    shape = first_shape[contact]
    cell = shape // 2
    world = cell // friction.shape[1]
    force = wp.spatial_top(forces[contact])
    if shape % 2 == 0:
        force = -force
    wp.atomic_add(friction, world, cell % friction.shape[1], force[0])
    wp.atomic_add(normal_force, world, cell % friction.shape[1], force[2])
