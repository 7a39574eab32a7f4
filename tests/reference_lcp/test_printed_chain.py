"""What a notebook shows of a chain and of its steady state: one line, and a figure."""

import numpy as np
import pytest

from reference_lcp import Chain, HarmonicBase, frictionless_transmittance, steady_state

LOCKED = np.array([0.0, 0.3, 30.0, 30.0])
"""Friction ratios: the first contact slides freely, the last two hold."""


@pytest.fixture(scope="module")
def chain() -> Chain:
    return Chain.from_ratios(cells=4, friction_ratio=LOCKED)


def test_line_names_the_cells_that_stick(chain: Chain) -> None:
    state = steady_state(chain, HarmonicBase.from_ratio(chain, 0.6))
    line = repr(state)
    assert "\n" not in line
    assert line.endswith("; cells 3–4 stick; 2 stick and slip>")
    level, bar = line.removeprefix("<SteadyState ").split(" dB")[0].replace("−", "-").split(" ± ")
    assert abs(float(level) - state.transmittance_db) <= float(bar)
    assert float(bar) >= state.error_bar.transmittance_db


def test_line_says_that_a_motion_is_not_periodic_yet(chain: Chain) -> None:
    state = steady_state(chain, HarmonicBase.from_ratio(chain, 0.6), max_periods=1, with_error_bar=False)
    assert "not certified (period limit)" in repr(state)


def test_cells_in_many_places_are_counted() -> None:
    chain = Chain.from_ratios(cells=8, friction_ratio=[30.0, 0.0] * 4)
    state = steady_state(chain, HarmonicBase.from_ratio(chain, 0.6), with_error_bar=False)
    assert "cells 4 of 8 stick>" in repr(state)


def test_line_of_a_chain_has_spans_where_cells_differ(chain: Chain) -> None:
    assert repr(chain).endswith("dashpots 0.6325 and 0 N s/m, friction bound 0…300 N>")


def test_figures_show_the_limits_and_a_period(chain: Chain) -> None:
    free, stuck, *_ = chain.plot().axes[0].get_lines()
    eta = free.get_xdata()[100]
    expected = frictionless_transmittance(chain, HarmonicBase.from_ratio(chain, eta))
    assert 10 ** (free.get_ydata()[100] / 20) == pytest.approx(expected)
    assert np.any(stuck.get_ydata() != free.get_ydata())
    state = steady_state(chain, HarmonicBase.from_ratio(chain, 0.6), with_error_bar=False)
    period, motion = state.plot(), state.orbit.trajectory
    assert len(period.axes) == 3 * chain.cells
    lines = [line.get_ydata() for line in period.axes[0].get_lines()]
    scale = state.orbit.lane.drive.displacement_scale(chain)
    assert lines[0] == pytest.approx(motion.outer_positions[:, 0] / scale)
    assert lines[1] == pytest.approx(motion.inner_positions[:, 0] / scale)
    assert period._repr_png_().startswith(b"\x89PNG")
