"""``multibody-xval run figure3``, ``accuracy``, ``work-precision`` and ``friction-map``: measurements and figures."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from multibody_xval.reports.cli.exit_code import ExitCode
from multibody_xval.reports.cli.options import (
    CHART_ENDINGS,
    TABLE_ENDINGS,
    Computing,
    Engines,
    Figure3Engines,
    ScenarioEngines,
    Store,
    TableFiles,
    check_outs,
    grouped,
    keeping,
)
from multibody_xval.reports.cli.shown import Shown, print_part
from multibody_xval.scenarios.output_files import checked_output_file, checked_output_folder
from reference_lcp.errors import ParameterError

if TYPE_CHECKING:
    import pandas as pd

    from multibody_xval.engines.interface.variant import Variant
    from multibody_xval.scenarios.running.evaluate import Means
    from multibody_xval.scenarios.store import Stored

Outs = Annotated[
    list[Path] | None,
    typer.Option(
        metavar="FILE",
        help="Write tables as .md, numbers as .csv, or the figure as .svg, .pdf or .png; may be repeated.",
    ),
]


FIGURE3 = Path("figure3")
"""Folder of the figure where no other is named."""


def compared(engines: Engines) -> list[Variant]:
    """Give the reference and the chosen configurations of engines."""
    from multibody_xval.scenarios.model import REFERENCE

    return [REFERENCE, *(own for own in engines.variants() if own.engine != REFERENCE.engine)]


@grouped
def figure3(
    engines: Figure3Engines,
    *,
    out: Annotated[
        Path, typer.Option(help="Folder of the figure, its numbers and the tables; made if it is missing.")
    ] = FIGURE3,
    store: Annotated[
        Path | None, typer.Option(help="File that stores every result; without it, results.sqlite in --out.")
    ] = None,
    run: Annotated[
        bool, typer.Option("--run/--no-run", help="Run missing points; --no-run shows only what is stored.")
    ] = True,
    computing: Computing,
) -> None:
    """Draw the paper's figure 3 with the reference, and with engines if they are named; answer the paper's claims.

    Writes figure3.svg, figure3.pdf, figure3.csv (every point) and figure3.md (what is printed) into --out. It takes
    less than a minute on two idle processors. Results are stored: a second call takes seconds, and an interrupted one
    continues.

    Exit code 0: no judged number deviates; 1: one does, more than a quarter of those of a judged preset is missing, or
    a named preset fails at more than a quarter.

    Example: multibody-xval run figure3 --engine mujoco:joint:default
    """
    computing.check(out, run=run)
    configs = compared(engines)
    from multibody_xval.reports.figures.studies import transmittance
    from multibody_xval.reports.page.sources import STORE
    from multibody_xval.scenarios.edges import judged_edges
    from multibody_xval.scenarios.result_tables import coarsest, file_columns, is_exact, points
    from multibody_xval.scenarios.ruler.judge import failures, judged
    from multibody_xval.scenarios.studies.claims import claim_cases, of_paper

    kept = store or out / STORE
    means = computing.means(kept)
    outs = _figure3_files(out, kept, run=run)
    with keeping(kept):
        every = of_paper(points(_figure3_results(configs, kept, means if run else None)))
    found, rows = judged_edges(every), judged(every)
    drawn = coarsest(rows[~is_exact(rows)])
    drawn = drawn.assign(verdict=drawn.verdict.where(drawn.case.isin(claim_cases()), "drawn, not judged"))
    of_engines = drawn[drawn.case.isin(claim_cases()) & drawn.config.isin(configs[1:])]
    lines = failures(of_engines, lambda own: own.config.isin(configs[1:]))
    words = ([] if out == FIGURE3 else [f"--out={out}"]) + ([f"--store={store}"] if store else [])
    end = Shown("Figure 3", engines.command("figure3", words + ([] if run else ["--no-run"])), every)
    printed, details, last = figure3_parts(every, found, of_engines)
    end.show(printed)
    end.keep(details | {"Finding": [*last, *lines]})
    end.write(outs, file_columns(drawn), lambda: transmittance(every, found))
    print_part([f"written: {out / 'figure3.svg'}, .pdf, .csv and .md", *last, *lines])
    if lines:
        raise typer.Exit(ExitCode.FAILED)


def _figure3_files(out: Path, kept: Path, *, run: bool) -> list[Path]:
    """Give the files of the figure in a folder, which is made; refuse what cannot be written, or shown without runs."""
    from multibody_xval.scenarios.store import existing_store

    if not run:
        existing_store(kept)
    checked_output_folder("--out", out)
    files = [out / f"figure3{ending}" for ending in (".svg", ".pdf", ".csv", ".md")]
    return [checked_output_file("--out", file, [kept]) for file in files]


def _figure3_results(configs: list[Variant], kept: Path, means: Means | None) -> list[Stored]:
    """Give the results that claims, edges and curves need: what the store lacks is run, or not without `means`."""
    from multibody_xval.scenarios.edges import propose
    from multibody_xval.scenarios.model import EXACT, REFERENCE, Run
    from multibody_xval.scenarios.plan import runs_at
    from multibody_xval.scenarios.running.evaluate import computed, stored_results
    from multibody_xval.scenarios.studies.claims import claim_cases
    from multibody_xval.scenarios.studies.figure3 import curve_cases

    if means is None:
        return [own for own in stored_results(kept) if own.run.config in {EXACT, *configs}]
    curves = [Run(REFERENCE, case, case.steps()) for case in curve_cases()]
    runs = list(dict.fromkeys([*runs_at(configs, claim_cases()), *curves]))
    return computed(runs, means, then=[("band edges", propose)])


Parts = dict[str, "pd.DataFrame | list[str]"]


def figure3_parts(every: pd.DataFrame, found: pd.DataFrame, of_engines: pd.DataFrame) -> tuple[Parts, Parts, list[str]]:
    """Give what `run figure3` prints, what its document has beside that, and the finding, which ends both."""
    from multibody_xval.reports.page.tables import edge_table, verdict_counts
    from multibody_xval.scenarios.ruler.judge import conclusion
    from multibody_xval.scenarios.studies import figure3 as study
    from multibody_xval.scenarios.studies.claims import RANGE, STATED, conclusions, shown

    answers, bands = study.answers_of_reference(every, found), study.bands_of_reference(every, found)
    covered = f"{RANGE[0]:g} to {RANGE[1]:g}"
    printed: Parts = {
        "Parameters": study.assumed(),
        f"Lower band edges η_r; share of {covered} that the band covers": study.edges_and_shares(found, bands),
        "The paper's claims": study.answered(answers, numbers=False),
    }
    details: Parts = {"What decides the claims": study.answered(answers, numbers=True)}
    last = [study.finding(answers, bands)]
    if of_engines.empty:
        return printed, details, last
    concluded = conclusions(every, found)
    edges = shown(concluded)
    printed |= {
        "Lower edges η_r by friction ratio": edges.drop(columns=[*STATED]),
        "What one would conclude": concluded.sentence.tolist()[1:],
    }
    details |= {
        "Answers, and lower edges η_r by friction ratio": edges,
        "Verdicts on points": verdict_counts(of_engines),
        "Band edges η_r": edge_table(found),
    }
    return printed, details, [*last, conclusion(of_engines)]


@grouped
def accuracy(engines: Engines, *, store: Store = None, out: TableFiles = None, computing: Computing) -> None:
    """Compare steady states with the exact motion: a row of errors for each engine, formulation and preset.

    Exit code 0: the table is complete, whatever its numbers.

    Example: multibody-xval run accuracy --store accuracy.sqlite --out accuracy.md
    """
    outs, means = check_outs(out, TABLE_ENDINGS, store), computing.means(store)
    configs = compared(engines)
    from multibody_xval.scenarios.result_tables import points
    from multibody_xval.scenarios.ruler.judge import judged
    from multibody_xval.scenarios.running.evaluate import computed
    from multibody_xval.scenarios.studies import accuracy_map as study

    with keeping(store):
        every = points(computed(study.map_runs(configs), means))
    table = study.accuracies(judged(every))
    end = Shown("Accuracy of the engines", engines.command("accuracy"), every, study.LEGEND)
    end.show({"": study.shown(table), "Remarks": study.remarks(table)})
    end.write(outs, table.assign(worst=[getattr(own, "title", "") for own in table.worst]))


@grouped
def work_precision(
    engines: Engines,
    *,
    steps: Annotated[
        list[int] | None,
        typer.Option(
            help="Steps per period; may be repeated. Without it, 50, 100, 200, 400 and 800, and twice as many up to "
            "6400 where the error still falls.",
            metavar="N",
        ),
    ] = None,
    store: Store = None,
    out: Outs = None,
    computing: Computing,
) -> None:
    """Compare engines and the reference by the error to the proven value over the time of a simulated second.

    The time of an engine is that of the searches for its steady states over the time that they simulate; one of --store
    is that of the earlier run.

    Exit code 0: the table is complete, whatever its numbers.

    Example: multibody-xval run work-precision --engine mujoco:joint:all --out speed.md --out speed.svg
    """
    from reference_lcp.defaults import FEWEST_STEPS_PER_PERIOD
    from reference_lcp.validation import MOST_STEPS, checked_count

    asked = sorted({checked_count("steps", count, FEWEST_STEPS_PER_PERIOD, MOST_STEPS) for count in steps or ()})
    outs, means = check_outs(out, (*TABLE_ENDINGS, *CHART_ENDINGS), store), computing.means(store)
    configs = compared(engines)
    from multibody_xval.reports.figures.studies import costs
    from multibody_xval.scenarios.result_tables import points
    from multibody_xval.scenarios.ruler.judge import judged
    from multibody_xval.scenarios.running.evaluate import computed
    from multibody_xval.scenarios.studies import step_study as study

    with keeping(store):
        runs = study.step_runs(configs, asked or study.USUAL_STEPS)
        then = [] if asked else [("finer steps", study.finer)]
        every = points(computed(runs, means, then=then))
    table = study.step_table(judged(every))
    command = engines.command("work-precision", [f"--steps={count}" for count in asked])
    end = Shown("Work and precision", command, every, study.LEGEND)
    end.show({"": study.shown(table), "Remarks": study.remarks(table)})
    end.write(outs, table.drop(columns="config"), lambda: costs(table))


@grouped
def friction_map(engines: ScenarioEngines, *, store: Store = None, out: Outs = None, computing: Computing) -> None:
    """Measure the force that keeps a box sliding, at speeds from 10 µm/s to 1 m/s and at angles to the world's axes.

    Exit code 0: the table is complete, whatever its numbers.

    Example: multibody-xval run friction-map --engine mujoco --engine pybullet --out map.csv --out map.svg
    """
    outs = check_outs(out, (*TABLE_ENDINGS, *CHART_ENDINGS), store)
    from multibody_xval.reports.figures.studies import frictions
    from multibody_xval.scenarios.catalogue import friction_map as study
    from multibody_xval.scenarios.catalogue.scenes.pushed_box import PUSHED_FROM_REST
    from multibody_xval.scenarios.running.evaluate import computed

    configs = PUSHED_FROM_REST.configs(engines.names)
    if not configs:
        raise ParameterError(f"engine = {', '.join(engines.names)} has no scenes of boxes; allowed: one that has")
    with keeping(store):
        table = study.friction_map(computed(study.map_runs(configs), computing.means(store), "driven boxes"))
    end = Shown("Effective friction", engines.command("friction-map"), table, study.LEGEND)
    end.show({"Friction over μ m g, less 1 [%]": study.shown(table), "Remarks": study.remarks(table)})
    end.write(outs, table, lambda: frictions(table))
