"""What is done beside a step of engines on Warp, on their device: rows come out, steps are counted."""

import warp as wp


@wp.kernel
def record(step: wp.array[int], values: wp.array2d[float], rows: wp.array3d[float]) -> None:
    """Write down the values of this step, of every world."""
    world, column = wp.tid()
    rows[step[0], world, column] = values[world, column]


@wp.kernel
def count(step: wp.array[int]) -> None:
    """Go on to the next step."""
    step[0] = step[0] + 1
