"""``python -m engines law``: the law of a preset, with its constants, and how near the engine is to it."""

from collections.abc import Sequence

from rich.console import Console

from engines.interface.law import Law, NotModelled
from engines.interface.variant import Variant
from engines.shared.law_distance import LawDistance, distance_from_law
from reference_lcp.chain.canonical import BASE_AMPLITUDE
from reference_lcp.chain.harmonic import HarmonicBase
from reference_lcp.chain.mass_in_mass import Chain
from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.step_limits import MINIMUM_STEPS_PER_PERIOD
from reference_lcp.terminal_table import print_table
from reference_lcp.visible import visible

FRICTION_RATIOS, FREQUENCY_RATIOS = (0.1, 0.3, 1.0), (0.5, 0.7, 0.9, 1.1, 1.3, 1.5)
"""The points of figure 3 at which engine and law are compared."""


def print_law(variant: Variant) -> None:
    """Print the law of a preset, and what is measured of it here."""
    law, console = variant.preset.stated_law(), Console()
    if law is None:
        console.print(
            f"{variant}: {'the step of the reference, equation (5)' if variant.preset.shares_scheme else 'none'}"
        )
    elif isinstance(law, NotModelled):
        console.print(f"{variant} is not modelled: {visible(law.reason)}", markup=False, soft_wrap=True)
    else:
        console.print(f"{variant}: {law.formula}", markup=False, soft_wrap=True)
        constants = law.constants.items()
        rows = [(symbol, f"{each.value:g}", each.unit, each.source) for symbol, each in constants]
        print_table(("constant", "value", "unit", "from"), rows)
        console.print(_measured(variant, law), markup=False, soft_wrap=True)


def _measured(variant: Variant, law: Law) -> str:
    """Compare a period of engine and law at the points where the law claims to hold."""
    bound = f"allowed {law.period_bound:g} U0: {law.bound_reason}"
    missing = variant.unavailable_reason
    if missing is not None:
        return f"not measured here, {missing}; {bound}"
    lanes = [lane for lane in _lanes() if law.unclaimed_reason(lane) is None]
    distances = [distance_from_law(variant.build([lane]), law, lane, MINIMUM_STEPS_PER_PERIOD) for lane in lanes]
    return f"after a period from the same state, at {len(lanes)} points: {_text(distances)}; {bound}"


def _text(distances: Sequence[LawDistance]) -> str:
    law, reference = (max(getattr(each, name) for each in distances) for name in ("law", "reference"))
    return f"at most {law:.2g} U0 from its law, {reference:.2g} U0 from the reference"


def _lanes() -> list[Lane]:
    """Give the chain of figure 3 at every point."""
    lanes = []
    for friction_ratio in FRICTION_RATIOS:
        chain = Chain.from_ratios(friction_ratio=friction_ratio)
        for frequency_ratio in FREQUENCY_RATIOS:
            base = HarmonicBase.from_ratio(chain, frequency_ratio, BASE_AMPLITUDE)
            lanes.append(Lane.periodic(chain, base, MINIMUM_STEPS_PER_PERIOD))
    return lanes
