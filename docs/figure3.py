"""The README's picture: the reference's curves, and what four engines found on the grid of a report.

multibody-xval report --quick --engine mujoco --engine pybullet --engine exudyn-regularised --engine drake
python docs/figure3.py report/points.csv docs/_static/figure3.svg
"""

import sys
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import pandas as pd

from multibody_xval.engines import engine
from multibody_xval.reports.figures.style import COLUMN, PALETTE, PRINT_STYLE
from multibody_xval.scenarios.model import Case
from multibody_xval.scenarios.sweeps.frequency_grid import resonances
from reference_lcp import Chain, CompiledSimulation, HarmonicBase, Lane, decibel, periodic_orbits, transmittance

STEPS = 400
LOWEST = -80.0
SHAPES = "os^D"


def curve(friction_ratio: float, frequency_ratios: np.ndarray) -> list[float]:
    """Transmittance of the reference [dB]."""
    chain = Chain.from_ratios(friction_ratio=friction_ratio)
    lanes = [Lane.periodic(chain, HarmonicBase.from_ratio(chain, float(eta)), STEPS) for eta in frequency_ratios]
    return [decibel(transmittance(orbit)) for orbit in periodic_orbits(CompiledSimulation(lanes), STEPS)]


def draw(table: Path, picture: Path) -> None:
    """Draw a table of transmittance into a picture."""
    rows = pd.read_csv(table).query("engine != 'reference' and preset == 'tuned' and steps == @STEPS")
    rows = rows.dropna(subset="transmittance_db")
    frictions = sorted(rows.friction_ratio.unique().tolist())
    names = rows.engine.unique().tolist()
    peaks = np.array(resonances(Case(friction_ratio=0.0, frequency_ratio=1.0)))
    eta = np.union1d(np.linspace(0.3, 1.6, 521), peaks[(peaks > 0.3) & (peaks < 1.6)])
    with plt.rc_context(PRINT_STYLE):
        figure, axes = plt.subplots(figsize=(2 * COLUMN, 0.95 * COLUMN), layout="constrained")
        for friction, line in zip(frictions, ("-", "--", ":"), strict=False):
            axes.plot(eta, curve(friction, eta), line, color="0.15", label=f"reference, friction ratio {friction:g}")
        for name, colour, shape in zip(names, PALETTE, SHAPES, strict=False):
            points = rows[rows.engine == name]
            size = 9.0 - 1.8 * names.index(name)
            title = engine(name).capabilities.title
            axes.plot(
                points.frequency_ratio, points.transmittance_db, shape,
                color=colour, fillstyle="none", markersize=size, label=title,
            )  # fmt: skip
        axes.set(xlabel="frequency ratio $\\omega/\\omega_r$", ylabel="transmittance [dB]", ylim=(LOWEST, 40))
        figure.legend(loc="outside upper center", ncols=4)
        figure.savefig(picture, metadata={"Date": None})


if __name__ == "__main__":
    draw(Path(sys.argv[1]), Path(sys.argv[2]))
