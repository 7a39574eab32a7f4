"""What several commands have in common: options, one by one and in groups, and how a command computes with them."""

from __future__ import annotations

import shlex
import sys
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, fields, is_dataclass
from functools import wraps
from inspect import Parameter, Signature, signature
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, get_type_hints

import typer

from multibody_xval.engines.completion import complete_variant
from multibody_xval.reports.cli.ending import Interrupted
from multibody_xval.scenarios.compute import SECONDS_A_RUN
from multibody_xval.scenarios.output_files import checked_output_file
from reference_lcp.errors import ParameterError, shown

if TYPE_CHECKING:
    from multibody_xval.engines.interface.variant import Variant
    from multibody_xval.scenarios.running.evaluate import Means

NAME_METAVAR = "NAME[:FORMULATION[:PRESET]]"

EVERY_PART = "`all` stands for every one that is installed. May be repeated. "

ENGINE_HELP = f"{NAME_METAVAR}; a name alone: joint:tuned. {EVERY_PART}"


def engine_option(text: str, metavar: str = "ENGINE") -> Any:
    """Give the option ``--engine``, with its help and its completion."""
    return typer.Option("--engine", metavar=metavar, help=text, autocompletion=complete_variant)


Settings = Annotated[
    list[str] | None,
    typer.Option(
        "--set",
        metavar="OPTION=VALUE",
        help="Change an option of the only --engine; may be repeated.",
    ),
]
Store = Annotated[
    Path | None,
    typer.Option(metavar="FILE", help="Keep every result in this file; a stopped run continues from it."),
]
Workers = Annotated[int | None, typer.Option(help="Worker processes; without it, one per processor.")]
Scheduler = Annotated[str | None, typer.Option(metavar="ADDRESS", help="Compute on the workers of a dask scheduler.")]


AsJson = Annotated[bool, typer.Option("--json", help="Print JSON.")]
TableFiles = Annotated[
    list[Path] | None,
    typer.Option("--out", metavar="FILE", help="Write the table as .md, or with every digit as .csv; may be repeated."),
]

COMMENT_ENDINGS, TABLE_ENDINGS, CHART_ENDINGS = (".md", ".json", ".csv"), (".md", ".csv"), (".svg", ".pdf", ".png")
"""Formats of a comment with its numbers, of a table, and of a figure."""


@dataclass(frozen=True)
class Engines:
    """The variants that a command is about."""

    chosen: Annotated[list[str] | None, engine_option(f"{ENGINE_HELP}Without it: all:all:all.")] = None
    settings: Settings = None

    @property
    def names(self) -> list[str]:
        """The chosen names, of which the only one has the settings too."""
        names = list(self.chosen or [])
        if not self.settings:
            return names
        for setting in self.settings:
            if "=" not in setting:
                raise ParameterError(f"--set {shown(setting)} sets no value; allowed: OPTION=VALUE")
        if len(names) != 1:
            problem = f"--set {self.settings[0]} beside {len(names)} --engine"
            raise ParameterError(f"{problem}; allowed: one, or --engine NAME:OPTION=VALUE for each")
        return [":".join([names[0], *self.settings])]

    def variants(self) -> list[Variant]:
        """Give the variants of these names, those of every installed engine without any."""
        from multibody_xval.engines.interface.variant import EVERY_VARIANT, variants_named

        self.announce_absent()
        return variants_named(self.names or [EVERY_VARIANT])

    def announce_absent(self) -> None:
        """Say which engines are left out since they are not installed, where all are asked."""
        from multibody_xval.engines.interface.registry import engine_names, installed_engine_names
        from multibody_xval.engines.interface.variant import ALL

        if self.names and not any(name.partition(":")[0] == ALL for name in self.names):
            return
        installed = installed_engine_names()
        absent = [name for name in engine_names() if name not in installed]
        if absent:
            print(f"not installed: {', '.join(absent)}; `multibody-xval engines` has the commands", file=sys.stderr)

    def command(self, name: str, options: Sequence[str] = ()) -> str:
        """Give the command that made a document: `run` with its name, the chosen engines and other options."""
        return shlex.join(
            ["multibody-xval", "run", *name.split(), *(f"--engine={each}" for each in self.names), *options]
        )


@dataclass(frozen=True)
class ScenarioEngines(Engines):
    """The configurations that answer scenarios, see `Scenario.configs`."""

    chosen: Annotated[
        list[str] | None,
        engine_option(
            f"{NAME_METAVAR}; a name alone: joint:tuned, in scenes default and recommended. {EVERY_PART}"
            "Without it: all that are installed."
        ),
    ] = None


@dataclass(frozen=True)
class Figure3Engines(Engines):
    """The configurations that are drawn beside the reference."""

    chosen: Annotated[
        list[str] | None,
        engine_option(f"{ENGINE_HELP}Without it: the reference alone."),
    ] = None

    def variants(self) -> list[Variant]:
        """Give the configurations of these names, none without any."""
        return super().variants() if self.names else []


@dataclass(frozen=True)
class Computing:
    """What computes runs, as `Means` takes it."""

    workers: Workers = None
    time_limit: Annotated[float, typer.Option(help="Seconds after which a run is stopped.")] = SECONDS_A_RUN
    scheduler: Scheduler = None
    retry_failed: Annotated[
        bool,
        typer.Option(
            "--retry-failed",
            help="Run again what failed before.",
        ),
    ] = False

    def means(self, store: Path | None) -> Means:
        """Give what computes, and where results are kept."""
        from multibody_xval.scenarios.running.evaluate import Means

        return Means(
            store=store, workers=self.workers, scheduler=self.scheduler, seconds_a_run=self.time_limit,
            retry_failed=self.retry_failed,
        )  # fmt: skip

    def check(self, store: Path | None, *, run: bool) -> None:
        """Refuse to run something again where nothing is run, and to show results that are nowhere."""
        if self.retry_failed and not run:
            raise ParameterError("--retry-failed with --no-run, which runs nothing; allowed: one of the two")
        if not run and store is None:
            raise ParameterError(
                "--no-run without --store; allowed where nothing is run: a store of an earlier command"
            )


@contextmanager
def keeping(store: Path | None) -> Iterator[None]:
    """Print what is kept at Ctrl-C, and end the command."""
    try:
        yield
    except KeyboardInterrupt:
        where = "nothing is kept without --store"
        if store is not None:
            where = f"results are kept in {store}; the same command goes on from there"
        raise Interrupted(f"interrupted: {where}") from None


def grouped(command: Callable[..., None]) -> Callable[..., None]:
    """Give a command in which every field of the records that it takes is an option of its own."""
    kinds = get_type_hints(command, include_extras=True)
    groups: dict[str, Any] = {name: kind for name, kind in kinds.items() if is_dataclass(kind)}

    @wraps(command)
    def of_options(**given: Any) -> None:
        for name, kind in groups.items():
            given[name] = kind(**{each.name: given.pop(each.name) for each in fields(kind)})
        command(**given)

    options: list[Parameter] = []
    for name, parameter in signature(command, eval_str=True).parameters.items():
        options += signature(groups[name], eval_str=True).parameters.values() if name in groups else [parameter]
    vars(of_options)["__signature__"] = Signature([own.replace(kind=Parameter.KEYWORD_ONLY) for own in options])
    return of_options


def check_outs(
    outs: Iterable[Path] | None, endings: Sequence[str], *inputs: Path | None, name: str = "--out"
) -> list[Path]:
    """Give the files to write; refuse one that cannot be written, of no known ending, named twice or of `inputs`."""
    checked: list[Path] = []
    for out in outs or ():
        if out.suffix not in endings:
            raise ParameterError(f"{name} = {out} has the ending {out.suffix!r}; allowed: {' or '.join(endings)}")
        checked.append(checked_output_file(name, out, [*inputs, *checked]))
    return checked
