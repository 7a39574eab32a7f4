"""``multibody-xval history``: blocks with dry friction in released versions of an engine."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from multibody_xval.engines.interface.texts import visible
from multibody_xval.reports.cli.options import keeping
from multibody_xval.scenarios.output_files import checked_output_file, checked_output_folder, write_whole
from reference_lcp.errors import ParameterError, checked_choice

app = typer.Typer(
    name="multibody-xval history", add_completion=False, rich_markup_mode=None, pretty_exceptions_enable=False
)


@app.command()
def history(
    name: Annotated[str, typer.Argument(metavar="NAME", help="The engine; a wrong name lists all.")],
    *,
    named: Annotated[str | None, typer.Option("--versions", metavar="V,V", help="As 3.3.7,4.0.0.")] = None,
    last: Annotated[int | None, typer.Option(help="Newest minor versions, with their last patch; else 10.")] = None,
    out: Annotated[Path, typer.Option(help="Folder of NAME.csv and NAME.html.")] = Path("history"),
) -> None:
    """Run blocks with dry friction in released versions of an engine, and show their distance from the exact motion.

    The package index lists the versions, and uv installs each for its runs. Without --versions and --last: the last
    patch of each of the 10 newest minor versions. NAME.csv keeps the results: the versions in it are not run again,
    unless they did not install.

    Exit code 0: the table is complete, whatever its numbers.

    Example: multibody-xval history mujoco --versions 3.3.7,4.0.0
    """
    from multibody_xval.reports.page.history import page
    from multibody_xval.scenarios.table_text import print_table
    from multibody_xval.scenarios.truth import history as study
    from reference_lcp.validation import checked_count

    checked_choice("engine", name, list(study.SCRIPTS))
    if named is not None and last is not None:
        raise ParameterError(f"--last = {last} with --versions = {named}; allowed: one of the two")
    most = checked_count("last", 10 if last is None else last, 1, 100)
    table, uv = study.stored(file := out / f"{name}.csv"), study.uv_found()
    names = study.chosen(study.versions(name, uv), named, most)
    checked_output_folder("--out", out)
    written = checked_output_file("--out", out / f"{name}.html")
    with keeping(file):
        table = study.add_missing(table, name, names, file, uv)
    write_whole(written, page(name, table, f"multibody-xval history {name} --versions {','.join(names)}"))
    own = table[table.version.isin(names)]
    wide = own.pivot_table("off by [m]", "problem", "version", sort=False).map("{:.2g}".format).reset_index()
    print_table(wide, f"Off by, in m, with {name}")
    for version, problem, status in own.loc[own["number [m]"].isna(), ["version", "problem", "status"]].to_numpy():
        print(visible(f"{version}, {problem}: {status}"))
    print(f"{(own.status == 'agrees').sum()} of {own['number [m]'].count()} motions agree; {written}")
