"""Numbers of the whole suite at fixed operating points, as CSV files: what a change of the code must leave as it is.

``python -m tests.golden.record FOLDER --store FILE`` computes them with every engine that is installed, in an hour or
two, and goes on where it was stopped; ``--engine NAME`` and ``--part NAME`` choose. Compare two folders with
``python -m tests.golden.compare BEFORE NOW``.

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

from multibody_xval.engines.interface.registry import engine, engine_names
from multibody_xval.engines.interface.variant import Variant, variants_of
from multibody_xval.scenarios.catalogue.registry import CATALOGUE
from multibody_xval.scenarios.catalogue.scenes.base import SceneScenario
from multibody_xval.scenarios.catalogue.verdict_table import finding_table
from multibody_xval.scenarios.runs.dask_cluster import executor_for
from multibody_xval.scenarios.runs.evaluator import Evaluator
from multibody_xval.scenarios.runs.parameters import DEFAULT_AMPLITUDE, ChainRatios, Excitation, Modulation
from multibody_xval.scenarios.runs.result import UNREPRESENTABLE, Result, ResultStatus
from multibody_xval.scenarios.runs.store import opened_store
from multibody_xval.scenarios.runs.task import SteadyStateTask
from multibody_xval.scenarios.studies.figure3 import QUICK_FRICTION_RATIOS, figure3, quick_frequency_ratios
from multibody_xval.scenarios.sweeps.edges import refined_edges
from multibody_xval.scenarios.sweeps.refinement import for_the_band, refined
from multibody_xval.scenarios.verdicts.proven import proven_level
from reference_lcp.one_call import steady_state
from reference_lcp.steady.richardson import amplitude_in_db

FOLDER = Path(__file__).parent
POINTS = FOLDER / "points.csv"

PARTS = ("steady", "scenarios", "edges", "reference")

TIME_LIMIT = 300.0
"""Of one batch [s]: long chains of an engine that never settles take a minute."""

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


def task(config: Variant, point: Mapping[str, str]) -> SteadyStateTask:
    """Give the run of a configuration at an operating point."""
    names = ("mass_ratio", "stiffness_ratio", "damping_ratio")
    profile = [float(part) for part in point["friction_profile"].split()]
    ratios: dict[str, object] = {name: float(point[name]) for name in names}
    if profile:
        ratios["friction_profile"] = tuple(profile)
    modulation = None
    if point["modulation"]:
        values = float(point["modulation"]), int(point["multiple"]), float(point["phase"])
        modulation = Modulation(modulation=values[0], multiple=values[1], phase=values[2])
    kind = point["excitation"]
    return SteadyStateTask(
        variant=config,
        friction_ratio=float(point["friction_ratio"]),
        frequency_ratio=float(point["frequency_ratio"]),
        ratios=ChainRatios(cells=int(point["cells"]), **ratios),  # type: ignore[arg-type]
        steps_per_period=int(point["steps_per_period"]),
        excitation=Excitation(kind=kind, amplitude=DEFAULT_AMPLITUDE[kind]),
        modulation=modulation,
    )


def configurations(name: str) -> list[Variant]:
    """Give every preset of an engine that can be used here."""
    return [own for own in variants_of(name, optional=True) if own.unavailable_reason is None]


def steady_rows(name: str, evaluator: Evaluator) -> Iterator[Row]:
    """Give the steady states of every preset of an engine; one that hardly ever settles has few rows, see `MOSTLY`."""
    amplification = _amplifications(evaluator)
    for config in configurations(name):
        chosen = points()
        first = {own: point for own, point in chosen.items() if own.startswith(HEADLINE)}
        results = evaluator.evaluate([task(config, point) for point in first.values()])
        settled = sum(result.converged for result in results)
        if settled < MOSTLY * len(first):
            chosen = first if settled else dict([next(iter(first.items()))])
        results = evaluator.evaluate([task(config, point) for point in chosen.values()])
        for point, result in zip(chosen, results, strict=True):
            yield {"config": str(config), "point": point, **steady_numbers(result, amplification[point])}


@cache
def _amplifications(evaluator: Evaluator) -> dict[str, float]:
    """Give how much farther from its steady state a motion may be than its residual says, by operating point."""
    results = evaluator.evaluate([task(Variant("reference"), point) for point in points().values()])
    return {point: result.amplification for point, result in zip(points(), results, strict=True)}


def steady_numbers(result: Result, amplification: float) -> Row:
    """Give the numbers of one steady state; ``open_db`` is what its residual leaves open of the level."""
    if not result.converged:
        return {"status": _status(result)}
    left = amplitude_in_db(result.residual * amplification, result.transmittance_db)
    return {
        "status": "periodic",
        "level_db": f"{result.transmittance_db:.9g}",
        "phase_deg": f"{math.degrees(result.phase):.7g}",
        "open_db": f"{left:.1e}",
        "stuck": " ".join(f"{part:.4g}" for part in result.stuck_fraction),
        "transitions": len(result.transitions),
    }


def _status(result: Result) -> str:
    if result.status is ResultStatus.PERIOD_LIMIT:
        return "not periodic"
    unsupported = result.status is ResultStatus.BLOCKED and result.reason.startswith(UNREPRESENTABLE)
    return "unsupported" if unsupported else "failed"


def scenario_rows(name: str, evaluator: Evaluator) -> Iterator[Row]:
    """Give every number of blocks, transients and scenes, of the presets of an engine."""
    for scenario in CATALOGUE.values():
        if isinstance(scenario, SceneScenario):
            configs = _scene_configurations(scenario, name)
        elif scenario.name in BLOCKS:
            configs = configurations(name)
        elif scenario.name in TRANSIENTS:
            configs = [own for own in configurations(name) if (own.formulation, own.preset_name) == ("joint", "tuned")]
        else:
            continue
        if configs:
            evaluator.stage(f"{name}, {scenario.name}")
            for row in finding_table({scenario: scenario.run(configs, evaluator)}).itertuples():
                config = Variant(row.engine, row.formulation, row.preset)
                labels = {"scenario": row.scenario, "case": row.case, "config": str(config), "quantity": row.metric}
                yield {**labels, "unit": row.unit, "value": "" if math.isnan(row.value) else f"{row.value:.9g}"}


def _scene_configurations(scenario: SceneScenario, name: str) -> list[Variant]:
    """Give the presets of an engine that have such scenes."""
    if engine(name).scene_gap(scenario.formulation):
        return []
    return [own for own in scenario.variants([name]) if own.formulation == scenario.formulation]


def edge_rows(name: str, evaluator: Evaluator) -> Iterator[Row]:
    """Give both edges of the band at the friction ratios of the quick report, of joints, tuned and by default."""
    for config in configurations(name):
        if config.formulation == "joint" and config.preset_name in GOLDEN_EDGES and _settles(config, evaluator):
            sweep = figure3([config], QUICK_FRICTION_RATIOS, quick_frequency_ratios(ChainRatios()))
            own = [point for point in sweep.grid_points() if point[0] == config]
            crossings = refined_edges(sweep, refined(sweep, own, for_the_band(sweep), evaluator), evaluator).crossings
            for (_, case, edge), crossing in crossings.items():
                labels = {"config": str(config), "friction_ratio": f"{case.friction_ratio:g}", "edge": str(edge)}
                numbers = {"frequency_ratio": f"{crossing.frequency_ratio:.9g}", "width": f"{crossing.width:.1e}"}
                yield {**labels, **numbers}


def _settles(config: Variant, evaluator: Evaluator) -> bool:
    """Whether a preset has a steady state at one of the first points."""
    first = [point for own, point in points().items() if own.startswith(HEADLINE)]
    return any(result.converged for result in evaluator.evaluate([task(config, point) for point in first]))


def reference_rows() -> Iterator[Row]:
    """Give what the reference says at every operating point with a constant normal force, with its error bar."""
    for name, point in points().items():
        if not point["modulation"]:
            own = task(Variant("reference"), point)
            chain, drive = own.setting()
            state = steady_state(chain, drive, steps_per_period=own.steps_per_period, with_exact_value=True)
            proven = proven_level(own)
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


def record(folder: Path, names: Sequence[str], parts: Sequence[str], evaluator: Evaluator) -> None:
    """Write the files of these engines."""
    usable = [name for name in names if engine(name).unavailable_reason() is None]
    if "reference" in parts:
        write(folder / "reference.csv", REFERENCE_COLUMNS, reference_rows())
    if "edges" in parts:
        rows = [row for name in usable for row in edge_rows(name, evaluator)]
        write(folder / "edges.csv", EDGE_COLUMNS, rows)
    for name in usable:
        if "steady" in parts:
            evaluator.stage(f"{name}, steady states")
            write(folder / "steady" / f"{name}.csv", STEADY_COLUMNS, steady_rows(name, evaluator))
        if "scenarios" in parts and name != "reference":
            write(folder / "scenarios" / f"{name}.csv", NUMBER_COLUMNS, scenario_rows(name, evaluator))


def main() -> None:
    """Record what the command line asks for."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--store", type=Path, required=True)
    parser.add_argument("--engine", action="append")
    parser.add_argument("--part", action="append", choices=PARTS)
    given = parser.parse_args()
    with (
        opened_store(given.store) as store,
        Evaluator(store, executor_for(None, TIME_LIMIT)) as evaluator,
    ):
        record(given.folder, given.engine or engine_names(), given.part or PARTS, evaluator)


if __name__ == "__main__":
    main()
