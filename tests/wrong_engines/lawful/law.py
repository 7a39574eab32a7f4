"""The law of the default preset of the wrong engines."""

from multibody_xval.engines.interface.laws import Constant, Law
from multibody_xval.engines.shared.linear_law import LinearStep, linear_law


def four_steps(_preset, part=0.25):
    def step(lane, of):
        linear = LinearStep.explicit(lane.chain, lane.time_step)

        def friction(_cell, slip, coupling, bound):
            return min(max(-of["s"] * slip / coupling, -bound), bound)

        return linear_law(lane, linear, friction)

    return Law(
        formula="equation (5), but a stick leaves 1 − s of its slip", step=step,
        constants={"s": Constant(part, "", "the engine")},
    )  # fmt: skip


LAWS = {"joint:default": four_steps}
