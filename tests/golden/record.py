"""Numbers of the whole suite at fixed operating points, as CSV files: what a change of the code must leave as it is.

``python -m tests.golden.record FOLDER --store FILE`` computes them with every engine that is installed, in an hour or
two, and goes on where it was stopped; ``--engine NAME`` and ``--part NAME`` choose. Compare two folders with
``python -m tests.golden.compare BEFORE NOW``.

Results are kept in FILE.

``points.csv`` has the operating points: points of the usual grids, points off them, long and lightly damped chains,
normal forces that swing or open the contacts. The other files are

- ``steady/ENGINE.csv``: the steady state of every preset at every point;
- ``scenarios/ENGINE.csv``: the numbers of blocks and scenes;
- ``edges.csv``: the edges of the attenuation band;
- ``reference.csv``: what ``multibody-xval reference`` says: level, error bar, exact and proven level.
"""

import argparse
import csv
import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from functools import cache
from pathlib import Path
from typing import Any

import pandas as pd

from multibody_xval.engines.interface.presets import Formulation
from multibody_xval.engines.interface.registry import engine, engine_names
from multibody_xval.engines.interface.variant import variants_of
from multibody_xval.scenarios import edges
from multibody_xval.scenarios.cases.scene_motion import SceneMotion
from multibody_xval.scenarios.catalogue.all_scenarios import SCENARIOS
from multibody_xval.scenarios.catalogue.numbers import numbers
from multibody_xval.scenarios.catalogue.scenario import Scenario
from multibody_xval.scenarios.model import REFERENCE, Case, Config, Result, Run, Status
from multibody_xval.scenarios.report_plan import grid
from multibody_xval.scenarios.result_tables import points as table_of
from multibody_xval.scenarios.ruler.proven import in_table, proven_levels
from multibody_xval.scenarios.running.evaluate import Means, computed
from multibody_xval.scenarios.store import Stored
from reference_lcp.one_call import steady_state
from reference_lcp.steady.richardson import amplitude_in_db

FOLDER = Path(__file__).parent
POINTS = FOLDER / "points.csv"

PARTS = ("steady", "scenarios", "edges", "reference")

TIME_LIMIT = 300.0
"""Of one run [s]: long chains of an engine that never settles take a minute."""

HEADLINE = "headline"
"""Begins the names of the points of the README's table, deep in the band."""

MOSTLY = 0.5
"""Part of these at which a preset must settle to be computed at all points: searches that find nothing take long. One
that settles at fewer is computed there alone, and one that never settles at the first."""

BLOCKS = ("static-hold", "ratchet", "breakaway", "stopping-distance", "static-above-kinetic", "published")
TRANSIENTS = ("free-decay", "ricker-pulse")
"""Scenarios that are not scenes; transients are those of tuned joints."""

STEADY_COLUMNS = ("config", "point", "status", "level_db", "phase_deg", "open_db", "stuck", "transitions")
NUMBER_COLUMNS = ("scenario", "case", "config", "quantity", "unit", "value")
EDGE_COLUMNS = ("config", "friction_ratio", "edge", "frequency_ratio", "width")
REFERENCE_COLUMNS = ("point", "level_db", "phase_deg", "error_bar_db", "exact_db", "proven_db", "stuck", "transitions")

GOLDEN_EDGES = ("tuned", "default")
"""Presets whose band edges are recorded, of joints."""

Row = Mapping[str, object]


@cache
def points() -> dict[str, dict[str, str]]:
    """Give the operating points by name."""
    with POINTS.open(newline="", encoding="utf-8") as file:
        return {row["point"]: row for row in csv.DictReader(file)}


def headline() -> list[str]:
    """Give the points of the README's table."""
    return [own for own in points() if own.startswith(HEADLINE)]


def case_at(point: Mapping[str, str]) -> Case:
    """Give the case of an operating point."""
    profile = tuple(float(part) for part in point["friction_profile"].split())
    numbers = ("mass_ratio", "stiffness_ratio", "damping_ratio", "friction_ratio", "frequency_ratio")
    values: dict[str, Any] = {name: float(point[name]) for name in numbers}
    if profile:
        values["friction_profile"] = profile
    if point["modulation"]:
        values["modulation"], values["modulation_phase"] = float(point["modulation"]), float(point["phase"])
        values["modulation_multiple"] = int(point["multiple"])
    return Case(cells=int(point["cells"]), drive=point["excitation"], **values)


def run_at(config: Config, point: str) -> Run:
    """Give the run of a configuration at an operating point."""
    own = points()[point]
    return Run(config, case_at(own), int(own["steps_per_period"]))


def configurations(name: str) -> list[Config]:
    """Give every preset of an engine that can be used here."""
    return [own for own in variants_of(name, optional=True) if own.unavailable_reason is None]


def chosen_points(settled: int, every: int) -> list[str]:
    """Give the points at which a preset is recorded that settles at so many of the headline's, see `MOSTLY`."""
    first = headline()
    if settled >= MOSTLY * len(first):
        return [*first, *[own for own in points() if own not in first][::every]]
    return first if settled else first[:1]


def settled(table: pd.DataFrame) -> dict[Config, int]:
    """Give at how many of the headline's points every configuration of a table has a steady state."""
    runs = {(case_at(points()[own]), int(points()[own]["steps_per_period"])) for own in headline()}
    rows = table[[own in runs for own in zip(table.case, table.steps, strict=True)]]
    return (rows.status == "periodic").groupby(rows.config, sort=False).sum().to_dict()


def steady_rows(name: str, means: Means, every: int = 1) -> Iterator[Row]:
    """Give the steady states of every preset of an engine; one that hardly ever settles has few rows, see `MOSTLY`."""
    first = [run_at(own, point) for own in configurations(name) for point in headline()]

    def rest(table: pd.DataFrame) -> list[Run]:
        return [run_at(own, point) for own, count in settled(table).items() for point in chosen_points(count, every)]

    of_reference = [run_at(REFERENCE, point) for point in points()]
    results = results_of(computed([*of_reference, *first], means, f"{name}, first points", [("other points", rest)]))
    growth = {point: results[run_at(REFERENCE, point)].amplification for point in points()}
    for config in configurations(name):
        count = sum(results[run_at(config, point)].status is Status.PERIODIC for point in headline())
        for point in chosen_points(count, every):
            numbers = steady_numbers(results[run_at(config, point)], growth[point])
            yield {"config": str(config), "point": point, **numbers}


def results_of(stored: Iterable[Stored]) -> dict[Run, Result]:
    """Give results by their runs."""
    return {row.run: row.result for row in stored}


def steady_numbers(result: Result, amplification: float) -> Row:
    """Give the numbers of one steady state; ``open_db`` is what its residual leaves open of the level."""
    if result.status is not Status.PERIODIC:
        return {"status": str(result.status)}
    left = amplitude_in_db(result.residual * amplification, result.level_db)
    return {
        "status": "periodic",
        "level_db": f"{result.level_db:.9g}",
        "phase_deg": f"{result.phase_deg:.7g}",
        "open_db": f"{left:.1e}",
        "stuck": " ".join(f"{part:.4g}" for part in result.stuck),
        "transitions": len(result.transitions),
    }


def scenario_rows(name: str, means: Means) -> Iterator[Row]:
    """Give every number of blocks, transients and scenes, of the presets of an engine."""
    for scenario in SCENARIOS.values():
        if configs := scenario_configurations(scenario, name):
            stored = computed(scenario.runs(configs), means, f"{name}, {scenario.name}")
            table = numbers(scenario, stored)
            for row in table[table.engine == name].itertuples():
                config = Config(row.engine, row.formulation, row.preset)
                labels = {"scenario": row.scenario, "case": row.case, "config": str(config), "quantity": row.quantity}
                yield {**labels, "unit": row.unit, "value": "" if math.isnan(row.value) else f"{row.value:.9g}"}


def scenario_configurations(scenario: Scenario, name: str) -> list[Config]:
    """Give the presets of an engine that are recorded in a scenario; none of steady states, which are points."""
    case = next(iter(scenario.cases.values()))
    if isinstance(case, SceneMotion):
        if engine(name).scene_gap(Formulation(case.formulation)):
            return []
        return [own for own in scenario.configs([name]) if own.formulation == case.formulation]
    if scenario.name in BLOCKS:
        return configurations(name)
    joints = [own for own in configurations(name) if (own.formulation, own.preset_name) == ("joint", "tuned")]
    return joints if scenario.name in TRANSIENTS else []


def edge_rows(name: str, means: Means) -> Iterator[Row]:
    """Give both edges of the band at the friction ratios of the quick report, of joints, tuned and by default."""
    joints = [own for own in configurations(name) if own.formulation == "joint" and own.preset_name in GOLDEN_EDGES]
    first = [run_at(own, point) for own in joints for point in headline()]
    counts = settled(table_of(computed(first, means, f"{name}, first points")))
    settling = [own for own in joints if counts[own]]
    runs = [Run(own, case, case.steps()) for own in dict.fromkeys([REFERENCE, *settling]) for case in grid(quick=True)]
    stored = computed(runs, means, f"{name}, grid", [("edges", edges.propose)])
    for own in edges.edges(table_of(stored)).dropna(subset="frequency_ratio").itertuples():
        config = Config(own.engine, own.formulation, own.preset)
        if config in settling:
            labels = {"config": str(config), "friction_ratio": f"{own.curve.friction_ratio:g}", "edge": own.edge}
            yield {**labels, "frequency_ratio": f"{own.frequency_ratio:.9g}", "width": f"{own.width:.1e}"}


def reference_rows() -> Iterator[Row]:
    """Give what the reference says at every operating point with a constant normal force, with its error bar."""
    for name, point in points().items():
        if not point["modulation"]:
            run = run_at(REFERENCE, name)
            state = steady_state(*run.of(Case).setting, steps_per_period=run.steps, with_exact_value=True)
            proven = proven_levels().get(in_table(run.of(Case)))
            yield {
                "point": name,
                "level_db": f"{state.transmittance_db:.12g}",
                "phase_deg": f"{math.degrees(state.phase):.9g}",
                "error_bar_db": "" if state.error_bar is None else f"{state.error_bar.transmittance_db:.6g}",
                "exact_db": "" if state.exact_db is None else f"{state.exact_db:.12g}",
                "proven_db": "" if proven is None else str(proven.transmittance_db),
                "stuck": " ".join(f"{part:.6g}" for part in state.stuck_fraction),
                "transitions": len(state.transitions),
            }


def write(file: Path, columns: Sequence[str], rows: Iterable[Row]) -> None:
    """Write rows, if there are any."""
    known = list(rows)
    if known:
        file.parent.mkdir(parents=True, exist_ok=True)
        with file.open("w", newline="", encoding="utf-8") as target:
            table = csv.DictWriter(target, columns, restval="", lineterminator="\n")
            table.writeheader()
            table.writerows(known)


def record(folder: Path, names: Sequence[str], parts: Sequence[str], means: Means, every: int) -> None:
    """Write the files of these engines."""
    usable = [name for name in names if engine(name).unavailable_reason() is None]
    if "reference" in parts:
        write(folder / "reference.csv", REFERENCE_COLUMNS, reference_rows())
    if "edges" in parts:
        rows = [row for name in usable for row in edge_rows(name, means)]
        write(folder / "edges.csv", EDGE_COLUMNS, rows)
    for name in usable:
        if "steady" in parts:
            write(folder / "steady" / f"{name}.csv", STEADY_COLUMNS, steady_rows(name, means, every))
        if "scenarios" in parts and name != "reference":
            write(folder / "scenarios" / f"{name}.csv", NUMBER_COLUMNS, scenario_rows(name, means))


def main() -> None:
    """Record what the command line asks for."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--store", type=Path, required=True)
    parser.add_argument("--engine", action="append")
    parser.add_argument("--part", action="append", choices=PARTS)
    parser.add_argument("--workers", type=int)
    parser.add_argument("--every", type=int, default=1, help="record one point of so many, and the headline's five")
    given = parser.parse_args()
    means = Means(store=given.store, workers=given.workers, seconds_a_run=TIME_LIMIT)
    record(given.folder, given.engine or engine_names(), given.part or PARTS, means, given.every)


if __name__ == "__main__":
    main()
