"""Units of a lane: what a state loses on its way into them comes back."""

import numpy as np

from multibody_xval.engines.shared.units import Units


def test_gaps_and_their_rates_come_back_in_metres_and_metres_per_second() -> None:
    units = Units(length=4.0, mass=2.0, time=0.5)
    gap, speed = np.array([1.0, 3.0]), np.array([-1.0, 0.25])
    assert units.normal_state(gap, speed).tolist() == [4.0, 12.0, -8.0, 2.0]
    assert (units.velocity, units.force) == (8.0, 32.0)
