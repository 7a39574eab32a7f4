"""``multibody-xval run laws``: engines beside what their presets say that they step by."""

from __future__ import annotations

from multibody_xval.reports.cli.options import TABLE_ENDINGS, Engines, TableFiles, check_outs, grouped
from multibody_xval.reports.cli.shown import Shown


@grouped
def laws(engines: Engines, *, out: TableFiles = None) -> None:
    """Compare engines with the step models of their presets, over one period from the same state.

    Exit code 0: the table is complete, whatever its numbers.

    Example: multibody-xval run laws --engine mujoco:joint:default --out laws.md
    """
    configs = engines.variants()
    outs = check_outs(out, TABLE_ENDINGS)
    from multibody_xval.reports.cli.compiling import announce_compilation
    from multibody_xval.scenarios.studies import laws as study

    announce_compilation()
    table = study.law_distances(configs)
    shown = Shown("Laws and engines", engines.command("laws"), table, study.LEGEND)
    shown.show({"": study.shown(table), "Formulas": study.formulas(table)})
    shown.write(outs, table)
