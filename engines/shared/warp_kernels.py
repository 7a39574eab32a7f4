"""What is done beside a step of engines on Warp, on their device: loads go in, rows come out, steps are counted."""

import warp as wp

wp.set_module_options({"enable_backward": False})  # nothing is differentiated


@wp.kernel
def load(step: wp.array[int], loads: wp.array2d[float], ctrl: wp.array2d[float]) -> None:
    """Set the control of this step, of every world."""
    world = wp.tid()
    ctrl[world, 0] = loads[step[0], world]


@wp.kernel
def press(step: wp.array[int], pressing: wp.array3d[float], ctrl: wp.array2d[float]) -> None:
    """Press the inner mass of every cell of every world on its outer one: a control a cell, after that of the load."""
    world, cell = wp.tid()
    ctrl[world, cell + 1] = -pressing[step[0], world, cell]


@wp.kernel
def bound(step: wp.array[int], bounds: wp.array3d[float], frictionloss: wp.array2d[float]) -> None:
    """Set the bound of friction in this step, of every inner mass of every world; each follows its outer mass."""
    world, cell = wp.tid()
    frictionloss[world, 2 * cell + 1] = bounds[step[0], world, cell]


@wp.kernel
def record(step: wp.array[int], values: wp.array2d[float], rows: wp.array3d[float]) -> None:
    """Write down the values of this step, of every world."""
    world, column = wp.tid()
    rows[step[0], world, column] = values[world, column]


@wp.kernel
def count(step: wp.array[int]) -> None:
    """Go on to the next step."""
    step[0] = step[0] + 1
