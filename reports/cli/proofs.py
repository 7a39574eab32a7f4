"""``multibody-xval run proofs``: the table of proven levels, proven again."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from multibody_xval.engines.interface.texts import visible
from multibody_xval.reports.cli.exit_code import ExitCode
from multibody_xval.reports.cli.options import check_outs
from multibody_xval.scenarios.output_files import write_whole
from multibody_xval.scenarios.terminal_table import tracked

if TYPE_CHECKING:
    import pandas as pd


def proofs(
    *,
    sample: Annotated[int | None, typer.Option(help="Prove so many points at random instead of all.")] = None,
    seed: Annotated[int, typer.Option(help="Of the sample.")] = 0,
    out: Annotated[
        list[Path] | None, typer.Option(help="Write the proven levels here, as .csv; may be repeated.")
    ] = None,
) -> None:
    """Prove the steady states of standard grids and catalogue, and compare their levels with the table of the suite.

    Levels on both sides of the edges of the band are proven too, unless it is a sample.
    Exit code 0: all are as in the table; 1: one is not.

    Example: multibody-xval run proofs --sample 20
    """
    outs = check_outs(out, [".csv"])
    from multibody_xval.scenarios.catalogue import proofs as study
    from multibody_xval.scenarios.ruler.proven import DIGITS
    from multibody_xval.scenarios.table_text import print_table
    from reference_lcp.defaults import PROOF_TIME_LIMIT
    from reference_lcp.exact.proof.prove import check_request

    cases = study.chosen_cases(sample, seed)
    check_request(DIGITS, PROOF_TIME_LIMIT)
    table = study.proofs([study.proof_of(case) for case in tracked(cases, "points")])
    summary = study.summary(table)
    print_table(summary)
    _print_exceptions(table)
    crossing = sample is not None or _print_edges()
    for file in outs:
        write_whole(file, study.table_rows(table).to_csv(index=False, lineterminator="\n"))
    if not (table.as_known.all() and crossing):
        raise typer.Exit(ExitCode.FAILED)


def _print_exceptions(table: pd.DataFrame) -> None:
    """Print what is not proven, and what is not as in the table."""
    from multibody_xval.scenarios.result_tables import rows_of

    shown = table[table.level.isna() | ~table.as_known]
    for case, level, reason, known in rows_of(shown, "case", "level", "reason", "as_known"):
        other = "" if known else "not as in the table; "
        print(visible(f"{case.title}: {other}{reason or level}"))


def _print_edges() -> bool:
    """Prove the edges of the band and print them; tell whether the level crosses 0 dB at each."""
    from multibody_xval.scenarios.catalogue.edge_proofs import edge_proofs, known_steps

    edges = edge_proofs()
    for edge in edges:
        print(edge)
    for friction in dict.fromkeys(edge.friction_ratio for edge in edges):
        known, steps = known_steps(friction)
        print(f"friction {friction:g}: all crossings are known in {known} of {steps} steps of the grid: nothing slips")
    return all(edge.crosses for edge in edges)
