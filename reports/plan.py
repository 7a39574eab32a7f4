"""What a report shows, before any work: of a sweep's file, named variants, all that is stored, or the default one."""

import shlex
import sys
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from multibody_xval.engines.interface.law import Law
from multibody_xval.engines.interface.presets import Formulation
from multibody_xval.engines.interface.variant import Variant, default_variants, recommended_variants, variants_named
from multibody_xval.engines.shared.law_distance import stepped_by, unclaimed_reason
from multibody_xval.reports.data.collect import QUICK, Scope
from multibody_xval.reports.data.options import TITLES
from multibody_xval.scenarios.runs.parameters import ChainRatios
from multibody_xval.scenarios.studies.figure3 import (
    FRICTION_RATIOS,
    QUICK_FRICTION_RATIOS,
    default_frequency_ratios,
    figure3,
    quick_frequency_ratios,
)
from multibody_xval.scenarios.sweeps.run import saved_sweeps
from multibody_xval.scenarios.sweeps.spec_file import read_sweep
from multibody_xval.scenarios.sweeps.sweep import Sweep, check_size
from multibody_xval.scenarios.verdicts.steady_case import REFERENCE
from reference_lcp.chain.simulation import Lane
from reference_lcp.errors import ParameterError

PROGRAM = ("multibody-xval", "report")

SCENARIOS = ("frictionless-limit", "locked-limit", "unit-cell", "breakaway", "stopping-distance")
"""Scenarios of the default report: limits, transitions and thresholds; half a minute of a processor at most."""


@dataclass(frozen=True)
class PlannedReport:
    """What a report shows: its sweep, the parts beside its grid, and the command that gives the same numbers."""

    sweep: Sweep
    scope: Scope
    command: str


def planned_report(names: Sequence[str], file: Path | None, *, quick: bool, stored_in: Path | None) -> PlannedReport:
    """Plan a report before any work: of a sweep's file, named variants, all that is stored, or the default one."""
    if file is not None:
        if names or quick:
            raise ParameterError("--sweep names engines and grid; allowed beside it: neither --engine nor --quick")
        return PlannedReport(sweep_of(file), Scope(), command_of(names, quick, file))
    if names:
        planned = _figure3(variants_named(names), quick)
        scope = replace(QUICK if quick else Scope(), beside=_siblings(planned))
        return PlannedReport(planned, scope, command_of(names, quick, None))
    if stored_in is not None and not quick:
        stored = stored_sweep(stored_in)
        return PlannedReport(stored, _scope(_beside(stored)), command_of((), False, None, stored_in))
    planned = _default_sweep(quick)
    beside = _beside(planned)
    scope = _scope(beside)
    if quick:
        installed = tuple(variant for variant in planned.variants if variant.preset_name == "default")
        scope = replace(QUICK, beside=beside, recommended=scope.recommended, claims=installed)
    else:
        scope = replace(scope, claims=(*planned.variants, *scope.recommended), scenarios=SCENARIOS)
    return PlannedReport(planned, scope, command_of((), quick, None))


def _scope(beside: tuple[Variant, ...]) -> Scope:
    """Give the parts beside a sweep.

    Recommended presets are beside it where they settle by a model of their steps: the others take seconds a point.
    """
    recommended = tuple(own for own in recommended_variants() if beside and _settles(own))
    return Scope(beside=beside, recommended=recommended)


def stored_sweep(store: Path) -> Sweep:
    """Give the sweep that a store saved last, with all engines that it has of these points; others are named."""
    saved = saved_sweeps(store)
    for other in saved.others:
        names = ", ".join(map(str, other.variants))
        axes = ", ".join(f"{len(values)} of {name}" for name, values in other.axes.items())
        print(f"not shown: the store also has {axes}, of {names}; --sweep FILE shows them", file=sys.stderr)
    return saved.sweep.with_reference()


def _default_sweep(quick: bool) -> Sweep:
    """Give the sweep of Figure 3 with all joints, tuned and default, which settle by laws that hold at every point.

    What no law predicts is unmodelled wherever it deviates, and the comparison would always fail.
    """
    joints = [variant for variant in default_variants() if variant.formulation == Formulation.JOINT]
    planned = _figure3(joints, quick)
    return replace(planned, variants=_predicted(planned))


def _beside(planned: Sweep) -> tuple[Variant, ...]:
    """Give every other default variant: these are compared at a few points."""
    return tuple(variant for variant in default_variants() if variant not in planned.variants)


def _siblings(planned: Sweep) -> tuple[Variant, ...]:
    """Give the presets of README and page of the engines and formulations of a sweep that are not in it.

    A recommended preset that does not settle by a model of its steps takes seconds a point.
    """
    tuned = dict.fromkeys(own.tuned for own in planned.variants if own.engine != REFERENCE.engine)
    siblings = []
    for variant in tuned:
        presets = variant.capabilities.presets[Formulation(variant.formulation)]
        siblings += [replace(variant, preset_name=name) for name in TITLES if name in presets]
    return tuple(
        own for own in siblings if own not in planned.variants and (own.preset_name != "recommended" or _settles(own))
    )


def _predicted(planned: Sweep) -> tuple[Variant, ...]:
    """Give the variants but for those of engines that no law predicts at every point."""
    lanes = [task.lane()[0] for task in replace(planned, variants=(REFERENCE,)).tasks()]
    return tuple(own for own in planned.variants if own.engine == REFERENCE.engine or _law_holds(own, lanes))


def _law_holds(variant: Variant, lanes: Sequence[Lane]) -> bool:
    law = stepped_by(variant)
    return law is not None and _settles(variant) and all(unclaimed_reason(law, lane) is None for lane in lanes)


def _settles(variant: Variant) -> bool:
    law = stepped_by(variant)
    return law.settles if isinstance(law, Law) else law is not None


def _figure3(variants: list[Variant], quick: bool) -> Sweep:
    ratios = ChainRatios()
    return figure3(
        variants=tuple(variants),
        friction_ratios=QUICK_FRICTION_RATIOS if quick else FRICTION_RATIOS,
        frequency_ratios=quick_frequency_ratios(ratios) if quick else default_frequency_ratios(ratios),
        ratios=ratios,
    )


def sweep_of(file: Path) -> Sweep:
    """Read the sweep of a report from its file: the reference takes part."""
    planned = read_sweep(file).with_reference()
    check_size(planned)
    return planned


def command_of(chosen: Sequence[str], quick: bool, sweep: Path | None, stored: Path | None = None) -> str:
    """Give the command that gives the same numbers, of a `stored` sweep too; the folder of the report is left out."""
    options = ["--quick"] if quick else []
    for name in chosen:
        options += ["--engine", name]
    if sweep is not None:
        options += ["--sweep", str(sweep)]
    if stored is not None:
        options += ["--no-run", "--store", str(stored)]
    return shlex.join([*PROGRAM, *options])
