"""A picture of one period of a steady state."""

from typing import TYPE_CHECKING, Any

import numpy as np

from reference_lcp.chain.drives import HarmonicForce
from reference_lcp.chain.simulation import PeriodicOrbit
from reference_lcp.observables.stick_slip import contact_modes
from reference_lcp.validation import FloatArray

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def plot_period(orbit: PeriodicOrbit) -> "Figure":
    """Draw displacement, relative velocity and friction of every cell over one period; grey where a contact sticks."""
    from matplotlib.figure import Figure

    trajectory, lane = orbit.trajectory, orbit.lane
    scale = lane.drive.displacement_scale(lane.chain)
    phase = trajectory.time / trajectory.time[-1]
    omega = 2 * np.pi / trajectory.time[-1]
    bound = np.where(lane.chain.friction_bound > 0, lane.chain.friction_bound, lane.chain.chain_stiffness * scale)
    stuck = contact_modes(orbit) == 0
    figure = Figure(figsize=(10, 1.3 * trajectory.cells + 1.2), layout="constrained")
    axes = figure.subplots(trajectory.cells, 3, sharex=True, sharey="col", squeeze=False)
    for cell, row in enumerate(axes):
        outer, inner = trajectory.outer_positions[:, cell] / scale, trajectory.inner_positions[:, cell] / scale
        _draw(row[0], phase, stuck[:, cell], {"outer mass": outer, "inner mass": inner})
        _draw(row[1], phase, stuck[:, cell], {"": trajectory.relative_velocity[:, cell] / (scale * omega)})
        _draw(row[2], phase, stuck[:, cell], {"": trajectory.friction[:, cell] / bound[cell]})
        row[0].set_ylabel(f"cell {cell + 1}")
    titles = ("displacement / U0 [-]", "relative velocity / (U0 ω) [-]", "friction / bound [-]")
    if isinstance(lane.drive, HarmonicForce):
        titles = ("displacement k_c / P0 [-]", "relative velocity k_c / (P0 ω) [-]", titles[-1])
    for axis, title in zip(axes[0], titles, strict=True):
        axis.set_title(title, fontsize=10)
    for axis in axes[-1]:
        axis.set_xlabel("time / period [-]")
    handles = axes[0, 0].get_legend_handles_labels()[0]
    figure.legend(handles=handles, loc="outside upper center", ncols=3, fontsize=9, frameon=False)
    return figure


def _draw(axis: Any, phase: FloatArray, stuck: Any, curves: dict[str, FloatArray]) -> None:
    whole = axis.get_xaxis_transform()
    axis.fill_between(phase, 0, 1, where=stuck, transform=whole, color="0.85", linewidth=0, label="contact sticks")
    for (label, curve), style in zip(curves.items(), ("-", "--"), strict=False):
        axis.plot(phase, curve, style, label=label, linewidth=1.2)
    axis.set_xlim(0, 1)
    axis.grid(alpha=0.3)
