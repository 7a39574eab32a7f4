"""The law of Box2D's own springs, distance joints: an implicit Euler step, in single precision."""

from multibody_xval.engines.interface.laws import Law
from multibody_xval.engines.interface.presets import Preset
from multibody_xval.engines.shared.linear_law import LinearStep, linear_law

SINGLE_PRECISION_PERIOD = 3e-5
"""Of U0: the stretch of a spring is the difference of two lengths of 64 U0, rounded to 64 U0 · 2^-24 = 4e-6 U0; a
period makes one to three of them."""


def own_springs(_: Preset) -> Law:
    """Give the law of distance joints as springs; it has no constants beside the chain's."""
    return Law(
        formula="(M + h C + h² K) q̇⁺ = M q̇ − h K q + h f(t) e_1 + W p; Coulomb's law",
        step=lambda lane, _: linear_law(lane, LinearStep.implicit(lane.chain, lane.time_step)),
        bound=SINGLE_PRECISION_PERIOD,
        bound_reason="single precision: a spring of 64 U0 is rounded to 4e-6 U0",
    )


LAWS = {"joint:recommended": own_springs, "joint:default": own_springs, "contact:default": own_springs}
"""By formulation and preset."""
