"""The page of `history`: errors of blocks over the versions of an engine."""

import pandas as pd
from matplotlib.axes import Axes

from multibody_xval.reports.figures.style import PALETTE
from multibody_xval.reports.figures.svg import Panel, svg
from multibody_xval.reports.formatting import environment


def page(engine: str, table: pd.DataFrame, command: str) -> str:
    """Give the page of the rows of a file of history, the oldest version first."""

    def draw(axes: Axes) -> None:
        places = {name: place for place, name in enumerate(dict.fromkeys(table.version))}
        for number, (problem, own) in enumerate(table[table["number [m]"].notna()].groupby("problem", sort=False)):
            line = "o-" if str(problem).endswith("joint") else "s--"
            sizes = own["off by [m]"].clip(lower=1e-9)  # a logarithmic axis has no zero
            axes.plot(own.version.map(places), sizes, line, ms=3, color=PALETTE[number % 4], label=problem)
        axes.set(yscale="log", ylabel="off by / m", xlabel=f"version of {engine}")
        axes.set_xticks(list(places.values()), list(places))
        axes.legend(loc="upper left", bbox_to_anchor=(1, 1), frameon=False, handles=axes.lines)
        axes.figure.subplots_adjust(right=0.72)

    panel = Panel(f"Error of blocks with dry friction in {engine}", "The table below has all numbers.", draw, 3.2, 7.2)
    template = environment("multibody_xval.reports.page").get_template("history.html")
    return template.render(title=panel.title, picture=svg(panel, "h"), table=table, command=command)
