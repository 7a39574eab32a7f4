"""Files of pictures: checked before any work, and written whole."""

from pathlib import Path
from typing import TYPE_CHECKING

from multibody_xval.engines.interface.texts import checked_path
from multibody_xval.scenarios.output_files import checked_output_file, replacing
from reference_lcp.errors import ParameterError

if TYPE_CHECKING:
    from matplotlib.figure import Figure

PICTURES = (".pdf", ".svg", ".png", ".eps", ".jpg", ".tif")
"""Formats of pictures: what journals and pages take, and matplotlib writes everywhere without another program."""


def checked_picture(name: str, file: str | Path) -> Path:
    """Give the path of a picture, or raise `ParameterError` if its ending or its folder is none for one."""
    path = checked_path(name, file)
    if path.suffix.lower() not in PICTURES:
        raise ParameterError(f"{name} = {path} has the ending {path.suffix!r}; allowed: {', '.join(PICTURES)}")
    return checked_output_file(name, path)


def save_picture(figure: "Figure", file: Path) -> None:
    """Write a figure, complete or not at all."""
    with replacing(file) as part:
        figure.savefig(part, dpi=150)
