"""The figure of one period of a steady state."""

import pytest

from multibody_xval.reports.figures.period import plot_period
from reference_lcp import Chain, HarmonicBase, steady_state


def test_the_figure_of_a_period_shows_every_cell() -> None:
    chain = Chain.from_ratios(cells=4, friction_ratio=[0.0, 0.3, 30.0, 30.0])
    orbit = steady_state(chain, HarmonicBase.from_ratio(chain, 0.6), with_error_bar=False).orbit
    figure, motion = plot_period(orbit), orbit.trajectory
    assert len(figure.axes) == 3 * chain.cells
    lines = [line.get_ydata() for line in figure.axes[0].get_lines()]
    scale = orbit.lane.drive.displacement_scale(chain)
    assert lines[0] == pytest.approx(motion.outer_positions[:, 0] / scale)
    assert lines[1] == pytest.approx(motion.inner_positions[:, 0] / scale)
