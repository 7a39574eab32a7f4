"""What counts as no change from one store to another."""

from dataclasses import dataclass

from multibody_xval.engines.interface.tolerances import SCHEME_TOLERANCE_DB
from reference_lcp.errors import ParameterError


@dataclass(frozen=True)
class Thresholds:
    """What counts as no change."""

    transmittance_db: float = SCHEME_TOLERANCE_DB
    """Largest difference of transmittance [dB] > 0, on the scale of `TRANSMITTANCE`; two engines that solve the same
    equations differ by less than the default."""
    stuck_fraction: float = 0.005
    """Largest difference of a contact's stuck fraction, in (0, 1]; by default two steps of 400."""
    transition: float = 0.005
    """Largest difference of the time of a transition, over the period, in (0, 1]; by default two steps of 400."""
    motion: float = 2.5e-5
    """Largest difference of a displacement of a transient motion, over its displacement scale, in (0, 1]; by default
    what single precision adds up to over forty periods, 2.3e-5 (`TRAJECTORY_TOLERANCE`), and a little more."""

    def __post_init__(self) -> None:
        from reference_lcp.validation import (  # NumPy is imported once numbers are compared
            LARGEST_DECIBEL,
            checked_scalar,
        )

        level = checked_scalar("threshold of transmittance", self.transmittance_db, "> 0")
        if level > LARGEST_DECIBEL:
            raise ParameterError(f"threshold of transmittance = {level:g} dB; allowed: > 0 and <= {LARGEST_DECIBEL:g}")
        for name in ("stuck_fraction", "transition", "motion"):
            if not 0 < getattr(self, name) <= 1:
                raise ParameterError(f"threshold of {name} = {getattr(self, name)}; allowed: > 0 and <= 1")
