"""Exit codes: one table for every command of the suite."""

from enum import IntEnum


class ExitCode(IntEnum):
    """How a command ended."""

    DONE = 0
    """It did what was asked for."""
    FAILED = 1
    """A comparison failed: an unexplained disagreement, a preset with too little that is certified, a regression, or no
    steady state."""
    WRONG_INPUT = 2
    """The input is refused: a value, a damaged store, an output that cannot be written, an engine that is missing."""
    RUN_FAILED = 3
    """The run could not go on, or its outputs could not be kept: a full disk, a store that is gone or stays locked, a
    lost cluster."""
    INTERRUPTED = 130
    """It was stopped by Ctrl-C; the number is that of shells."""
