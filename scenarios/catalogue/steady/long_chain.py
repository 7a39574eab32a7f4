"""Longer chains: 7 to 50 cells."""

import math
from collections.abc import Sequence

from multibody_xval.scenarios.catalogue.steady.base import SteadyScenario
from multibody_xval.scenarios.runs.parameters import ChainRatios
from multibody_xval.scenarios.runs.result import Result
from multibody_xval.scenarios.runs.task import SteadyStateTask
from multibody_xval.scenarios.verdicts.finding import PHASE, TRANSMITTANCE, phase_reader
from multibody_xval.scenarios.verdicts.judge import Steps
from multibody_xval.scenarios.verdicts.steady_case import COARSE, CONVERGED, FINE, FINEST, Expected, SteadyCase

CHAIN_LENGTHS = (7, 15, 30, 50)

FRICTION_RATIO, FREQUENCY_RATIO = 0.1, 0.5
"""In the pass band, where friction takes most of the motion from the longest chain and hardly any from the shortest."""

RESIDUAL_GROWTH = 2.0
"""Power of the length by which seconds grow: a step costs in proportion to the cells, and so
do the periods that a steady state takes."""


def _case(cells: int) -> SteadyCase:
    return SteadyCase(
        label=f"{cells} cells",
        friction_ratio=FRICTION_RATIO,
        frequency_ratio=FREQUENCY_RATIO,
        ratios=ChainRatios(cells=cells),
    )


class LongChain(SteadyScenario):
    """The canonical chain with more and more cells."""

    name = "long-chain"
    source = "the canonical case with more cells, at friction ratio 0.1 and η_r 0.5"
    cases = tuple(_case(cells) for cells in CHAIN_LENGTHS)

    def stages(self) -> list[tuple[SteadyCase, ...]]:
        """Run length after length."""
        return [(case,) for case in self.cases]

    def growth(self, case: SteadyCase) -> float:
        """Give by how much longer this length takes than the one before."""
        index = self.cases.index(case)
        return (case.ratios.cells / self.cases[max(index - 1, 0)].ratios.cells) ** RESIDUAL_GROWTH

    def expected_by(self, case: SteadyCase) -> list[SteadyStateTask]:
        """Give the tasks of the converged reference, with three step sizes."""
        return [case.task(CONVERGED, refinement) for refinement in (COARSE, FINE, FINEST)]

    def expected(self, case: SteadyCase, results: Sequence[Result]) -> Expected:
        """Give the converged reference and its error bar."""
        return expected_of(results)


def expected_of(refined: Sequence[Result]) -> Expected:
    """Give the converged reference's transmittance and its error bar, from three step sizes."""
    finest = refined[-1]
    if not all(result.converged for result in refined):
        return Expected(transmittance_db=finest.transmittance_db, bar_db=math.nan)
    steps = [result.steps_per_period for result in refined]
    levels = [result.transmittance_db for result in refined]
    phases = map(phase_reader(finest.phase, finest.transmittance_db), refined)
    return Expected(
        transmittance_db=finest.transmittance_db,
        phase=finest.phase,
        bar_db=Steps(dict(zip(steps, levels, strict=True))).error(TRANSMITTANCE),
        phase_bar=Steps(dict(zip(steps, phases, strict=True))).error(PHASE),
    )
