"""A picture of a motion: one period of a steady state, or a trajectory."""

from typing import TYPE_CHECKING, Any

import numpy as np

from reference_lcp.chain.drives import HarmonicForce
from reference_lcp.chain.mass_in_mass import Chain
from reference_lcp.chain.simulation import PeriodicOrbit
from reference_lcp.chain.trajectory import Trajectory
from reference_lcp.observables.stick_slip import contact_modes
from reference_lcp.validation import FloatArray

if TYPE_CHECKING:
    from matplotlib.figure import Figure

IN_UNITS = ("displacement [m]", "relative velocity [m/s]", "friction [N]")


def plot_motion(motion: PeriodicOrbit | Trajectory) -> "Figure":
    """Draw displacement, relative velocity and friction of every cell, or body and contact; grey where it sticks.

    Of a chain's orbit over the displacement scale, the drive's frequency and the bound; else in SI units.
    """
    from matplotlib.figure import Figure

    trajectory = motion if isinstance(motion, Trajectory) else motion.trajectory
    time, scales, titles, axis = trajectory.time, (1.0, 1.0, np.ones(trajectory.cells)), IN_UNITS, "time [s]"
    if isinstance(motion, PeriodicOrbit) and isinstance(motion.lane.chain, Chain):
        time, axis = trajectory.time / trajectory.time[-1], "time / period [-]"
        scales, titles = _of_chain(motion)
    stuck, cells = contact_modes(motion) == 0, trajectory.slip is None
    rows = trajectory.cells if cells else max(trajectory.cells, trajectory.positions.shape[1])
    figure = Figure(figsize=(10, 1.3 * rows + 1.2), layout="constrained")
    axes = figure.subplots(rows, 3, sharex=True, sharey="col", squeeze=False)
    for place, row in enumerate(axes):
        row[0].set_ylabel(f"{'cell' if cells else 'body, contact'} {place + 1}")
        shaded = stuck[:, place] if place < trajectory.cells else np.zeros(time.size, dtype=bool)
        if cells:
            both = {"outer mass": trajectory.outer_positions, "inner mass": trajectory.inner_positions}
            _draw(row[0], time, shaded, {name: own[:, place] / scales[0] for name, own in both.items()})
        elif place < trajectory.positions.shape[1]:
            _draw(row[0], time, shaded & False, {"": trajectory.positions[:, place]})
        if place < trajectory.cells:
            _draw(row[1], time, shaded, {"": trajectory.relative_velocity[:, place] / scales[1]})
            _draw(row[2], time, shaded, {"": trajectory.friction[:, place] / scales[2][place]})
    for own, title in zip(axes[0], titles, strict=True):
        own.set_title(title, fontsize=10)
    for own in axes[-1]:
        own.set_xlabel(axis)
    handles = axes[0, 0 if cells else 1].get_legend_handles_labels()[0]
    figure.legend(handles=handles, loc="outside upper center", ncols=3, fontsize=9, frameon=False)
    return figure


def _of_chain(orbit: PeriodicOrbit) -> tuple[tuple[float, float, FloatArray], tuple[str, str, str]]:
    """What displacements, relative velocities and friction of an orbit are over, and titles that say so."""
    lane, chain = orbit.lane, orbit.lane.chain
    scale = lane.drive.displacement_scale(chain)
    omega = 2 * np.pi / orbit.trajectory.time[-1]
    bound = np.where(chain.friction_bound > 0, chain.friction_bound, chain.chain_stiffness * scale)
    titles = ("displacement / U0 [-]", "relative velocity / (U0 ω) [-]", "friction / bound [-]")
    if isinstance(lane.drive, HarmonicForce):
        titles = ("displacement k_c / P0 [-]", "relative velocity k_c / (P0 ω) [-]", titles[-1])
    return (scale, scale * omega, bound), titles


def _draw(axis: Any, time: FloatArray, stuck: Any, curves: dict[str, FloatArray]) -> None:
    whole = axis.get_xaxis_transform()
    axis.fill_between(time, 0, 1, where=stuck, transform=whole, color="0.85", linewidth=0, label="contact sticks")
    for (label, curve), style in zip(curves.items(), ("-", "--"), strict=False):
        axis.plot(time, curve, style, label=label, linewidth=1.2)
    axis.set_xlim(0, time[-1])
    axis.grid(alpha=0.3)
