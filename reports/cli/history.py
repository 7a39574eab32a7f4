"""``multibody-xval history`` and ``bisect``: what released versions of an engine do with dry friction."""

from __future__ import annotations

import sys
import tempfile
from collections.abc import Mapping
from contextlib import suppress
from functools import cache, partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from reports.cli.options import Work, check_outs

if TYPE_CHECKING:
    from reports.reproducers.scene_script import SceneReproduction
    from reports.reproducers.script import Reproduction
    from scenarios.studies.history import ReleasedEngine, ReleasedVersion, VersionNumbers

SCRIPTED = ("figure3", "slope-hold", "slide-to-stop", "joint-hold")
"""Scenarios whose scripts versions are asked beside blocks: a point of the chain, and scenes."""

app = typer.Typer(name="multibody-xval", add_completion=False, pretty_exceptions_enable=False)

Engine = Annotated[str, typer.Argument(metavar="NAME", help="The engine.")]
First = Annotated[str | None, typer.Option("--from", metavar="VERSION", help="The oldest version that is asked.")]
Last = Annotated[
    str | None, typer.Option("--to", metavar="VERSION", help="The newest version; without it, the latest.")
]
Kept = Annotated[
    Path | None, typer.Option("--store", help="JSON file that keeps every version; a stopped run continues from it.")
]


@app.command()
def history(
    engine: Engine,
    *,
    first: First = None,
    last: Last = None,
    store: Kept = None,
    out: Annotated[Path | None, typer.Option(help="Write the page too, as .md.")] = None,
) -> None:
    """Ask every released version of an engine about dry friction, and say what changed.

    Each version gets an environment of its own, which is removed again. It runs blocks as plain scripts of the engine,
    and what reproduce prints of its default: a point of the chain, and scenes. Errors are against the exact motion.
    Exit code 0: asked, whatever changed; 2: wrong input, or the disk has no room; 3: --store or --out could not be
    written; 130: interrupted.

    Example: multibody-xval history mujoco --from 3.2 --store mujoco.json --out mujoco.md
    """
    from reference_lcp.output import write_whole
    from scenarios.studies.history import History, history_document, releases

    known = History(engine, store)
    check_outs([out], (".md",), store)
    versions = releases(known.engine, first, last)
    _announce(known.engine, versions)
    known.scripts = cache(partial(_scripts, _shown(known.engine)))
    found: list[VersionNumbers] = []
    for release in versions:
        found.append(known.of(release))
        print(f"{release.version}: {found[-1].reason or f'{len(found[-1].numbers)} numbers'}", file=sys.stderr)
    page = history_document(engine, found)
    print(page, end="")
    if out is not None:
        write_whole(out, page)


@app.command()
def bisect(
    engine: Engine,
    *,
    metric: Annotated[str, typer.Option(help="The number; a wrong one lists all that there are.")],
    first: First = None,
    last: Last = None,
    tolerance: Annotated[float, typer.Option(help="Part of an error by which versions may differ.")] = 1e-8,
    store: Kept = None,
) -> None:
    """Find between which two released versions of an engine a number changed.

    Exit code 0: found; 2: wrong input, or the disk has no room; 3: the ends do not differ, or do not give the number;
    130: interrupted.

    Example: multibody-xval bisect mujoco --from 3.8.0 --metric "joint block-held velocity"
    """
    from reference_lcp.validation import checked_scalar
    from scenarios.studies.history import History, VersionChange, first_change, numbers_of, releases

    checked_scalar("tolerance", tolerance, "> 0")
    known = History(engine, store)
    shown = _shown(known.engine)
    number = numbers_of(known, metric, list(shown))
    versions = releases(known.engine, first, last)
    _announce(known.engine, versions)
    known.scripts = cache(partial(_scripts, shown))
    before, after, old, new = first_change(versions, number, tolerance)
    found = VersionChange(metric, before.version, after.version, old, new)
    print(f"{metric}: {old:.12g} in {before.version} ({before.date})")
    print(f"{metric}: {new:.12g} in {after.version} ({after.date}), {found.direction} by {abs(new - old):.3g}")


def _shown(engine: ReleasedEngine) -> dict[str, Reproduction | SceneReproduction]:
    """Give what `reproduce` can print of the defaults of the installed version, by its name, before any work."""
    from engines.interface.registry import registered_engine
    from engines.interface.variant import Variant
    from reference_lcp.errors import ParameterError
    from reports.reproducers.scene_script import reproduction

    shown = {}
    adapters = [registered_engine(name) for name in engine.adapters]
    variants = [
        Variant(adapter.name, str(formulation), "default")
        for adapter in adapters
        if adapter.unavailable_reason() is None
        for formulation, presets in adapter.capabilities.presets.items()
        if "default" in presets
    ]
    for variant in variants:
        for scenario in SCRIPTED:
            with suppress(ParameterError):  # it has no such script
                own = reproduction(str(variant), scenario)
                shown[f"{variant} {scenario} [{own.metric.unit}]"] = own
    return shown


def _scripts(shown: Mapping[str, Reproduction | SceneReproduction]) -> dict[str, str]:
    """Write the scripts; the numbers that stand in them are computed."""
    from reports.reproducers.scene_script import reproduction_script

    variants = [own.variant for own in shown.values()]
    with Work(1).evaluator(None, variants) as evaluator:
        return {name: reproduction_script(own, evaluator) for name, own in shown.items()}


def _announce(engine: ReleasedEngine, versions: list[ReleasedVersion]) -> None:
    """Say what is made, one after the other; refuse a disk without room."""
    from scenarios.studies.history import check_room

    needed = check_room(versions, Path(tempfile.gettempdir()))
    ends = f"{versions[0].version} to {versions[-1].version}"
    room = f"environments of up to {needed / 1e6:.0f} MB, one at a time"
    print(f"{len(versions)} versions of {engine.package}, {ends}: {room}", file=sys.stderr)
