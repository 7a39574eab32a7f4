"""Where the numbers of a report come from: versions, options, steps, tolerances, grid."""

import platform
from collections.abc import Mapping, Sequence
from datetime import UTC, datetime
from importlib.metadata import version
from typing import Any

import pandas as pd

from engines.interface.registry import engine
from engines.interface.variant import Variant
from reference_lcp.defaults import DEFAULT_RESIDUAL, LARGEST_PHASE_STEP
from reports.data.descriptions import band_definition, compared_with, drive_description
from reports.data.points import by_variant
from reports.data.variants import blocked_reason
from scenarios.runs.result import ResultStatus
from scenarios.sweeps.attenuation_band import EDGE_RESOLUTION
from scenarios.sweeps.compared import ComparedSweep
from scenarios.sweeps.dataset import description_of
from scenarios.sweeps.start_check import StartCheck
from scenarios.sweeps.sweep import Case, Sweep
from scenarios.verdicts.finding import FLOOR_DB

PACKAGES = ("multibody-xval", "numpy", "scipy", "numba")
"""What every number depends on, beside the engines."""


def provenance(
    result: ComparedSweep,
    command: str,
    points: pd.DataFrame,
    recorded: Mapping[str, Mapping[str, Any]],
    starts: Sequence[StartCheck] = (),
) -> dict[str, Any]:
    """Give all that a reader needs to reproduce the numbers, as plain data; `points` are those of the grid."""
    sweep = result.sweep
    return {
        "command": command,
        "written": datetime.now(UTC).strftime("%Y-%m-%d %H:%M UTC"),
        "python": f"{platform.python_implementation()} {platform.python_version()}",
        "platform": f"{platform.system()} {platform.machine()}",
        "packages": {package: version(package) for package in PACKAGES},
        "variants": [
            _variant(result, variant, own, recorded.get(str(variant)))
            for variant, own in by_variant(points, sweep.variants).items()
        ],
        "chain": {name: value for name, value in sweep.ratios.as_data().items() if name not in sweep.axes},
        "drive": {
            "kind": sweep.excitation.kind,
            "amplitude": sweep.excitation.amplitude,
            "description": drive_description(sweep),
        },
        **{
            name if name == "cells" else f"{name}s": list(values)
            for name, values in sweep.axes.items()
            if name != "frequency_ratio"
        },
        "frequency_ratios": {", ".join(map(repr, case.by_axis.values())): _grid(result, case) for case in sweep.cases},
        "band": {
            "definition": band_definition(sweep),
            "threshold_db": sweep.band.threshold_db,
            "depth_db": sweep.band.depth_db,
            "resolution": EDGE_RESOLUTION,
        },
        "time_step": (
            f"dt = period / steps per period, with at least {sweep.fewest_steps} steps and as many as "
            f"dt ω_max ≤ {LARGEST_PHASE_STEP:g} needs, ω_max being the highest natural frequency of the linear chain"
        ),
        "starts": [_start(check) for check in starts],
        "tolerances": {"residual": DEFAULT_RESIDUAL, "floor_db": FLOOR_DB, "given": _given_tolerance(sweep)},
    }


def _start(check: StartCheck) -> dict[str, Any]:
    return {
        "variant": str(check.variant),
        "title": check.variant.title,
        "searched_both_ways": check.searched,
        "elsewhere": check.elsewhere,
    }


def _given_tolerance(sweep: Sweep) -> dict[str, Any] | None:
    """Give the tolerance that the sweep sets itself, and what it is measured from."""
    given = sweep.tolerance
    if given is None:
        return None
    return {"transmittance_db": given.transmittance_db, "baseline": str(given.baseline)}


def _variant(
    result: ComparedSweep, variant: Variant, points: pd.DataFrame, recorded: Mapping[str, Any] | None
) -> dict[str, Any]:
    """Describe one variant: what it is, how it is set up, how well it converged."""
    of, converged = engine(variant.engine), points[points["status"] == ResultStatus.CONVERGED]
    return {
        "engine": variant.engine,
        "formulation": variant.formulation,
        "preset": variant.preset_name,
        "title": variant.title,
        "blocked": blocked_reason(result, variant),
        "licence": of.capabilities.licence,
        "friction_law": str(of.capabilities.friction_law),
        "precision": of.capabilities.precision,
        "notes": of.capabilities.notes,
        "compared_with": compared_with(variant, result.sweep.tolerance),
        **(recorded or description_of(variant)),
        "steps_per_period": sorted(map(int, set(converged["steps_per_period"]))),
        "worst_residual": float(converged["residual"].max()),
    }


def _grid(result: ComparedSweep, case: Case) -> list[float]:
    return sorted({point.frequency_ratio for variant in result.sweep.variants for point in result.curve(variant, case)})
