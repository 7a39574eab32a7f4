"""What those whose blocks creep see first: the drift of a stack on a slope, and what to paste into a model."""

from collections.abc import Iterable, Sequence
from typing import Any

import pandas as pd

from multibody_xval.engines.interface.presets import Formulation
from multibody_xval.engines.interface.registry import engine, engine_names
from multibody_xval.reports.reproducers.recipe import blocks, recipe_file, recipe_text
from multibody_xval.scenarios.catalogue.all_scenarios import SCENARIOS
from multibody_xval.scenarios.catalogue.numbers import numbers
from multibody_xval.scenarios.catalogue.worst_numbers import printed_number
from multibody_xval.scenarios.model import Config, Run
from multibody_xval.scenarios.store import Stored
from multibody_xval.scenarios.studies.claims import TITLES

HOLD = SCENARIOS["stack-hold"]
"""Three boxes on a slope of 12°, which friction holds."""


def drift_runs(configs: Sequence[Config]) -> list[Run]:
    """Give the runs of the stack for those configurations that are compared in scenes and whose engine is installed."""
    named = map(engine, dict.fromkeys(own.engine for own in configs))
    able = [own.name for own in named if not (own.unavailable_reason() or own.scene_gap(Formulation.CONTACT))]
    held = [own for name in able for own in HOLD.configs([name]) if own in configs]
    return [_own_step(own) for own in held]


def drift_table(stored: Iterable[Stored]) -> pd.DataFrame:
    """Give a row an engine, as texts: drift [µm/s] with default options and with the recipe, and the exact one."""
    cases, known = set(HOLD.cases.values()), set(engine_names())
    rows = [own for own in stored if own.run.case in cases and own.run.config.engine in known]
    rows = [own for own in rows if own.run == _own_step(own.run.config)]
    if not rows:
        return pd.DataFrame()
    found = numbers(HOLD, rows)
    own = found[found.quantity == "drift"]
    texts = own.value.map(printed_number).where(own.value.notna(), own.verdict)
    named = own.assign(text=texts, engine=own.engine.map(lambda name: engine(name).capabilities.title),
                       options=own.preset.map(TITLES).fillna(own.preset))  # fmt: skip
    wide = named.pivot_table(index="engine", columns="options", values="text", aggfunc="last", sort=False)
    return wide.fillna("–").assign(exact="0").reset_index().rename_axis(columns=None)


def creep(table: pd.DataFrame) -> str:
    """Say in a sentence how fast the stack creeps in the worst engine of `drift_table`; empty where none was run."""
    parts = []
    for name, words in ((TITLES["default"], "default options"), (TITLES["recommended"], "the recipe")):
        sizes = pd.to_numeric(table.get(name, pd.Series(dtype=str)).str.replace(",", ""), errors="coerce")
        if sizes.notna().any():
            worst: Any = sizes.idxmax()
            parts.append(f"at up to {table[name][worst]} µm/s with {words} ({table.engine[worst]})")
    return f"Boxes that should rest creep {', and '.join(parts)}." if parts else ""


def pasted(configs: Iterable[Config]) -> dict[str, str]:
    """Give what to write in a model, by the titles of engines: the block of the recipe."""
    names = [name for name in dict.fromkeys(own.engine for own in configs) if name in engine_names()]
    texts = {engine(name).capabilities.title: recipe_text(name) for name in names if recipe_file(engine(name))}
    return {title: blocks(text)[0] for title, text in texts.items() if blocks(text)}


def _own_step(config: Config) -> Run:
    """Give the run of a configuration at the engine's own time step, which is the first."""
    return next(iter(HOLD.own_runs(config).values()))
