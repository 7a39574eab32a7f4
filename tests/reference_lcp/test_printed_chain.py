"""What a notebook shows of a chain and of its steady state: one line."""

import numpy as np
import pytest

from reference_lcp import Chain, HarmonicBase, steady_state

LOCKED = np.array([0.0, 0.3, 30.0, 30.0])
"""Friction ratios: the first contact slides freely, the last two hold."""


@pytest.fixture(scope="module")
def chain() -> Chain:
    return Chain.from_ratios(cells=4, friction_ratio=LOCKED)


def test_line_counts_the_contacts_that_stick(chain: Chain) -> None:
    state = steady_state(chain, HarmonicBase.from_ratio(chain, 0.6))
    line = repr(state)
    assert "\n" not in line
    assert line.endswith("; of 4 contacts 2 stick, 1 stick and slip>")
    level, bar = line.removeprefix("<SteadyState ").split(" dB")[0].replace("−", "-").split(" ± ")
    assert abs(float(level) - state.transmittance_db) <= float(bar)
    assert float(bar) >= state.error_bar.transmittance_db


def test_line_says_that_a_motion_is_not_periodic_yet(chain: Chain) -> None:
    state = steady_state(chain, HarmonicBase.from_ratio(chain, 0.6), max_periods=1, with_error_bar=False)
    assert "not certified (period limit)" in repr(state)


def test_line_of_a_chain_has_spans_where_cells_differ(chain: Chain) -> None:
    assert repr(chain).endswith("dashpots 0.6325 and 0 N s/m, friction bound 0…300 N>")
