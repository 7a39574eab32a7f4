"""Where the numbers of a report come from: versions, options, steps, tolerances, grid."""

import platform
from datetime import UTC, datetime
from importlib.metadata import version
from typing import Any

from engines.interface.registry import engine
from engines.interface.variant import Variant
from reference_lcp.chain.simulation import LARGEST_PHASE_STEP
from reference_lcp.steady.orbits import DEFAULT_RESIDUAL
from reports.data.findings import band_definition, blocked_reason, compared_with, drive_description, findings
from scenarios.studies.attenuation_band import EDGE_RESOLUTION
from scenarios.studies.figure3 import CONVERGED, Figure3Result
from scenarios.verdicts.finding import FLOOR_DB

PACKAGES = ("multibody-xval", "numpy", "scipy", "numba")
"""What every number depends on, beside the engines."""


def provenance(result: Figure3Result, command: str) -> dict[str, Any]:
    """Give everything that a reader needs to reproduce the numbers, as plain data.

    Parameters
    ----------
    result
        The result.
    command
        The command line that asked for it.
    """
    asked = result.asked
    return {
        "command": command,
        "written": datetime.now(UTC).strftime("%Y-%m-%d %H:%M UTC"),
        "python": f"{platform.python_implementation()} {platform.python_version()}",
        "platform": f"{platform.system()} {platform.machine()}",
        "packages": {package: version(package) for package in PACKAGES},
        "variants": [_variant(result, variant) for variant in asked.all_variants],
        "chain": asked.ratios.as_data(),
        "drive": {
            "kind": asked.excitation.kind,
            "amplitude": asked.excitation.amplitude,
            "description": drive_description(asked),
        },
        "friction_ratios": list(asked.friction_ratios),
        "frequency_ratios": {repr(friction): _grid(result, friction) for friction in asked.friction_ratios},
        "band": {
            "definition": band_definition(result),
            "threshold_db": asked.band.threshold_db,
            "depth_db": asked.band.depth_db,
            "resolution": EDGE_RESOLUTION,
        },
        "time_step": (
            f"dt = period / steps per period, with at least {asked.steps_per_period} steps and as many as "
            f"dt ω_max ≤ {LARGEST_PHASE_STEP:g} asks for, ω_max being the highest natural frequency of the linear chain"
        ),
        "tolerances": {
            "residual": DEFAULT_RESIDUAL,
            "floor_db": FLOOR_DB,
            "given": None
            if asked.tolerance is None
            else {"transmittance_db": asked.tolerance.transmittance_db, "ruler": str(asked.tolerance.baseline)},
        },
    }


def _variant(result: Figure3Result, variant: Variant) -> dict[str, Any]:
    """Describe one variant: what it is, how it is set up, how well it converged."""
    of = engine(variant.engine)
    preset = of.preset(variant.formulation, variant.preset_name)
    answers = [point.answer for point in result.points_of(variant) if point.answer.converged]
    return {
        "engine": variant.engine,
        "formulation": variant.formulation,
        "preset": variant.preset_name,
        "title": variant.title,
        "package": of.capabilities.package,
        "version": of.version() if of.unavailable_reason() is None else None,
        "blocked": blocked_reason(result, variant),
        "licence": of.capabilities.licence,
        "friction_law": str(of.capabilities.friction_law),
        "precision": of.capabilities.precision,
        "notes": of.capabilities.notes,
        "compared_with": compared_with(variant, result.asked.tolerance),
        "description": preset.description,
        "options": [
            {"name": name, "value": option.value, "default": option.default, "reason": option.reason}
            for name, option in preset.options.items()
        ],
        "steps_per_period": sorted({answer.steps_per_period for answer in answers}),
        "worst_residual": findings(result, variant).worst_residual,
    }


def _grid(result: Figure3Result, friction_ratio: float) -> list[float]:
    return [point.frequency_ratio for point in result.curve(CONVERGED, friction_ratio)]
