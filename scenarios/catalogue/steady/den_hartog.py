"""The driven friction oscillator, against the closed form of Den Hartog."""

import cmath
import math
from collections.abc import Sequence

from multibody_xval.scenarios.catalogue.steady.base import ClosedForm
from multibody_xval.scenarios.runs.parameters import ChainRatios
from multibody_xval.scenarios.runs.result import Result
from multibody_xval.scenarios.verdicts.steady_case import Expected, SteadyCase
from reference_lcp.exact.den_hartog import SlidingMotion
from reference_lcp.observables.stick_slip import Mode

STANDING_RATIO = 1e6
"""Mass ratio of the cell: its inner mass moves by a millionth of what the outer one does."""

STIFFNESS_RATIO = 1.0

POINTS = ((0.8, 0.3), (1.3, 0.4), (0.6, 0.2))
"""Frequency over the oscillator's own, and friction over the amplitude of the force; the mass never stops."""

OSCILLATOR_RATIOS = ChainRatios(
    cells=1, mass_ratio=STANDING_RATIO, stiffness_ratio=STIFFNESS_RATIO, damping_ratio=0.0, inner_damping_ratio=0.0
)


def _case(frequency_ratio: float, force_ratio: float) -> SteadyCase:
    # The oscillator's frequency is √((k_c + k_i) / m_o), the cell's unit of frequency √(k_i / m_i).
    unit = math.sqrt((1 + 1 / STIFFNESS_RATIO) * STANDING_RATIO)
    return SteadyCase(
        label=f"r {frequency_ratio:g}, F/P0 {force_ratio:g}",
        friction_ratio=force_ratio,
        frequency_ratio=frequency_ratio * unit,
        ratios=OSCILLATOR_RATIOS,
    )


class DenHartog(ClosedForm):
    """The outer mass slides on an inner one that stands still, as heavy as a million of it.

    The base moves it through the chain's spring, without a dashpot: a force P0 = k_c U0 on an oscillator of the
    stiffness k_c + k_i, so that F/P0 is the friction ratio.
    """

    name = "den-hartog"
    source = "J. P. Den Hartog, Trans. ASME 53 (1931)"
    cases = tuple(_case(*point) for point in POINTS)
    with_stick_slip = True

    def expected(self, case: SteadyCase, results: Sequence[Result]) -> Expected:
        """Give the closed form."""
        return expected_motion(*POINTS[self.cases.index(case)])


def expected_motion(frequency_ratio: float, force_ratio: float) -> Expected:
    """Give transmittance and turns of the sliding motion."""
    motion = SlidingMotion.of(frequency_ratio, force_ratio)
    response = motion.response / (1 + STIFFNESS_RATIO)
    # k_i x0 and the friction, with the fundamental 4F/π, accelerate the standing mass m_i; over x0 that is
    spring = STIFFNESS_RATIO / (1 + STIFFNESS_RATIO)
    standing = (spring + 4 / math.pi * force_ratio / motion.amplitude) / (STANDING_RATIO * frequency_ratio**2)
    chain, drive = _case(frequency_ratio, force_ratio).setting()
    turns = ((motion.turn, Mode.FORWARD), ((motion.turn + 0.5) % 1.0, Mode.BACKWARD))
    return Expected(
        transmittance_db=20 * math.log10(abs(response)),
        phase=cmath.phase(response),
        bar_db=20 * math.log10(1 + standing),
        phase_bar=math.degrees(standing),
        transitions=tuple(sorted((1, time * drive.period, str(kind)) for time, kind in turns)),
        stuck_fraction=(0.0,) * chain.cells,
    )
