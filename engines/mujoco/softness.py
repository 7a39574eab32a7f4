"""How soft MuJoCo's friction is: the numbers of ``solimp`` and ``solref``."""

LEAST_IMPEDANCE, LARGEST_IMPEDANCE, WIDTH = 0.9, 0.95, 0.001
"""d_0, d_max and width [m] of MuJoCo's own ``solimp``, for contacts and for frictionloss alike."""


def damping_rate(time_constant: float, largest: float, time_step: float) -> float:
    """Give b, by which a slip velocity decelerates itself [1/s]; `largest` is d_max."""
    return 2 / (largest * max(time_constant, 2 * time_step))


def relative_softness(least: float) -> float:
    """Give R / A of a joint's friction; `least` is d_0."""
    return (1 - least) / least
