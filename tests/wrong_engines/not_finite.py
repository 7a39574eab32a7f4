"""Engines whose motion is sound, but for one wrong number in what they report of it."""

import dataclasses

import numpy as np

from tests.wrong_engines.faulty import Faulty, Lane


def reporting(what: str, value: float, row: float = 0.5) -> type[Lane]:
    """Give the lane that puts a number into the second column of an array, or into the times, at a part of the run."""

    class Reports(Lane):
        def run(self, state, start, steps):
            found = super().run(state, start, steps)
            array = getattr(found, what)
            if array is None:
                return found
            wrong, index = array.astype(float), int(row * found.steps)
            wrong[index if what == "time" else 1 if what == "internal_state" else (index, 1)] = value
            return dataclasses.replace(found, **{what: wrong})

        def advance(self, state, start, steps):
            return Lane.run(self, state, start, steps).end

    return Reports


class NormalForceNotFinite(Faulty):
    """One normal force is NaN."""

    name = "faulty-normal"
    lane_model = reporting("normal_force", np.nan)


class FrictionNotFinite(Faulty):
    """One friction force is NaN."""

    name = "faulty-friction"
    lane_model = reporting("friction", np.nan)


class PositionNotFinite(Faulty):
    """One position on the way is infinite."""

    name = "faulty-position"
    lane_model = reporting("positions", np.inf)


class VelocityNotFinite(Faulty):
    """One velocity on the way is NaN."""

    name = "faulty-velocity"
    lane_model = reporting("velocities", np.nan)


class GapNotFinite(Faulty):
    """One gap is NaN."""

    name = "faulty-gap"
    lane_model = reporting("normal_gap", np.nan)


class InternalStateNotFinite(Faulty):
    """One internal variable is NaN in the end."""

    name = "faulty-internal"
    lane_model = reporting("internal_state", np.nan)


class TimeOfItsOwn(Faulty):
    """One row has another time."""

    name = "faulty-time"
    lane_model = reporting("time", 7.0)


class TimeNotFinite(Faulty):
    """One row has no time."""

    name = "faulty-timeless"
    lane_model = reporting("time", np.nan)
