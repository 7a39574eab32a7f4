"""Exit codes: one table for every command of the suite."""

from enum import IntEnum


class ExitCode(IntEnum):
    """How a command ended."""

    DONE = 0
    """The command succeeded."""
    FAILED = 1
    """A comparison failed: an unexplained disagreement, a preset with too few certified numbers, a regression, or no
    steady state."""
    WRONG_INPUT = 2
    """The input is refused: a value, a damaged store, an output that cannot be written, an engine that is missing."""
    RUN_FAILED = 3
    """The run could not go on, or its outputs could not be written: a full disk, a store that is gone or stays locked,
    a lost cluster."""
    INTERRUPTED = 130
    """It was stopped by Ctrl-C; shells use this number too."""
