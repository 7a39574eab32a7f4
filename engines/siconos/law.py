"""The law of Siconos: Moreau–Jean's θ-method with exact Coulomb friction."""

from collections.abc import Mapping

from engines.interface.law import Constant, Law, NotModelled
from engines.interface.presets import Preset
from reference_lcp.chain.simulation import Lane
from reference_lcp.stepping.linear_implicit import LinearImplicitLane, LinearStep, ScalarFriction


def moreau_jean(preset: Preset) -> Law:
    """Give the law of springs, dashpots and load at the time that θ says, and friction as an impulse."""
    return Law(
        formula=(
            "(M + h θ C + h² θ² K) q̇⁺ = (M − h (1−θ) C − h² θ (1−θ) K) q̇ − h K q "
            "+ h ((1−θ) f(t) + θ f(t+h)) e_1 + W p; q⁺ = q + h (θ q̇⁺ + (1−θ) q̇); Coulomb's law of w⁺"
        ),
        constants={"θ": Constant(preset["theta"], "", "theta")},
        model=_moreau_jean,
    )


def opening_contacts(_: Preset) -> NotModelled:
    """Say why no model follows contacts that act where their gap is not positive only."""
    return NotModelled("round-off opens a contact now and then for a step or two, which have no friction")


def _moreau_jean(lane: Lane, constants: Mapping[str, float]) -> LinearImplicitLane:
    step = LinearStep.theta(lane.chain, lane.time_step, constants["θ"])
    return LinearImplicitLane(lane, step, ScalarFriction.coulomb(lane.chain.cells))
