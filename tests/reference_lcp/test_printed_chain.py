"""What a notebook shows of a chain and of its steady state: one line."""

import numpy as np

from reference_lcp import steady_state
from tests.reference_lcp.cases import driven


def test_line_has_the_level_to_its_error_bar_and_the_cells_that_stick() -> None:
    """The first contact slides freely, the last two hold."""
    chain, drive = driven(0.6, cells=4, friction_ratio=np.array([0.0, 0.3, 30.0, 30.0]))
    state = steady_state(chain, drive)
    line = repr(state)
    assert line.endswith("; of 4 contacts 2 stick, 1 stick and slip>")
    level, bar = line.removeprefix("<SteadyState ").split(" dB")[0].replace("−", "-").split(" ± ")
    assert abs(float(level) - state.transmittance_db) <= float(bar)
    assert float(bar) >= state.error_bar.transmittance_db
    assert repr(chain).endswith("dashpots 0.6325 and 0 N s/m, friction bound 0…300 N>")
