"""The page of the paper's claims: what each engine would conclude.

python docs/claims.py claims.sqlite docs/claims.md mujoco:all:all pybullet:all:all ...
"""

import sys
from pathlib import Path

from multibody_xval.engines.interface.variant import variants_named
from multibody_xval.scenarios.runs import TIME_LIMIT
from multibody_xval.scenarios.runs.dask_cluster import executor_for
from multibody_xval.scenarios.runs.evaluator import Evaluator
from multibody_xval.scenarios.runs.store import opened_store
from multibody_xval.scenarios.studies.claims import (
    CLAIM_COLUMNS,
    LOCKED,
    MOVED,
    RANGE,
    STATED,
    Conclusions,
    evaluated_conclusions,
    farthest_edge,
    sentence,
)
from multibody_xval.scenarios.studies.figure3 import figure3
from multibody_xval.scenarios.tables import markdown_lines, markdown_list, text_table

PRESETS = ("default", "recommended", "tuned")

INTRODUCTION = f"""# What the paper claims

The extended abstract makes three claims about [the attenuation band](physics.md#the-attenuation-band). This page
answers them with the reference, and says what one would conclude with each engine.
`multibody-xval run figure3 --engine NAME` prints the same.

A claim on the width is read twice: by the lower edge, and by the share of $\\eta_r$ {RANGE[0]:g} to {RANGE[1]:g}
that the band covers, which is always finite. It *holds* if both say so, and *holds as read here* if one does. An
edge has moved if it has by more than {MOVED:g}. Locking is read at $\\eta_r = 1$, where a free inner mass moves
most: a stuck fraction of {LOCKED:g} or more, as the mean of the cells, at friction ratios of 1 and 5. At resonances
cells slip even then.
"""

ENGINES = """
## With each engine

The numbers are lower edges $\\eta_r$ by friction ratio. A dash is an edge without a steady state on the way to it.
Where a law predicts an engine, the law's curves lead: the engine runs on both sides of every edge, 2e-6 apart, and
at $\\eta_r = 1$; on the whole grid where its edge is not between.
"""

LOWEST = """
## The widest band

Between the friction ratios of the figure, the lower edge of the reference is lowest at 0.296: 0.6372. It is at most
0.001 higher between 0.247 and 0.312. With a damping ratio of 0.03 instead of 0.01 it is lowest at 0.245: 0.6051.
"""


def _is_apart(own: Conclusions, reference: Conclusions) -> bool:
    """Whether a variant answers a claim otherwise or not at all, or has an edge that has moved."""
    answers, expected = ([claim.answer for claim in each.claims] for each in (own, reference))
    return answers != expected or farthest_edge(own, reference) >= MOVED


def main(store: Path, page: Path, names: list[str]) -> None:
    """Write the page of these variants, with what the store has of them."""
    variants = [variant for variant in variants_named(names) if variant.preset_name in PRESETS]
    with opened_store(store) as kept, Evaluator(kept, executor_for(None, TIME_LIMIT, None)) as evaluator:
        found = evaluated_conclusions(figure3(), variants, evaluator)
    reference, *others = found
    stated = [f"{name}: {text}: {own.answer}; {own.numbers}" for (name, text), own in
              zip(STATED.items(), reference.claims, strict=True)]  # fmt: skip
    apart = [sentence(own, reference) for own in others if _is_apart(own, reference)]
    lines = [
        INTRODUCTION, *markdown_list(stated), ENGINES, *markdown_lines(text_table(CLAIM_COLUMNS, found)), "",
        *markdown_list([*apart, "With each of the others one would conclude the same as with the reference."]),
        LOWEST,
    ]  # fmt: skip
    page.write_text("\n".join(lines).rstrip() + "\n", encoding="utf-8")


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2]), sys.argv[3:])
