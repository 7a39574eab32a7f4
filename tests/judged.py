"""Judged tables of points, as tests make them."""

from collections.abc import Sequence

import pandas as pd

from scenarios.sweeps.table import Point, table_of, with_columns


def judged_table(points: Sequence[Point]) -> pd.DataFrame:
    """Give a judged table of points; the reverse of `points_of`."""
    columns = {name: [getattr(point, name) for point in points] for name in ("result", "others", "findings")}
    return with_columns(table_of(point[:3] for point in points), **columns)
