"""The law of Siconos: springs, dashpots and load at the time that θ says, and friction as an impulse."""

from multibody_xval.engines.interface.law import Constant, Law
from multibody_xval.engines.interface.presets import Preset
from multibody_xval.engines.shared.linear_law import LinearStep, linear_law


def moreau_jean(preset: Preset) -> Law:
    """Give the law of the Moreau–Jean θ-scheme."""
    return Law(
        formula=(
            "(M + h θ C + h² θ² K) q̇⁺ = (M − h (1−θ) C − h² θ (1−θ) K) q̇ − h K q "
            "+ h ((1−θ) f(t) + θ f(t+h)) e_1 + W p; q⁺ = q + h (θ q̇⁺ + (1−θ) q̇); Coulomb's law of w⁺"
        ),
        constants={"θ": Constant(preset["theta"], "", "theta")},
        step=lambda lane, of: linear_law(lane, LinearStep.theta(lane.chain, lane.time_step, of["θ"])),
    )


LAWS = {"joint:tuned": moreau_jean, "joint:default": moreau_jean, "contact:tuned": moreau_jean}
"""By formulation and preset; contacts of the default open now and then by round-off."""
