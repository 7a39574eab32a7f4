"""Numbers of the whole suite at fixed operating points, as CSV files: what a change of the code must leave as it is.

``python -m tests.golden.record FOLDER STORE`` computes them with every engine that is installed, in an hour or two,
keeps results in the file STORE, and goes on where it was stopped; ``--engine NAME`` and ``--part NAME`` choose,
and ``--only TEXT`` takes the operating points and scenarios whose names begin so.
Compare two folders with ``python -m tests.golden.compare BEFORE NOW``.

``points.csv`` has the operating points: points of the usual grids, points off them, long and lightly damped chains,
normal forces that swing or open the contacts. The other files are

- ``steady/ENGINE.csv``: the steady state of every preset at every point;
- ``scenarios/ENGINE.csv``: the numbers of blocks and scenes;
- ``edges/ENGINE.csv``: the edges of the attenuation band.
"""

import itertools
from collections.abc import Callable, Mapping
from functools import cache
from pathlib import Path
from typing import Annotated

import pandas as pd
import typer

from multibody_xval.engines.interface.presets import Formulation
from multibody_xval.engines.interface.registry import engine, engine_names
from multibody_xval.engines.interface.variant import variants_of
from multibody_xval.scenarios import edges
from multibody_xval.scenarios.cases.scene_motion import SceneMotion
from multibody_xval.scenarios.catalogue.all_scenarios import SCENARIOS
from multibody_xval.scenarios.catalogue.numbers import numbers
from multibody_xval.scenarios.catalogue.scenario import Scenario
from multibody_xval.scenarios.model import REFERENCE, Case, Config, Run
from multibody_xval.scenarios.report_plan import grid
from multibody_xval.scenarios.result_tables import is_reference
from multibody_xval.scenarios.result_tables import points as table_of
from multibody_xval.scenarios.running.evaluate import Means, computed
from reference_lcp.steady.richardson import amplitude_in_db
from tests.golden.compare import COLUMNS, NAMES

FOLDER = Path(__file__).parent

TIME_LIMIT = 300.0
"""Of one run [s]: long chains of an engine that never settles take a minute."""

HEADLINE, LONG = "headline", ("long", "light")
"""Begin the names of the points of the README's table, deep in the band: presets that settle at few of them are
recorded there alone, for searches that find nothing take long; and those of chains whose searches take long."""

BLOCKS = ("static-hold", "ratchet", "breakaway", "stopping-distance", "static-above-kinetic", "published")
TRANSIENTS = ("free-decay", "ricker-pulse")
"""Scenarios that are not scenes; transients are those of tuned joints."""

JOINTS = ("tuned", "default")
"""Presets of joints whose band edges are recorded."""

BESIDE = {"steady": ["open_db"], "scenarios": ["unit"], "edges": ["width"]}
"""Columns of files that decide what others may differ by, and are not compared."""


@cache
def points() -> dict[str, tuple[Case, int]]:
    """Give the operating points by name: the case, and its steps per period."""
    found = {}
    for row in pd.read_csv(FOLDER / "points.csv", dtype={"friction_profile": str}).to_dict("records"):
        name, steps, profile = (row.pop(column) for column in ("point", "steps", "friction_profile"))
        first, *others = map(float, profile.split())
        found[name] = Case(**row, friction_profile=(first, *others) if others else first), steps
    return found


def run_at(config: Config, point: str) -> Run:
    """Give the run of a configuration at an operating point."""
    return Run(config, *points()[point])


def configurations(name: str) -> list[Config]:
    """Give every preset of an engine that can be used here."""
    return [own for own in variants_of(name, optional=True) if own.unavailable_reason is None]


def steady(name: str, means: Means, only: tuple[str, ...]) -> pd.DataFrame:
    """Give the steady states of every preset of an engine."""
    asked = [point for point in points() if point.startswith(only)]
    runs = [run_at(REFERENCE, point) for point in asked]
    for own in configurations(name):
        runs += [run_at(own, point) for point in asked if own.preset.settles or point.startswith(HEADLINE)]
    table = steady_numbers(table_of(computed(list(dict.fromkeys(runs)), means, name)))
    return table[table.engine == name]


def steady_numbers(table: pd.DataFrame) -> pd.DataFrame:
    """Add names, and what residuals leave open, to steady states; those of the reference say how residuals grow."""
    names = {place: name for name, place in points().items()}
    table = table.assign(point=[names[place] for place in zip(table.case, table.steps, strict=True)])
    growth = table[is_reference(table)].set_index("point").amplification
    left = table.residual * table.point.map(growth)
    return table.assign(
        open_db=list(map(amplitude_in_db, left, table.transmittance_db)),
        level_db=table.transmittance_db,
        transitions=table.transitions.where(table.status == "periodic", ""),
    )


def scenario_numbers(name: str, means: Means, only: tuple[str, ...]) -> pd.DataFrame:
    """Give every number of blocks, transients and scenes, of the presets of an engine."""
    found = []
    for scenario in (own for own in SCENARIOS.values() if own.name.startswith(only)):
        if configs := scenario_configurations(scenario, name):
            table = numbers(scenario, computed(scenario.runs(configs), means, f"{name}, {scenario.name}"))
            found.append(with_config(table[table.engine == name]))
    return pd.concat(found) if found else pd.DataFrame()


def scenario_configurations(scenario: Scenario, name: str) -> list[Config]:
    """Give the presets of an engine that are recorded in a scenario; none of steady states, which are points."""
    case = next(iter(scenario.cases.values()))
    if isinstance(case, SceneMotion):
        missing = engine(name).scene_gap(Formulation(case.formulation))
        return [] if missing else [own for own in scenario.configs([name]) if own.formulation == case.formulation]
    if scenario.name in BLOCKS:
        return configurations(name)
    joints = [own for own in configurations(name) if (own.formulation, own.preset_name) == ("joint", "tuned")]
    return joints if scenario.name in TRANSIENTS else []


def band_edges(name: str, means: Means, _only: tuple[str, ...]) -> pd.DataFrame:
    """Give both edges of the band at the friction ratios of the quick report, of joints, tuned and by default."""
    joints = [own for own in configurations(name) if own.formulation == "joint" and own.preset_name in JOINTS]
    configs = dict.fromkeys([REFERENCE, *(own for own in joints if own.preset.settles)])
    runs = [Run(own, case, case.steps()) for own in configs for case in grid(quick=True)]
    found = edges.edges(table_of(computed(runs, means, f"{name}, edges", [("edges", edges.propose)])))
    found = with_config(found[found.engine == name].dropna(subset="frequency_ratio"))
    return found.assign(friction_ratio=[curve.friction_ratio for curve in found.curve])


def with_config(table: pd.DataFrame) -> pd.DataFrame:
    """Add the names of configurations."""
    rows = zip(table.engine, table.formulation, table.preset, strict=True)
    return table.assign(config=[str(Config(*row)) for row in rows])


def write(folder: Path, part: str, name: str, table: pd.DataFrame) -> None:
    """Write the file of an engine; numbers of cells have spaces between."""
    columns = [*NAMES[part], *COLUMNS[part], *BESIDE.get(part, [])]
    shown = table[columns].map(lambda own: " ".join(f"{x:.4g}" for x in own) if isinstance(own, tuple) else own)
    (folder / part).mkdir(parents=True, exist_ok=True)
    shown.to_csv(folder / part / f"{name}.csv", index=False, float_format="%.12g")


PARTS: Mapping[str, Callable[[str, Means, tuple[str, ...]], pd.DataFrame]] = {
    "steady": steady, "scenarios": scenario_numbers, "edges": band_edges,
}  # fmt: skip
"""Folders of files, and what gives the rows of an engine."""


def main(
    folder: Path,
    store: Path,
    engine_name: Annotated[list[str] | None, typer.Option("--engine")] = None,
    part: list[str] | None = None,
    only: list[str] | None = None,
) -> None:
    """Record what the command line asks for."""
    means = Means(store=store, seconds_a_run=TIME_LIMIT)
    usable = [name for name in engine_name or engine_names() if engine(name).unavailable_reason() is None]
    for own, name in itertools.product(part or PARTS, usable):
        table = PARTS[own](name, means, tuple(only or [""]))
        if len(table):
            write(folder, own, name, table)


if __name__ == "__main__":
    typer.run(main)
