"""The figure of a motion."""

import pytest

from multibody_xval import FrictionContact, MassSpringSystem, Motion, RickerPulse, Spring, plot, simulate
from multibody_xval.reports.figures.motion import plot_motion
from reference_lcp import Chain, HarmonicBase, steady_state


def test_the_figure_of_a_period_shows_every_cell() -> None:
    chain = Chain.from_ratios(cells=4, friction_ratio=[0.0, 0.3, 30.0, 30.0])
    orbit = steady_state(chain, HarmonicBase.from_ratio(chain, 0.6), with_error_bar=False).orbit
    figure, motion = plot_motion(orbit), orbit.trajectory
    assert len(figure.axes) == 3 * chain.cells
    lines = [line.get_ydata() for line in figure.axes[0].get_lines()]
    scale = orbit.lane.drive.displacement_scale(chain)
    assert lines[0] == pytest.approx(motion.outer_positions[:, 0] / scale)
    assert lines[1] == pytest.approx(motion.inner_positions[:, 0] / scale)


def test_a_motion_and_a_steady_state_of_bodies_are_drawn_too(tmp_path) -> None:
    chain = Chain.from_ratios(cells=2, friction_ratio=0.3)
    motion = simulate(chain, RickerPulse(0.01, 30.0, 0.4), time_step=1e-3, steps=900)
    figure = plot(motion, tmp_path / "pulse.svg")
    assert (tmp_path / "pulse.svg").stat().st_size > 1000
    assert figure.axes[0].get_lines()[1].get_ydata() == pytest.approx(motion.inner_positions[:, 0])
    springs = [Spring(0, Motion(amplitude=1.0, angular_frequency=0.6), 1.0), Spring(1, 0, 1.0)]
    rubbing = [FrictionContact(1, None, 1.0, 0.3)]
    state = steady_state(MassSpringSystem(masses=[1.0, 1.0], springs=springs, friction=rubbing))
    lines = [axis.get_lines() for axis in plot(state).axes]
    assert [len(own) for own in lines] == [1, 1, 1, 1, 0, 0]
    assert lines[3][0].get_ydata() == pytest.approx(state.orbit.trajectory.positions[:, 1])
