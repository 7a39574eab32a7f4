"""What is done beside a step of MuJoCo Warp, on its device: loads go in, rows come out, steps are counted."""

import warp as wp


@wp.kernel
def load(step: wp.array[int], controls: wp.array3d[float], ctrl: wp.array2d[float]) -> None:
    """Set the controls of this step, of every world."""
    world, actuator = wp.tid()
    ctrl[world, actuator] = controls[step[0], world, actuator]


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
