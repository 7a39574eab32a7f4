"""What is set before a step of MuJoCo Warp, on its device."""

import warp as wp


@wp.kernel
def load(step: wp.array[int], loads: wp.array2d[float], ctrl: wp.array2d[float]) -> None:
    """Set the control of this step, of every world."""
    world = wp.tid()
    ctrl[world, 0] = loads[step[0], world]


@wp.kernel
def bound(step: wp.array[int], bounds: wp.array3d[float], frictionloss: wp.array2d[float]) -> None:
    """Set the bound of friction in this step, of every inner mass of every world; each follows its outer mass."""
    world, cell = wp.tid()
    frictionloss[world, 2 * cell + 1] = bounds[step[0], world, cell]
