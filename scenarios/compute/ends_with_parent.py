"""Imported by the process from which workers are forked, first of all: it ends with the process that has started it.

It would wait for workers otherwise, and one that hangs never ends.
"""

import signal

from multibody_xval.scenarios.compute.prctl import SET_PARENT_DEATH_SIGNAL, prctl

prctl(SET_PARENT_DEATH_SIGNAL, signal.SIGKILL)
