"""What both formulations of DART begin with."""

from typing import Any


def new_world(time_step: float, deactivation: bool) -> Any:
    """Make an empty world without gravity.

    Parameters
    ----------
    time_step
        In the units of the world.
    deactivation
        Whether bodies that move slowly may be put to sleep.
    """
    import dartpy

    world = dartpy.simulation.World()
    options = world.getDeactivationOptions()
    options.mEnabled = deactivation
    world.setDeactivationOptions(options)
    world.setTimeStep(time_step)
    world.setGravity([0.0, 0.0, 0.0])
    return world
