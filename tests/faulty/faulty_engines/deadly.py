"""Engines that take their process along."""

import ctypes
import os
import signal

from faulty_engines import Faulty, Lane

DEADLY = 0.5
"""They do so at this frequency ratio only, wherever it is asked."""


def at_the_deadly_point(lane) -> bool:
    """Whether the lane is driven at `DEADLY`."""
    return abs(lane.drive.angular_frequency / lane.chain.resonator_frequency - DEADLY) < 1e-9


class Crashes(Faulty):
    """Reads where there is no memory."""

    name = "faulty-crash"

    class lane_model(Lane):  # noqa: N801
        def run(self, state, start, steps):
            if at_the_deadly_point(self.lane):
                ctypes.string_at(0)
            return super().run(state, start, steps)


class Hangs(Faulty):
    """Waits in compiled code, and lets no other thread of Python run."""

    name = "faulty-hang"

    class lane_model(Lane):  # noqa: N801
        def run(self, state, start, steps):
            if at_the_deadly_point(self.lane):
                ctypes.PyDLL(None).sleep(10_000)
            return super().run(state, start, steps)


class IsKilled(Faulty):
    """Is killed from outside, as by a system that runs out of memory."""

    name = "faulty-killed"

    class lane_model(Lane):  # noqa: N801
        def run(self, state, start, steps):
            if at_the_deadly_point(self.lane):
                os.kill(os.getpid(), signal.SIGKILL)
            return super().run(state, start, steps)
