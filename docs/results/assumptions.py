"""How lower edges and the answers to the paper's claims change with the parameters that its figure 3 does not print.

python docs/results/assumptions.py assumptions.sqlite docs/results/assumptions.csv

One parameter at a time; the first row has those that the suite assumes. Results are kept: a second call takes seconds.
"""

import math
import sys
from pathlib import Path

import pandas as pd

from multibody_xval.scenarios.edges import judged_edges, propose
from multibody_xval.scenarios.model import REFERENCE, Run
from multibody_xval.scenarios.report_plan import FRICTION_RATIOS
from multibody_xval.scenarios.result_tables import points
from multibody_xval.scenarios.running.evaluate import Means, computed
from multibody_xval.scenarios.studies.claims import BEYOND, RESONATOR, STATED, answers
from multibody_xval.scenarios.sweeps.file import sweep_of
from multibody_xval.scenarios.sweeps.plan import Sweep

CHAINS: dict[str, dict[str, float]] = {
    "as assumed": {},
    "mass ratio 0.5": {"mass_ratio": 0.5},
    "mass ratio 2": {"mass_ratio": 2.0},
    "stiffness ratio 0.5": {"stiffness_ratio": 0.5},
    "stiffness ratio 2": {"stiffness_ratio": 2.0},
    "damping ratio 0.002": {"damping_ratio": 0.002},
    "damping ratio 0.05": {"damping_ratio": 0.05},
}
"""What differs from the chain that is assumed, by its name."""

FIRST, LAST, ACCURACY_DB = 0.2, 2.5, 1.0
"""Frequency ratios of curves, and how well they are interpolated: all edges here lie well inside."""


def runs(sweep: Sweep, table: pd.DataFrame | None = None) -> list[Run]:
    """Give the runs that the curves still need, without those that judge them: edges bring their own."""
    needed = [run for run in sweep.runs(table) if run.config == REFERENCE]
    return [run for run in needed if run.steps == run.case.steps()]


def row(chain: dict[str, float], store: Path) -> dict[str, str]:
    """Give the lower edges of the exact motion by friction ratio, and the answers to the claims."""
    adaptive = {"first": FIRST, "last": LAST, "accuracy_db": ACCURACY_DB}
    content = {"engines": ["reference"], "chain": chain}
    friction = {"friction_ratio": list(FRICTION_RATIOS)}
    curves = sweep_of(content | {"grid": friction | {"frequency_ratio": adaptive}})
    locked = sweep_of(content | {"grid": friction | {"frequency_ratio": [RESONATOR]}})
    then = [("adaptive curves", lambda table: runs(curves, table)), ("band edges", propose)]
    table = points(computed([*runs(locked), *runs(curves)], Means(store=store), then=then))
    found = judged_edges(table)
    found = found[found.engine == REFERENCE.engine].assign(friction_ratio=[own.friction_ratio for own in found.curve])
    bands = found.pivot_table(index="friction_ratio", columns="edge", values="exact", dropna=False)
    at = table[(table.frequency_ratio == RESONATOR) & (table.steps == table.steps.min())].set_index("friction_ratio")
    own = bands.assign(
        upper=bands.upper.fillna(math.inf),
        last=LAST,
        stuck=[sum(at.stuck[friction]) / len(at.stuck[friction]) for friction in bands.index],
        share=(bands.upper.fillna(LAST) - bands.lower) / (LAST - FIRST),
    )
    edges = {f"edge at {friction:g}": f"{own.lower[friction]:.4f}" for friction in FRICTION_RATIOS}
    claims = {f"claim {claim}": answer[0] for claim, answer in zip(STATED, answers(own), strict=True)}
    return edges | {f"stick at {friction:g}": f"{own.stuck[friction]:.0%}" for friction in BEYOND} | claims


if __name__ == "__main__":
    table = pd.DataFrame([{"parameters": name, **row(chain, Path(sys.argv[1]))} for name, chain in CHAINS.items()])
    table.to_csv(sys.argv[2], index=False, lineterminator="\n")
