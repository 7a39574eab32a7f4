"""PyBullet: how long its chains may be; more in `test_own_values.py`."""

import pytest

from reference_lcp.chain.trajectory import State
from tests.engines.scheme_oracle import ROUND_OFF, distance, lane_of, run


@pytest.mark.needs("pybullet")
def test_the_longest_chain_moves_by_the_scheme() -> None:
    lane, rest = lane_of(cells=63), State.at_rest(1, 63)
    assert distance(lane, rest, run("pybullet", lane, rest, 100)) < ROUND_OFF
