"""What an engine does before its first run, such as compiling: said, and limited, apart from what is run."""

from dataclasses import dataclass

from reference_lcp.chain.harmonic import HarmonicBase
from reference_lcp.chain.mass_in_mass import Chain
from reference_lcp.chain.simulation import Lane

STEPS_PER_PERIOD = 400
"""Of the lane by which engines are prepared; those that compile do so whatever its numbers are."""


@dataclass(frozen=True)
class Preparation:
    """What an engine does before its first run in a process; the first time on a machine, it takes long.

    Parameters
    ----------
    what
        What it does, for a reader, such as ``compiles its kernels``.
    limit
        Seconds after which it is given up.
    batches
        Numbers of lanes that are built, where what it does depends on that.
    """

    what: str
    limit: float
    batches: tuple[int, ...] = (1,)


def sample_lane(cells: int) -> Lane:
    """Give a lane of so many cells of the canonical chain, that slip and stick."""
    chain = Chain.from_ratios(cells=cells, friction_ratio=0.3)
    drive = HarmonicBase.from_ratio(chain, 0.9)
    return Lane(chain, drive, drive.period / STEPS_PER_PERIOD)
