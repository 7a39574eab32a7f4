"""Scenes of rigid bodies: engines next to each other, with default options and with the recipe for any model."""

import math
from collections.abc import Mapping, Sequence
from typing import Any

import pandas as pd
from markupsafe import Markup

from multibody_xval.engines.interface.registry import engine
from multibody_xval.reports.formatting import environment
from multibody_xval.scenarios.catalogue.worst_numbers import printed_number

DECADES = 6
"""Shades of the heat map: decades of a number over the smallest one that counts as none."""

LEAST = {"µm/s": 0.1, "µrad/s": 0.1, "%": 0.1, "mm": 0.1, "mrad": 1.0, "°": 0.1}
"""By unit, what counts as none."""


def heat_map(rows: pd.DataFrame, pages: Mapping[str, str] | None = None) -> Markup:
    """Give a table of numbers and engines, default options over the recipe, in shades of the recipe's.

    Parameters
    ----------
    rows
        Columns ``engine``, ``number``, ``default``, ``recommended``; see
        `multibody_xval.scenarios.catalogue.worst_numbers`.
    pages
        What is linked, by name of the engine.
    """
    engines = list(dict.fromkeys(rows.engine))
    values: dict[Any, list[float]] = rows.set_index(["number", "engine"])[["default", "recommended"]].T.to_dict("list")
    cells = {
        number: [_cell(number, values.get((number, name), [])) for name in engines] for number in rows.number.unique()
    }
    titles = {name: engine(name).capabilities.title for name in engines}
    template = environment("multibody_xval.reports.figures").get_template("scene_map.html")
    return Markup(template.render(titles=titles, cells=cells, pages=pages or {}))


def _cell(number: str, values: Sequence[float]) -> tuple[int, list[str]] | None:
    """Give the shade of a cell and its lines; ``None`` of an empty one."""
    known = [value for value in values if not math.isnan(value)]
    if not known:
        return None
    first, *others = dict.fromkeys(printed_number(value).replace("-", "−") for value in known)
    return _shade(number, known[-1]), [first, *(f"→ {text}" for text in others)]


def _shade(number: str, value: float) -> int:
    """Give the decades of a number over what counts as none."""
    least = LEAST[number.rpartition("[")[2].rstrip("]")]
    if not math.isfinite(value):
        return DECADES
    return min(DECADES, max(0, math.ceil(math.log10(max(abs(value), least) / least))))
