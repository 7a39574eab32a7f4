"""pymunk: what its readings point to; more in `test_own_values.py`."""

import numpy as np
import pytest

from multibody_xval.engines.pymunk import Pymunk
from tests.engines.scheme_oracle import lane_of, random_state


@pytest.mark.needs("pymunk")
def test_what_is_read_is_written_by_pymunk_into_its_own_memory() -> None:
    """Many simulations side by side, dropped in between: a reading must not outlive, nor move, what it points to."""
    simulations = [Pymunk().build([lane_of()], preset=preset) for preset in ("tuned", "default") * 10]
    ends = [simulation.advance(random_state(), 0, 50).positions for simulation in simulations]
    del simulations[::3]
    again = [simulation.advance(random_state(), 0, 50).positions for simulation in simulations]
    assert all(any(np.array_equal(one, other) for other in ends[:2]) for one in again)
