"""The page of the paper's claims: what each engine would conclude.

python docs/claims.py claims.sqlite docs/claims.md mujoco:all:all pybullet:all:all ...
"""

import sys
from datetime import date
from pathlib import Path

import pandas as pd

from multibody_xval.engines.interface.variant import variants_named
from multibody_xval.scenarios.edges import edges, propose
from multibody_xval.scenarios.model import REFERENCE
from multibody_xval.scenarios.plan import runs_at
from multibody_xval.scenarios.result_tables import points
from multibody_xval.scenarios.running.evaluate import Means, computed
from multibody_xval.scenarios.studies.claims import (
    LOCKED,
    MOVED,
    RANGE,
    STATED,
    claim_cases,
    conclusions,
    of_paper,
    shown,
)
from multibody_xval.scenarios.studies.figure3 import answered, assumed
from multibody_xval.scenarios.table_text import markdown_lines, markdown_list

PRESETS = ("default", "recommended", "tuned")

INTRODUCTION = f"""# What the paper claims

The extended abstract makes three claims about [the attenuation band](physics.md#the-attenuation-band). This page
answers them with the reference, and says what one would conclude with each engine.
`multibody-xval run figure3` draws the figure with the reference as SVG and PDF, with its numbers as CSV. It prints the
lower edges of the exact motion with their error bars, and these claims. It takes 17 s on two processors, and three
minutes where these are busy.
`multibody-xval run figure3 --engine NAME` answers for an engine too.

{{assumed}}

The table below was made on {{today}}, with
the versions of [the table of engines](engines/index.md).

A claim on the width is read twice: by the lower edge, and by the share of $\\eta_r$ {RANGE[0]:g} to {RANGE[1]:g}
that the band covers, which is always finite. It *holds* if both say so, and *holds as read here* if one does. An
edge has moved if it has by more than {MOVED:g}. Locking is read at $\\eta_r = 1$, where a free inner mass moves
most: a stuck fraction of {LOCKED:g} or more, as the mean of the cells, at friction ratios of 1 and 5. At resonances
cells slip even then.
"""

ENGINES = """
## With each engine

The numbers are lower edges $\\eta_r$ by friction ratio. A dash is a band that is not known: a run failed, or
there is no steady state on the way to an edge.
"""

LOWEST = """
## The widest band

Between the friction ratios of the figure, the lower edge of the reference is lowest at 0.296: 0.6372. It is at most
0.001 higher between 0.247 and 0.312. With a damping ratio of 0.03 instead of 0.01 it is lowest at 0.245: 0.6051.
"""


OTHERS = "With each of the others one would conclude the same as with the reference."


def page(rows: pd.DataFrame) -> str:
    """Give the page about a table of points."""
    rows = of_paper(rows)
    found = edges(rows)
    concluded = conclusions(rows, found)
    answers = concluded[list(STATED)]
    apart = (answers != answers.iloc[0]).any(axis=1) | (concluded.farthest >= MOVED)
    introduction = INTRODUCTION.format(today=f"{date.today():%-d %B %Y}", assumed=" ".join(assumed()))
    lines = [
        introduction, *markdown_list(answered(rows, found)), ENGINES,
        *markdown_lines(shown(concluded)), "",
        *markdown_list([*concluded.sentence[apart], OTHERS]),
        LOWEST,
    ]  # fmt: skip
    return "\n".join(lines).rstrip() + "\n"


def main(store: Path, file: Path, names: list[str]) -> None:
    """Write the page of these configurations; what the store lacks is run."""
    asked = [own for own in variants_named(names) if own.preset_name in PRESETS]
    runs = runs_at([REFERENCE, *asked], claim_cases())
    stored = computed(runs, Means(store=store), then=[("band edges", propose)])
    file.write_text(page(points(stored)), encoding="utf-8")


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2]), sys.argv[3:])
