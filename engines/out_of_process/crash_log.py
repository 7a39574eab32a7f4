"""What `faulthandler` leaves of a process that has crashed: where it was."""

import re
from pathlib import Path

FATAL = "Fatal Python error: "
"""How it begins."""


def place_of_crash(crash_log: str) -> str:
    """Give the innermost frame, as the end of a message; empty without one."""
    # of several threads, the one that began first, and does the work, comes last
    frame = re.search(r'File "([^"]+)", line (\d+) in (\S+)', crash_log.rsplit("Thread 0x", 1)[-1])
    return f", in {frame[3]} ({Path(frame[1]).name}:{frame[2]})" if frame else ""
