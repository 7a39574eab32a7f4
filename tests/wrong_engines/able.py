"""Engines that can do more, or at more places, than the other wrong ones, and what is wrong with that."""

import dataclasses

import numpy as np

from multibody_xval.engines import Formulation
from tests.wrong_engines.faulty import PRESETS, Faulty, Lane


class HoldingLane(Lane):
    """Contacts that hold static_ratio μ λ_N at rest."""

    share = 1.0

    def __init__(self, lane, preset):
        super().__init__(lane, preset)
        self.held = np.ones(lane.chain.cells, dtype=bool)

    def friction(self, slip):
        stop = -self.reduced_mass * slip / self.lane.time_step
        most = np.where(self.held, self.share * self.lane.static_ratio, 1.0) * self.bound
        self.held = np.abs(stop) <= most
        return np.where(self.held, stop, np.clip(stop, -self.bound, self.bound))


class Able(Faulty):
    """Sound: it turns, and has static friction of its own."""

    name = "faulty-able"
    capabilities = dataclasses.replace(
        Faulty.capabilities,
        presets={
            Formulation.JOINT: {"tuned": dataclasses.replace(PRESETS["tuned"], turns=True, static_friction=True)},
        },
    )
    lane_model = HoldingLane


class TurnsItsBound(Able):
    """Friction is larger where the row is turned."""

    name = "faulty-turned"

    class lane_model(HoldingLane):  # noqa: N801
        def __init__(self, lane, preset):
            super().__init__(lane, preset)
            self.bound = (1 + np.sin(lane.direction) / 10) * self.bound


class ReadsAside(Able):
    """The friction that is reported is read along the tangent of the world."""

    name = "faulty-aside"

    class lane_model(HoldingLane):  # noqa: N801
        def run(self, state, start, steps):
            found = super().run(state, start, steps)
            return dataclasses.replace(found, friction=np.cos(self.lane.direction) * found.friction)


class HoldsNoMore(Able):
    """Contacts at rest hold as much as they slide with."""

    name = "faulty-kinetic"

    class lane_model(HoldingLane):  # noqa: N801
        def __init__(self, lane, preset):
            super().__init__(lane, preset)
            self.share = 1 / lane.static_ratio


class NeverLetsGo(Able):
    """Contacts slide with what they hold."""

    name = "faulty-static"

    class lane_model(HoldingLane):  # noqa: N801
        def __init__(self, lane, preset):
            super().__init__(lane, preset)
            self.bound = lane.static_ratio * self.bound
            self.share = 1 / lane.static_ratio


class KnowsNoRubber(Faulty):
    """Coefficients of friction are at most 0.9."""

    name = "faulty-rubber"

    class lane_model(Lane):  # noqa: N801
        def __init__(self, lane, preset):
            super().__init__(lane, preset)
            self.bound = np.minimum(lane.chain.friction_coefficient, 0.9) * lane.chain.normal_force


class CountsShort(Faulty):
    """The number of the step is kept in sixteen bits with a sign."""

    name = "faulty-counts"

    class lane_model(Lane):  # noqa: N801
        def run(self, state, start, steps):
            return super().run(state, start % 2**15, steps)


class WearsOut(Faulty):
    """After two hundred runs friction is less."""

    name = "faulty-wears"

    class lane_model(Lane):  # noqa: N801
        runs = 0

        def run(self, state, start, steps):
            self.runs += 1
            if self.runs > 200:
                self.bound = 0.99 * self.lane.chain.friction_bound
            return super().run(state, start, steps)
