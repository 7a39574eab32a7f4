"""How far engines are from what is said of their steps: a law, or the reference's scheme."""

from collections.abc import Iterable
from typing import Any

import numpy as np
import pandas as pd

from multibody_xval.engines.interface.laws import law_of
from multibody_xval.engines.interface.registry import engine
from multibody_xval.engines.interface.tolerances import CREEP, TRAJECTORY_TOLERANCE
from multibody_xval.scenarios.compute import SECONDS_A_RUN
from multibody_xval.scenarios.compute.checked import CheckedSimulation
from multibody_xval.scenarios.model import REFERENCE, Config
from multibody_xval.scenarios.result_tables import CONFIG, full_name
from multibody_xval.scenarios.running.pool import preparation_seconds, reason_of
from multibody_xval.scenarios.running.processes import GRACE, Pool, local
from multibody_xval.scenarios.store import identity
from reference_lcp.chain.drives import HarmonicBase
from reference_lcp.chain.mass_in_mass import Chain
from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.trajectory import State
from reference_lcp.defaults import BASE_AMPLITUDE
from reference_lcp.defaults import MINIMUM_STEPS_PER_PERIOD as STEPS

FRICTION_RATIO, FREQUENCY_RATIOS = 0.3, (0.5, 0.7, 0.9, 1.1, 1.3, 1.5)
"""The points of Figure 3 at which engine and law are compared."""

APPROACH_PERIODS = 10
"""Periods of the reference from rest, to the state from which both start: contacts stick and slip as they will."""

LEGEND = f"""\
Why does an engine deviate? A *law* is a formula for the steps of a preset, with constants from its options. Engine and
law start from the same state, at {len(FREQUENCY_RATIOS)} points of Figure 3 (friction ratio {FRICTION_RATIO:g},
{STEPS} steps per period), and positions are compared over one period. A law explains an error, and excuses none.

| column | what it is |
|---|---|
| *steps by* | a law, or the reference's scheme, equation (5), where the preset says so; others are left out |
| *largest* | distance of engine and law after one period, over U0 |
| *allowed* | what the contract of engines allows |
| *from Coulomb* | distance of the engine from the reference's step |
"""

HEADINGS = {
    "configuration": "configuration", "steps_by": "steps by", "largest": "largest [U0]", "allowed": "allowed",
    "from_reference": "from Coulomb", "reason": "not measured",
}  # fmt: skip
"""Columns of the table, with their headings for people."""


def law_distances(configs: Iterable[Config]) -> pd.DataFrame:
    """Give one row a configuration that states how it steps; what crashes or hangs is the row's reason.

    Columns: ``configuration``, those of `CONFIG`, ``version``, ``steps_by``, ``formula``, ``constants``, ``largest``
    distance from what is stated and ``from_reference``, after a period, over U0, ``allowed`` and ``reason``.
    """
    with local(1) as pool:
        rows = [_row(config, pool) for config in configs if config.engine != REFERENCE.engine and _is_stated(config)]
    columns = [
        "configuration", *CONFIG, "version", "steps_by", "formula", "constants", "largest", "from_reference", "allowed",
        "reason",
    ]  # fmt: skip
    return pd.DataFrame(rows, columns=columns)


def _is_stated(config: Config) -> bool:
    return config.preset.shares_scheme or law_of(config) is not None


def _row(config: Config, pool: Pool) -> dict[str, Any]:
    law = law_of(config)
    names = dict(zip(CONFIG, (config.engine, str(config.formulation), config.preset_name), strict=True))
    row: dict[str, Any] = {"configuration": full_name(config), **names, "version": identity(config)[0]}
    if law is None:
        allowed = TRAJECTORY_TOLERANCE[config.capabilities.precision] + CREEP * config.preset.residual_slip_compliance
        row |= {"steps_by": "the reference's scheme", "formula": "", "constants": "", "allowed": allowed}
    else:
        numbers = (f"{name} = {each.value:g} {each.unit}".strip() for name, each in law.constants.items())
        row |= {"steps_by": "a law", "formula": law.formula, "constants": ", ".join(numbers), "allowed": law.bound}
    limit = preparation_seconds(config) + SECONDS_A_RUN
    try:
        found = pool.submit((period_distances, [config], limit, config.capabilities.package)).result(limit + GRACE)
    except Exception as problem:  # an engine or a law may raise anything, or end its process
        return row | {"largest": np.nan, "from_reference": np.nan, "reason": reason_of(problem)}
    return row | dict(zip(("largest", "from_reference"), found, strict=True)) | {"reason": ""}


def period_distances(config: Config) -> tuple[float, float]:
    """Give the largest distances after one period from what is stated and from the reference's step, over U0."""
    law, chain, apart = law_of(config), Chain.from_ratios(friction_ratio=FRICTION_RATIO), []
    for frequency_ratio in FREQUENCY_RATIOS:
        lane = Lane.periodic(chain, HarmonicBase.from_ratio(chain, frequency_ratio, BASE_AMPLITUDE), STEPS)
        reference = engine(REFERENCE.engine).build([lane])
        start = reference.advance(State.at_rest(1, chain.cells), 0, APPROACH_PERIODS * STEPS)
        expected = reference.run(start, 0, STEPS)[0].positions
        own = CheckedSimulation(config.build([lane])).run(start, 0, STEPS)[0].positions
        stated = expected if law is None else law.positions(lane, start, STEPS)
        apart.append([np.max(np.abs(own - other)) / BASE_AMPLITUDE for other in (stated, expected)])
    own, others = np.max(apart, axis=0)
    return float(own), float(others)


def shown(table: pd.DataFrame) -> pd.DataFrame:
    """Give the table for people."""
    columns = [name for name in HEADINGS if name != "reason" or table.reason.any()]
    texts = table[columns].rename(columns=HEADINGS)
    for name, pattern in (("largest [U0]", "{:.1e}"), ("allowed", "{:.0e}"), ("from Coulomb", "{:.1e}")):
        texts[name] = ["–" if pd.isna(value) else pattern.format(value) for value in texts[name]]
    return texts


def formulas(table: pd.DataFrame) -> list[str]:
    """Give the formula of every law, with its constants, in a line."""
    rows = table[table.formula != ""]
    lines = zip(rows.configuration, rows.formula, rows.constants, strict=True)
    return [f"{name}: {formula}{f'; {constants}' if constants else ''}" for name, formula, constants in lines]
