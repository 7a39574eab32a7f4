"""Where the numbers of a report come from: versions, options, steps, tolerances, grid."""

import platform
from datetime import UTC, datetime
from importlib.metadata import version
from typing import TYPE_CHECKING, Any

import pandas as pd

from multibody_xval.engines.interface.registry import engine
from multibody_xval.engines.interface.variant import Variant
from multibody_xval.reports.data.descriptions import band_definition, compared_with, drive_description
from multibody_xval.reports.data.points import by_variant
from multibody_xval.scenarios.runs.result import ResultStatus
from multibody_xval.scenarios.sweeps.attenuation_band import EDGE_RESOLUTION
from multibody_xval.scenarios.sweeps.checks import Check
from multibody_xval.scenarios.sweeps.dataset import description_of
from multibody_xval.scenarios.verdicts.finding import FLOOR_DB
from reference_lcp.defaults import DEFAULT_RESIDUAL, LARGEST_PHASE_STEP

if TYPE_CHECKING:
    from multibody_xval.reports.data.report import Report

PACKAGES = ("multibody-xval", "numpy", "scipy", "numba")
"""What every number depends on, beside the engines."""


def provenance(report: "Report") -> dict[str, Any]:
    """Give all that a reader needs to reproduce the numbers, as plain data."""
    sweep, given = report.result.sweep, report.result.sweep.tolerance
    curves = report.points.groupby("case", sort=False)["frequency_ratio"]
    grids: dict[Any, list[float]] = curves.agg(set).map(sorted).to_dict()
    return {
        "command": report.command,
        "written": datetime.now(UTC).strftime("%Y-%m-%d %H:%M UTC"),
        "python": f"{platform.python_implementation()} {platform.python_version()}",
        "platform": f"{platform.system()} {platform.machine()}",
        "packages": {package: version(package) for package in PACKAGES},
        "variants": [
            _variant(report, variant, points) for variant, points in by_variant(report.points, sweep.variants).items()
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
        "frequency_ratios": {", ".join(map(repr, case.by_axis.values())): grids.get(case, []) for case in sweep.cases},
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
        "starts": [_check(check, "searched_both_ways", "elsewhere") for check in report.starts],
        "models": [_check(check, "compared", "differing") for check in report.result.models],
        "tolerances": {
            "residual": DEFAULT_RESIDUAL,
            "floor_db": FLOOR_DB,
            "given": None
            if given is None
            else {"transmittance_db": given.transmittance_db, "baseline": str(given.baseline)},
        },
    }


def _check(check: Check, compared: str, differing: str) -> dict[str, Any]:
    """Give a check with the names of its numbers."""
    numbers = {compared: check.compared, differing: check.differing}
    return {"variant": str(check.variant), "title": check.variant.title, **numbers}


def _variant(report: "Report", variant: Variant, points: pd.DataFrame) -> dict[str, Any]:
    """Describe one variant: what it is, how it is set up, how well it converged."""
    of, converged = engine(variant.engine), points[points["status"] == ResultStatus.CONVERGED]
    described = report.recorded.get(str(variant)) or description_of(variant)
    return {
        "engine": variant.engine,
        "formulation": variant.formulation,
        "preset": variant.preset_name,
        "title": variant.title,
        "blocked": report.blocked.get(variant),
        "licence": of.capabilities.licence,
        "friction_law": str(of.capabilities.friction_law),
        "precision": of.capabilities.precision,
        "notes": of.capabilities.notes,
        "compared_with": compared_with(variant, report.result.sweep.tolerance),
        **described,
        "options": [{**option, "reach": variant.reach(option["name"])} for option in described["options"]],
        "steps_per_period": sorted(map(int, set(converged["steps_per_period"]))),
        "worst_residual": float(converged["residual"].max()),
    }
