"""The law of the family's default preset: friction that stops a contact by a part of its slip per step."""

from multibody_xval.engines.interface.laws import Constant, Law
from multibody_xval.engines.shared.linear_law import LinearStep, linear_law


def stopping_in_parts(preset):
    def step(lane, of):
        def friction(_cell, slip, coupling, bound):
            return min(max(-of["s"] * slip / coupling, -bound), bound)

        return linear_law(lane, LinearStep.explicit(lane.chain, lane.time_step), friction)

    part = Constant(preset["part"], "", "option part")
    return Law(formula="equation (5), but a stick leaves 1 − s of its slip", step=step, constants={"s": part})


LAWS = {"joint:default": stopping_in_parts}
