"""The paper's claims on the page of results: what each engine would conclude.

python docs/claims.py claims.sqlite docs/results/chain.md mujoco:all:all pybullet:all:all ...
"""

import re
import sys
from pathlib import Path

import pandas as pd

from multibody_xval.engines.interface.variant import variants_named
from multibody_xval.scenarios.edges import edges, propose
from multibody_xval.scenarios.model import REFERENCE
from multibody_xval.scenarios.plan import runs_at
from multibody_xval.scenarios.result_tables import points
from multibody_xval.scenarios.running.evaluate import Means, computed
from multibody_xval.scenarios.studies.claims import (
    MOVED,
    STATED,
    claim_cases,
    conclusions,
    of_paper,
    shown,
)
from multibody_xval.scenarios.studies.figure3 import answered, answers_of_reference
from multibody_xval.scenarios.table_text import markdown_lines, markdown_list

PRESETS = ("default", "recommended", "tuned")

MADE = re.compile(r"(<!-- made claims -->\n).*?(<!-- end -->)", re.DOTALL)
"""What is written anew in the page."""

OTHERS = "With each of the others one would conclude the same as with the reference."


def text(rows: pd.DataFrame) -> str:
    """Give the answers, the table of edges and the conclusions of a table of points."""
    rows = of_paper(rows)
    found = edges(rows)
    concluded = conclusions(rows, found)
    stated = answered(answers_of_reference(rows, found), numbers=True)
    answers = concluded[list(STATED)]
    apart = (answers != answers.iloc[0]).any(axis=1) | (concluded.farthest >= MOVED)
    sentences = markdown_list([*concluded.sentence[apart], OTHERS])
    return "\n".join([*markdown_list(stated), "", *markdown_lines(shown(concluded)), "", *sentences]) + "\n"


def main(store: Path, file: Path, names: list[str]) -> None:
    """Write the page of these configurations; what the store lacks is run."""
    asked = [own for own in variants_named(names) if own.preset_name in PRESETS]
    runs = runs_at([REFERENCE, *asked], claim_cases())
    stored = computed(runs, Means(store=store), then=[("band edges", propose)])
    made = text(points(stored))
    page = file.read_text(encoding="utf-8")
    file.write_text(MADE.sub(lambda found: found[1] + made + found[2], page), encoding="utf-8")


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2]), sys.argv[3:])
