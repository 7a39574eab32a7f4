"""Engines that take their process along, or would take that of the client."""

import contextlib
import ctypes
import faulthandler
import os
import resource
import signal
import sys
import threading
import time
from multiprocessing.connection import Connection
from pathlib import Path

import numpy as np

from tests.wrong_engines.faulty import Faulty, Lane

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


class Dies(Faulty):
    """Reads where there is no memory, in every run."""

    name = "faulty-dies"

    class lane_model(Lane):  # noqa: N801
        def run(self, state, start, steps):
            return ctypes.string_at(0)


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


class Stops(Faulty):
    """Is stopped from outside, and never goes on."""

    name = "faulty-stopped"

    class lane_model(Lane):  # noqa: N801
        def run(self, state, start, steps):
            if at_the_deadly_point(self.lane):
                os.kill(os.getpid(), signal.SIGSTOP)
            return super().run(state, start, steps)


class Disarms(Faulty):
    """Cancels the alarm of its process, and hangs."""

    name = "faulty-disarms"

    class lane_model(Lane):  # noqa: N801
        def run(self, state, start, steps):
            if at_the_deadly_point(self.lane):
                faulthandler.cancel_dump_traceback_later()
                ctypes.PyDLL(None).sleep(10_000)
            return super().run(state, start, steps)


class Forks(Faulty):
    """Leaves a child behind that sleeps, and goes on in a copy of itself too."""

    name = "faulty-forks"

    class lane_model(Lane):  # noqa: N801
        forked = False

        def run(self, state, start, steps):
            if at_the_deadly_point(self.lane) and not self.forked:
                self.forked = True
                sleeper = os.fork()
                if sleeper == 0:
                    time.sleep(10_000)
                if "FAULTY_CHILD" in os.environ:
                    Path(os.environ["FAULTY_CHILD"]).write_text(str(sleeper))
                os.fork()
            return super().run(state, start, steps)


class Exits(Faulty):
    """Ends the program, as if all were well."""

    name = "faulty-exits"

    class lane_model(Lane):  # noqa: N801
        def run(self, state, start, steps):
            if at_the_deadly_point(self.lane):
                sys.exit(0)
            return super().run(state, start, steps)


class Leaves(Faulty):
    """Ends its process, as if all were well, without a word to Python."""

    name = "faulty-leaves"

    class lane_model(Lane):  # noqa: N801
        def run(self, state, start, steps):
            if at_the_deadly_point(self.lane):
                os._exit(0)
            return super().run(state, start, steps)


class IsHungry(Faulty):
    """Takes all memory that there is, here 2 GiB."""

    name = "faulty-hungry"

    class lane_model(Lane):  # noqa: N801
        def run(self, state, start, steps):
            if at_the_deadly_point(self.lane):
                resource.setrlimit(resource.RLIMIT_AS, (2**31, resource.RLIM_INFINITY))
                np.ones(2**40)
            return super().run(state, start, steps)


class Garbles(Faulty):
    """Writes into every pipe of its process."""

    name = "faulty-garbles"

    class lane_model(Lane):  # noqa: N801
        def run(self, state, start, steps):
            if at_the_deadly_point(self.lane):
                for descriptor in Path("/proc/self/fd").iterdir():
                    with contextlib.suppress(OSError):
                        if str(descriptor.readlink()).startswith("pipe"):
                            os.write(int(descriptor.name), 100 * b"what an engine says")
            return super().run(state, start, steps)


class Interrupts(Faulty):
    """Raises what Ctrl-C raises."""

    name = "faulty-interrupts"

    class lane_model(Lane):  # noqa: N801
        def run(self, state, start, steps):
            if at_the_deadly_point(self.lane):
                raise KeyboardInterrupt
            return super().run(state, start, steps)


class UnspeakableError(Exception):
    """Fails when it is asked what it says."""

    def __str__(self) -> str:
        raise RuntimeError("no words")


class IsUnspeakable(Faulty):
    """Raises what cannot be printed."""

    name = "faulty-unspeakable"

    class lane_model(Lane):  # noqa: N801
        def run(self, state, start, steps):
            if at_the_deadly_point(self.lane):
                raise UnspeakableError
            return super().run(state, start, steps)


class Mumbles(Faulty):
    """Raises an error whose message has a byte that is no UTF-8, as that of a file name."""

    name = "faulty-mumbles"

    class lane_model(Lane):  # noqa: N801
        def run(self, state, start, steps):
            if at_the_deadly_point(self.lane):
                raise OSError("no file \udc80\x1b[2J")
            return super().run(state, start, steps)


class ChangesNumPy(Faulty):
    """Replaces a function of NumPy for whoever shares its process."""

    name = "faulty-changes"

    def _build(self, lanes, formulation, preset):
        sine = np.sin
        np.sin = lambda values: 0.5 * sine(values)
        return super()._build(lanes, formulation, preset)


class IsAnotherVersion(Faulty):
    """Its version in a worker is not that of the client."""

    name = "faulty-version"

    def version(self):
        """Version by the environment: `FAULTY_VERSION`, or that of a worker process."""
        return os.environ.get("FAULTY_VERSION", "9.9.9" if "MULTIBODY_XVAL_WORKER" in os.environ else "1.0.0")


class LeavesADaemon(Faulty):
    """Leaves a process behind that has a session of its own and no parent, and writes its number into a file."""

    name = "faulty-daemon"

    class lane_model(Lane):  # noqa: N801
        def run(self, state, start, steps):
            file = Path(os.environ["FAULTY_CHILD"])
            if not file.exists() and os.fork() == 0:
                os.setsid()
                daemon = os.fork()
                if daemon == 0:
                    time.sleep(10_000)
                file.write_text(str(daemon))
                os._exit(0)
            return super().run(state, start, steps)


class StopsWhileSending(Faulty):
    """Is stopped in the middle of what it sends."""

    name = "faulty-sending"

    class lane_model(Lane):  # noqa: N801
        def run(self, state, start, steps):
            if at_the_deadly_point(self.lane):
                Connection._send = self.send_a_part
            return super().run(state, start, steps)

        @staticmethod
        def send_a_part(connection, data):
            os.write(connection.fileno(), data[:100])
            os.kill(os.getpid(), signal.SIGSTOP)


class LeavesAThread(Faulty):
    """Leaves a thread behind that never ends, and that Python waits for at its end."""

    name = "faulty-thread"

    class lane_model(Lane):  # noqa: N801
        def run(self, state, start, steps):
            if at_the_deadly_point(self.lane):
                threading.Thread(target=time.sleep, args=(10_000,)).start()
            return super().run(state, start, steps)


class Floods(Faulty):
    """Prints a hundred megabytes."""

    name = "faulty-flood"

    class lane_model(Lane):  # noqa: N801
        flooded = False

        def run(self, state, start, steps):
            if at_the_deadly_point(self.lane) and not self.flooded:
                self.flooded = True
                for _ in range(100):
                    sys.__stdout__.write(1_000_000 * "~")
                sys.__stdout__.flush()
            return super().run(state, start, steps)


class TalksTooMuch(Faulty):
    """Raises a million words."""

    name = "faulty-talks"

    class lane_model(Lane):  # noqa: N801
        def run(self, state, start, steps):
            raise RuntimeError(1_000_000 * "word ")
