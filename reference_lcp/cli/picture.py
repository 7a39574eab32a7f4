"""``--plot``: the file of a picture, checked before any work."""

from pathlib import Path

from reference_lcp.accuracy.plot import checked_picture_format
from reference_lcp.console import checked_output_file


def check_picture(plot: Path | None) -> None:
    """Refuse a file that cannot be written, or whose ending names no format."""
    if plot is not None:
        checked_picture_format(checked_output_file("plot file", plot))
