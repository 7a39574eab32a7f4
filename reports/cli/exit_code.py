"""Exit codes of all commands."""

from enum import IntEnum


class ExitCode(IntEnum):
    """How a command ended."""

    DONE = 0
    """The command succeeded."""
    FAILED = 1
    """A comparison failed: a judged number deviates, too many numbers of a judged preset are missing, a named engine
    fails too often, something became worse, or there is no steady state."""
    WRONG_INPUT = 2
    """The input is refused: a value, a damaged store, an output that cannot be written, an engine that is missing."""
    RUN_FAILED = 3
    """The run could not go on, or its outputs could not be written: a full disk, a store that is gone or stays locked,
    a lost cluster."""
    UNEXPECTED = 4
    """A fault of the suite itself; the line names a file with the details, which belong into a report of it."""
    INTERRUPTED = 130
    """It was stopped by Ctrl-C; shells use this number too."""
    READER_GONE = 141
    """What read its output has closed it, as ``head`` does; shells use this number too."""
